"""Provide real runtimes and the reference behind one interface."""

import importlib
from collections.abc import Iterable

from bokeh_validation.drivers.base import Driver
from bokeh_validation.errors import Unavailable, UserError

# name -> module, imported on first use, and class
DRIVERS = {
    "osmesa": ("drivers.gl", "OSMesa"),
    "egl": ("drivers.gl", "EGL"),
    "wgpu": ("drivers.webgpu", "WGPU"),
    "dxc": ("drivers.webgpu", "DXC"),
    "webgl2": ("drivers.web", "WebGL2"),
    "webgpu": ("drivers.web", "WebGPU"),
    "d3d9": ("drivers.d3d9", "D3D9"),
    "reference": ("drivers.computed", "Reference"),
}
NAMES = tuple(DRIVERS)
# Tried in this order when no driver is named, fastest start first
AUTO = ("egl", "osmesa", "wgpu", "dxc")


def load(name: str, adapter: str | None = None) -> Driver:
    """Create a driver by name. Raises UserError for an unknown name, Unavailable if this machine lacks it."""
    if name not in DRIVERS:
        raise UserError(f"no driver {name!r}: one of {', '.join(NAMES)}")
    module, driver = DRIVERS[name]
    return getattr(importlib.import_module(f"bokeh_validation.{module}"), driver)(adapter)


def pick(name: str | None, adapter: str | None) -> Driver:
    """Load the named driver, or the first one of AUTO that this machine has. Raises UserError."""
    for candidate in AUTO if name is None else ():
        try:
            return load(candidate, adapter)
        except Unavailable:
            continue
    (loaded,), _ = pick_all([AUTO[0] if name is None else name], adapter)
    return loaded


def pick_all(names: Iterable[str], adapter: str | None) -> tuple[list[Driver], dict[str, str]]:
    """Load the named drivers; returns them, and name -> reason for those that are missing.

    Raises UserError if none is available.
    """
    loaded, missing = [], {}
    for name in names:
        check_name(name)
        try:
            loaded.append(load(name, adapter))
        except Unavailable as error:
            missing[name] = str(error)
    if not loaded:
        reasons = "; ".join(f"{name}: {reason}" for name, reason in missing.items())
        raise UserError(f"none of the drivers is on this machine ({reasons}). See validation/run doctor.")
    return loaded, missing


def check_name(name: str) -> None:
    """Check that a driver of this name exists. Raises UserError otherwise."""
    if name not in NAMES:
        raise UserError(f"--driver {name}: no such driver. Give one of {', '.join(NAMES)}.")
