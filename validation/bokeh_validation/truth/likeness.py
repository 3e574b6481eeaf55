"""Every method on every scene against what a lens sees there: the work behind `validation/run truth`."""

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np
import typer
from PIL import Image

from bokeh_validation import metrics, pictures, terminal
from bokeh_validation.drivers.base import Driver
from bokeh_validation.errors import UserError
from bokeh_validation.figures import panels
from bokeh_validation.frame.methods import PRESETS
from bokeh_validation.probes import shapes
from bokeh_validation.probes.model import Case
from bokeh_validation.truth import suite
from bokeh_validation.truth.scatter import scatter
from bokeh_validation.truth.suite import SceneFile

# gather: shapes.brute_force, in one pass with Listing 3's weights; scatter: scatter.py
METHODS = ("pinhole", "paper", "exact", "gather", "scatter", "layered")
# What is drawn of layered where nobody says
SHOWN_PRESETS = ("low", "medium")


class Row(NamedTuple):
    """A picture against the truth of its scene.

    label  the method, for layered with its preset
    flip   mean FLIP, 0 is the truth
    psnr   of tone-mapped colour, dB
    light  sum of linear rgb over that of the truth
    """

    scene: str
    label: str
    flip: float
    psnr: float
    light: float


def chosen(option: str, given: Iterable[str] | None, known: Iterable[str], default: Iterable[str]) -> list[str]:
    """Those of an option in the order of `known`. Raises UserError."""
    for one in given or ():
        if one not in known:
            raise UserError(f"{option} {one}: unknown. Give one of {', '.join(known)}.")
    return [one for one in known if one in (given or default)]


def labels(methods: Iterable[str] | None = None, presets: Iterable[str] | None = None) -> list[str]:
    """Of the rows for --method and --preset; all by default. Raises UserError."""
    layered = [f"layered {name}" for name in chosen("--preset", presets, PRESETS, SHOWN_PRESETS)]
    wanted = chosen("--method", methods, METHODS, METHODS)
    return [method for method in wanted if method != "layered"] + (layered if "layered" in wanted else [])


def case(scene: SceneFile, label: str, aperture: str = "hexagon", **changes) -> Case:
    """A scene by the method of a label, the polygon turned as in the truth. `changes` to the settings."""
    method, _, preset = label.partition(" ")
    kind = {"paper": "paper", "layered": "layered"}.get(method, "exact")
    changes = {"rotation": suite.TRUTH_ROTATION[aperture], **changes}
    changes |= {"spacing": 1.0} if method == "exact" else {"preset": preset} if preset else {}
    found = suite.scene_case(scene, kind, aperture)
    return replace(found, settings=replace(found.settings, **changes))


def picture(driver: Driver, scene: SceneFile, label: str, aperture: str = "hexagon", **changes) -> np.ndarray:
    """What a method makes of a scene, (H, W, >= 3). The rest as of case()."""
    asked, method = case(scene, label, aperture, **changes), label.partition(" ")[0]
    if method == "pinhole":
        return asked.color
    if method == "gather":
        return shapes.brute_force(driver, asked)
    if method == "scatter":
        return scatter(asked)
    return driver.run(asked.plan.passes, asked.textures(), asked.size)["result"]


def row(scene: SceneFile, label: str, image: np.ndarray, lens: np.ndarray) -> Row:
    """A picture measured."""
    light = image[..., :3].astype(np.float64).sum() / lens[..., :3].astype(np.float64).sum()
    return Row(scene.name, label, metrics.flip(image, lens), metrics.psnr(image, lens), float(light))


def markdown(rows: list[Row]) -> list[str]:
    """The table of docs/likeness.md: a row for a method, a column for a scene."""
    names = list(dict.fromkeys(one.scene for one in rows))
    lines = [f"| | {' | '.join(names)} |", f"|{'---|' * (len(names) + 1)}"]
    for label in dict.fromkeys(one.label for one in rows):
        cells = {one.scene: f"{one.flip:.4f}, {one.psnr:.2f} dB, {one.light:.3f}" for one in rows if one.label == label}
        lines.append(f"| {label} | {' | '.join(cells[name] for name in names)} |")
    return lines


