"""Taking turns between processes: what is made in the cache folder on first use is made by one of them."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from typing import ParamSpec, TypeVar

from bokeh_validation import paths

P = ParamSpec("P")
T = TypeVar("T")


@contextmanager
def held(name: str) -> Iterator[None]:
    """Wait for the lock `name` of the cache folder and hold it.

    It is gone with the process that holds it, however that ends. Not for a lock within itself. On Windows, where the
    tests run in one process, nobody waits.
    """
    if sys.platform == "win32":
        yield
        return
    import fcntl

    with open(paths.ensured(paths.cache_folder() / "locks") / name, "w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


def one_at_a_time(name: str) -> Callable[[Callable[P, T]], Callable[P, T]]:
    """Decorator: one process at a time runs the function; the next one finds what it has made."""

    def decorate(function: Callable[P, T]) -> Callable[P, T]:
        @wraps(function)
        def alone(*arguments: P.args, **named: P.kwargs) -> T:
            with held(name):
                return function(*arguments, **named)

        return alone

    return decorate
