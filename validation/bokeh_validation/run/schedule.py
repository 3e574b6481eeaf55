"""Schedule tests for pytest: the longest first, by recorded durations, so that all processes finish together.

A process receives a unit at a time: consecutive tests of a file, which share fixtures that take long to set up.
"""

from collections.abc import Iterable, Mapping

import pytest
from xdist.scheduler import LoadScopeScheduling

# Node id of a test -> [seconds of its set-up, total seconds]
Durations = Mapping[str, list[float]]

KEY = "bokeh/durations"
# Durations of a brief validation/run, where a test takes less time
BRIEF_KEY = "bokeh/durations of a brief run"
# A unit is closed once its tests take this many seconds
UNIT = 20.0
# Fixtures that take longer than this (seconds) are shared: the tests that follow stay in the same unit
SHARED = 1.0
# Assumed for a test without a recorded duration. In a first run units are then five tests of a file, in the order of
# the command line, where the engines' samples, whose builds take minutes, stand first. Simulated on the recorded
# durations with builds of up to 600 s, that run ends 2 % later than in the best order, and 6 % on four cores.
UNKNOWN = [0.0, 4.0]


def units(collection: Iterable[str], durations: Durations) -> dict[str, str]:
    """Group tests into units; returns node id -> name of its unit, which is its first test."""
    unit_of, files = {}, {}
    for nodeid in collection:
        files.setdefault(nodeid.partition("::")[0], []).append(nodeid)
    for tests in files.values():
        recorded = [durations.get(nodeid, UNKNOWN) for nodeid in tests]
        sharing = any(set_up > SHARED for set_up, _ in recorded)
        name, unit_seconds = tests[0], 0.0
        for nodeid, (set_up, seconds) in zip(tests, recorded, strict=True):
            if unit_seconds >= UNIT and (set_up > SHARED or not sharing):
                name, unit_seconds = nodeid, 0.0
            unit_of[nodeid] = name
            unit_seconds += seconds
    return unit_of


class LongestFirst(LoadScopeScheduling):
    """Hand out units in descending order of their durations."""

    def __init__(self, config, log, durations: Durations):
        super().__init__(config, log)
        self.durations, self.units, self.seconds = durations, {}, {}
        config.option.loadscopereorder = False

    def schedule(self) -> None:
        """Form the units once all processes have collected the tests, then distribute them."""
        if self.collection is None:
            self.units = units(next(iter(self.registered_collections.values())), self.durations)
            for nodeid, unit in self.units.items():
                seconds = self.durations.get(nodeid, UNKNOWN)[1]
                self.seconds[unit] = self.seconds.get(unit, 0.0) + seconds
        super().schedule()

    def _split_scope(self, nodeid: str) -> str:
        return self.units[nodeid]

    def _assign_work_unit(self, node) -> None:
        longest = max(self.workqueue, key=self.seconds.__getitem__)
        self.workqueue.move_to_end(longest, last=False)
        super()._assign_work_unit(node)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Distribute by recorded durations, regardless of --dist."""
    return LongestFirst(config, log, config.cache.get(_key(config), {}))


def _key(config: pytest.Config) -> str:
    return BRIEF_KEY if config.getoption("--report", None) == "brief" else KEY


class Recorder:
    """Record how long the tests of a session take."""

    def __init__(self):
        self.found: dict[str, list[float]] = {}
        self.skipped: set[str] = set()

    def pytest_runtest_logreport(self, report):
        """Add the duration of one phase of a test."""
        set_up, seconds = self.found.get(report.nodeid, (0.0, 0.0))
        set_up_now = report.duration if report.when == "setup" else 0.0
        self.found[report.nodeid] = [round(set_up + set_up_now, 3), round(seconds + report.duration, 3)]
        if report.skipped:
            self.skipped.add(report.nodeid)

    def pytest_sessionfinish(self, session):
        """Update the durations of tests that ran; a skipped test keeps its previous one."""
        ran = {nodeid: seconds for nodeid, seconds in self.found.items() if nodeid not in self.skipped}
        if ran:
            key, cache = _key(session.config), session.config.cache
            cache.set(key, {**cache.get(key, {}), **ran})


@pytest.hookimpl(trylast=True)
def pytest_configure(config):
    """Record durations in the main process, where all reports arrive."""
    if not hasattr(config, "workerinput"):
        config.pluginmanager.register(Recorder(), "durations")
