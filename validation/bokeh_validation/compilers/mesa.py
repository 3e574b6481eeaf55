"""The compiler inside an OpenGL driver (Mesa's, or a GPU vendor's), asked through a live context.

moderngl links a program or raises; it keeps no log of what went well and sorts out GLSL ES. So these few functions of
OpenGL are called directly.
"""

import ctypes
import os
import re
from functools import cache

from bokeh_validation.compilers.tool import CompileResult, accepted, once, refused
from bokeh_validation.drivers.gl import EGL, GLDriver, OSMesa
from bokeh_validation.errors import Unavailable

# from GL/glcorearb.h
STAGES = {"vertex": 0x8B31, "fragment": 0x8B30}
COMPILE_STATUS, LINK_STATUS, INFO_LOG_LENGTH = 0x8B81, 0x8B82, 0x8B84


@once
def driver() -> GLDriver:
    """OSMesa, or EGL where there is no OSMesa. Raises Unavailable."""
    # Mesa skips what it finds in its cache of compiled shaders, and with it the warnings
    os.environ.setdefault("MESA_SHADER_CACHE_DISABLE", "true")
    try:
        return OSMesa()
    except Unavailable as first:
        try:
            return EGL()
        except Unavailable:
            raise first from None


def version() -> str:
    """The driver and its device. Raises Unavailable."""
    return f"{driver().name}: {driver().adapter}"


def build(vertex: str, fragment: str) -> CompileResult:
    """Compile both stages and link them to a program. Raises Unavailable where the driver lacks the GLSL version."""
    context = driver()
    _require(vertex, context)
    context.make_current()
    gl = _functions()
    program = gl.call("glCreateProgram")
    logs, ok = [], True
    for stage, source in (("vertex", vertex), ("fragment", fragment)):
        shader, compiled, log = gl.compiled(stage, source)
        gl.call("glAttachShader", program, shader)
        logs += [f"{stage}: {line}" for line in log]
        ok = ok and compiled
    if ok:
        gl.call("glLinkProgram", program)
        ok, log = gl.outcome(program, "Program", LINK_STATUS)
        logs += [f"link: {line}" for line in log]
    gl.call("glDeleteProgram", program)
    return accepted("\n".join(logs)) if ok else refused("\n".join(logs))


def _require(source: str, context: GLDriver) -> None:
    """The GLSL versions that an OpenGL context takes: up to its own, ES 3.00 from OpenGL 4.3 or by an extension."""
    line = re.match(r"\s*#version (\d+)( es)?", source)
    if line is None:
        return
    has = context.context.version_code
    if line[2] and int(line[1]) == 300 and has < 430 and "GL_ARB_ES3_compatibility" not in context.context.extensions:
        raise Unavailable(f"{context.adapter} has no GLSL ES 3.00: that needs OpenGL 4.3; update Mesa")
    if not line[2] and int(line[1]) > has:
        raise Unavailable(f"{context.adapter} has no GLSL {line[1]}; update Mesa")


class _Functions:
    """OpenGL functions by name, for the driver's context."""

    def __init__(self, context: GLDriver):
        self._last: dict[str, tuple[str, tuple]] = {}
        if isinstance(context, OSMesa):
            self._address = context.foreign.load
        else:
            library = ctypes.CDLL("libEGL.so.1")
            library.eglGetProcAddress.restype = ctypes.c_void_p
            self._address = lambda name: library.eglGetProcAddress(name.encode())

    def call(self, name: str, *arguments):
        """Call a function: whole numbers are int, and so is what it returns."""
        return ctypes.CFUNCTYPE(ctypes.c_int)(self._address(name))(*arguments)

    def compiled(self, stage: str, source: str) -> tuple[int, bool, list[str]]:
        """(shader, whether it compiled, log). The last of a stage is kept: the vertex shader is mostly the same."""
        known, result = self._last.get(stage, (None, (0,)))
        if known != source:
            self.call("glDeleteShader", result[0])
            shader = self.call("glCreateShader", STAGES[stage])
            text = ctypes.c_char_p(source.encode())
            self.call("glShaderSource", shader, 1, ctypes.byref(text), None)
            self.call("glCompileShader", shader)
            result = (shader, *self.outcome(shader, "Shader", COMPILE_STATUS))
            self._last[stage] = (source, result)
        return result

    def outcome(self, handle: int, kind: str, status: int) -> tuple[bool, list[str]]:
        """Whether a step went well, and what was said of it."""
        ok, length = ctypes.c_int(), ctypes.c_int()
        self.call(f"glGet{kind}iv", handle, status, ctypes.byref(ok))
        self.call(f"glGet{kind}iv", handle, INFO_LOG_LENGTH, ctypes.byref(length))
        log = ctypes.create_string_buffer(max(length.value, 1))
        self.call(f"glGet{kind}InfoLog", handle, len(log), None, log)
        return bool(ok.value), [line for line in log.value.decode("utf-8", "replace").splitlines() if line.strip()]


@cache
def _functions() -> _Functions:
    return _Functions(driver())
