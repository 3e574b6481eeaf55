"""Provide real runtimes and the reference behind one interface."""

import importlib

from bokeh_validation.drivers.base import Driver
from bokeh_validation.errors import UserError

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


def load(name: str, adapter: str | None = None) -> Driver:
    """Create a driver by name. Raises UserError for an unknown name, Unavailable if this machine lacks it."""
    if name not in DRIVERS:
        raise UserError(f"no driver {name!r}: one of {', '.join(NAMES)}")
    module, driver = DRIVERS[name]
    return getattr(importlib.import_module(f"bokeh_validation.{module}"), driver)(adapter)
