"""What tests share: drivers, each made once; a missing one is a failure under CI and a skip elsewhere."""

import os

import pytest

from bokeh_validation import drivers
from bokeh_validation.errors import Unavailable

REAL = tuple(name for name in drivers.NAMES if name != "reference")
_loaded: dict[str, object] = {}


def load(name: str) -> drivers.Driver:
    """A driver, or the end of the test."""
    if name not in _loaded:
        try:
            _loaded[name] = drivers.load(name)
        except Unavailable as error:
            _loaded[name] = error
    found = _loaded[name]
    if isinstance(found, Unavailable):
        if os.environ.get("CI"):
            pytest.fail(f"driver {name} is missing: {found}")
        pytest.skip(f"driver {name}: {found}")
    return found
