"""Mutants tested in forked copies of one pytest session, in which everything is imported and collected already.

The parent starts no driver, so that each copy may have its own. A test is told by BOKEH_SHADERS where the shaders are.
"""

import contextlib
import io
import multiprocessing
import os
import re
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from multiprocessing import connection
from pathlib import Path

import pytest

from bokeh_validation import paths
from bokeh_validation.errors import UserError
from bokeh_validation.mutants.mutant import Mutant, mutated, originals
from bokeh_validation.mutants.outcomes import ALIVE, ARGUED, BROKEN, CAUGHT, Result
from bokeh_validation.shaders import parity, rules
from bokeh_validation.windows import wine

TESTS = paths.VALIDATION / "tests" / "shaders"
WORKERS = 2
# A test that takes longer hangs
TEST_S = 120
# What is asked where the tests that a mutant names all pass: every test of the shaders but those that draw for minutes
# and the drivers that take seconds to start. test_parity.py changes texts that it has read before.
NOT_LAST = re.compile(r"test_fuzz|test_parity|webgl2|webgpu|d3d9|d3d11|test_scenes|test_time")
# How the message of a failed assertion begins, in contrast to that of an error, a time-out among them
ASSERTION = re.compile(r"assert|AssertionError|Failed: (?!Timeout)")
FORK = multiprocessing.get_context("fork")


@dataclass(eq=False)
class Job:
    """Tests on shaders in a process of its own.

    texts    the files that are not as in the checkout, by their path
    control  no mutant: the parity check is left alone, and a failure does not end it
    seen     whether the parity check notices
    records  (test, 'passed', 'skipped' or 'failed', message), and as the last one of a test that did not end 'begun'
    """

    texts: Mapping[str, str]
    items: Sequence[pytest.Item]
    control: bool = False
    everywhere: bool = False
    seen: bool = False
    records: list[tuple[str, str, str]] = field(default_factory=list)
    seconds: float = 0.0


class _Plugin:
    """Calls `action` with the collected tests in place of running them, and keeps the reports of those that run."""

    def __init__(self, action: Callable):
        self.action = action
        self.error: BaseException | None = UserError(
            "the tests of the shaders cannot be collected: see validation/test."
        )
        self.reports: list[pytest.TestReport] = []

    def pytest_runtestloop(self, session):
        # pytest would report what is raised, an interruption too, and go on
        try:
            if not session.testsfailed:
                self.error = None
                self.action(session.items, self.reports)
        except BaseException as error:
            self.error = error
        return True

    def pytest_runtest_logreport(self, report):
        self.reports.append(report)


def run(
    mutants: Sequence[Mutant], killers: Iterable[str], step: Callable[[str], None] = lambda _: None
) -> list[Result]:
    """What becomes of each; `killers` has theirs and maybe others.

    Raises UserError where an edit does not fit the shaders, or there is no such killer.
    """
    results = [Result(m.name, m.kind, m.languages, m.place, m.change) for m in mutants]
    texts = [mutated(mutant) for mutant in mutants]

    def action(items, reports):
        known = {killer: _named(killer, items) for killer in dict.fromkeys(killers)}
        last = {item: None for item in items if not NOT_LAST.search(item.nodeid)}
        jobs = []
        for mutant, text in zip(mutants, texts, strict=True):
            asked = {item: None for killer in mutant.killers for item in known[killer]}
            jobs.append(Job(text, list(asked if mutant.argument else asked | last), everywhere=mutant.everywhere))

        def done(job: Job) -> None:
            number = jobs.index(job)
            _judge(mutants[number], job, results[number])
            step(f"{mutants[number].name}: {results[number].outcome}")

        _work(jobs, reports, done)
        _control(results, items, reports)

    plugin = _Plugin(action)
    options = ["-c", str(paths.VALIDATION / "pytest.ini"), "--rootdir", str(paths.VALIDATION), "-n", "0", "-s"]
    with contextlib.redirect_stdout(io.StringIO()):
        pytest.main([*options, "-p", "no:cacheprovider", str(TESTS)], plugins=[plugin])
    if plugin.error is not None:
        raise plugin.error
    return results


def _named(killer: str, items: Sequence[pytest.Item]) -> list[pytest.Item]:
    """The tests that a killer names (killers.py)."""
    name, _, words = killer.partition("[")
    found = [item for item in items if _name(item).partition("[")[0] == name]
    found = [item for item in found if all(word in item.nodeid for word in words.removesuffix("]").split())]
    if not found:
        raise UserError(f"mutants: there is no test {killer}. Bring killers.py up to date with the tests.")
    return found


def _name(item: pytest.Item) -> str:
    """Its id without folders."""
    return f"{item.path.name}::{item.nodeid.partition('::')[2]}"


