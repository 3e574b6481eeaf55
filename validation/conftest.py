"""Define fixtures and options of all tests."""

import pytest
from support import DRIVERS, LANGUAGES, NIGHTLY, load

from bokeh_validation import drivers

pytest_plugins = tuple(f"bokeh_validation.run.{name}" for name in ("schedule", "session", "unchanged"))


def pytest_addoption(parser):
    """Add validation/test --all, for CI."""
    said = "every engine's sample (Bevy builds for minutes), and every probe and setting in each language"
    parser.addoption("--all", action="store_true", help=said)


def pytest_collection_modifyitems(config, items):
    """Leave out tests marked `nightly` unless everything is asked for, and tests that are for validation/run only."""
    if config.getoption("--report"):
        return
    marks = ("report",) if config.getoption("--all") else ("report", "nightly")
    left_out = [item for item in items if any(map(item.get_closest_marker, marks))]
    config.hook.pytest_deselected(items=left_out)
    items[:] = [item for item in items if item not in left_out]


@pytest.fixture(params=DRIVERS)
def driver(request) -> drivers.Driver:
    """Return one driver of each language in turn; with --all, also those of NIGHTLY."""
    return load(request.param)


@pytest.fixture
def all_drivers(request) -> list[drivers.Driver]:
    """Return all drivers that `driver` takes in turn."""
    return [load(name) for name in (*LANGUAGES, *(NIGHTLY if request.config.getoption("--all") else ()))]
