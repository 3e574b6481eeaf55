"""Compile with Mesa's compiler, through a live context."""

import os

import moderngl

from bokeh_validation.compilers.tool import CompileResult, accepted, refused
from bokeh_validation.drivers.gl import OSMesa
from bokeh_validation.process import once

NO_CACHE = "MESA_SHADER_CACHE_DISABLE"


@once
def driver() -> OSMesa:
    """Return an OSMesa driver. Raises Unavailable."""
    # Mesa skips compiling what is in its shader cache, so that is disabled, but only for this driver: the drivers that
    # this process creates later, and the programs that it starts, draw ten times sooner with the cache
    if NO_CACHE in os.environ:
        return OSMesa()
    os.environ[NO_CACHE] = "true"
    try:
        return OSMesa()
    finally:
        del os.environ[NO_CACHE]


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
