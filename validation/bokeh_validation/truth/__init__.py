"""Every method on every scene against what a lens sees there: the work behind `validation/run truth`."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from bokeh_validation import files, metrics, pictures, terminal
from bokeh_validation.drivers.base import Driver
from bokeh_validation.errors import UserError
from bokeh_validation.pictures import Panel
from bokeh_validation.probes.model import Case
from bokeh_validation.truth import labels, motion, random_score, ray_traced
from bokeh_validation.truth.labels import METHODS
from bokeh_validation.truth.ray_traced import SceneFile

DEFAULT = METHODS[: METHODS.index("layered medium") + 1]
# Above it, the memory of places to look at
MOST_RANDOM = 10_000
# How bright the scenes are shown
EXPOSURE = {"market_7": 2.2, "canopy_12": 0.5, "canopy_12x3": 0.5}
CAPTIONS = {
    "pinhole": "input: colour and depth through a pinhole",
    "paper": "paper, hexagon, 13 samples per line",
    "gather": "gather: Listing 3, 924 samples",
    "layered medium": "layered, preset MEDIUM",
    "truth": "truth: ray traced through a lens",
}
# scene, without the times of its lens -> left and top of its detail; width, height
PLACES, DETAIL_SIZE = {"market_7": (600, 220), "street_11": (225, 150), "canopy_12": (100, 100)}, (240, 160)


def case(scene: SceneFile, label: str, aperture: str = "hexagon", **changes) -> Case:
    """A scene by one of METHODS, the polygon turned as in the truth. `changes` to the settings."""
    changes = {"rotation": ray_traced.TRUTH_ROTATION[aperture], **changes}
    image = ray_traced.picture(scene)
    return Case(scene.name, labels.settings(label, scene.camera, aperture, **changes), image.color, image.depth)


def picture(driver: Driver, scene: SceneFile, label: str, aperture: str = "hexagon", **changes) -> np.ndarray:
    """What a method makes of a scene, (H, W, >= 3). The rest as of case()."""
    return labels.picture(driver, label, case(scene, label, aperture, **changes))


def measured(image: np.ndarray, lens: np.ndarray) -> dict[str, float]:
    """A picture against the truth: mean FLIP; PSNR of tone-mapped colour, dB; linear light over that of the truth."""
    light = image[..., :3].astype(np.float64).sum() / lens[..., :3].astype(np.float64).sum()
    return {"flip": metrics.flip(image, lens), "psnr": metrics.psnr(image, lens), "light": float(light)}


def markdown(rows: Sequence[Mapping]) -> list[str]:
    """The table of docs/results.md: a row for a method, a column for a scene; FLIP, PSNR in dB, light kept."""
    names = dict.fromkeys(row["scene"] for row in rows)
    lines = [f"| | {' | '.join(names)} |", f"|{'---|' * (len(names) + 1)}"]
    for label in dict.fromkeys(row["label"] for row in rows):
        cells = ["{flip:.4f}/{psnr:.2f}/{light:.3f}".format_map(row) for row in rows if row["label"] == label]
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


def ray_traced_report(
    methods: Sequence[str], used: Driver, folder: Path | None, scenes: Sequence[SceneFile]
) -> tuple[list[dict], list[str]]:
    """Rows and their table, and pictures into a folder."""
    rows = []
    with terminal.progress("truth", len(scenes) * len(methods)) as step:
        for file in scenes:
            lens, images = ray_traced.truth(file, "hexagon"), {}
            for label in methods:
                images[label] = picture(used, file, label)
                rows.append({"scene": file.name, "label": label, **measured(images[label], lens)})
                step(f"{file.name}, {label}")
            for name, pixels in shown(file, images | {"truth": lens}).items() if folder else ():
                pictures.write_document(folder, name, pixels)
    return rows, markdown(rows)


def truth(
    method: Annotated[
        list[str] | None,
        typer.Option(help=f"Of {', '.join(METHODS)}; may be given again. Default: those up to layered medium."),
    ] = None,
    scene: Annotated[
        list[str] | None, typer.Option(help="Of validation/scenes; may be given again. Default: all.")
    ] = None,
    count: Annotated[
        int | None,
        typer.Option("--random", metavar="N", help="N random scenes, by layered medium unless others are named."),
    ] = None,
    seed: Annotated[int | None, typer.Option(metavar="S", help="Of the first random scene. Default: 0.")] = None,
    sequence: Annotated[
        str | None, typer.Option("--motion", metavar="NAME", help=f"Flicker: {', '.join(motion.NAMES)}, or all.")
    ] = None,
    driver: terminal.OneDriver = None,
    adapter: terminal.Adapter = None,
    json_file: terminal.JsonFile = None,
    folder: Annotated[
        Path | None, typer.Option("--pictures", metavar="FOLDER", help="Write the pictures of docs/results.md here.")
    ] = None,
) -> None:
    """How near every method comes to what a lens sees (docs/results.md): FLIP, PSNR, light relative to it, on
    ray-traced scenes. --random, --motion: on rasterised ones, faults counted, or how much it flickers.
    """
    given = {"--scene": scene, "--random": count, "--motion": sequence}
    if len(several := [name for name, value in given.items() if value is not None]) > 1:
        raise UserError(f"{' and '.join(several)}: those are different pictures. Give one of them.")
    if seed is not None and (count is None or seed < 0):
        raise UserError(f"--seed {seed}: not allowed. Give 0 or more, with --random N.")
    if count is not None and not 1 <= count <= MOST_RANDOM:
        raise UserError(f"--random {count}: not allowed. Give 1 to {MOST_RANDOM}.")
    known, default = (METHODS, DEFAULT) if sequence is None else (motion.KNOWN, motion.DEFAULT)
    chosen = terminal.chosen("--method", method, known, default if count is None else DEFAULT[-1:])
    names, scenes = motion.chosen(sequence), ray_traced.chosen(scene)
    terminal.check_writable(json_file)
    files.check_folder("--pictures", folder)
    used = terminal.pick_driver(driver, adapter)
    if count is not None:
        rows, lines = random_score.report(chosen, used.name, adapter, folder, range(seed or 0, (seed or 0) + count))
    elif sequence is not None:
        rows, lines = motion.report(chosen, used.name, adapter, folder, names)
    else:
        rows, lines = ray_traced_report(chosen, used, folder, scenes)
    terminal.write_json(json_file, {"driver": used.name, "adapter": used.adapter, "rows": rows})
    terminal.tell(*lines, f"{used.name} ({used.adapter})")
