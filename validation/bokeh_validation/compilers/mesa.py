"""The compiler inside an OpenGL driver (Mesa's, or a GPU vendor's), asked through a live context.

moderngl links a program or raises; it keeps no log of what went well and sorts out GLSL ES. So these few functions of
OpenGL are called directly.
"""

import ctypes
import os
import re
from collections.abc import Callable

from bokeh_validation.compilers.result import CompileResult, accepted, refused
from bokeh_validation.drivers.gl import EGL, GLDriver, OSMesa
from bokeh_validation.errors import Unavailable

INSTALL = OSMesa.install

# from GL/glcorearb.h
FRAGMENT_SHADER, VERTEX_SHADER = 0x8B30, 0x8B31
COMPILE_STATUS, LINK_STATUS, INFO_LOG_LENGTH = 0x8B81, 0x8B82, 0x8B84

UINT, POINTER = ctypes.c_uint, ctypes.c_void_p
PROTOTYPES: dict[str, tuple] = {
    "glCreateShader": (UINT, UINT),
    "glShaderSource": (None, UINT, ctypes.c_int, POINTER, POINTER),
    "glCompileShader": (None, UINT),
    "glGetShaderiv": (None, UINT, UINT, POINTER),
    "glGetShaderInfoLog": (None, UINT, ctypes.c_int, POINTER, POINTER),
    "glDeleteShader": (None, UINT),
    "glCreateProgram": (UINT,),
    "glAttachShader": (None, UINT, UINT),
    "glLinkProgram": (None, UINT),
    "glGetProgramiv": (None, UINT, UINT, POINTER),
    "glGetProgramInfoLog": (None, UINT, ctypes.c_int, POINTER, POINTER),
    "glDeleteProgram": (None, UINT),
}


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


def version(context: GLDriver | None = None) -> str:
    """The driver and its device; without a context, of a new one. Raises Unavailable."""
    context = context or driver()
    return f"{context.name}: {context.adapter}"


def build(vertex: str, fragment: str, context: GLDriver) -> CompileResult:
    """Compile both stages and link them to a program. Raises Unavailable where the context lacks the GLSL version."""
    _require(vertex, context)
    context.make_current()
    gl = _Functions(context)
    program = gl.call("glCreateProgram")
    logs, ok = [], True
    for name, stage, source in (("vertex", VERTEX_SHADER, vertex), ("fragment", FRAGMENT_SHADER, fragment)):
        shader, compiled, log = gl.compile(stage, source)
        gl.call("glAttachShader", program, shader)
        gl.call("glDeleteShader", shader)  # it goes with the program
        logs += [f"{name}: {line}" for line in log.splitlines() if line.strip()]
        ok = ok and compiled
    if ok:
        ok, log = gl.link(program)
        logs += [f"link: {line}" for line in log.splitlines() if line.strip()]
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


def _loader(context: GLDriver) -> Callable[[str], int]:
    """How to find OpenGL functions in the library that made this context."""
    if isinstance(context, OSMesa):
        return context.foreign.load
    library = ctypes.CDLL("libEGL.so.1")
    library.eglGetProcAddress.restype = POINTER
    return lambda name: library.eglGetProcAddress(name.encode()) or 0


class _Functions:
    """The OpenGL functions of PROTOTYPES, for the context that is current."""

    def __init__(self, context: GLDriver):
        load = _loader(context)
        self._functions = {}
        for name, (returns, *arguments) in PROTOTYPES.items():
            address = load(name)
            if not address:
                raise Unavailable(f"{context.adapter} has no {name}; {INSTALL}")
            self._functions[name] = ctypes.CFUNCTYPE(returns, *arguments)(address)

    def call(self, name: str, *arguments):
        """Call a function by its name."""
        return self._functions[name](*arguments)

    def compile(self, stage: int, source: str) -> tuple[int, bool, str]:
        """(shader, compiled, log)."""
        shader = self.call("glCreateShader", stage)
        text = ctypes.c_char_p(source.encode())
        self.call("glShaderSource", shader, 1, ctypes.byref(text), None)
        self.call("glCompileShader", shader)
        return shader, *self._outcome(shader, "Shader", COMPILE_STATUS)

    def link(self, program: int) -> tuple[bool, str]:
        """(linked, log)."""
        self.call("glLinkProgram", program)
        return self._outcome(program, "Program", LINK_STATUS)

    def _outcome(self, handle: int, kind: str, status: int) -> tuple[bool, str]:
        ok, length = ctypes.c_int(), ctypes.c_int()
        self.call(f"glGet{kind}iv", handle, status, ctypes.byref(ok))
        self.call(f"glGet{kind}iv", handle, INFO_LOG_LENGTH, ctypes.byref(length))
        log = ctypes.create_string_buffer(max(length.value, 1))
        self.call(f"glGet{kind}InfoLog", handle, len(log), None, log)
        return bool(ok.value), log.value.decode("utf-8", "replace")
