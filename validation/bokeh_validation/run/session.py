"""Run tests with pytest for commands that draw and compile everything, and hand the results back to the command.

A test with the fixture `hand_over` gives the command an object. run() runs such tests in several processes, each with
its own drivers, browser and Wine, and returns the objects.
"""

import io
import os
import pickle
from collections.abc import Callable, Mapping, Sequence
from contextlib import redirect_stdout
from dataclasses import dataclass, field
from typing import Protocol

import pytest

from bokeh_validation import drivers, paths, terminal
from bokeh_validation.errors import UserError

# Key of the object in a test report's properties
HANDED_OVER = "handed over"
BRIEF, FULL = "brief", "full"
CORES = os.cpu_count() or 1
PROCESSES = min(CORES, 4)


class Handed(Protocol):
    """Describe what a test hands over."""

    @property
    def ok(self) -> bool:
        """Return whether the result is right; what is missing does not make it wrong."""


@dataclass
class Collector:
    """Collect what the tests of a session hand over, in the main process, where their reports arrive.

    step    called after each test with its name
    found   node id -> what the test handed over
    errors  node id -> the last line of its failure
    """

    step: Callable[[str], None]
    found: dict[str, Handed] = field(default_factory=dict)
    errors: dict[str, str] = field(default_factory=dict)

    def pytest_runtest_logreport(self, report):
        """Collect from the report of one phase of a test."""
        for key, data in report.user_properties:
            if key == HANDED_OVER:
                self.found[report.nodeid] = pickle.loads(data)
        if report.failed:
            text = report.longreprtext.strip() or "failed"
            self.errors[report.nodeid] = text.splitlines()[-1]
        if report.when == "teardown" or report.failed:
            self.step(name_of(report.nodeid))


def pytest_addoption(parser):
    """Register the options that run() sets."""
    parser.addoption("--report", choices=(BRIEF, FULL), help="set by validation/run: the named tests, all of them")
    parser.addoption("--adapter", help="set by validation/run --adapter: a part of a device's name")


def pytest_configure(config):
    """Register the mark."""
    config.addinivalue_line("markers", "report: run for validation/run only, on a driver that the suite leaves out")


@pytest.fixture
def hand_over(request) -> Callable[[Handed], None]:
    """Return a function that hands an object to the command; the object arrives whether the test passes or fails."""
    return lambda result: request.node.user_properties.append((HANDED_OVER, pickle.dumps(result)))


def probe(name: str, driver: str) -> str:
    """Return the node id of the test of a probe on a driver, which hands over an Outcome."""
    return f"tests/shaders/test_probes.py::test_probe[{name}-{driver}]"


def variant(name: str) -> str:
    """Return the node id of the test of a variant of the programs, which hands over a Compilation."""
    return f"tests/harness/test_compile.py::test_accepted[{name}]"


def sample(name: str) -> str:
    """Return the node id of the test of an engine's sample, which hands over an Outcome."""
    return f"engines/tests/test_engines.py::test_sample[{name}]"


# Node id of the test that draws market_7 by every method; hands over an Outcome
MARKET = "tests/shaders/test_truth.py::test_market"


def name_of(nodeid: str) -> str:
    """Return the parameters in a node id's brackets, or the function's name if there are none."""
    function, _, parameters = nodeid.rpartition("::")[2].partition("[")
    return parameters.removesuffix("]") or function


def run(
    tests: Sequence[str], step: Callable[[str], None], depth: str = FULL, adapter: str | None = None
) -> tuple[dict[str, Handed], dict[str, str]]:
    """Run tests of the suite, longest first.

    tests    node ids
    step     called after each test with its name
    depth    BRIEF or FULL; in a brief run a test does the least that can show something
    adapter  part of a device's name
    Returns node id -> what the test handed over, in the order of `tests`, and node id -> why it failed.
    Raises KeyboardInterrupt if the tests were stopped, UserError if they could not be run.
    """
    collector, said = Collector(step), io.StringIO()
    options = ["-c", str(paths.VALIDATION / "pytest.ini"), "--rootdir", str(paths.VALIDATION)]
    options += ["-o", f"cache_dir={paths.cache_folder() / 'pytest'}", "--report", depth, "-n", str(PROCESSES)]
    options += ["--adapter", adapter] if adapter else []
    # a worker stopped inside Mesa may crash on its way out; its stack trace helps nobody
    options += ["-p", "no:faulthandler"]
    with redirect_stdout(said):
        code = pytest.main([*options, *(str(paths.VALIDATION / test) for test in tests)], plugins=[collector])
    if code == pytest.ExitCode.INTERRUPTED:
        raise KeyboardInterrupt
    if code not in (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED):
        raise UserError(f"the tests could not be run: {' '.join(said.getvalue().split())[-300:]}")
    return {test: collector.found[test] for test in tests if test in collector.found}, collector.errors


def check_adapter(names: Sequence[str], adapter: str | None) -> None:
    """Check before anything is run that one of the drivers has a device of this name. Raises UserError."""
    if adapter is not None:
        drivers.pick_all(names, adapter)


def unexplained(found: Mapping[str, Handed], errors: Mapping[str, str]) -> dict[str, str]:
    """Return name of a test -> its failure, for tests whose handed-over result does not itself report a failure."""
    return {name_of(test): error for test, error in errors.items() if test not in found or found[test].ok}


def told(found: Mapping[str, Handed], errors: Mapping[str, str]) -> bool:
    """Print the failures that unexplained() returns; returns whether there were none."""
    failures = unexplained(found, errors)
    terminal.tell(*(f"{name}: {error}" for name, error in failures.items()))
    return not failures
