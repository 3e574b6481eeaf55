"""pytest: the longest first, by how long each test took here the last time, so that all processes end together.

A process is given a unit at a time: consecutive tests of a file, which share what takes long to make.
"""

from collections.abc import Iterable, Mapping

import pytest
from xdist.scheduler import LoadScopeScheduling

# Node id of a test -> [seconds of its set-up, seconds in all]
Durations = Mapping[str, list[float]]

KEY = "bokeh/durations"
# In brief a test takes less: validation/run
BRIEF_KEY = "bokeh/durations of a brief run"
# A unit is ended once it takes so many seconds
UNIT = 20.0
# A fixture that takes longer to set up is shared by the tests that follow: they are not parted from it
SHARED = 1.0
# What is assumed of a test that was never run here
UNKNOWN = [0.0, 1.0]


def units(collection: Iterable[str], durations: Durations) -> dict[str, str]:
    """Node id -> its unit, named by the unit's first test."""
    found, files = {}, {}
    for nodeid in collection:
        files.setdefault(nodeid.partition("::")[0], []).append(nodeid)
    for tests in files.values():
        known = [durations.get(nodeid, UNKNOWN) for nodeid in tests]
        sharing = any(set_up > SHARED for set_up, _ in known)
        name, taken = tests[0], 0.0
        for nodeid, (set_up, seconds) in zip(tests, known, strict=True):
            if taken >= UNIT and (set_up > SHARED or not sharing):
                name, taken = nodeid, 0.0
            found[nodeid] = name
            taken += seconds
    return found


class LongestFirst(LoadScopeScheduling):
    """Units in the order of their durations."""

    def __init__(self, config, log, durations: Durations):
        super().__init__(config, log)
        self.durations, self.units, self.seconds = durations, {}, {}
        config.option.loadscopereorder = False

    def schedule(self) -> None:
        """Find the units once all processes have collected the tests, and distribute them."""
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
    """Distribute by recorded durations, whatever --dist says."""
    return LongestFirst(config, log, config.cache.get(_key(config), {}))


def _key(config: pytest.Config) -> str:
    return BRIEF_KEY if config.getoption("--report", None) == "brief" else KEY


class Recorder:
    """Keeps how long the tests of a session took."""

    def __init__(self):
        self.found: dict[str, list[float]] = {}
        self.skipped: set[str] = set()

    def pytest_runtest_logreport(self, report):
        """Add a phase of a test."""
        set_up, seconds = self.found.get(report.nodeid, (0.0, 0.0))
        own = report.duration if report.when == "setup" else 0.0
        self.found[report.nodeid] = [round(set_up + own, 3), round(seconds + report.duration, 3)]
        if report.skipped:
            self.skipped.add(report.nodeid)

    def pytest_sessionfinish(self, session):
        """Replace what is known of the tests that ran; one that was skipped keeps what it took when it ran."""
        ran = {nodeid: seconds for nodeid, seconds in self.found.items() if nodeid not in self.skipped}
        if ran:
            key, cache = _key(session.config), session.config.cache
            cache.set(key, {**cache.get(key, {}), **ran})


@pytest.hookimpl(trylast=True)
def pytest_configure(config):
    """Record in the process that all reports arrive in."""
    if not hasattr(config, "workerinput"):
        config.pluginmanager.register(Recorder(), "durations")
