"""Drivers for the tests, each made once; a missing one is a failure under CI and a skip elsewhere."""

import os

import pytest

from bokeh_validation import drivers
from bokeh_validation.errors import Unavailable

pytest_plugins = ("side_by_side",)

REAL = tuple(name for name in drivers.NAMES if name != "reference")
_loaded: dict[str, object] = {}


def pytest_addoption(parser):
    """validation/test --all: the slow engine samples too, whether their files changed or not."""
    parser.addoption("--all", action="store_true", help="run the slow engine samples too (Bevy builds for minutes)")


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


@pytest.fixture(params=REAL)
def driver(request) -> drivers.Driver:
    """Every real driver in turn."""
    return load(request.param)


@pytest.fixture
def all_drivers() -> list[drivers.Driver]:
    """All real drivers at once."""
    return [load(name) for name in REAL]
