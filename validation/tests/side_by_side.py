"""Plugin for several test processes at once (pytest-xdist): which tests stay together, in which order, which run alone.

Every process has drivers, a Chromium, a Wine prefix and a display of its own. They share the cache folder, where
locks.py has them take turns.
"""

import os
import re
from contextlib import ExitStack

import pytest
from xdist.scheduler import LoadScopeScheduling

from bokeh_validation import drivers, locks, matrix
from bokeh_validation.reference import gather

# Tests of these files share what takes long to make: a compiled matrix, a drawn set of figures, a sample in a browser.
WHOLE = re.compile(r"tests/\w+/test_(bench|browser|compile|compile_only|figures|guides_\w+|windows)\.py")
DRIVER = re.compile(rf"(?<=[\[-])({'|'.join(drivers.NAMES)})(?=[\]-])")

ALONE, ENTRANCE = "tests-alone", "tests-entrance"


class Units(LoadScopeScheduling):
    """What goes to a process as one. Tests that differ in the driver only share the reference's result."""

    def __init__(self, config, log=None):
        super().__init__(config, log)
        # in the order of place(), not the unit with the most tests first
        config.option.loadscopereorder = False

    def _split_scope(self, nodeid: str) -> str:
        return unit(nodeid)


def unit(nodeid: str) -> str:
    """What a test belongs to: its file, or the tests that differ from it in the driver only."""
    whole = WHOLE.search(nodeid)
    return whole[0] if whole else DRIVER.sub("", nodeid)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Which tests stay together."""
    return Units(config, log)


def pytest_configure(config):
    """In one of several processes: as many threads as are left for each."""
    if hasattr(config, "workerinput"):
        each = max(1, (os.cpu_count() or 1) // config.workerinput["workercount"])
        gather.THREADS = matrix.THREADS = each


def pytest_collection_modifyitems(items):
    """Tests that are given more time than others first and those that run alone last: nobody waits long at the end."""

    def place(item) -> int:
        if item.get_closest_marker("alone"):
            return 1
        return -1 if item.get_closest_marker("timeout") else 0

    items.sort(key=place)


# outside of the time limit, which is for the test and not for waiting
@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_protocol(item):
    """Nothing else runs while a test does that is marked `alone`.

    Everyone comes through the entrance, where the one that waits to be alone stands: nobody gets past it. Only one of
    several processes does: one by itself may be the child of a test that is inside, which waits for it.
    """
    if not hasattr(item.config, "workerinput"):
        return (yield)
    alone = item.get_closest_marker("alone") is not None
    with ExitStack() as until_the_end:
        with locks.held(ENTRANCE):
            until_the_end.enter_context(locks.held(ALONE, shared=not alone))
        return (yield)
