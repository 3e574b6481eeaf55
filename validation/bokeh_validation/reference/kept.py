"""Passes that the reference has run before, kept on disk: most of a pass's time is the interpreter's.

A file's name is a digest of all that its contents follow from: the text of the program, its constants and parameters,
the textures, the size, the precision, and the code of the reference itself. How a target stores and rounds comes
afterwards (numerics.images.stored), so that drivers which round differently share a file. What an edit does not change
is found again; what it leaves behind is the oldest soon, and goes when the folder is full.
"""

import io
import os
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import suppress
from functools import cache
from pathlib import Path

import numpy as np

from bokeh_validation import locks, paths, shaders
from bokeh_validation.numerics.images import Image
from bokeh_validation.numerics.precision import Precision
from bokeh_validation.process import once
from bokeh_validation.reference import execution, glsl
from bokeh_validation.shaders import calls
from bokeh_validation.shaders.passes import Pass

# In the cache folder
FOLDER = "reference"
# Of that, bytes: the passes of the whole test suite are a third of it
MOST = 1_500_000_000
# Larger passes are not kept: a picture of a scene takes seconds, which its other costs exceed
MOST_PIXELS = 1 << 16
CODE = ("reference", "numerics", "shaders/passes.py", "shaders/entries.py", "shaders/parameters.py", "shaders/calls.py")


def run_pass(
    item: Pass,
    inputs: Mapping[str, Image],
    size: tuple[int, int],
    precision: Precision | None,
    text: str | None = None,
) -> list[Image]:
    """execution.run_pass(), or what it gave before."""
    if size[0] * size[1] > MOST_PIXELS or os.environ.get("BOKEH_REFERENCE_ANEW"):
        return execution.run_pass(item, inputs, size, precision, text)
    given = item, inputs, size, precision, text or shaders.text("glsl")
    made = list(_ingredients(*given))
    for _ in range(2):
        file = locks.kept(FOLDER, ".npz", made, lambda: _written(execution.run_pass(*given)))
        try:
            return _read(file, item.spec.targets)
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
            # not whole, or deleted by another process that makes room: made anew
            file.unlink(missing_ok=True)
    raise RuntimeError(f"{file}: was deleted twice while it was read")


def _ingredients(item: Pass, inputs: Mapping[str, Image], size, precision, text: str) -> Iterator[bytes]:
    """All that a pass's targets follow from."""
    library = glsl.library(text)
    program = calls.program(text, f"{item.entry}_PS", frozenset(item.constants.items()))
    yield _code()
    numbers = [sorted(values.items()) for values in (library.constants, item.constants, item.given())]
    yield repr((item.entry, sorted(program.items()), sorted(library.structs), numbers, size, precision)).encode()
    for slot, image in sorted(inputs.items()):
        fields = [image.value, image.error, image.undecided]
        yield repr((slot, [None if field is None else (field.shape, field.dtype.str) for field in fields])).encode()
        yield from (np.ascontiguousarray(field).tobytes() for field in fields if field is not None)


@cache
def _code() -> bytes:
    """That of the reference, and of what computes for it."""
    here = Path(__file__).parents[1]
    places = [here / name for name in CODE]
    texts = [file for place in places for file in (sorted(place.glob("*.py")) if place.is_dir() else [place])]
    return locks.digest([np.__version__, *texts]).encode()


def _read(file: Path, targets: int) -> list[Image]:
    """Raises one of the errors of np.load where the file is not there or not whole."""
    with np.load(file) as kept:
        images = [
            Image(kept[f"value{k}"], *(kept[f"error{k}"], kept["undecided"]) if "undecided" in kept else ())
            for k in range(targets)
        ]
    os.utime(file)
    return images


def _written(images: list[Image]) -> bytes:
    _make_room()
    fields = {f"value{k}": image.value for k, image in enumerate(images)}
    if images[0].undecided is not None:
        fields |= {f"error{k}": image.error for k, image in enumerate(images)}
        # one program decides for all its targets
        fields["undecided"] = images[0].undecided
    file = io.BytesIO()
    np.savez(file, **fields)
    return file.getvalue()


@once
def _make_room() -> None:
    """Delete what was not read for longest, once in a process that writes; another process may do the same."""
    found = []
    for entry in os.scandir(paths.ensured(paths.cache_folder() / FOLDER)):
        with suppress(FileNotFoundError):
            found.append((entry.stat().st_mtime, entry.stat().st_size, entry.path))
    total = sum(size for _, size, _ in found)
    for _, size, path in sorted(found):
        if total <= MOST * 3 // 4:
            break
        with suppress(FileNotFoundError):
            os.unlink(path)
        total -= size
