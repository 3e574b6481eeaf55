"""Other depth-of-field effects beside ours and the ray-traced truth: the work behind `validation/run peers`."""

from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from bokeh_validation import drivers, jobs, pictures, terminal, truth
from bokeh_validation.errors import Unavailable, UserError
from bokeh_validation.truth import ray_traced
from bokeh_validation.truth.peers import Peers, crate, measured
from bokeh_validation.truth.peers.effects import EFFECTS, ONE_LIGHT, Parameters, found
from bokeh_validation.truth.peers.measured import Drawn, Shape

# What is shown of a scene beside the truth, and where: left and top
SHOWN = (*EFFECTS, "layered medium", "truth")
PLACES = {"market_7": (30, 200), "street_11": (200, 110), "canopy_12": (100, 100)}
DETAIL = (300, 200)


def title(name: str, versions: dict[str, str]) -> str:
    """Of a row."""
    effect = EFFECTS.get(name)
    return f"{effect.title} {versions[effect.package]}" if effect else name


def markdown(
    rows: list[Drawn], shapes: dict[str, Shape], times: dict[str, float], versions: dict[str, str]
) -> list[str]:
    """The table of docs/peers.md."""
    names = list(dict.fromkeys(one.scene for one in rows))
    head = ["", "fetches", "ms", "one light", *names]
    lines = [f"| {' | '.join(head)} |", f"|{'---|' * len(head)}"]
    for effect in dict.fromkeys(one.effect for one in rows):
        mine = {one.scene: one for one in rows if one.effect == effect}
        counts = sorted({round(one.fetches) for one in mine.values()})
        count = " to ".join(str(count) for count in dict.fromkeys((counts[0], counts[-1])))
        cells = [f"{mine[name].flip:.4f}/{mine[name].psnr:.2f}/{mine[name].light:.3f}" for name in names]
        shape = f"{shapes[effect].overlap:.2f}/{shapes[effect].light:.2f}"
        taken = f"{times[effect]:.0f}" if effect in times else ""
        lines.append(f"| {' | '.join([title(effect, versions), count, taken, shape, *cells])} |")
    return lines


def parameters(rows: list[Drawn], shapes: dict[str, Shape]) -> dict[str, dict[str, Parameters]]:
    """What every effect was drawn with, as effects.found() has it."""
    used: dict[str, dict[str, Parameters]] = {}
    for one in rows:
        if one.parameters:
            used.setdefault(one.scene, {})[one.effect] = one.parameters
    return used | {ONE_LIGHT: {name: shape.parameters for name, shape in shapes.items() if shape.parameters}}


def shown(name: str, images: dict[str, np.ndarray], versions: dict[str, str]) -> np.ndarray:
    """A detail of a scene by every effect, 8-bit rgb."""
    exposure, place = truth.EXPOSURE.get(name, 1.0), PLACES[name.removesuffix("x3")]
    found = []
    for label in SHOWN:
        if label in images:
            pixels = pictures.crop(pictures.filmic(images[label], exposure), *place, *DETAIL)
            found.append(pictures.Panel(pixels, title(label, versions)))
    width = 3 if len(found) > 4 else 2
    return pictures.grid([found[at : at + width] for at in range(0, len(found), width)])


def peers(
    effect: Annotated[list[str] | None, typer.Option(help="May be given again. Default: all.")] = None,
    scene: Annotated[
        list[str] | None, typer.Option(help="Of validation/scenes; may be given again. Default: all.")
    ] = None,
    json_file: terminal.JsonFile = None,
    search: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            callback=terminal.json_target,
            help="Search the best parameters anew, and write them as JSON.",
        ),
    ] = None,
    folder: Annotated[
        Path | None, typer.Option("--pictures", metavar="FOLDER", help="Write the pictures of docs/peers.md here.")
    ] = None,
) -> None:
    """Other depth-of-field effects beside ours and the truth (docs/peers.md): FLIP, light, shape, fetches, time."""
    effects = terminal.chosen("--effect", effect, EFFECTS)
    known = {one.name: one for one in ray_traced.SCENES}
    scenes = [one.name for one in ray_traced.chosen(scene)]
    terminal.check_writable(json_file, search)
    if folder is not None and not folder.is_dir():
        raise UserError(f"--pictures {folder}: there is no such folder. Make it first.")
    try:
        page, driver = Peers(), drivers.load(measured.DRIVER)
    except Unavailable as error:
        raise UserError(f"the effects cannot be run here ({error}).") from error
    try:
        crate.source()
    except Unavailable as error:
        effects = [name for name in effects if EFFECTS[name].package != crate.NAME]
        terminal.tell(f"without Bevy's: {error}")
    versions = page.versions()
    page.close()
    known_best = {} if search else found()
    asked = {name: {one: known_best.get(name, {}).get(one) for one in effects} for name in (*scenes, ONE_LIGHT)}
    work = [(measured.scene, (name, asked[name])) for name in scenes] + [(measured.shapes, (asked[ONE_LIGHT],))]
    with terminal.progress("peers", len(work) + 1) as step:
        *drawn, shapes = jobs.run(work, step)
        rows = [row for found, _ in drawn for row in found]
        best = {one.effect: one.parameters for one in rows if one.scene == scenes[0] and one.parameters}
        times = measured.times(known[scenes[0]], best)
        step("times")
    for name, (_, images) in zip(scenes, drawn, strict=True) if folder else ():
        lens = {"truth": ray_traced.truth(known[name], "hexagon")}
        pictures.write_document(folder, f"peers_{name}", shown(name, images | lens, versions))
    numbers = {"device": driver.adapter, "versions": versions, "times": times, "times_of": scenes[0]}
    numbers["shapes"] = {name: one._asdict() for name, one in shapes.items()}
    terminal.write_json(json_file, numbers | {"rows": [one._asdict() for one in rows]})
    terminal.write_json(search, parameters(rows, shapes))
    terminal.tell(*markdown(rows, shapes, times, versions), f"FLIP, PSNR, light; ms of {scenes[0]}; {driver.adapter}")
