"""Let processes take turns: what the cache folder lacks is made once, by the first process that needs it."""

import hashlib
import shutil
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from filelock import FileLock

from bokeh_validation import files, paths


@contextmanager
def held(name: str) -> Iterator[None]:
    """Hold the lock `name` of the cache folder, waiting for it if necessary. Also works as a decorator of a function.

    The lock is released when its process ends, however that happens. It is not reentrant.
    """
    with FileLock(paths.ensured(paths.cache_folder() / "locks") / name):
        yield


def digest(ingredients: Iterable[str | bytes | Path]) -> str:
    """Return a hash of texts and bytes, and of files by their names and contents."""
    hashed = hashlib.sha256()
    for ingredient in ingredients:
        label, content = "", ingredient.encode() if isinstance(ingredient, str) else ingredient
        if isinstance(ingredient, Path):
            label, content = ingredient.name, ingredient.read_bytes()
        hashed.update(f"{label} {len(content)} ".encode() + content)
    return hashed.hexdigest()


def built_once(name: str, ingredients: Iterable[str | Path], build: Callable[[Path], object]) -> Path:
    """Return the folder in the cache folder that is built from these ingredients, building it on first use.

    name         of the folder, such as 'engines/ogre'; a digest of the ingredients is added
    ingredients  everything that the contents depend on, see digest()
    build        fills the folder, which is empty; if it raises, the next call starts over
    """
    folder = paths.cache_folder() / f"{name}-{digest(ingredients)[:16]}"
    complete = folder / "complete"
    with held(name.replace("/", "-")):
        if not complete.exists():
            shutil.rmtree(folder, ignore_errors=True)
            build(paths.ensured(folder))
            complete.touch()
    return folder


def kept(folder: str, suffix: str, ingredients: Iterable[str | bytes | Path], make: Callable[[], bytes]) -> Path:
    """Return the file in the cache folder that is made from these ingredients, making it on first use.

    folder       below the cache folder, such as 'bytecode'
    suffix       of the file's name, with its dot
    ingredients  everything that the bytes depend on, see digest()
    make         returns the bytes; if it raises, nothing is kept
    """
    file = paths.ensured(paths.cache_folder() / folder) / f"{digest(ingredients)[:32]}{suffix}"
    if not file.exists():
        content = make()
        files.whole(file, lambda partial: partial.write_bytes(content))
    return file
