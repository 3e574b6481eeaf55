"""Fixtures and options of all tests, and their order."""

import pytest
from support import DRIVERS, LANGUAGES, NIGHTLY, load

from bokeh_validation import drivers

# They take longest: begun first, so that nobody waits for one alone at the end.
LONGEST = (
    "engines", "web", "probes", "within", "compile", "invalid_input", "truth", "demo", "pages", "godot", "drivers",
    "steady", "fuzz", "reference", "layers", "guides", "exact", "pictures", "viewport", "validate", "browser", "peers",
    "pack", "render", "check", "frame", "bench", "parity",
)  # fmt: skip


def pytest_addoption(parser):
    """validation/test --all, for CI."""
    said = "every engine's sample (Bevy builds for minutes), and every probe and setting in each language"
    parser.addoption("--all", action="store_true", help=said)


def pytest_collection_modifyitems(config, items):
    """Without --all, what is marked `nightly` is left out.

    A process is given whole files (--dist loadfile): their tests share what takes long to make."""
    if not config.getoption("--all"):
        left_out = [item for item in items if item.get_closest_marker("nightly")]
        config.hook.pytest_deselected(items=left_out)
        items[:] = [item for item in items if not item.get_closest_marker("nightly")]
    order = {f"test_{name}": index for index, name in enumerate(LONGEST)}
    items.sort(key=lambda item: order.get(item.path.stem, len(order)))


@pytest.fixture(params=DRIVERS)
def driver(request) -> drivers.Driver:
    """One of each language in turn; with --all, those of NIGHTLY too."""
    return load(request.param)


@pytest.fixture
def all_drivers(request) -> list[drivers.Driver]:
    """Those that `driver` is in turn, at once."""
    return [load(name) for name in (*LANGUAGES, *(NIGHTLY if request.config.getoption("--all") else ()))]
