"""The command `validation/run isa`."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, astuple, dataclass, field
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from bokeh_validation import files, terminal
from bokeh_validation.errors import Unavailable
from bokeh_validation.isa import compiled, estimate
from bokeh_validation.isa.compiled import Method
from bokeh_validation.isa.estimate import DEVICES
from bokeh_validation.isa.targets import MISSING, OTHERS, STOCK, TARGETS, Count

SIZES = ((1920, 1080), (3840, 2160))
ESTIMATED = {device.target for device in DEVICES}


@dataclass
class Counts:
    """What the compilers made of the programs.

    found    target -> program -> count; those of ESTIMATED have the programs with their loops written out as well
    mesa     target -> version
    missing  target -> why there is none
    """

    found: dict[str, dict[str, Count]] = field(default_factory=dict)
    mesa: dict[str, str] = field(default_factory=dict)
    missing: dict[str, str] = field(default_factory=dict)


def isa(
    every: Annotated[
        bool,
        typer.Option(
            "--all", help="Newer AMD, NVIDIA, Adreno, Mali and VideoCore too: 220 MB of packages, unpacked once."
        ),
    ] = False,
    against: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder with glsl/ of another release: show ratios to it.")
    ] = None,
    json_file: terminal.JsonFile = None,
    table: Annotated[
        Path | None, typer.Option(metavar="FILE.tsv", help="Write the counts here, as the tests compare them.")
    ] = None,
) -> None:
    """Instructions, fetches and registers of every pass, by the compilers of real GPUs; none needs the GPU."""
    terminal.check_writable(json_file, table)
    methods = compiled.all_methods()
    names = [target.name for target in (*STOCK, *(OTHERS if every else ()))]
    counts = count(methods, names)
    old = count(methods, list(counts.found), against) if against else Counts()
    wide = terminal.table_console(130)
    for name, found in counts.found.items():
        wide.print(
            passes_table(f"{TARGETS[name].title} ({name}), Mesa {counts.mesa[name]}", found, old.found.get(name))
        )
    for device in DEVICES:
        if device.target in counts.found:
            wide.print(methods_table(device, methods, counts.found[device.target]))
    for name, reason in {**counts.missing, **(MISSING if every else {})}.items():
        terminal.console.print(f"{terminal.NOT_RUN} {name}: {reason}", highlight=False)
    terminal.write_json(json_file, as_json(methods, counts, old))
    if table is not None:
        files.whole(table, lambda partial: partial.write_text("".join(rows(counts)), encoding="ascii"))
    if not counts.found:
        terminal.end(False)


def count(methods: Iterable[Method], names: Iterable[str], folder: Path | None = None) -> Counts:
    """The programs of methods on targets; `folder` as in compiled.made. Raises UserError."""
    counts, compiled_for = Counts(), {}
    names = list(names)
    with terminal.progress("isa", len(names)) as step:
        for name in names:
            paths = name in ESTIMATED and folder is None
            kind = paths, TARGETS[name].profile
            if kind not in compiled_for:
                compiled_for[kind] = compiled.made(compiled.of_methods(methods, paths), kind[1], folder)
            try:
                counts.mesa[name], counts.found[name] = TARGETS[name].counts(*compiled_for[kind])
            except Unavailable as error:
                counts.missing[name] = str(error)
            step(name)
    return counts


def passes_table(title: str, found: Mapping[str, Count], old: Mapping[str, Count] | None) -> Table:
    """A row a program, as it is compiled; the slots are those on a pixel's path."""
    table = Table(title=title)
    estimated = any(name.endswith(compiled.PATH) for name in found)
    columns = ["instructions", "fetches", "registers", "waves", "spills"]
    columns += ["loops", "slots"] if estimated else []
    columns += ["instructions, ratio", "fetches, ratio"] if old else []
    for column in ("pass", *columns):
        table.add_column(column, justify="left" if column in ("pass", "loops") else "right")
    for name, one in found.items():
        if name.endswith(compiled.PATH) or (old is not None and name not in old):
            continue
        cells = [one.instructions, one.texture, one.registers, one.waves or "", one.spills]
        if estimated:
            # of a pass for several polygons, the first one
            path = next(path for key, path in found.items() if key.startswith(name) and key.endswith(compiled.PATH))
            unrolled = estimate.is_unrolled(one, path)
            cells += ["unrolled" if unrolled else "rolled", one.slots if unrolled else path.slots]
        if old:
            cells += [f"{one.instructions / old[name].instructions:.3f}", f"{one.texture / old[name].texture:.3f}"]
        table.add_row(name, *map(str, cells))
    return table


def methods_table(device: estimate.Device, methods: Iterable[Method], counts: Mapping[str, Count]) -> Table:
    """A row a method: estimated milliseconds, and what it is bound by."""
    table = Table(title=f"{device.title}, estimated milliseconds a frame")
    for column in ("method", "fetches", *(f"{width} x {height}" for width, height in SIZES), "bound by"):
        table.add_column(column, justify="left" if column in ("method", "bound by") else "right")
    for method in methods:
        cost = estimate.cost(method, counts, device)
        table.add_row(method.name, f"{method.fetches:.1f}", *(cost.text(size) for size in SIZES), cost.bound)
    return table


def rows(counts: Counts) -> Iterator[str]:
    """Lines of --table: target, version of Mesa, program, then the fields of its count."""
    for target, found in counts.found.items():
        for name, one in found.items():
            if not name.endswith(compiled.PATH):
                values = "\t".join(map(str, astuple(one)))
                yield f"{target}\t{counts.mesa[target]}\t{name}\t{values}\n"


def as_json(methods: Iterable[Method], counts: Counts, old: Counts) -> dict:
    """Everything, for --json."""
    estimates = {
        device.title: {
            method.name: asdict(cost := estimate.cost(method, counts.found[device.target], device))
            | {"bound": cost.bound}
            for method in methods
        }
        for device in DEVICES
        if device.target in counts.found
    }
    return {
        "mesa": counts.mesa,
        "counts": {name: {key: asdict(one) for key, one in found.items()} for name, found in counts.found.items()},
        "against": {name: {key: asdict(one) for key, one in found.items()} for name, found in old.found.items()},
        "nanoseconds a pixel": estimates,
        "missing": counts.missing,
    }
