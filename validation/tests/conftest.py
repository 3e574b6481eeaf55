"""Fixtures and options of all tests, and their order."""

import pytest
from support import REAL, load

from bokeh_validation import drivers

# They take longest: begun first, so that nobody waits for one alone at the end.
LONGEST = (
    "engines", "drivers", "truth", "validate", "compile", "hostile", "exact", "pictures", "layers", "fuzz", "patterns",
    "render", "parity", "bench", "browser", "pages", "mutants",
    "invariance", "installed",
)  # fmt: skip


def pytest_addoption(parser):
    """validation/test --all: engine samples that were not built here yet, and every probe in each language, too."""
    parser.addoption("--all", action="store_true", help="every sample (Bevy builds for minutes) and probe")


def pytest_collection_modifyitems(items):
    """A process is given whole files (--dist loadfile): their tests share what takes long to make."""
    order = {f"test_{name}": index for index, name in enumerate(LONGEST)}
    items.sort(key=lambda item: order.get(item.path.stem, len(order)))


@pytest.fixture(params=REAL)
def driver(request) -> drivers.Driver:
    """Every real driver in turn."""
    return load(request.param)


@pytest.fixture
def all_drivers() -> list[drivers.Driver]:
    """All real drivers at once."""
    return [load(name) for name in REAL]
