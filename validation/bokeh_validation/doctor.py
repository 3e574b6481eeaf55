"""What this machine has: compilers, drivers, and how to get what is missing."""

import platform
import sys
from collections.abc import Callable
from typing import Annotated

import typer
from rich.table import Table

from bokeh_validation import drivers, paths
from bokeh_validation.compile_matrix.registry import COMPILERS
from bokeh_validation.compilers import dxc, fxc
from bokeh_validation.terminal import console


def find(check: Callable[[], str]) -> tuple[str, str]:
    """'found' with the version or adapter that `check` gives, or 'missing' with how to install it."""
    try:
        return "[green]found[/]", check()
    except Exception as error:  # a broken installation is a finding, not a crash
        return "[yellow]missing[/]", " ".join(str(error).split())


def environment() -> dict[str, str]:
    """Machine and folders."""
    return {
        "system": f"{platform.platform()}, {platform.machine()}",
        "python": sys.version.split()[0],
        "checkout": str(paths.ROOT),
        "cache folder (the only place outside the checkout that is written to)": str(paths.cache_folder()),
    }


def doctor(
    install: Annotated[bool, typer.Option("--install", help="Fetch what can be fetched into the cache.")] = False,
) -> None:
    """Every compiler and driver: version or adapter, or the command that installs it."""
    if install:
        dxc.fetch()
        fxc.fetch()
    table = Table("", "", "", box=None, show_header=False, pad_edge=False)
    for tool, version in {compiler.tool: compiler.version for compiler in COMPILERS}.items():
        table.add_row(f"compiler {tool}", *find(version))
    for name in drivers.NAMES:
        table.add_row(f"driver {name}", *find(lambda name=name: drivers.load(name).adapter))
    for name, value in environment().items():
        table.add_row(name, "", value)
    console.print(table)
