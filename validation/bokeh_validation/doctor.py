"""List the compilers and drivers of this machine and how to install what is missing."""

import platform
import shutil
import sys
from collections.abc import Callable
from typing import Annotated

import typer
from rich.table import Table

from bokeh_validation import drivers, needs, paths, setup
from bokeh_validation.compile_matrix.registry import COMPILERS
from bokeh_validation.compilers import dxc, fxc, slang
from bokeh_validation.terminal import console


def find(check: Callable[[], str]) -> tuple[str, str]:
    """Return 'found' with the version or adapter that `check` returns, or 'missing' with the reason, which says how to
    install it.
    """
    try:
        return "[green]found[/]", check()
    except Exception as error:  # a broken installation is a finding, not a crash
        return "[yellow]missing[/]", " ".join(str(error).split())


def state(name: str, absent: set[str]) -> str:
    """Return whether a need is met, as markup, or '' if that cannot be determined.

    name    a key of NEEDS
    absent  Debian packages that are not installed
    """
    need = needs.NEEDS[name]
    if need.extra:
        is_installed = (setup.environment() / f"complete-{need.extra}").exists()
    elif need.packages and shutil.which("dpkg-query"):
        is_installed = all(package not in absent or shutil.which(package) for package in need.packages)
    else:
        return ""
    return "[green]found[/]" if is_installed else "[yellow]missing[/]"


def print_needs() -> None:
    """Print the table of needs.py, marking each need as found or missing, then the needs of each command."""
    absent = set(setup.missing(needs.packages(list(needs.NEEDS))))
    table = Table("", "", "to fetch", "", box=None, pad_edge=False)
    states = {name: state(name, absent) for name in needs.NEEDS}
    for name, need in needs.NEEDS.items():
        table.add_row(f"need {name}", states[name], f"{need.megabytes} MB", need.what)
    console.print(table)
    for name in (name for name in states if "missing" in states[name]):
        console.print(f"missing {name}: {needs.install(name)}", markup=False, highlight=False, soft_wrap=True)
    table = Table("", "in all", "", box=None, pad_edge=False)
    for command, names in needs.COMMANDS.items():
        called = "validation/test" if command == "test" else f"validation/run {command}".strip()
        table.add_row(
            called, f"{needs.megabytes(command)} MB", "everything" if names == needs.EVERYTHING else ", ".join(names)
        )
    console.print(table)


def environment() -> dict[str, str]:
    """Return the system, the Python version and the folders, by their labels."""
    return {
        "system": f"{platform.platform()}, {platform.machine()}",
        "python": sys.version.split()[0],
        "checkout": str(paths.ROOT),
        "cache folder (the only place outside the checkout that is written to)": str(paths.cache_folder()),
    }


def doctor(
    install: Annotated[bool, typer.Option("--install", help="Fetch what can be fetched into the cache.")] = False,
) -> None:
    """List every compiler and driver with its version, what each command needs, and how to install what is missing."""
    if install:
        dxc.fetch()
        fxc.fetch()
        slang.fetch()
    table = Table("", "", "", box=None, show_header=False, pad_edge=False)
    for tool, version in {compiler.tool: compiler.version for compiler in COMPILERS}.items():
        table.add_row(f"compiler {tool}", *find(version))
    for name in drivers.NAMES:
        table.add_row(f"driver {name}", *find(lambda name=name: drivers.load(name).adapter))
    for name, value in environment().items():
        table.add_row(name, "", value)
    console.print(table)
    print_needs()
