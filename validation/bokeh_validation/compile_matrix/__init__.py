"""Compile every program of variants.py with every compiler that accepts it; tests/harness/test_compile.py does so."""

import json
import os
import re
from collections import defaultdict
from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass, field
from functools import cache

from rich.table import Table

from bokeh_validation import files, locks, paths, shaders
from bokeh_validation.compile_matrix.registry import COMPILERS, linked_with
from bokeh_validation.errors import Unavailable
from bokeh_validation.shaders import calls
from bokeh_validation.shaders.variants import Program

# What outcomes depend on apart from the shaders: the code that builds programs and runs compilers, and their versions
CODE = (
    *(f"bokeh_validation/{name}" for name in ("browser", "compile_matrix", "compilers", "shaders", "windows")),
    "bokeh_validation/needs.py",
    "requirements.txt",
)
OK, FAILED, MISSING = "ok", "failed", "missing"
STYLES = {FAILED: "bold red", MISSING: "yellow", OK: "green"}


@dataclass(frozen=True)
class Cell:
    """Hold one compiler's outcome for a program: what it printed, or how to install it if it is MISSING."""

    status: str
    message: str = ""
    facts: dict[str, int] = field(default_factory=dict)


@dataclass(frozen=True)
class Row:
    """Hold a program, and compiler -> outcome for the compilers that it goes through; those whose input failed are
    left out.
    """

    program: Program
    cells: dict[str, Cell]


@dataclass(frozen=True)
class Compilation:
    """Hold compiled programs in their given order."""

    rows: list[Row]

    @property
    def counts(self) -> dict[str, int]:
        """Return status -> number of cells, for 'ok', 'failed' and 'missing'."""
        statuses = [cell.status for row in self.rows for cell in row.cells.values()]
        return {status: statuses.count(status) for status in (OK, FAILED, MISSING)}

    @property
    def ok(self) -> bool:
        """Return whether nothing failed."""
        return not self.counts[FAILED]

    @property
    def passed(self) -> bool:
        """Return whether nothing failed and, under CI, nothing is missing."""
        return self.ok and not (os.environ.get("CI") and self.counts[MISSING])

    @property
    def summary(self) -> str:
        """Return one line: how many compilations were run, and how many failed."""
        counts = self.counts
        text = f"{len(self.rows)} programs, {counts[OK]} of {counts[OK] + counts[FAILED]} compilations ok"
        return text + (f", {counts[FAILED]} {FAILED}" if counts[FAILED] else "")

    def failures(self, lines: int = 3) -> list[str]:
        """Return the first lines of each compiler's errors, once for all programs with the same error."""
        names: dict[tuple[str, str], list[str]] = defaultdict(list)
        for row in self.rows:
            for column, cell in row.cells.items():
                if cell.status == FAILED:
                    names[column, cell.message].append(row.program.name)
        return [
            "\n    ".join([f"{column} {FAILED}: {len(programs)}, {programs[0]}", *message.splitlines()[:lines]])
            for (column, message), programs in names.items()
        ]

    @property
    def missing(self) -> dict[str, str]:
        """Return missing compiler -> how to install it."""
        cells = [entry for row in self.rows for entry in row.cells.items()]
        return {column: cell.message for column, cell in cells if cell.status == MISSING}

    def table(self) -> Table:
        """Return a table with a row per variant: its compilers, how many programs each rejected, and the most slots."""
        table = Table("variant", "programs", "compilers", box=None, pad_edge=False)
        for variant in dict.fromkeys(row.program.variant for row in self.rows):
            rows = [row for row in self.rows if row.program.variant == variant]
            cells = {name: [row.cells[name] for row in rows if name in row.cells] for name in rows[0].program.compilers}
            table.add_row(variant, str(len(rows)), ", ".join(_words(*entry) for entry in cells.items() if entry[1]))
        return table

    def as_json(self) -> dict[str, object]:
        """Return everything as lists, dicts, texts and numbers."""
        rows = [{"name": row.program.name, **asdict(row)} for row in self.rows]
        return {"ok": self.passed, "summary": self.summary, "counts": self.counts, "rows": rows}


