"""The command `validation/run isa`."""

from collections.abc import Iterable
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from bokeh_validation import files, terminal
from bokeh_validation.errors import Unavailable
from lab.isa import compiled
from lab.isa.targets import SYSTEM, TARGETS, Count

# What makes SPIR-V of each language
WAYS = {"glsl": "GLSL by glslang", "hlsl": "HLSL by DXC", "wgsl": "WGSL by naga"}
COLUMNS = tuple(field.name for field in fields(Count))


@dataclass
class Counts:
    """What the compilers made of the passes.

    found    (target, language) -> pass -> count
    mesa     target -> version
    missing  (target, language) -> why there is none
    """

    found: dict[tuple[str, str], dict[str, Count]]
    mesa: dict[str, str]
    missing: dict[tuple[str, str], str]

    def languages(self, target: str) -> list[str]:
        """Those that a target was given."""
        return [language for name, language in self.found if name == target]

    def rows(self, target: str) -> list[list[str]]:
        """A row a pass: its name, and of each of COLUMNS the languages' numbers side by side."""
        ways = [self.found[target, language] for language in self.languages(target)]
        return [
            [name, *(" / ".join(str(getattr(way[name], column)) for way in ways) for column in COLUMNS)]
            for name in ways[0]
        ]


def isa(
    every: Annotated[
        bool,
        typer.Option(
            "--all", help="Other AMD, NVIDIA, Adreno, Mali and VideoCore too: 220 MB of packages, unpacked once."
        ),
    ] = False,
    table: Annotated[Path | None, typer.Option(metavar="FILE.tsv", help="Write the tables here as well.")] = None,
) -> None:
    """Instructions, registers and latency of every pass, by the compilers of real GPUs; none needs the GPU."""
    terminal.check_writable(table)
    counts = count(TARGETS if every else [SYSTEM])
    for target in counts.mesa:
        ways = " / ".join(WAYS[language] for language in counts.languages(target))
        shown = Table(title=f"{TARGETS[target].title} ({target}), Mesa {counts.mesa[target]}: {ways}")
        for heading in ("pass", *COLUMNS):
            shown.add_column(heading, justify="left" if heading == "pass" else "right")
        for row in counts.rows(target):
            shown.add_row(*row)
        # a file or a pipe has no width of its own
        Console(width=None if terminal.console.is_terminal else 130).print(shown)
    for (target, language), reason in counts.missing.items():
        terminal.console.print(f"{terminal.NOT_RUN} {target}, {WAYS[language]}: {reason}", highlight=False)
    if table is not None:
        lines = ["\t".join((target, *row)) + "\n" for target in counts.mesa for row in counts.rows(target)]
        files.whole(table, lambda partial: partial.write_text("".join(lines), encoding="ascii"))
    if not counts.mesa:
        terminal.end(False)


def count(names: Iterable[str]) -> Counts:
    """All passes on targets, of those of the languages that these take. Raises UserError."""
    counts, codes, passes, names = Counts({}, {}, {}), {}, compiled.all_passes(), list(names)
    with terminal.progress("isa", len(names)) as step:
        for name in names:
            target = TARGETS[name]
            for language in target.languages:
                kind = language, target.profile
                try:
                    if kind not in codes:
                        codes[kind] = compiled.code(passes, *kind)
                    counts.mesa[name], counts.found[name, language] = target.counts(codes[kind])
                except Unavailable as error:
                    counts.missing[name, language] = str(error)
                    break
            step(name)
    return counts
