"""What the commands of validation/run share: options, progress, output, and the drivers that --driver names."""

import json
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.progress import MofNCompleteColumn, Progress

from bokeh_validation import files
from bokeh_validation.errors import Unavailable, UserError

if TYPE_CHECKING:
    from bokeh_validation.drivers.base import Driver

OK, FAILED, NOT_RUN = "[green]ok[/]", "[red]FAILED[/]", "[dim]not run[/]"
# Tried in this order when no driver is named: the fastest to start first.
AUTO = ("egl", "osmesa", "wgpu", "dxc")

DRIVER_HELP = "osmesa, egl, wgpu, dxc, d3d9, webgl2, webgpu or reference."
OneDriver = Annotated[str | None, typer.Option("--driver", help=DRIVER_HELP)]
SeveralDrivers = Annotated[list[str] | None, typer.Option("--driver", help=DRIVER_HELP)]
Adapter = Annotated[str | None, typer.Option("--adapter", help="Part of a device's name; a wrong one lists them.")]

console = Console(soft_wrap=True)
# What stands for standard output where a file is asked for
STANDARD_OUTPUT = Path("-")


def _json_target(context: typer.Context, path: Path | None) -> Path | None:
    """The file of an option for JSON. Where that is '-', all other text of the command goes to standard error."""
    if path == STANDARD_OUTPUT:
        console.stderr = True
        context.call_on_close(lambda: setattr(console, "stderr", False))
    return path


JsonFile = Annotated[
    Path | None,
    typer.Option("--json", callback=_json_target, help="Write everything here too; -: standard output."),
]


def tell(*lines: str) -> None:
    """Print lines as they are."""
    for line in lines:
        console.print(line, markup=False, highlight=False)


def tell_missing(missing: Mapping[str, str]) -> None:
    """Print, in grey, what was not run and how to get it, a line each."""
    for name, reason in missing.items():
        console.print(f"not run: {name}: {reason}", style="dim", markup=False, highlight=False)


def end(ok: bool) -> None:
    """End the command by its exit code."""
    raise typer.Exit(0 if ok else 1)


@contextmanager
def progress(description: str, total: int) -> Iterator[Callable[[str], None]]:
    """A progress bar on standard error, gone when done; yields what is to be called after each step, with its name."""
    columns = (*Progress.get_default_columns(), MofNCompleteColumn())
    bar = Progress(*columns, console=Console(stderr=True), transient=True, disable=not sys.stderr.isatty())
    task = bar.add_task(description, total=total)
    with bar:
        yield lambda text: bar.update(task, advance=1, description=f"{description} {text}")


def parsed_size(text: str, least: int, most: int) -> tuple[int, int]:
    """(width, height) of --size '1920x1080'. Raises UserError."""
    match = re.fullmatch(r"([0-9]{1,6})x([0-9]{1,6})", text)
    size = (int(match[1]), int(match[2])) if match else (0, 0)
    if not all(least <= side <= most for side in size):
        raise UserError(f"--size {text}: not allowed. Give {least} to {most} pixels a side, such as 1920x1080.")
    return size


def chosen(
    option: str, given: Iterable[str] | None, known: Iterable[str], default: Iterable[str] | None = None
) -> list[str]:
    """What an option names, in the order of `known`; by default all of them. Raises UserError."""
    for name in given or ():
        if name not in known:
            raise UserError(f"{option} {name}: unknown. Give one of {', '.join(known)}.")
    return [name for name in known if name in (given or default or known)]


def check_writable(*targets: Path | None) -> None:
    """Refuse, before any work is done, files that cannot be written. Raises UserError."""
    for path in targets:
        if path not in (None, STANDARD_OUTPUT):
            files.check_writable(path)


def write_json(path: Path | None, data: object) -> None:
    """Write a file as a whole, or to standard output, if it was asked for."""
    text = json.dumps(data, indent=1) + "\n"
    if path == STANDARD_OUTPUT:
        sys.stdout.write(text)
    elif path is not None:
        files.whole(path, lambda partial: partial.write_text(text, encoding="utf-8"))


def pick_driver(name: str | None, adapter: str | None) -> "Driver":
    """The driver named, or the first that this machine has. Raises UserError."""
    from bokeh_validation import drivers

    for candidate in AUTO if name is None else ():
        try:
            return drivers.load(candidate, adapter)
        except Unavailable:
            continue
    (found,), _ = pick_drivers([AUTO[0] if name is None else name], adapter)
    return found


def pick_drivers(names: Iterable[str], adapter: str | None) -> tuple[list["Driver"], dict[str, str]]:
    """The drivers named, and name -> reason for those that are missing. Raises UserError where none is left."""
    from bokeh_validation import drivers

    found, missing = [], {}
    for name in names:
        check_driver(name)
        try:
            found.append(drivers.load(name, adapter))
        except Unavailable as error:
            missing[name] = str(error)
    if not found:
        reasons = "; ".join(f"{name}: {reason}" for name, reason in missing.items())
        raise UserError(f"none of the drivers is on this machine ({reasons}). See validation/run doctor.")
    return found, missing


def check_driver(name: str) -> None:
    """Refuse a name that is no driver's. Raises UserError."""
    from bokeh_validation import drivers

    if name not in drivers.NAMES:
        raise UserError(f"--driver {name}: no such driver. Give one of {', '.join(drivers.NAMES)}.")
