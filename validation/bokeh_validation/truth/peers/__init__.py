"""Other depth-of-field effects beside ours and the ray-traced truth: the work behind `validation/run peers`."""

from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from bokeh_validation import drivers, files, jobs, pictures, terminal, truth
from bokeh_validation.errors import Unavailable, UserError
from bokeh_validation.truth import ray_traced
from bokeh_validation.truth.peers import crate, effects, measured
from bokeh_validation.truth.peers.effects import EFFECTS, ONE_LIGHT, Parameters
from bokeh_validation.truth.peers.measured import Drawn, Shape

# What is shown of a scene beside the truth, and where: left and top
SHOWN = (*EFFECTS, "layered medium", "truth")
PLACES = {"market_7": (30, 200), "street_11": (200, 110), "canopy_12": (100, 100)}
DETAIL = (300, 200)


def title(name: str, versions: dict[str, str]) -> str:
    """Of a row."""
    effect = EFFECTS.get(name)
    return f"{effect.title} {versions[effect.package]}" if effect else name


def markdown(rows: list[Drawn], shapes: dict[str, Shape], versions: dict[str, str]) -> list[str]:
    """The table of docs/peers.md."""
    names = list(dict.fromkeys(row.scene for row in rows))
    head = ["", "fetches", "one light", *names]
    lines = [f"| {' | '.join(head)} |", f"|{'---|' * len(head)}"]
    for effect in dict.fromkeys(row.effect for row in rows):
        of_scenes = {row.scene: row for row in rows if row.effect == effect}
        counts = sorted({round(row.fetches) for row in of_scenes.values()})
        count = " to ".join(str(count) for count in dict.fromkeys((counts[0], counts[-1])))
        cells = [f"{of_scenes[name].flip:.4f}/{of_scenes[name].psnr:.2f}/{of_scenes[name].light:.3f}" for name in names]
        shape = f"{shapes[effect].overlap:.2f}/{shapes[effect].light:.2f}"
        lines.append(f"| {' | '.join([title(effect, versions), count, shape, *cells])} |")
    return lines


def parameters(rows: list[Drawn], shapes: dict[str, Shape]) -> dict[str, dict[str, Parameters]]:
    """What every effect was drawn with, as found.json has it."""
    used: dict[str, dict[str, Parameters]] = {}
    for row in rows:
        if row.parameters:
            used.setdefault(row.scene, {})[row.effect] = row.parameters
    return used | {ONE_LIGHT: {name: shape.parameters for name, shape in shapes.items() if shape.parameters}}


def shown(name: str, images: dict[str, np.ndarray], versions: dict[str, str]) -> np.ndarray:
    """A detail of a scene by every effect, 8-bit rgb."""
    exposure, place = truth.EXPOSURE.get(name, 1.0), PLACES[name.removesuffix("x3")]
    details = [
        pictures.Panel(pictures.crop(pictures.filmic(images[label], exposure), *place, *DETAIL), title(label, versions))
        for label in SHOWN if label in images
    ]  # fmt: skip
    width = 3 if len(details) > 4 else 2
    return pictures.grid([details[at : at + width] for at in range(0, len(details), width)])


def _available(asked: list[str]) -> tuple[list[str], dict[str, str], str]:
    """Effects that can be run here, versions of their packages, and the device. Raises UserError."""
    try:
        with effects.Page() as page:
            versions, device = page.versions, drivers.load(measured.DRIVER).adapter
    except Unavailable as error:
        raise UserError(f"the effects cannot be run here ({error}).") from error
    try:
        crate.source()
    except Unavailable as error:
        asked = [name for name in asked if EFFECTS[name].package != crate.NAME]
        terminal.tell(f"without Bevy's: {error}")
    return asked, versions, device


def peers(
    effect: Annotated[list[str] | None, typer.Option(help="May be given again. Default: all.")] = None,
    scene: Annotated[
        list[str] | None, typer.Option(help="Of validation/scenes; may be given again. Default: all.")
    ] = None,
    json_file: terminal.JsonFile = None,
    search: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Search parameters; write them as JSON."),
    ] = None,
    folder: Annotated[
        Path | None, typer.Option("--pictures", metavar="FOLDER", help="Write the pictures of docs/peers.md here.")
    ] = None,
) -> None:
    """Other depth-of-field effects beside ours and the truth (docs/peers.md): FLIP, light, shape, fetches."""
    asked = terminal.chosen("--effect", effect, EFFECTS)
    scenes = ray_traced.chosen(scene)
    terminal.check_writable(json_file, search)
    files.check_folder("--pictures", folder)
    asked, versions, device = _available(asked)
    known = {} if search else effects.parameters()
    work = [(measured.scene, (file.name, _of_place(known, file.name, asked))) for file in scenes]
    work.append((measured.shapes, (_of_place(known, ONE_LIGHT, asked),)))
    with terminal.progress("peers", len(work)) as step:
        *drawn, shapes = jobs.run(work, step)
    rows = [row for of_scene, _ in drawn for row in of_scene]
    for file, (_, images) in zip(scenes, drawn, strict=True) if folder else ():
        page = shown(file.name, images | {"truth": ray_traced.truth(file, "hexagon")}, versions)
        pictures.write_document(folder, f"peers_{file.name}", page)
    numbers = {"device": device, "versions": versions, "rows": [row._asdict() for row in rows]}
    terminal.write_json(json_file, numbers | {"shapes": {name: shape._asdict() for name, shape in shapes.items()}})
    terminal.write_json(search, parameters(rows, shapes))
    terminal.tell(*markdown(rows, shapes, versions), f"FLIP, PSNR, light; {device}")


def _of_place(known: dict[str, dict[str, Parameters]], place: str, asked: list[str]) -> measured.Chosen:
    """Effect -> its parameters on a scene or for one light; None where there are none."""
    return {name: known.get(place, {}).get(name) for name in asked}