# ------------------------------------------------------------------------------------------------------------ pictures

# How bright the scenes are shown
EXPOSURE = {"market_7": 2.2, "canopy_12": 0.5, "canopy_12x3": 0.5}
CAPTIONS = {
    "pinhole": "input: color and depth through a pinhole",
    "paper": "paper, hexagon, 13 samples a line",
    "gather": "gather: Listing 3, 924 samples",
    "scatter": "scatter: each pixel by its own CoC",
    "layered medium": "layered, preset MEDIUM",
    "truth": "truth: ray traced through a lens",
}
WHOLE = ("pinhole", "paper", "layered medium", "truth")
DETAIL = ("gather", "scatter", "layered medium", "truth")
# scene, without the times of its lens -> left and top of its detail; width, height
PLACES, DETAIL_SIZE = {"market_7": (600, 220), "street_11": (225, 150), "canopy_12": (100, 100)}, (240, 160)


def shown(scene: SceneFile, images: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """A detail at twice its size, and market_7 at half: file name -> 8-bit rgb, as far as there are images."""
    exposed = {k: pictures.filmic(image, EXPOSURE.get(scene.name, 1.0)) for k, image in images.items()}
    found = {}
    if scene is suite.MARKET and all(label in images for label in WHOLE):
        halved = {k: np.asarray(Image.fromarray(exposed[k]).reduce(2)) for k in WHOLE}
        found[f"likeness_{scene.name}"] = _grid(halved)
    if all(label in images for label in DETAIL):
        place = PLACES[scene.name.removesuffix("x3")]
        details = {k: pictures.enlarged(panels.crop(exposed[k], *place, *DETAIL_SIZE), 2) for k in DETAIL}
        found[f"likeness_{scene.name}_detail"] = _grid(details)
    return found


def _grid(parts: dict[str, np.ndarray]) -> np.ndarray:
    found = [panels.Panel(pixels, CAPTIONS[label]) for label, pixels in parts.items()]
    return panels.grid([found[:2], found[2:]])


def truth(
    method: Annotated[
        list[str] | None,
        typer.Option(help="pinhole, paper, exact, gather, scatter or layered; may be given again. Default: all."),
    ] = None,
    scene: Annotated[
        list[str] | None, typer.Option(help="Of validation/scenes; may be given again. Default: all.")
    ] = None,
    preset: Annotated[
        list[str] | None, typer.Option(help="layered: low, medium, high or ultra. Default: low and medium.")
    ] = None,
    driver: terminal.OneDriver = None,
    adapter: terminal.Adapter = None,
    json_file: terminal.JsonFile = None,
    folder: Annotated[
        Path | None, typer.Option("--pictures", metavar="FOLDER", help="Write the pictures of docs/likeness.md here.")
    ] = None,
) -> None:
    """How near every method comes to what a lens sees (docs/likeness.md): FLIP, PSNR, light over the truth's."""
    known = {scene.name: scene for scene in suite.SCENES}
    wanted, scenes = labels(method, preset), [known[name] for name in chosen("--scene", scene, known, known)]
    terminal.check_writable(json_file)
    if folder is not None and not folder.is_dir():
        raise UserError(f"--pictures {folder}: there is no such folder. Make it first.")
    used = terminal.pick_driver(driver, adapter)
    rows = []
    with terminal.progress("truth", len(scenes) * len(wanted)) as step:
        for one in scenes:
            lens, images = suite.truth(one, "hexagon"), {}
            for label in wanted:
                images[label] = picture(used, one, label)
                rows.append(row(one, label, images[label], lens))
                step(f"{one.name}, {label}")
            for name, pixels in shown(one, images | {"truth": lens}).items() if folder else ():
                pictures.write_png(folder / f"{name}.png", pictures.coarse(pixels))
    found = {"driver": used.name, "adapter": used.adapter, "rows": [one._asdict() for one in rows]}
    terminal.write_json(json_file, found)
    terminal.tell(*markdown(rows), f"FLIP, PSNR, light; {used.name} ({used.adapter})")
