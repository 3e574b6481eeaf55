"""What this machine has: compilers, drivers, adapters, and how to get what is missing."""

import platform
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Annotated

import typer
from rich.table import Table

from bokeh_validation import drivers, paths
from bokeh_validation.compilers import dxc, fxc
from bokeh_validation.compilers.registry import TOOLS
from bokeh_validation.errors import Unavailable
from bokeh_validation.terminal import console

WINDOWS = ("fxc", "d3d9", "d3d11")


@dataclass(frozen=True)
class Finding:
    """One compiler or driver. `detail` is its version or adapter, or how to install it."""

    kind: str
    name: str
    found: bool
    detail: str


def _find(kind: str, name: str, check: Callable[[], str]) -> Finding:
    try:
        detail = check()
    except Unavailable as error:
        return Finding(kind, name, False, str(error))
    except Exception as error:  # a broken installation is a finding, not a crash
        return Finding(kind, name, False, f"broken: {' '.join(str(error).split())[:200]}")
    untried = " (without Wine: never tried)" if sys.platform == "win32" and name in WINDOWS else ""
    return Finding(kind, name, True, detail + untried)


def _adapter(driver: str) -> str:
    return drivers.load(driver).adapter


def findings() -> list[Finding]:
    """Every compiler and driver of the harness."""
    return [
        *(_find("compiler", name, version) for name, version in TOOLS.items()),
        *(_find("driver", name, partial(_adapter, name)) for name in drivers.NAMES),
    ]


def adapters() -> list[tuple[str, str]]:
    """(driver, adapter name) for --adapter."""
    found = []
    try:
        from bokeh_validation.drivers import gl

        found += [("egl", name) for name in gl.egl_adapters()]
    except Exception:  # listing is a convenience: without EGL the driver's own line says what is wrong
        pass
    try:
        from bokeh_validation.drivers import webgpu

        found += [(name, a.info["device"]) for a in webgpu.wgpu_adapters() for name in ("wgpu", "dxc")]
    except Exception:
        pass
    return found


def environment() -> dict[str, str]:
    """Machine and folders."""
    return {
        "system": f"{platform.platform()}, {platform.machine()}",
        "python": sys.version.split()[0],
        "checkout": str(paths.ROOT),
        "cache folder (the only place outside the checkout that is written to)": str(paths.cache_folder()),
    }


def doctor(
    install: Annotated[
        bool, typer.Option("--install", help="Fetch what can be fetched into the cache folder.")
    ] = False,
) -> None:
    """Every compiler and driver: version or adapter, or the command that installs it."""
    if install:
        dxc.fetch()
        fxc.fetch()
    table = Table("", "", "", box=None, show_header=False, pad_edge=False)
    for finding in findings():
        state = "[green]found[/]" if finding.found else "[yellow]missing[/]"
        table.add_row(f"{finding.kind} {finding.name}", state, finding.detail)
    for driver, adapter in adapters():
        table.add_row(f"adapter for {driver}", "", adapter)
    for name, value in environment().items():
        table.add_row(name, "", value)
    console.print(table)
