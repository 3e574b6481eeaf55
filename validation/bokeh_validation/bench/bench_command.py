"""The command `validation/run bench`."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from bokeh_validation import drivers, pictures, terminal
from bokeh_validation.bench import measure, output, rows, session
from bokeh_validation.drivers.base import TimedDriver
from bokeh_validation.errors import UserError

# Drivers with a way to draw without upload and read-back, in the order in which they are tried
DRIVERS = ("egl", "osmesa", "wgpu", "dxc")
DEFAULT_DRIVERS = ("osmesa", "wgpu")
QUICK_SIZE = (160, 160)
# Of the layers: the scene as it is
LAYERS_SIZE = (960, 540)
ROUNDS, QUICK_ROUNDS = 9, 5
LEAST_SIDE, MOST_SIDE = 16, 8192
LEAST_ROUNDS, MOST_ROUNDS = 3, 1000


def plan(size: str | None, rounds: int | None, quick: bool, clock: str | None = None) -> session.Plan:
    """What to measure. Raises UserError for a size, a number of rounds or a clock that makes no sense."""
    if clock is not None and clock not in measure.CLOCKS:
        raise UserError(f"--clock {clock}: unknown. Give one of {', '.join(measure.CLOCKS)}.")
    if rounds is not None and not LEAST_ROUNDS <= rounds <= MOST_ROUNDS:
        raise UserError(f"--rounds {rounds}: not allowed. Give {LEAST_ROUNDS} to {MOST_ROUNDS}.")
    wanted = None if size is None else terminal.parsed_size(size, LEAST_SIDE, MOST_SIDE)
    if quick:
        layers_size = wanted or session.SOFTWARE_SIZE
        return session.Plan(wanted or QUICK_SIZE, layers_size, rounds or QUICK_ROUNDS, rows.QUICK_SIDES, clock)
    return session.Plan(wanted, wanted or LAYERS_SIZE, rounds or ROUNDS, rows.SIDES, clock)


def load(names: list[str] | None, adapter: str | None) -> tuple[list[TimedDriver], dict[str, str]]:
    """The drivers asked for, and name -> reason for those that are missing. Raises UserError where none is left."""
    for name in names or []:
        if name not in DRIVERS:
            why = "its times would hold upload and read-back" if name in drivers.NAMES else "no such driver"
            raise UserError(f"--driver {name}: {why}. Give one of {', '.join(DRIVERS)}.")
    return terminal.pick_drivers(dict.fromkeys(names or DEFAULT_DRIVERS), adapter)


def bench(
    driver: Annotated[
        list[str] | None,
        typer.Option("--driver", help="osmesa, egl, wgpu or dxc; default: osmesa and wgpu. The others are not timed."),
    ] = None,
    adapter: terminal.Adapter = None,
    size: Annotated[
        str | None, typer.Option(metavar="WxH", help="Pixels. Default: 800x800; smaller in software.")
    ] = None,
    rounds: Annotated[int | None, typer.Option(help="Rounds that count, 3 or more.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Small, few counts, few rounds: within 40 s.")] = False,
    clock: Annotated[
        str | None,
        typer.Option(help="wall, query or cpu. Default: cpu in software, else query where it agrees with wall."),
    ] = None,
    json_file: Annotated[Path | None, typer.Option("--json", help="Write everything here, raw rounds too.")] = None,
    plot: Annotated[Path | None, typer.Option(metavar="FILE.png", help="Draw the curves and the floors.")] = None,
) -> None:
    """Table 1: time of the methods against naive, against each other and against a floor of the same fetches."""
    wanted = plan(size, rounds, quick, clock)
    terminal.check_writable(json_file, plot)
    found, missing = load(driver, adapter)
    with terminal.progress("bench", wanted.steps * len(found)) as step:
        results = [session.measure(one, wanted, lambda text, name=one.name: step(f"{name}: {text}")) for one in found]
    terminal.write_json(json_file, session.as_json(results, missing))
    if plot is not None:
        pictures.write_png(plot, output.plot(results))
    # a table in a file or a pipe needs a width of its own
    wide = terminal.console if terminal.console.is_terminal else Console(width=120)
    for result in results:
        for part in output.tables(result):
            wide.print(part)
    for name, reason in missing.items():
        terminal.console.print(f"{terminal.NOT_RUN} {name}: {reason}")
