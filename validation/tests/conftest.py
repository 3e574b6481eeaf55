"""Fixtures and options of all tests."""

import pytest
from support import REAL, load

from bokeh_validation import drivers

pytest_plugins = ("side_by_side",)


def pytest_addoption(parser):
    """validation/test --all: the slow engine samples too, whether their files changed or not."""
    parser.addoption("--all", action="store_true", help="run the slow engine samples too (Bevy builds for minutes)")


@pytest.fixture(params=REAL)
def driver(request) -> drivers.Driver:
    """Every real driver in turn."""
    return load(request.param)


@pytest.fixture
def all_drivers() -> list[drivers.Driver]:
    """All real drivers at once."""
    return [load(name) for name in REAL]
