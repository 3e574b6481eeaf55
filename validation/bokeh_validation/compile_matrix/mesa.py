"""Compile with Mesa's compiler, through a live context."""

import os

import moderngl

from bokeh_validation.compilers.tool import CompileResult, accepted, refused
from bokeh_validation.drivers.gl import OSMesa
from bokeh_validation.process import once


@once
def driver() -> OSMesa:
    """Return an OSMesa driver. Raises Unavailable."""
    # Mesa skips compiling what is in its shader cache, so that is disabled
    os.environ.setdefault("MESA_SHADER_CACHE_DISABLE", "true")
    return OSMesa()


def version() -> str:
    """Return the driver and its device. Raises Unavailable."""
    return f"{driver().name}: {driver().adapter}"


def build(vertex: str, fragment: str) -> CompileResult:
    """Compile both stages and link them to a program. Raises Unavailable."""
    driver().make_current()
    try:
        driver().context.program(vertex_shader=vertex, fragment_shader=fragment)
    except moderngl.Error as error:
        return refused(str(error))
    return accepted("")
