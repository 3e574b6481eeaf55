"""The compiler inside an OpenGL driver (Mesa's, or a GPU vendor's), asked through a live context."""

import os

import moderngl

from bokeh_validation.compilers.tool import CompileResult, accepted, once, refused
from bokeh_validation.drivers.gl import EGL, GLDriver, OSMesa
from bokeh_validation.errors import Unavailable


@once
def driver() -> GLDriver:
    """OSMesa, or EGL where there is no OSMesa. Raises Unavailable."""
    # Mesa does not compile what it finds in its cache of compiled shaders
    os.environ.setdefault("MESA_SHADER_CACHE_DISABLE", "true")
    try:
        return OSMesa()
    except Unavailable as no_osmesa:
        try:
            return EGL()
        except Unavailable:
            raise no_osmesa from None


def version() -> str:
    """The driver and its device. Raises Unavailable."""
    return f"{driver().name}: {driver().adapter}"


def build(vertex: str, fragment: str) -> CompileResult:
    """Compile both stages and link them to a program. Raises Unavailable."""
    driver().make_current()
    try:
        driver().context.program(vertex_shader=vertex, fragment_shader=fragment).release()
    except moderngl.Error as error:
        return refused(str(error))
    return accepted("")
