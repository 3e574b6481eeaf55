"""Taking turns between processes: what is made in the cache folder on first use is made by one of them."""

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager

from bokeh_validation import paths


@contextmanager
def held(name: str) -> Iterator[None]:
    """Wait for the lock `name` of the cache folder and hold it; as a decorator too, while the function runs.

    It is gone with the process that holds it, however that ends. Not for a lock within itself.
    """
    with open(paths.ensured(paths.cache_folder() / "locks") / name, "w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield
