"""The compile matrix: every program of variants.py through every compiler that takes it."""

import os
import time
from collections import defaultdict, deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import asdict, dataclass, replace
from itertools import groupby

from rich.markup import escape
from rich.table import Table
from rich.text import Text

from bokeh_validation import terminal
from bokeh_validation.compilers.registry import COMPILERS, FAILED, MISSING, OK, Cell, Compiler, Job, compile_
from bokeh_validation.errors import Unavailable
from bokeh_validation.shaders.variants import Program, load

COLUMNS = tuple(compiler.name for compiler in COMPILERS)
THREADS = 2  # for the compilers that need not stay in one
TOGETHER = 16  # programs that a compiler is given at once, where it takes several
STYLES = {OK: "green", FAILED: "bold red", MISSING: "yellow"}


@dataclass(frozen=True)
class Matrix:
    """One run.

    rows      in the order of variants.load()
    versions  compiler -> version, or '' where it is missing: those that some row goes through, in the order of COLUMNS
    seconds   how long it took
    """

    rows: list[Program]
    versions: dict[str, str]
    seconds: float

    @property
    def ok(self) -> bool:
        """Every compiler that applies is there and took its programs."""
        return all(is_ok(row) for row in self.rows)

    @property
    def counts(self) -> dict[str, int]:
        """Number of cells: 'ok', 'failed', 'missing'."""
        statuses = [cell.status for row in self.rows for cell in row.cells.values()]
        return {status: statuses.count(status) for status in (OK, FAILED, MISSING)}


def is_ok(row: Program) -> bool:
    """Every compiler that applies is there and took it."""
    return not any(cell.status in (FAILED, MISSING) for cell in row.cells.values())


def run(
    programs: Sequence[Program],
    progress: Callable[[str], None] | None = None,
    edit: Callable[[str], str] | None = None,
) -> Matrix:
    """Compile all programs.

    progress  called in this thread with the name of each that is finished
    edit      changes the text of each shader before it is compiled
    """
    start = time.perf_counter()
    finished: list[Program] = []
    waiting: deque[tuple[list[Job], Future]] = deque()

    def collect() -> None:
        jobs, future = waiting.popleft()
        future.result()
        for job in jobs:
            cells = {name: job.cells.get(name, Cell()) for name in COLUMNS}
            finished.append(replace(job.program, cells=cells))
            if progress:
                progress(job.program.name)

    pool = ThreadPoolExecutor(THREADS)
    try:
        for jobs in _jobs(programs, edit):
            used = [compiler for compiler in COMPILERS if compiler.name in jobs[0].program.compilers]
            # OpenGL, wgpu and DXC stay in this thread while the pool runs the other compilers of earlier programs
            compile_([compiler for compiler in used if compiler.here], jobs)
            waiting.append((jobs, pool.submit(compile_, [compiler for compiler in used if not compiler.here], jobs)))
            while waiting and waiting[0][1].done():
                collect()
        while waiting:
            collect()
    finally:
        pool.shutdown(cancel_futures=True)
    there = {name for program in programs for name in program.compilers}
    versions = {compiler.name: _version(compiler) for compiler in COMPILERS if compiler.name in there}
    return Matrix(finished, versions, time.perf_counter() - start)


def _jobs(programs: Iterable[Program], edit: Callable[[str], str] | None) -> Iterator[list[Job]]:
    """The programs in their order, TOGETHER of a variant at most."""
    for _, group in groupby(programs, lambda program: program.variant):
        same = [Job(program, edit(program.source) if edit else program.source) for program in group]
        yield from (same[first : first + TOGETHER] for first in range(0, len(same), TOGETHER))


def _version(compiler: Compiler) -> str:
    try:
        return compiler.version()
    except Unavailable:
        return ""


def summary(matrix: Matrix) -> str:
    """One line: how many cells of each kind, and the time."""
    counts = matrix.counts
    parts = [f"{len(matrix.rows)} programs", f"{counts[OK]} of {sum(counts.values())} compilations ok"]
    parts += [f"{counts[kind]} {kind}" for kind in (FAILED, MISSING) if counts[kind]]
    if any("warnings" in cell.facts for row in matrix.rows for cell in row.cells.values()):
        parts.append("* with warnings")
    return ", ".join(parts) + f", {matrix.seconds:.1f} s"


