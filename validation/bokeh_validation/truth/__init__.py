"""Every method on every scene against what a lens sees there: the work behind `validation/run truth`."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from bokeh_validation import files, metrics, pictures, terminal
from bokeh_validation.drivers.base import Driver
from bokeh_validation.frame.methods import PRESETS
from bokeh_validation.pictures import Panel
from bokeh_validation.probes import shapes
from bokeh_validation.probes.model import Case, drawn
from bokeh_validation.truth import ray_traced
from bokeh_validation.truth.ray_traced import SceneFile

# gather: shapes.brute_force, in one pass with Listing 3's weights
METHODS = ("pinhole", "paper", "exact", "gather", *(f"layered {preset}" for preset in PRESETS))
DEFAULT = METHODS[: METHODS.index("layered medium") + 1]
# How bright the scenes are shown
EXPOSURE = {"market_7": 2.2, "canopy_12": 0.5, "canopy_12x3": 0.5}
CAPTIONS = {
    "pinhole": "input: color and depth through a pinhole",
    "paper": "paper, hexagon, 13 samples a line",
    "gather": "gather: Listing 3, 924 samples",
    "layered medium": "layered, preset MEDIUM",
    "truth": "truth: ray traced through a lens",
}
# scene, without the times of its lens -> left and top of its detail; width, height
PLACES, DETAIL_SIZE = {"market_7": (600, 220), "street_11": (225, 150), "canopy_12": (100, 100)}, (240, 160)


def case(scene: SceneFile, label: str, aperture: str = "hexagon", **changes) -> Case:
    """A scene by one of METHODS, the polygon turned as in the truth. `changes` to the settings."""
    method, _, preset = label.partition(" ")
    drawn_by = {"paper": "paper", "layered": "layered"}.get(method, "exact")
    changes = {"rotation": ray_traced.TRUTH_ROTATION[aperture], **changes}
    changes |= {"spacing": 1.0} if method == "exact" else {"preset": preset} if preset else {}
    plain = ray_traced.scene_case(scene, drawn_by, aperture)
    return replace(plain, settings=replace(plain.settings, **changes))


def picture(driver: Driver, scene: SceneFile, label: str, aperture: str = "hexagon", **changes) -> np.ndarray:
    """What a method makes of a scene, (H, W, >= 3). The rest as of case()."""
    blurred, method = case(scene, label, aperture, **changes), label.partition(" ")[0]
    if method == "pinhole":
        return blurred.color
    if method == "gather":
        return shapes.brute_force(driver, blurred)
    return drawn(driver, blurred)


def measured(image: np.ndarray, lens: np.ndarray) -> dict[str, float]:
    """A picture against the truth: mean FLIP; PSNR of tone-mapped colour, dB; linear light over that of the truth."""
    light = image[..., :3].astype(np.float64).sum() / lens[..., :3].astype(np.float64).sum()
    return {"flip": metrics.flip(image, lens), "psnr": metrics.psnr(image, lens), "light": float(light)}


def markdown(rows: Sequence[Mapping]) -> list[str]:
    """The table of docs/likeness.md: a row for a method, a column for a scene, in the order of the rows."""
    names = dict.fromkeys(row["scene"] for row in rows)
    lines = [f"| | {' | '.join(names)} |", f"|{'---|' * (len(names) + 1)}"]
    for label in dict.fromkeys(row["label"] for row in rows):
        cells = ["{flip:.4f}, {psnr:.2f} dB, {light:.3f}".format_map(row) for row in rows if row["label"] == label]
        lines.append(f"| {label} | {' | '.join(cells)} |")
    return lines


def shown(scene: SceneFile, images: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """A detail at twice its size, and market_7 at half: file name -> 8-bit rgb, as far as there are images."""
    exposed = {label: pictures.filmic(image, EXPOSURE.get(scene.name, 1.0)) for label, image in images.items()}
    place, found = PLACES[scene.name.removesuffix("x3")], {}

    def draw(name: str, second: str, cut: Callable[[np.ndarray], np.ndarray]) -> None:
        labels = ("pinhole", second, "layered medium", "truth")
        if set(labels) <= set(images):
            panels = [Panel(cut(exposed[label]), CAPTIONS[label]) for label in labels]
            found[f"likeness_{scene.name}{name}"] = pictures.grid([panels[:2], panels[2:]])

    draw("_detail", "gather", lambda pixels: pictures.enlarged(pictures.crop(pixels, *place, *DETAIL_SIZE), 2))
    if scene is ray_traced.MARKET:
        draw("", "paper", pictures.halved)
    return found


def truth(
    method: Annotated[
        list[str] | None,
        typer.Option(help=f"Of {', '.join(METHODS)}; may be given again. Default: those up to layered medium."),
    ] = None,
    scene: Annotated[
        list[str] | None, typer.Option(help="Of validation/scenes; may be given again. Default: all.")
    ] = None,
    driver: terminal.OneDriver = None,
    adapter: terminal.Adapter = None,
    json_file: terminal.JsonFile = None,
    folder: Annotated[
        Path | None, typer.Option("--pictures", metavar="FOLDER", help="Write the pictures of docs/likeness.md here.")
    ] = None,
) -> None:
    """How near every method comes to what a lens sees (docs/likeness.md): FLIP, PSNR, light over the truth's."""
    chosen, scenes = terminal.chosen("--method", method, METHODS, DEFAULT), ray_traced.chosen(scene)
    terminal.check_writable(json_file)
    files.check_folder("--pictures", folder)
    used, rows = terminal.pick_driver(driver, adapter), []
    with terminal.progress("truth", len(scenes) * len(chosen)) as step:
        for file in scenes:
            lens, images = ray_traced.truth(file, "hexagon"), {}
            for label in chosen:
                images[label] = picture(used, file, label)
                rows.append({"scene": file.name, "label": label, **measured(images[label], lens)})
                step(f"{file.name}, {label}")
            for name, pixels in shown(file, images | {"truth": lens}).items() if folder else ():
                pictures.write_document(folder, name, pixels)
    terminal.write_json(json_file, {"driver": used.name, "adapter": used.adapter, "rows": rows})
    terminal.tell(*markdown(rows), f"FLIP, PSNR, light; {used.name} ({used.adapter})")
