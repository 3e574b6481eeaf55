"""Provide what the commands of validation/run share: options, progress and output."""

import json
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import MofNCompleteColumn, Progress

from bokeh_validation import files
from bokeh_validation.errors import UserError

OK, FAILED, NOT_RUN = "[green]ok[/]", "[red]FAILED[/]", "[dim]not run[/]"

DRIVER_HELP = "osmesa, egl, wgpu, dxc, d3d9, webgl2, webgpu or reference."
OneDriver = Annotated[str | None, typer.Option("--driver", help=DRIVER_HELP)]
SeveralDrivers = Annotated[list[str] | None, typer.Option("--driver", help=DRIVER_HELP)]
Adapter = Annotated[str | None, typer.Option("--adapter", help="Part of a device's name; a wrong one lists them.")]

console = Console(soft_wrap=True)
# The path that means standard output
STANDARD_OUTPUT = Path("-")


def _json_target(context: typer.Context, path: Path | None) -> Path | None:
    """Return the path of a --json option; if it is '-', send all other text of the command to standard error."""
    if path == STANDARD_OUTPUT:
        console.stderr = True
        context.call_on_close(lambda: setattr(console, "stderr", False))
    return path


JsonFile = Annotated[
    Path | None,
    typer.Option("--json", callback=_json_target, help="Write everything here too; -: standard output."),
]


def tell(*lines: str) -> None:
    """Print lines without interpreting markup."""
    for line in lines:
        console.print(line, markup=False, highlight=False)


def tell_missing(missing: Mapping[str, str]) -> None:
    """Print in grey what was not run and how to get it, one line each."""
    for name, reason in missing.items():
        console.print(f"not run: {name}: {reason}", style="dim", markup=False, highlight=False)


def end(ok: bool) -> None:
    """End the command with exit code 0, or 1 if not `ok`."""
    raise typer.Exit(0 if ok else 1)


@contextmanager
def progress(description: str, total: int) -> Iterator[Callable[[str], None]]:
    """Show a progress bar on standard error until done; yields a function to call after each step with the step's
    name.
    """
    columns = (*Progress.get_default_columns(), MofNCompleteColumn())
    bar = Progress(*columns, console=Console(stderr=True), transient=True, disable=not sys.stderr.isatty())
    task = bar.add_task(description, total=total)
    with bar:
        yield lambda text: bar.update(task, advance=1, description=f"{description} {text}")


def parsed_size(text: str, minimum: int, maximum: int) -> tuple[int, int]:
    """Parse --size such as '1920x1080' into (width, height) with sides within the limits, pixels. Raises UserError."""
    match = re.fullmatch(r"([0-9]{1,6})x([0-9]{1,6})", text)
    size = (int(match[1]), int(match[2])) if match else (0, 0)
    if not all(minimum <= side <= maximum for side in size):
        raise UserError(f"--size {text}: not allowed. Give {minimum} to {maximum} pixels a side, such as 1920x1080.")
    return size


def chosen(
    option: str, names: Iterable[str] | None, allowed: Iterable[str], default: Iterable[str] | None = None
) -> list[str]:
    """Return the names given for an option in the order of `allowed`; if none are given, `default`, else all.

    Raises UserError for an unknown name.
    """
    for name in names or ():
        if name not in allowed:
            raise UserError(f"{option} {name}: unknown. Give one of {', '.join(allowed)}.")
    return [name for name in allowed if name in (names or default or allowed)]


def check_writable(*targets: Path | None) -> None:
    """Check before any work is done that these files can be written. Raises UserError otherwise."""
    for path in targets:
        if path not in (None, STANDARD_OUTPUT):
            files.check_writable(path)


def write_json(path: Path | None, data: object) -> None:
    """Write data as JSON to a file or to standard output; do nothing if `path` is None."""
    text = json.dumps(data, indent=1) + "\n"
    if path == STANDARD_OUTPUT:
        sys.stdout.write(text)
    elif path is not None:
        files.whole(path, lambda partial: partial.write_text(text, encoding="utf-8"))