def tables(matrix: Matrix) -> list[Table | Text]:
    """What the command line prints: a table for each variant, the summary, and failures()."""
    names = dict.fromkeys(row.variant for row in matrix.rows)
    return [*(table(matrix, name) for name in names), Text(summary(matrix)), *(Text(text) for text in failures(matrix))]


def table(matrix: Matrix, variant: str) -> Table:
    """A variant: a line for each entry with its sample counts, a column for each compiler. 80 characters are enough."""
    groups: dict[str, list[Program]] = defaultdict(list)
    for row in matrix.rows:
        if row.variant == variant:
            groups[row.entry].append(row)
    columns = next(iter(groups.values()))[0].compilers
    result = Table(box=None, pad_edge=False, padding=(0, 1, 0, 0))
    for heading in (escape(variant), *columns):
        result.add_column(heading, overflow="fold")
    for entry, rows in groups.items():
        words = [entry.removeprefix("Bokeh"), *(str(row.samples) for row in rows if row.samples)]
        result.add_row(" ".join(words), *(_mark([row.cells[column] for row in rows]) for column in columns))
    return result


def _mark(cells: Sequence[Cell]) -> str:
    """The worst status of some cells, with how many of them have it."""
    statuses = [cell.status for cell in cells]
    worst = next(kind for kind in (FAILED, MISSING, OK) if kind in statuses)
    text = worst
    if statuses.count(worst) < len(statuses):
        text += f" {statuses.count(worst)}/{len(statuses)}"
    elif worst == OK and any("warnings" in cell.facts for cell in cells):
        text += "*"
    slots = [int(cell.facts["slots"]) for cell in cells if "slots" in cell.facts]
    if slots:
        text += f", {max(slots)} slots"
    return f"[{STYLES[worst]}]{text}[/]"


def failures(matrix: Matrix, lines: int = 3) -> list[str]:
    """What failed or is missing, each compiler's own first lines. Rows with the same message are told once.

    Cells that only lack the output of a failed one are left out.
    """
    told: dict[tuple[str, str, str], list[str]] = defaultdict(list)
    for row in matrix.rows:
        for column, cell in row.cells.items():
            if cell.status in (FAILED, MISSING) and cell.follows not in row.compilers:
                message = "\n".join(cell.message.splitlines()[:lines])
                # a missing compiler is missing for every variant
                owner = row.variant if cell.status == FAILED else ""
                told[column, owner, message].append(row.name)
    texts = []
    for (column, owner, message), names in told.items():
        rest = f" and {len(names) - 1} more" if len(names) > 1 else ""
        head = f"{column}: {names[0]}{rest}" if owner else f"{column}: missing, {len(names)} programs not checked"
        texts.append("\n    ".join([head, *message.splitlines()]))
    return texts


def as_json(matrix: Matrix) -> dict[str, object]:
    """All of it for JSON: lists, dicts, texts and numbers only."""
    keys = ("name", "variant", "language", "profile", "entry", "samples")
    rows = [
        {key: getattr(row, key) for key in keys}
        | {"ok": is_ok(row), "cells": {column: asdict(cell) for column, cell in row.cells.items()}}
        for row in matrix.rows
    ]
    return {
        "ok": matrix.ok,
        "counts": matrix.counts,
        "summary": summary(matrix),
        "seconds": round(matrix.seconds, 2),
        "versions": dict(matrix.versions),
        "columns": list(matrix.versions),
        "rows": rows,
    }


def compile_programs(json_file: terminal.JsonFile = None) -> None:
    """Every shader program through every compiler."""
    terminal.check_writable(json_file)
    programs = load()
    with terminal.progress("compile", len(programs)) as step:
        matrix = run(programs, step)
    for part in tables(matrix):
        terminal.console.print(part)
    terminal.write_json(json_file, as_json(matrix))
    terminal.end(passed(matrix))


def passed(matrix: Matrix) -> bool:
    """Nothing failed; under CI nothing is missing either."""
    return not matrix.counts[FAILED] and not (os.environ.get("CI") and matrix.counts[MISSING])