def _judge(mutant: Mutant, job: Job, result: Result) -> None:
    result.parity, result.seconds = job.seen, job.seconds
    test, outcome, said = job.records[-1] if job.records else ("", "", "")
    passed = sum(outcome == "passed" for _, outcome, _ in job.records)
    if mutant.everywhere and job.seen:
        result.outcome, result.detail = BROKEN, "not the same in all languages: the parity check sees it"
    elif outcome == "begun":
        result.outcome, result.test, result.detail = BROKEN, test, said
    elif outcome == "failed":
        result.outcome, result.test, result.detail = CAUGHT if ASSERTION.match(said) else BROKEN, test, said
    elif not passed:
        result.outcome, result.detail = BROKEN, "no test was run"
    elif mutant.argument:
        result.outcome, result.detail = ARGUED, mutant.argument
    else:
        result.outcome, result.detail = ALIVE, f"{passed} tests passed, {len(job.records) - passed} skipped"


def _control(results: Sequence[Result], items: Sequence[pytest.Item], reports: list) -> None:
    """Have those that caught something prove that they pass without the change."""
    asked = {result.test for result in results if result.outcome == CAUGHT}
    chosen = [item for item in items if _name(item) in asked]
    jobs = [Job({}, chosen[start::WORKERS], control=True) for start in range(WORKERS)]
    _work(jobs, reports)
    bad = {test: said for job in jobs for test, outcome, said in job.records if outcome != "passed"}
    for result in results:
        if result.outcome == CAUGHT and result.test in bad:
            result.outcome, result.detail = BROKEN, f"fails without the change as well: {bad[result.test]}"


def _work(jobs: Sequence[Job], reports: list, done: Callable[[Job], None] = lambda _: None) -> None:
    """Run them, some at a time; their processes are gone afterwards, whatever happens."""
    waiting, running = list(reversed(jobs)), {}
    with tempfile.TemporaryDirectory(prefix="bokeh-mutants-") as folder:
        try:
            while waiting or running:
                while waiting and len(running) < WORKERS:
                    job = waiting.pop()
                    end, other = FORK.Pipe(duplex=False)
                    process = FORK.Process(target=_child, args=(job, Path(folder, str(len(waiting))), reports, other))
                    process.start()
                    other.close()
                    running[end] = job, process, time.monotonic()
                for end in connection.wait(running, 1.0):
                    _hear(end, running)
                for end, (job, process, heard) in list(running.items()):
                    if end.closed or time.monotonic() > heard + TEST_S:
                        _kill(process)
                        running.pop(end)
                        done(job)
        finally:
            for _, process, _ in running.values():
                _kill(process)


def _hear(end: connection.Connection, running: dict) -> None:
    """Take a message of a job; at its end the connection is closed."""
    job, process, heard = running[end]
    now = time.monotonic()
    job.seconds += now - heard
    running[end] = job, process, now
    try:
        message = end.recv()
    except EOFError:
        process.join()
        end.close()
        return
    if isinstance(message, bool):
        job.seen = message
    else:
        if job.records and job.records[-1][1] == "begun":
            job.records.pop()
        job.records.append(message)


def _kill(process) -> None:
    """With the programs that it has started."""
    if process.is_alive():
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.kill()
    process.join()


def _child(job: Job, folder: Path, reports: list[pytest.TestReport], end: connection.Connection) -> None:
    """What a job's process does."""
    os.setpgrp()
    for number, mode in ((0, os.O_RDONLY), (1, os.O_WRONLY), (2, os.O_WRONLY)):
        os.dup2(os.open(os.devnull, mode), number)
    try:
        if not job.control:
            # more than a line that an edit has made too long
            seen = any(rules.TOO_LONG not in difference.what for difference in parity.check(job.texts))
            end.send(seen)
            if seen and job.everywhere:
                return
        for key, text in {**originals(), **job.texts}.items():
            paths.ensured((folder / key).parent)
            (folder / key).write_text(text, encoding="ascii")
        os.environ["BOKEH_SHADERS"] = os.environ["TMPDIR"] = tempfile.tempdir = str(folder)
        _forget()
        _ask(job, reports, end)
    except Exception as error:
        end.send(("", "begun", repr(error)))
    finally:
        wine.stop()
        shutil.rmtree(folder, ignore_errors=True)


def _ask(job: Job, reports: list[pytest.TestReport], end: connection.Connection) -> None:
    """Run its tests, up to the first that fails."""
    for item, following in zip(job.items, (*job.items[1:], None), strict=True):
        end.send((_name(item), "begun", f"no end within {TEST_S} s, or a crash"))
        reports.clear()
        item.ihook.pytest_runtest_protocol(item=item, nextitem=following)
        worst = max(reports, key=lambda report: ("passed", "skipped", "failed").index(report.outcome))
        crash = getattr(worst.longrepr, "reprcrash", None)
        said = " ".join((crash.message if crash else str(worst.longrepr or "")).split())
        end.send((_name(item), worst.outcome, said))
        if worst.failed and not job.control:
            return


def _forget() -> None:
    """What functions keep may be of the checkout's shaders."""
    for module in list(sys.modules.values()):
        for value in list(vars(module).values()):
            if isinstance(value, type(originals)) and value.__module__.startswith(("bokeh_validation", "test_")):
                value.cache_clear()
