"""The command `validation/run compile`: every program of variants.py through every compiler that takes it."""

import os
import re
import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, field

from rich.table import Table

from bokeh_validation import paths, terminal
from bokeh_validation.compilers.registry import COMPILERS, Compiler
from bokeh_validation.errors import Unavailable
from bokeh_validation.shaders.variants import Program, load

OK, FAILED, MISSING = "ok", "failed", "missing"
STYLES = {OK: "green", FAILED: "bold red", MISSING: "yellow"}
THREADS = 2  # for the compilers that need not stay in one


@dataclass(frozen=True)
class Cell:
    """Outcome of one compiler for one program.

    status   OK, FAILED or MISSING
    message  what the compiler printed; for MISSING how to install it
    facts    see CompileResult; warnings = number of lines printed although it is ok
    follows  the compiler whose failure left this one without input, else empty
    """

    status: str
    message: str = ""
    facts: dict[str, int] = field(default_factory=dict)
    follows: str = ""


@dataclass(frozen=True)
class Row:
    """A program, and compiler -> its outcome: of those that the program goes through."""

    program: Program
    cells: dict[str, Cell]


@dataclass(frozen=True)
class Compilation:
    """Programs that were compiled, in the order in which they were given, and the seconds that it took."""

    rows: list[Row]
    seconds: float

    @property
    def counts(self) -> dict[str, int]:
        """Number of cells: 'ok', 'failed', 'missing'."""
        statuses = [cell.status for row in self.rows for cell in row.cells.values()]
        return {status: statuses.count(status) for status in (OK, FAILED, MISSING)}

    @property
    def passed(self) -> bool:
        """Nothing failed; under CI nothing is missing either."""
        return not self.counts[FAILED] and not (os.environ.get("CI") and self.counts[MISSING])

    @property
    def columns(self) -> list[str]:
        """Names of the compilers that some row goes through."""
        return [compiler.name for compiler in COMPILERS if any(compiler.name in row.cells for row in self.rows)]

    @property
    def summary(self) -> str:
        """One line: how many cells of each kind, and the time."""
        counts = self.counts
        parts = [f"{len(self.rows)} programs", f"{counts[OK]} of {sum(counts.values())} compilations ok"]
        parts += [f"{counts[kind]} {kind}" for kind in (FAILED, MISSING) if counts[kind]]
        return ", ".join(parts) + f", {self.seconds:.1f} s"

    def failures(self, lines: int = 3) -> list[str]:
        """What failed or is missing: each compiler's own first lines, once for all programs that have them in common.

        Cells that only lack the output of a failed one are left out.
        """
        names: dict[tuple[str, str, str], list[str]] = defaultdict(list)
        for row in self.rows:
            for column, cell in row.cells.items():
                if cell.status != OK and not cell.follows:
                    names[column, cell.status, cell.message].append(row.program.name)
        return [
            "\n    ".join([f"{column} {status}: {len(programs)}, {programs[0]}", *message.splitlines()[:lines]])
            for (column, status, message), programs in names.items()
        ]

    def table(self) -> Table:
        """A line for each variant: its compilers, how many programs each refused, and the most slots of any."""
        table = Table("variant", "programs", "compilers", box=None, pad_edge=False)
        for variant in dict.fromkeys(row.program.variant for row in self.rows):
            rows = [row for row in self.rows if row.program.variant == variant]
            words = [_words(name, [row.cells[name] for row in rows]) for name in rows[0].program.compilers]
            table.add_row(variant, str(len(rows)), ", ".join(words))
        return table

    def as_json(self) -> dict[str, object]:
        """All of it: lists, dicts, texts and numbers only."""
        versions = {compiler.name: _version(compiler) for compiler in COMPILERS if compiler.name in self.columns}
        rows = [{"name": row.program.name, **asdict(row)} for row in self.rows]
        return {"ok": self.passed, "summary": self.summary, "counts": self.counts, "versions": versions, "rows": rows}


