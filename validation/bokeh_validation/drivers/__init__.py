"""Real runtimes behind one interface, and the reference."""

from bokeh_validation.drivers.base import Driver
from bokeh_validation.errors import UserError

NAMES = ("osmesa", "egl", "wgpu", "dxc", "webgl2", "webgpu", "d3d9", "d3d11", "reference")


def load(name: str, adapter: str | None = None) -> Driver:
    """A driver by name. Raises UserError for an unknown name and Unavailable for one that this machine lacks."""
    if name in ("osmesa", "egl"):
        from bokeh_validation.drivers import gl

        return {"osmesa": gl.OSMesa, "egl": gl.EGL}[name](adapter)
    if name in ("wgpu", "dxc"):
        from bokeh_validation.drivers import webgpu

        return {"wgpu": webgpu.WGPU, "dxc": webgpu.DXC}[name](adapter)
    if name in ("d3d9", "d3d11"):
        from bokeh_validation.drivers import d3d

        return {"d3d9": d3d.D3D9, "d3d11": d3d.D3D11}[name](adapter)
    if name in ("webgl2", "webgpu"):
        from bokeh_validation.drivers import web

        return {"webgl2": web.WebGL2, "webgpu": web.WebGPU}[name](adapter)
    if name == "reference":
        from bokeh_validation.reference.device import Reference

        return Reference(adapter)
    raise UserError(f"no driver {name!r}: one of {', '.join(NAMES)}")
