"""The work behind `validation/run figures`."""

import os
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from bokeh_validation import exr, paths, pictures, terminal
from bokeh_validation.drivers.base import Driver
from bokeh_validation.errors import Unavailable, UserError
from bokeh_validation.figures import depth, diagrams, photographs, points
from bokeh_validation.figures.figure import Made

# Number -> title and what makes it of a driver; that raises Unavailable where this machine lacks its input
FIGURES: dict[int, tuple[str, Callable[[Driver], Made]]] = {
    1: ("Photographs with a constant depth", photographs.photographs),
    2: ("Intensity leakage", depth.leakage),
    3: ("A sharp silhouette", depth.silhouette),
    4: ("Kernels of the naive gather", diagrams.kernels),
    5: ("A point becomes a square in two passes", partial(points.stages, 5, "square")),
    6: ("A point becomes a diamond in two passes", partial(points.stages, 6, "diamond")),
    7: ("Blurring the CoC", depth.coc_blur),
    8: ("Apertures from parallelograms", diagrams.booleans),
    9: ("Min and max of parallelograms", points.shapes),
    10: ("Workflows", diagrams.workflows),
    11: ("A canopy", depth.canopy),
    12: ("Two points under min", points.minimum),
    13: ("Two points under max", points.maximum),
}
NUMBERS_FILE = "figures.json"


def chosen(only: str | None) -> list[int]:
    """The figures of '1,4,9', in order; None: all. Raises UserError."""
    if only is None:
        return [*FIGURES]
    words = [word.strip() for word in only.split(",")]
    for word in words:
        if not word.isdecimal() or int(word) not in FIGURES:
            raise UserError(f"--only {only}: {word!r} is no figure of the paper. Give numbers from 1 to 13: 1,4,9.")
    return sorted(set(map(int, words)))


def places(output: Path | None) -> tuple[Path, Path]:
    """Where to write to: pictures, HDR images with the numbers. Only the last part may be missing. Raises UserError.

    output  one folder for everything; None: docs/reproduction, and the cache folder
    """
    cache = paths.cache_folder()
    found = (output, output) if output else (paths.ROOT / "docs/reproduction", cache / "reproduction")
    if output is None:
        paths.ensured(cache)
    for folder in found:
        if folder.exists() and not folder.is_dir():
            raise UserError(f"--output {folder}: is a file. Name a folder.")
        if not folder.parent.is_dir():
            raise UserError(f"--output {folder}: there is no folder {folder.parent}. Make it first.")
        try:
            folder.mkdir(exist_ok=True)
            # so that the answer is known before any work is done
            with tempfile.TemporaryFile(dir=folder):
                pass
        except OSError as error:
            raise UserError(
                f"--output {folder}: cannot be written to ({error.strerror}). Name another place."
            ) from error
    return found


def written(title: str, one: Made, folder: Path, images: Path) -> dict:
    """Write a figure, each file as a whole; what the file of numbers says of it."""
    for name, pixels in one.pictures.items():
        pictures.write_png(folder / f"{name}.png", pixels)
    for name, image in one.images.items():
        exr.write(images / f"{name}.exr", np.ascontiguousarray(image))
    return {
        "title": title,
        "pictures": sorted(f"{name}.png" for name in one.pictures),
        "images": sorted(f"{name}.exr" for name in one.images),
        "tables": [table.as_json() for table in one.tables],
    }


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
    if driver == "reference":
        raise UserError("--driver reference: figures are made by the shaders. Give a real driver; see doctor.")
    used = terminal.pick_driver(driver, adapter)
    folder, images = places(output)
    told, missing, lines = {}, {}, []
    with terminal.progress("figures", len(wanted)) as step:
        for number in wanted:
            title, make = FIGURES[number]
            try:
                one = make(used)
            except Unavailable as error:
                # the pictures that are there of it stay
                missing[number] = str(error)
            else:
                told[number] = written(title, one, folder, images)
                lines += [f"Figure {number}: {title}", *(line for table in one.tables for line in table.markdown())]
            step(f"figure {number}")
    data = {"driver": used.name, "adapter": used.adapter, "figures": told, "missing": missing}
    terminal.write_json(images / NUMBERS_FILE, data)
    terminal.tell(*lines, *(f"Figure {number} not made: {reason}" for number, reason in missing.items()))
    count = sum(len(one["pictures"]) for one in told.values())
    terminal.tell(f"{count} pictures in {folder}, images and numbers in {images}, by {used.name} ({used.adapter})")
    terminal.end(not (missing and os.environ.get("CI")))