def _words(column: str, cells: Sequence[Cell]) -> str:
    """Such as 'fxc ok (up to 426 slots)' or 'naga failed 3'."""
    statuses = [cell.status for cell in cells]
    worst = next(status for status in (FAILED, MISSING, OK) if status in statuses)
    text = f"{column} [{STYLES[worst]}]{worst}[/]" + (f" {statuses.count(worst)}" if worst != OK else "")
    slots = [cell.facts["slots"] for cell in cells if "slots" in cell.facts]
    return text + (f" (up to {max(slots)} slots)" if slots else "")


def _version(compiler: Compiler) -> str:
    try:
        return f"{compiler.tool} {compiler.version()}"
    except Unavailable:
        return ""


def compile_programs(
    programs: Iterable[Program],
    progress: Callable[[str], None] | None = None,
    edit: Callable[[str], str] | None = None,
) -> Compilation:
    """Compile all programs.

    progress  called with the name of each that is finished
    edit      changes the text of each shader before it is compiled
    """
    start = time.perf_counter()
    pool = ThreadPoolExecutor(THREADS)
    waiting = []
    try:
        for program in programs:
            row, source, binaries = Row(program, {}), edit(program.source) if edit else program.source, {}
            # OpenGL, wgpu and DXC stay in this thread while the pool runs the other compilers of earlier programs
            _fill(row, source, binaries, True)
            waiting.append(pool.submit(_fill, row, source, binaries, False))
            if progress:
                waiting[-1].add_done_callback(lambda _, name=program.name: progress(name))
        rows = [future.result() for future in waiting]
    finally:
        pool.shutdown(cancel_futures=True)
    return Compilation(rows, time.perf_counter() - start)


def _fill(row: Row, source: str, binaries: dict[str, bytes], one_thread: bool) -> Row:
    """Add the cells of the compilers that need one thread, or of the others; `binaries` is what each has made."""
    program, cells = row.program, row.cells
    for compiler in COMPILERS:
        if compiler.name not in program.compilers or compiler.one_thread != one_thread:
            continue
        producer = next((name for name in compiler.takes if name in program.compilers), "")
        if producer and cells[producer].status != OK:
            message = cells[producer].message if cells[producer].status == MISSING else f"no input: {producer} failed"
            cells[compiler.name] = Cell(cells[producer].status, message, follows=producer)
            continue
        try:
            result = compiler.run(program, binaries[producer] if producer else source)
        except Unavailable as error:
            cells[compiler.name] = Cell(MISSING, str(error))
            continue
        message = result.messages if producer else located(result.messages, source, program.language)
        cells[compiler.name] = Cell(OK if result.ok else FAILED, message, result.facts)
        binaries[compiler.name] = result.binary
    return row


# How each compiler writes a place, up to the line number: glslang and mesa, DXC and fxc, naga and tint
_PLACE = re.compile(r"(?<![\w.])(?:shader\.(?:vert|frag)|0|bokeh\.hlsl|wgsl):(\d+)(?=[:(])")


def located(message: str, source: str, language: str) -> str:
    """Places in the complete program as places in the package's files, such as bokeh.glsl:251.

    source  the program: lines of its own (version, defines), whose places are left as they are, then the three files
    """
    if not message:
        return ""
    files = [paths.library(language), paths.layers(language), paths.passes(language)]
    names = [f"{file.name}:{n}" for file in files for n in range(1, len(file.read_text("ascii").splitlines()) + 1)]
    head = len(source.splitlines()) - len(names)

    def place(match: re.Match) -> str:
        line = int(match[1]) - head
        return names[line - 1] if 1 <= line <= len(names) else match[0]

    return _PLACE.sub(place, message) if head >= 0 else message


def compile_all(json_file: terminal.JsonFile = None) -> None:
    """Every shader program through every compiler."""
    terminal.check_writable(json_file)
    programs = load()
    with terminal.progress("compile", len(programs)) as step:
        compilation = compile_programs(programs, step)
    terminal.console.print(compilation.table())
    terminal.tell(compilation.summary, *compilation.failures())
    terminal.write_json(json_file, compilation.as_json())
    terminal.end(compilation.passed)
