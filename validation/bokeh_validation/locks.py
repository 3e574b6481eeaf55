"""Taking turns between processes: what is made in the cache folder on first use is made by one of them."""

import hashlib
import shutil
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from filelock import FileLock

from bokeh_validation import files, paths


@contextmanager
def held(name: str) -> Iterator[None]:
    """Wait for the lock `name` of the cache folder and hold it; as a decorator too, while the function runs.

    It is gone with the process that holds it, however that ends. Not for a lock within itself.
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
    """The folder of the cache folder that holds what is built from these ingredients: built on first use.

    name         of the folder, such as 'engines/ogre'; a digest of the ingredients is added
    ingredients  all that the contents depend on, see digest()
    build        fills the folder, which is empty; where it raises, the next call begins anew
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
    """The file of the cache folder that holds what is made from these ingredients: made on first use.

    folder       in the cache folder, such as 'bytecode'
    suffix       of the file's name, with its dot
    ingredients  all that the bytes depend on, see digest()
    make         returns the bytes; where it raises, nothing is kept
    """
    file = paths.ensured(paths.cache_folder() / folder) / f"{digest(ingredients)[:32]}{suffix}"
    if not file.exists():
        made = make()
        files.whole(file, lambda partial: partial.write_bytes(made))
    return file
