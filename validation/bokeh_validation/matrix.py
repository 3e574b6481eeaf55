"""The compile matrix: every row of variants.toml through every compiler that takes it."""

import os
import time
from collections import defaultdict, deque
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass

from rich.markup import escape
from rich.table import Table
from rich.text import Text

from bokeh_validation import terminal, variants
from bokeh_validation.compilers import angle, chain, glslang, glslc, mesa, mojoshader, naga, spirv, tint
from bokeh_validation.compilers.chain import FAILED, MISSING, NOT_APPLICABLE, OK, Cell, Runtimes
from bokeh_validation.errors import Unavailable
from bokeh_validation.variants import COLUMNS, Variant, load

__all__ = [
    "Cell",
    "Matrix",
    "Row",
    "Runtimes",
    "as_json",
    "count",
    "failures",
    "load",
    "run",
    "summary",
    "table",
    "tables",
    "versions",
]

THREADS = 2  # for the command line compilers
STYLES = {OK: "green", FAILED: "bold red", MISSING: "yellow"}


@dataclass(frozen=True)
class Row:
    """A program of the matrix and what each compiler of COLUMNS said of it."""

    program: Variant
    cells: dict[str, Cell]

    @property
    def name(self) -> str:
        """Unique in the matrix and readable."""
        return self.program.name

    @property
    def variant(self) -> str:
        """Id of the [[variant]]."""
        return self.program.id

    @property
    def language(self) -> str:
        """'hlsl', 'glsl' or 'wgsl'."""
        return self.program.language

    @property
    def profile(self) -> str:
        """Such as '330' or 'sm6'."""
        return self.program.profile

    @property
    def entry(self) -> str:
        """Stem of the entry point."""
        return self.program.entry

    @property
    def samples(self) -> int | None:
        """BOKEH_NUM_SAMPLES, or None for an entry that was compiled with the default."""
        return self.program.samples

    @property
    def ok(self) -> bool:
        """Every compiler that applies is there and took it."""
        return all(cell.status in (OK, NOT_APPLICABLE) for cell in self.cells.values())


@dataclass(frozen=True)
class Matrix:
    """One run.

    rows      in the order of variants.toml
    versions  compiler -> version, or '' where it is missing
    seconds   how long it took
    """

    rows: list[Row]
    versions: dict[str, str]
    seconds: float

    @property
    def ok(self) -> bool:
        """Every applicable cell is ok."""
        return all(row.ok for row in self.rows)

    @property
    def columns(self) -> list[str]:
        """Compilers that some row goes through, in the order of COLUMNS."""
        return list(self.versions)

    @property
    def counts(self) -> dict[str, int]:
        """Number of cells: 'ok', 'failed', 'missing'."""
        statuses = [cell.status for row in self.rows for cell in row.cells.values()]
        return {status: statuses.count(status) for status in (OK, FAILED, MISSING)}


Progress = Callable[[str], None]


def run(
    rows: Sequence[Variant],
    progress: Progress | None = None,
    runtimes: Runtimes | None = None,
    edit: Callable[[str], str] | None = None,
) -> Matrix:
    """Compile all rows.

    progress  called in this thread with the name of each finished row, count(rows) times
    runtimes  drivers to use; by default new ones, made when a row needs them
    edit      changes the text of each shader before it is compiled
    """
    start = time.perf_counter()
    runtimes = runtimes or Runtimes()
    finished: list[Row] = []
    waiting: deque[tuple[Variant, Future]] = deque()

    def collect() -> None:
        variant, future = waiting.popleft()
        finished.append(Row(variant, future.result()))
        if progress:
            progress(finished[-1].name)

    pool = ThreadPoolExecutor(THREADS)
    try:
        for variant in rows:
            source = variants.source(variant)
            source = edit(source) if edit else source
            # OpenGL, wgpu, Chromium, DXC and fxc stay in this thread while the pool runs the tools of earlier rows
            cells, binary = chain.in_process(variant, source, runtimes)
            waiting.append((variant, pool.submit(chain.tools, variant, source, cells, binary)))
            while waiting and waiting[0][1].done():
                collect()
        while waiting:
            collect()
    finally:
        pool.shutdown(cancel_futures=True)
    return Matrix(finished, versions(rows, runtimes), time.perf_counter() - start)


def versions(rows: Iterable[Variant], runtimes: Runtimes) -> dict[str, str]:
    """Version of each compiler that the rows use, '' where it is missing."""

    def cross_checked() -> str:
        return f"spirv-cross {spirv.version_cross()}, glslang {glslang.version()}"

    ask: dict[str, Callable[[], str]] = {
        "fxc": lambda: runtimes.get("fxc").version,
        "mojoshader": mojoshader.version,
        "glslang": glslang.version,
        "glslc": glslc.version,
        "dxc-spirv": lambda: runtimes.get("dxc").version,
        "dxc-dxil": lambda: runtimes.get("dxc").version,
        "spirv-val": spirv.version_val,
        "essl300": cross_checked,
        "essl310": cross_checked,
        "hlsl50": lambda: f"spirv-cross {spirv.version_cross()}, fxc {runtimes.get('fxc').version}",
        "msl": lambda: f"spirv-cross {spirv.version_cross()}",
        "mesa": lambda: mesa.version(runtimes.get("gl")),
        "angle": lambda: angle.version(runtimes.chromium()),
        "tint": lambda: tint.version(runtimes.chromium()),
        "naga": lambda: naga.version(runtimes.get("wgpu")),
    }
    used = {column for row in rows for column in row.compilers}
    found = {}
    for column in COLUMNS:
        if column in used:
            try:
                found[column] = ask[column]()
            except Unavailable:
                found[column] = ""
    return found


def count(rows: Sequence[Variant]) -> int:
    """How many times run() will call `progress`."""
    return len(rows)


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
    groups: dict[str, list[Row]] = defaultdict(list)
    for row in matrix.rows:
        if row.variant == variant:
            groups[row.entry].append(row)
    columns = next(iter(groups.values()))[0].program.compilers
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
            if cell.status in (FAILED, MISSING) and cell.follows not in row.program.compilers:
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
    return {
        "ok": matrix.ok,
        "counts": matrix.counts,
        "summary": summary(matrix),
        "seconds": round(matrix.seconds, 2),
        "versions": dict(matrix.versions),
        "columns": matrix.columns,
        "rows": [
            {
                "name": row.name,
                "variant": row.variant,
                "language": row.language,
                "profile": row.profile,
                "entry": row.entry,
                "samples": row.samples,
                "ok": row.ok,
                "cells": {
                    column: {
                        "status": cell.status,
                        "message": cell.message,
                        "facts": dict(cell.facts),
                        "follows": cell.follows,
                    }
                    for column, cell in row.cells.items()
                },
            }
            for row in matrix.rows
        ],
    }


def compile_programs(json_file: terminal.JsonFile = None) -> None:
    """Every variant of variants.toml through every compiler."""
    terminal.check_writable(json_file)
    rows = load()
    with terminal.progress("compile", count(rows)) as step:
        matrix = run(rows, step)
    for part in tables(matrix):
        terminal.console.print(part)
    terminal.write_json(json_file, as_json(matrix))
    terminal.end(passed(matrix))


def passed(matrix: Matrix) -> bool:
    """Nothing failed; under CI nothing is missing either."""
    return not matrix.counts[FAILED] and not (os.environ.get("CI") and matrix.counts[MISSING])
