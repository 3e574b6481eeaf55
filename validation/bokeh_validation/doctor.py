"""What this machine has: compilers, drivers, and how to get what is missing."""

import platform
import sys
from collections.abc import Callable
from functools import partial
from typing import Annotated

import typer
from rich.table import Table

from bokeh_validation import drivers, paths
from bokeh_validation.compilers import dxc, fxc
from bokeh_validation.compilers.registry import COMPILERS
from bokeh_validation.errors import Unavailable
from bokeh_validation.terminal import console

FOUND, MISSING = "[green]found[/]", "[yellow]missing[/]"


def find(name: str, check: Callable[[], str]) -> tuple[str, str]:
    """FOUND with the version or adapter that `check` gives, or MISSING with how to install it."""
    try:
        detail = check()
    except Unavailable as error:
        return MISSING, str(error)
    except Exception as error:  # a broken installation is a finding, not a crash
        return MISSING, f"broken: {' '.join(str(error).split())[:200]}"
    return FOUND, detail


def _adapter(driver: str) -> str:
    return drivers.load(driver).adapter


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
        table.add_row(f"compiler {tool}", *find(tool, version))
    for name in drivers.NAMES:
        table.add_row(f"driver {name}", *find(name, partial(_adapter, name)))
    for name, value in environment().items():
        table.add_row(name, "", value)
    console.print(table)
