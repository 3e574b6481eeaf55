"""Fixtures and options of all tests, and which of them go to a process together."""

import re

import pytest
from support import REAL, load

from bokeh_validation import drivers

# Tests of these files share what takes long to make: a compiled matrix, a drawn set of figures, a sample in a browser.
WHOLE = re.compile(r"\w+/test_(browser|compile|compile_only|figures|threejs|windows)\.py")
DRIVER = re.compile(rf"(?<=[\[-])({'|'.join(drivers.NAMES)})(?=[\]-])")


def pytest_addoption(parser):
    """validation/test --all: the slow engine samples too, whether their files changed or not."""
    parser.addoption("--all", action="store_true", help="run the slow engine samples too (Bevy builds for minutes)")


# before xdist reads the groups
@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config, items):
    """What goes to a process as one: a file, or the tests that differ in the driver only and share the reference's
    result. Those that may take longest come first, so that nobody waits long at the end."""
    items.sort(key=lambda item: item.get_closest_marker("timeout") is None)
    if hasattr(config, "workerinput"):
        for item in items:
            whole = WHOLE.search(item.nodeid)
            group = whole[0] if whole else DRIVER.sub("", item.nodeid)
            # xdist takes no group with a bracket for one
            item.add_marker(pytest.mark.xdist_group(re.sub(r"[][@]", " ", group)))


@pytest.fixture(params=REAL)
def driver(request) -> drivers.Driver:
    """Every real driver in turn."""
    return load(request.param)


@pytest.fixture
def all_drivers() -> list[drivers.Driver]:
    """All real drivers at once."""
    return [load(name) for name in REAL]