def _words(column: str, cells: list[Cell]) -> str:
    """Format a compiler's cells, such as 'fxc ok (up to 426 slots)' or 'naga failed 3'."""
    statuses = [cell.status for cell in cells]
    worst = next(status for status in STYLES if status in statuses)
    text = f"{column} [{STYLES[worst]}]{worst}[/]" + (f" {statuses.count(worst)}" if worst != OK else "")
    slots = [cell.facts["slots"] for cell in cells if "slots" in cell.facts]
    return text + (f" (up to {max(slots)} slots)" if slots else "")


def compile_programs(
    programs: Iterable[Program], edit: Callable[[str], str] | None = None, kept: bool = False
) -> Compilation:
    """Compile all programs.

    edit  changes the text of each shader beforehand
    kept  take the outcome of a program from the cache folder if it was accepted before and its code, without functions
          that it does not call, is the same
    """
    if kept:
        return Compilation([_kept(program) for program in programs])
    return Compilation([_row(program, edit(program.source) if edit else program.source) for program in programs])


def _kept(program: Program) -> Row:
    text = shaders.text(program.language)
    code = {**calls.program(text, program.function), **calls.program(text, linked_with(program).function)}
    declared = calls.declared(text, code)
    digest = locks.digest([_code(), repr(program), *map(repr, (sorted(code.items()), sorted(declared)))])
    file = paths.ensured(paths.cache_folder() / "compiled") / f"{digest[:32]}.json"
    if file.exists():
        return Row(program, {name: Cell(**cell) for name, cell in json.loads(file.read_bytes()).items()})
    row = _row(program, program.source)
    if all(cell.status == OK for cell in row.cells.values()):
        text = json.dumps({name: asdict(cell) for name, cell in row.cells.items()})
        files.whole(file, lambda target: target.write_text(text, encoding="utf-8"))
    return row


@cache
def _code() -> str:
    found = (paths.VALIDATION / name for name in CODE)
    paths_found = (file for path in found for file in (sorted(path.rglob("*.*")) if path.is_dir() else [path]))
    return locks.digest(file for file in paths_found if file.suffix != ".pyc")


def _row(program: Program, source: str) -> Row:
    cells, binaries = {}, {}
    for compiler in COMPILERS:
        if compiler.name not in program.compilers:
            continue
        producer = next((name for name in compiler.takes if name in program.compilers), "")
        if producer and producer not in binaries:
            continue
        try:
            result = compiler.run(program, binaries[producer] if producer else source)
        except Unavailable as error:
            cells[compiler.name] = Cell(MISSING, str(error))
            continue
        message = result.messages if producer else located(result.messages, source, program.language)
        cells[compiler.name] = Cell(OK if result.ok else FAILED, message, result.facts)
        if result.ok:
            binaries[compiler.name] = result.binary
    return Row(program, cells)


# Formats in which compilers write a position, up to the line number: glslang and Mesa, DXC and fxc, naga and Tint
_PLACE = re.compile(r"(?<![\w.])(?:shader\.(?:vert|frag)|0|bokeh\.hlsl|wgsl):(\d+)(?=[:(])")


def located(message: str, source: str, language: str) -> str:
    """Replace positions in the complete program by positions in the package's files, such as bokeh.glsl:251.

    source  the program: first its own lines (version, defines), whose positions are left unchanged, then all files
    """
    if not message:
        return ""
    counts = {stem: len(shaders.file_text(language, stem).splitlines()) for stem in paths.STEMS}
    names = [f"{stem}.{language}:{n}" for stem, count in counts.items() for n in range(1, count + 1)]
    head = len(source.splitlines()) - len(names)

    def place(match: re.Match) -> str:
        line = int(match[1]) - head
        return names[line - 1] if 1 <= line <= len(names) else match[0]

    return _PLACE.sub(place, message) if head >= 0 else message
