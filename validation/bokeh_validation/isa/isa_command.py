"""The command `validation/run isa`."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import astuple, dataclass
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from bokeh_validation import files, terminal
from bokeh_validation.errors import Unavailable
from bokeh_validation.isa import compiled, estimate
from bokeh_validation.isa.compiled import Method
from bokeh_validation.isa.estimate import DEVICES
from bokeh_validation.isa.targets import OTHERS, STOCK, TARGETS, Count

# heading -> field of Count
COLUMNS = {"instructions": "instructions", "fetches": "texture"}
COLUMNS |= {name: name for name in ("registers", "waves", "spills", "latency")}
ESTIMATED = {device.target for device in DEVICES}


@dataclass
class Counts:
    """What the compilers made of the programs.

    found    (target, language) -> program -> count; the GLSL of ESTIMATED with its loops written out as well
    mesa     target -> version
    missing  target -> why there is none
    """

    found: dict[tuple[str, str], dict[str, Count]]
    mesa: dict[str, str]
    missing: dict[str, str]


def isa(
    every: Annotated[
        bool,
        typer.Option(
            "--all", help="Newer AMD, NVIDIA, Adreno, Mali and VideoCore too: 220 MB of packages, unpacked once."
        ),
    ] = False,
    table: Annotated[
        Path | None, typer.Option(metavar="FILE.tsv", help="Write the counts here, as the tests compare them.")
    ] = None,
) -> None:
    """Instructions, fetches and registers of every pass, by the compilers of real GPUs; none needs the GPU."""
    terminal.check_writable(table)
    methods = compiled.all_methods()
    counts = count(methods, [target.name for target in (*STOCK, *(OTHERS if every else ()))])
    # a table in a file or a pipe needs a width of its own
    wide = terminal.console if terminal.console.is_terminal else Console(width=130)
    for name in counts.mesa:
        wide.print(passes_table(name, counts))
    for device in DEVICES:
        if device.target in counts.mesa:
            wide.print(methods_table(device, methods, counts.found[device.target, "glsl"]))
    for name, reason in counts.missing.items():
        terminal.console.print(f"{terminal.NOT_RUN} {name}: {reason}", highlight=False)
    if table is not None:
        files.whole(table, lambda partial: partial.write_text("".join(rows(counts)), encoding="ascii"))
    if not counts.mesa:
        terminal.end(False)


def count(methods: Iterable[Method], names: Iterable[str], languages: Iterable[str] = ("glsl", "hlsl")) -> Counts:
    """The programs of methods on targets, of those of the languages that these take. Raises UserError."""
    counts, codes = Counts({}, {}, {}), {}
    names = list(names)
    with terminal.progress("isa", len(names)) as step:
        for name in names:
            target = TARGETS[name]
            try:
                for language in [language for language in target.languages if language in languages]:
                    kind = language, target.profile, name in ESTIMATED and language == "glsl"
                    if kind not in codes:
                        codes[kind] = compiled.code(compiled.of_methods(methods, kind[2]), *kind[:2])
                    counts.mesa[name], counts.found[name, language] = target.counts(codes[kind])
            except Unavailable as error:
                counts.mesa.pop(name, None)
                counts.missing[name] = str(error)
            step(name)
    return counts


def passes_table(name: str, counts: Counts) -> Table:
    """A row a program, as it is compiled: of GLSL, and of HLSL beside it."""
    table = Table(title=f"{TARGETS[name].title} ({name}), Mesa {counts.mesa[name]}: GLSL / HLSL by DXC")
    for heading in ("pass", *COLUMNS):
        table.add_column(heading, justify="left" if heading == "pass" else "right")
    programs = [counts.found[name, language] for language in TARGETS[name].languages]
    for program in programs[0]:
        if not program.endswith(compiled.PATH):
            both = [by_name[program] for by_name in programs]
            table.add_row(program, *(" / ".join(str(getattr(c, field)) for c in both) for field in COLUMNS.values()))
    return table


def methods_table(device: estimate.Device, methods: Iterable[Method], counts: Mapping[str, Count]) -> Table:
    """A row a method: estimated milliseconds, and what it is bound by."""
    table = Table(title=f"{device.title}, estimated milliseconds a frame")
    for column in ("method", "fetches", "1920 x 1080", "bound by"):
        table.add_column(column, justify="left" if column in ("method", "bound by") else "right")
    for method in methods:
        cost = estimate.cost(method, counts, device)
        table.add_row(method.name, f"{method.fetches:.1f}", cost.text(compiled.SIZE), cost.bound)
    return table


def rows(counts: Counts) -> Iterator[str]:
    """Lines of --table: target, version of Mesa, language, program, then the fields of its count."""
    for (target, language), programs in counts.found.items():
        for name, numbers in programs.items():
            if not name.endswith(compiled.PATH):
                fields = (target, counts.mesa[target], language, name, *astuple(numbers))
                yield "\t".join(map(str, fields)) + "\n"
