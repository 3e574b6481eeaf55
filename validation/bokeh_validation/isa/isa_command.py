"""The command `validation/run isa`."""

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from bokeh_validation import terminal
from bokeh_validation.errors import Unavailable
from bokeh_validation.isa import model, programs
from bokeh_validation.isa.model import DEVICES
from bokeh_validation.isa.programs import Method, Program
from bokeh_validation.isa.targets import MISSING, OTHERS, STOCK, TARGETS, Count

SIZES = ((1920, 1080), (3840, 2160))
Counts = dict[str, dict[str, Count]]  # target -> program -> count


def isa(
    every: Annotated[
        bool, typer.Option("--all", help="Newer AMD, NVIDIA and Adreno too: 200 MB of packages, unpacked once.")
    ] = False,
    against: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder with glsl/ of another release: show ratios to it.")
    ] = None,
    json_file: terminal.JsonFile = None,
) -> None:
    """Instructions, fetches and registers of every pass, by the compilers of real GPUs; none needs the GPU."""
    terminal.check_writable(json_file)
    chosen = programs.all_methods()
    wanted = programs.of_methods(chosen)
    targets = [*STOCK, *(OTHERS if every else ())]
    counts, missing = count(wanted, [target.name for target in targets])
    old = count(wanted, list(counts), against)[0] if against else {}
    # a table in a file or a pipe needs a width of its own
    wide = terminal.console if terminal.console.is_terminal else Console(width=160)
    for name, found in counts.items():
        wide.print(passes_table(name, wanted, found, old.get(name, {})))
    for device in DEVICES:
        if device.target in counts:
            wide.print(methods_table(device, chosen, counts[device.target]))
    for name, reason in {**missing, **(MISSING if every else {})}.items():
        terminal.console.print(f"{terminal.NOT_RUN} {name}: {reason}", highlight=False)
    terminal.write_json(json_file, as_json(chosen, counts, old, missing))
    if not counts:
        terminal.end(False)


def count(
    wanted: Mapping[str, Program], names: list[str], folder: Path | None = None
) -> tuple[Counts, dict[str, str]]:
    """(target -> program -> count, target -> why there is none)."""
    vertex, fragments = programs.spirv(dict(wanted), folder)
    counts, missing = {}, {}
    with terminal.progress("isa", len(names)) as step:
        for name in names:
            try:
                counts[name] = TARGETS[name].counts(vertex, fragments)
            except Unavailable as error:
                missing[name] = str(error)
            step(name)
    return counts, missing


def passes_table(
    target: str, wanted: Mapping[str, Program], found: Mapping[str, Count], old: Mapping[str, Count]
) -> Table:
    """A row a program: as it is, and along a pixel's path."""
    table = Table(title=f"{target}: {TARGETS[target].title}")
    columns = ["instructions", "fetches", "registers", "waves", "spills", "loops", "slots on the path"]
    for column in ("pass", *columns, *(["instructions, ratio", "fetches, ratio"] if old else [])):
        table.add_column(column, justify="left" if column in ("pass", "loops") else "right")
    for name, program in wanted.items():
        if program.path or (old and name not in old):
            continue
        one, path = found[name], found[f"{name} path"]
        cells = [one.instructions, one.texture, one.registers, one.waves or "", one.spills, loops(one, path), path.slots]
        if old:
            cells += [f"{one.instructions / old[name].instructions:.3f}", f"{one.texture / old[name].texture:.3f}"]
        table.add_row(name, *map(str, cells))
    return table


def loops(one: Count, path: Count) -> str:
    """Whether the compiler has written out the loops: all fetches of the path are in the code then."""
    return "unrolled" if one.texture >= path.texture else "rolled"


def methods_table(device: model.Device, chosen: list[Method], counts: Mapping[str, Count]) -> Table:
    """A row a method: what it is bound by, and estimated milliseconds."""
    table = Table(title=f"{device.title}, estimated: milliseconds a frame, least and most")
    for column in ("method", "fetches", *(f"{width} x {height}" for width, height in SIZES), "bound by"):
        table.add_column(column, justify="right" if column != "method" else "left")
    for method in chosen:
        cost = model.cost(method, counts, device)
        times = ["{:.2f} .. {:.2f}".format(*cost.milliseconds(size)) for size in SIZES]
        table.add_row(method.name, f"{method.fetches:.1f}", *times, cost.bound)
    return table


def as_json(chosen: list[Method], counts: Counts, old: Counts, missing: Mapping[str, str]) -> dict:
    """Everything, for --json."""
    estimates = {
        device.title: {
            method.name: {**asdict(found := model.cost(method, counts[device.target], device)), "bound": found.bound}
            for method in chosen
        }
        for device in DEVICES
        if device.target in counts
    }
    return {
        "counts": {name: {key: asdict(one) for key, one in found.items()} for name, found in counts.items()},
        "against": {name: {key: asdict(one) for key, one in found.items()} for name, found in old.items()},
        "nanoseconds a pixel": estimates,
        "missing": dict(missing),
    }
