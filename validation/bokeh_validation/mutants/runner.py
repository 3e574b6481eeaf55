"""Mutants made and tested, several at a time."""

import tempfile
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from queue import SimpleQueue
from threading import Event, Lock

from bokeh_validation import paths
from bokeh_validation.mutants import edits, soundness
from bokeh_validation.mutants.model import ALIVE, ARGUED, BROKEN, CAUGHT, UNPROVEN, Mutant, Result, Selection
from bokeh_validation.mutants.workspace import Session, Workspace

WORKERS = 2
# What is asked where the tests that a mutant names all pass: every file but those that build, draw for minutes, or
# test this package; and only the drivers that start within a second.
SLOW_FILES = ("bench", "browser", "compile_only", "engines", "figures", "fuzz", "guides", "mutants", "windows")
SLOW_NAMES = ("webgl2", "webgpu", "d3d9", "d3d11", "test_scenes", "test_time")
# These compare documents with the size of the compiled text, which every edit changes: they would prove nothing.
NO_PROOF = ("test_table_of_shader_model_3", "test_slots_of_the_viewport")


def remaining() -> Selection:
    """The quick part of all tests."""
    names = (path.name for path in sorted((paths.VALIDATION / "tests").rglob("test_*.py")))
    files = tuple(name for name in names if not name.removeprefix("test_").startswith(SLOW_FILES))
    return Selection(files, f"not ({' or '.join((*SLOW_NAMES, *NO_PROOF))})")


@dataclass(frozen=True)
class Run:
    """Results in the order of the mutants, and what the tests say without any change."""

    results: list[Result]
    baselines: dict[Selection, Session]

    @property
    def ok(self) -> bool:
        """All were caught, or argued."""
        return all(result.ok for result in self.results)


@dataclass(frozen=True)
class Verdict:
    """The part of a Result that is found out; see there."""

    outcome: str
    test: str = ""
    detail: str = ""
    seconds: float = 0.0


class Runner:
    """Mutants on copies of the checkout, one for each worker.

    last  tests for mutants that their own tests do not catch; None: nothing more is asked
    """

    def __init__(self, workspaces: Sequence[Workspace], last: Selection | None):
        self.last = last
        self.free: SimpleQueue[Workspace] = SimpleQueue()
        for workspace in workspaces:
            self.free.put(workspace)
        self.baselines: dict[Selection, Session] = {}
        self._last_baseline = Lock()

    @contextmanager
    def workspace(self):
        """A free copy, until the end of the block."""
        workspace = self.free.get()
        try:
            yield workspace
        finally:
            self.free.put(workspace)

    def baseline(self, selection: Selection) -> None:
        """Learn what tests say of shaders without any change."""
        with self.workspace() as workspace:
            self.baselines[selection] = workspace.test(selection)

    def mutant(self, mutant: Mutant) -> Result:
        """Test one. Raises UserError where it does not fit the shaders, Unavailable where a compiler is missing."""
        texts = edits.mutated(mutant)
        seen = soundness.seen_by_parity(texts)
        verdict = Verdict(BROKEN, detail=soundness.refusal(mutant, texts, seen))
        if not verdict.detail:
            with self.workspace() as workspace:
                verdict = self._tested(mutant, texts, workspace)
        change = edits.described(mutant)
        return Result(mutant.name, mutant.kind, mutant.languages, mutant.places, change, parity=seen, **asdict(verdict))

    def _tested(self, mutant: Mutant, texts: dict[str, str], workspace: Workspace) -> Verdict:
        seconds, unproven = 0.0, ""
        last = (self.last,) if self.last and not mutant.argument else ()
        for selection in (*mutant.killers, *last):
            if selection is self.last:
                self._need_last(workspace)
            without = self.baselines[selection]
            if not without.ok:
                unproven = f"without the change: {selection}: {without.test} {without.message}"
                continue
            with workspace.changed(texts):
                session = workspace.test(selection)
            seconds += session.seconds
            if not session.ok:
                return Verdict(CAUGHT if session.assertion else BROKEN, session.test, session.message, seconds)
        if unproven:
            return Verdict(UNPROVEN, "", unproven, seconds)
        return Verdict(ARGUED if mutant.argument else ALIVE, "", mutant.argument, seconds)

    def _need_last(self, workspace: Workspace) -> None:
        # a worker that waits here holds its copy, and the one that works has its own
        with self._last_baseline:
            if self.last not in self.baselines:
                self.baselines[self.last] = workspace.test(self.last)


def selections(mutants: Sequence[Mutant]) -> list[Selection]:
    """Every selection that they name, once."""
    return list(dict.fromkeys(selection for mutant in mutants for selection in mutant.killers))


def steps(mutants: Sequence[Mutant]) -> int:
    """How often run() calls `step`."""
    return len(mutants) + len(selections(mutants))


def run(
    mutants: Sequence[Mutant], step: Callable[[str], None] = lambda text: None, last: Selection | None = None
) -> Run:
    """First the tests without any change, then every mutant. Raises as Runner.mutant does.

    Where it is interrupted, or one raises, the sessions that run are ended and no others begin.
    """
    stop = Event()
    for mutant in mutants:
        edits.mutated(mutant)
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="bokeh-mutants-")))
        workspaces = [stack.enter_context(Workspace(folder / str(number), stop)) for number in range(WORKERS)]
        pool = stack.enter_context(ThreadPoolExecutor(WORKERS))
        # before the pool waits for its threads
        stack.callback(stop.set)
        runner = Runner(workspaces, last)
        wanted = selections(mutants)
        _finished({pool.submit(runner.baseline, selection): str(selection) for selection in wanted}, step)
        futures = {pool.submit(runner.mutant, mutant): mutant.name for mutant in mutants}
        _finished(futures, step)
        return Run([future.result() for future in futures], runner.baselines)


def _finished(futures: dict[Future, str], step: Callable[[str], None]) -> None:
    """Wait for all; where one raises, the rest need not begin."""
    try:
        for future in as_completed(futures):
            future.result()
            step(futures[future])
    except BaseException:
        for future in futures:
            future.cancel()
        raise
