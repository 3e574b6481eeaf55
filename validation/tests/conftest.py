"""Fixtures and options of all tests, and which of them go to a process together."""

import re

import pytest
from support import REAL, load
from xdist.scheduler import LoadScopeScheduling

from bokeh_validation import drivers

# Tests of these files share what takes long to make: a compiled matrix, a drawn set of figures, a sample in a browser.
WHOLE = re.compile(r"\w+/test_(browser|compile|compile_only|figures|threejs|windows)\.py")
DRIVER = re.compile(rf"(?<=[\[-])({'|'.join(drivers.NAMES)})(?=[\]-])")


def pytest_addoption(parser):
    """validation/test --all: the slow engine samples too, whether their files changed or not."""
    parser.addoption("--all", action="store_true", help="run the slow engine samples too (Bevy builds for minutes)")


class Groups(LoadScopeScheduling):
    """What goes to a process as one: a file, or tests that differ in the driver only and share the reference's result.

    xdist's own marks for that do nothing here: xdist 3.8 writes them where pytest 9.2 does not read.
    """

    def _split_scope(self, nodeid: str) -> str:
        whole = WHOLE.search(nodeid)
        return whole[0] if whole else DRIVER.sub("", nodeid)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Which tests stay together."""
    return Groups(config, log)


def pytest_collection_modifyitems(items):
    """Those that may take longest come first, so that nobody waits long at the end."""
    items.sort(key=lambda item: item.get_closest_marker("timeout") is None)


@pytest.fixture(params=REAL)
def driver(request) -> drivers.Driver:
    """Every real driver in turn."""
    return load(request.param)


@pytest.fixture
def all_drivers() -> list[drivers.Driver]:
    """All real drivers at once."""
    return [load(name) for name in REAL]
