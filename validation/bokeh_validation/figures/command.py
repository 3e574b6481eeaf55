"""The work behind `validation/run figures`."""

import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np
import typer

from bokeh_validation import exr, paths, pictures, terminal
from bokeh_validation.drivers.base import Driver
from bokeh_validation.errors import Unavailable, UserError
from bokeh_validation.figures import depth, diagrams, photographs, points
from bokeh_validation.figures.figure import Figure, Made

_ALL = (*photographs.FIGURES, *depth.FIGURES, *diagrams.FIGURES, *points.FIGURES)
FIGURES: dict[int, Figure] = {figure.number: figure for figure in sorted(_ALL, key=lambda figure: figure.number)}
NUMBERS_FILE = "figures.json"


class Places(NamedTuple):
    """Where a run writes to: pictures for the document, and HDR images with the numbers."""

    pictures: Path
    images: Path


class Result(NamedTuple):
    """What a run made, by figure, and the reasons for what it did not make."""

    made: dict[int, Made]
    missing: dict[int, str]


def chosen(only: str | None) -> list[Figure]:
    """The figures of '1,4,9', in order; None: all. Raises UserError."""
    if only is None:
        return [*FIGURES.values()]
    words = [word.strip() for word in only.split(",")]
    for word in words:
        if not word.isdecimal() or int(word) not in FIGURES:
            raise UserError(f"--only {only}: {word!r} is no figure of the paper. Give numbers from 1 to 13: 1,4,9.")
    return [FIGURES[number] for number in sorted(set(map(int, words)))]


def pick_driver(name: str | None, adapter: str | None) -> Driver:
    """A real one. Raises UserError."""
    if name == "reference":
        raise UserError("--driver reference: figures are made by the shaders. Give a real driver; see doctor.")
    return terminal.pick_driver(name, adapter)


def places(output: Path | None) -> Places:
    """The folders to write to, made where only the last part is missing. Raises UserError.

    output  one folder for everything; None: docs/reproduction, and the cache folder
    """
    cache = paths.cache_folder()
    found = Places(output, output) if output else Places(paths.ROOT / "docs/reproduction", cache / "reproduction")
    if output is None:
        paths.ensured(cache)
    for folder in found:
        _prepare(folder)
    return found


def _prepare(folder: Path) -> None:
    """Make a folder and write something into it, so that the answer is known before any work is done."""
    if folder.exists() and not folder.is_dir():
        raise UserError(f"--output {folder}: is a file. Name a folder.")
    if not folder.parent.is_dir():
        raise UserError(f"--output {folder}: there is no folder {folder.parent}. Make it first.")
    try:
        folder.mkdir(exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise UserError(f"--output {folder}: cannot be written to ({error.strerror}). Name another place.") from error


def run(figures: list[Figure], driver: Driver, target: Places, progress: Callable[[str], None]) -> Result:
    """Make figures and write them: each file is whole, and the numbers come last.

    A figure whose input this machine lacks is left out; the pictures that are there of it stay.
    """
    made, missing, told = {}, {}, {}
    for figure in figures:
        try:
            one = made[figure.number] = figure.make(driver)
        except Unavailable as error:
            missing[figure.number] = str(error)
        else:
            for name, pixels in one.pictures.items():
                pictures.write_png(target.pictures / f"{name}.png", pixels)
            for name, image in one.images.items():
                exr.write(target.images / f"{name}.exr", np.ascontiguousarray(image))
            told[figure.number] = {
                "title": figure.title,
                "pictures": sorted(f"{name}.png" for name in one.pictures),
                "images": sorted(f"{name}.exr" for name in one.images),
                "tables": [table.as_json() for table in one.tables],
            }
        progress(f"figure {figure.number}")
    data = {"driver": driver.name, "adapter": driver.adapter, "figures": told, "missing": missing}
    terminal.write_json(target.images / NUMBERS_FILE, data)
    return Result(made, missing)


def figures(
    only: Annotated[str | None, typer.Option(metavar="1,4,9", help="These figures of the paper; else all.")] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="FOLDER", help="One folder for all files; else docs/reproduction and the cache."
        ),
    ] = None,
    driver: terminal.OneDriver = None,
    adapter: terminal.Adapter = None,
) -> None:
    """Figures 1 to 13 of the paper with our shaders, as PNG, and the EXR and numbers behind them."""
    wanted = chosen(only)
    used = pick_driver(driver, adapter)
    target = places(output)
    with terminal.progress("figures", len(wanted)) as step:
        result = run(wanted, used, target, step)
    for number, made in result.made.items():
        terminal.tell(f"Figure {number}: {FIGURES[number].title}")
        for table in made.tables:
            terminal.tell(*table.markdown())
    terminal.tell(*(f"Figure {number} not made: {reason}" for number, reason in result.missing.items()))
    count = sum(len(made.pictures) for made in result.made.values())
    terminal.tell(
        f"{count} pictures in {target.pictures}, images and numbers in {target.images}, by {used.name} ({used.adapter})"
    )
    terminal.end(not (result.missing and os.environ.get("CI")))
