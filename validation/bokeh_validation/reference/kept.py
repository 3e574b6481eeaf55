"""Cache on disk the passes that the reference has run, since the interpreter takes most of a pass's time.

A file is named by a digest of everything that its contents depend on: the program's text, its constants and
parameters, the textures, the size, the precision, and the reference's own code. How a target stores and rounds is
applied afterwards (numerics.images.stored), so drivers that round differently share a file. An edit reuses what it
does not affect; what becomes unused is deleted as the oldest once the folder is full.
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

# Name of the folder in the cache folder
FOLDER = "reference"
# Limit of its size in bytes; the passes of the whole test suite take a third of it
MOST = 1_500_000_000
# Larger passes are not cached: an image of a scene takes seconds, which its other costs exceed
MOST_PIXELS = 1 << 16
CODE = ("reference", "numerics", "shaders/passes.py", "shaders/entries.py", "shaders/parameters.py", "shaders/calls.py")


def run_pass(
    render_pass: Pass,
    inputs: Mapping[str, Image],
    size: tuple[int, int],
    precision: Precision | None,
    text: str | None = None,
) -> list[Image]:
    """Return the result of execution.run_pass(), from the cache if it is there."""
    if size[0] * size[1] > MOST_PIXELS or os.environ.get("BOKEH_REFERENCE_ANEW"):
        return execution.run_pass(render_pass, inputs, size, precision, text)
    arguments = render_pass, inputs, size, precision, text or shaders.text("glsl")
    ingredients = list(_ingredients(*arguments))
    for _ in range(2):
        file = locks.kept(FOLDER, ".npz", ingredients, lambda: _written(execution.run_pass(*arguments)))
        try:
            return _read(file, render_pass.spec.targets)
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
            # incomplete, or deleted by another process that made room: compute it again
            file.unlink(missing_ok=True)
    raise RuntimeError(f"{file}: was deleted twice while it was read")


def _ingredients(render_pass: Pass, inputs: Mapping[str, Image], size, precision, text: str) -> Iterator[bytes]:
    """Yield everything that a pass's targets depend on."""
    library = glsl.library(text)
    program = calls.program(text, f"{render_pass.entry}_PS", frozenset(render_pass.constants.items()))
    yield _code()
    numbers = [sorted(values.items()) for values in (library.constants, render_pass.constants, render_pass.given())]
    yield repr((render_pass.entry, sorted(program.items()), sorted(library.structs), numbers, size, precision)).encode()
    for slot, image in sorted(inputs.items()):
        fields = [image.value, image.error, image.undecided]
        yield repr((slot, [None if field is None else (field.shape, field.dtype.str) for field in fields])).encode()
        yield from (np.ascontiguousarray(field).tobytes() for field in fields if field is not None)


@cache
def _code() -> bytes:
    """Return a digest of the code of the reference and of NumPy's version."""
    package = Path(__file__).parents[1]
    code_paths = [package / name for name in CODE]
    texts = [file for path in code_paths for file in (sorted(path.glob("*.py")) if path.is_dir() else [path])]
    return locks.digest([np.__version__, *texts]).encode()


def _read(file: Path, targets: int) -> list[Image]:
    """Read the images of a file; raises np.load's errors if it is missing or incomplete."""
    with np.load(file) as archive:
        images = [
            Image(archive[f"value{k}"], *(archive[f"error{k}"], archive["undecided"]) if "undecided" in archive else ())
            for k in range(targets)
        ]
    os.utime(file)
    return images


def _written(images: list[Image]) -> bytes:
    _make_room()
    fields = {f"value{k}": image.value for k, image in enumerate(images)}
    if images[0].undecided is not None:
        fields |= {f"error{k}": image.error for k, image in enumerate(images)}
        # one program decides for all of its targets
        fields["undecided"] = images[0].undecided
    file = io.BytesIO()
    np.savez(file, **fields)
    return file.getvalue()


@once
def _make_room() -> None:
    """Delete the files that were not read for longest, once per process that writes."""
    files_by_age = []
    for entry in os.scandir(paths.ensured(paths.cache_folder() / FOLDER)):
        with suppress(FileNotFoundError):
            files_by_age.append((entry.stat().st_mtime, entry.stat().st_size, entry.path))
    total = sum(size for _, size, _ in files_by_age)
    for _, size, path in sorted(files_by_age):
        if total <= MOST * 3 // 4:
            break
        with suppress(FileNotFoundError):
            os.unlink(path)
        total -= size
