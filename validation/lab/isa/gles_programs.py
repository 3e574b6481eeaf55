"""A program by itself: GLSL ES programs linked and drawn with by an OpenGL ES driver on a GPU that is not there.

It runs in an emulated Python, so it needs nothing but the driver. Standard input: {"vertex": [FILE, ENTRY],
"fragments": [[NAME, FILE, ENTRY, TARGETS], ...]}, files of GLSL ES 3.00. The driver writes what it counts to standard
error; after each program this adds a line `## NAME`.
"""

import ctypes
import json
import os
import sys
from ctypes import byref, c_char_p, c_int, c_uint, c_void_p

# from EGL/egl.h, EGL/eglext.h, GLES3/gl3.h
PLATFORM_GBM, OPENGL_ES_API, NONE = 0x31D7, 0x30A0, 0x3038
CONTEXT_VERSION = (0x3098, 3, 0x30FB, 0, NONE)
VERTEX, FRAGMENT, COMPILED = 0x8B31, 0x8B30, 0x8B81
TEXTURE_2D, RGBA16F, FRAMEBUFFER, COLOR_ATTACHMENT, TRIANGLES = 0x0DE1, 0x881A, 0x8D40, 0x8CE0, 4
SIZE, MOST = 64, 4


def context():
    """A current context of OpenGL ES 3 without a surface; returns the library."""
    gbm, egl, gl = (ctypes.CDLL(name) for name in ("libgbm.so.1", "libEGL.so.1", "libGLESv2.so.2"))
    for function in (gbm.gbm_create_device, egl.eglGetPlatformDisplay, egl.eglCreateContext):
        function.restype = c_void_p
    device = gbm.gbm_create_device(os.open("/dev/dri/renderD128", os.O_RDWR))
    display = c_void_p(egl.eglGetPlatformDisplay(PLATFORM_GBM, c_void_p(device), None))
    if not egl.eglInitialize(display, None, None):
        sys.exit("no device")
    egl.eglBindAPI(OPENGL_ES_API)
    made = egl.eglCreateContext(display, None, None, (c_int * len(CONTEXT_VERSION))(*CONTEXT_VERSION))
    egl.eglMakeCurrent(display, None, None, c_void_p(made))
    return gl


def shader(gl, kind, file):
    """A compiled shader of a file."""
    with open(file, encoding="ascii") as stream:
        text = c_char_p(stream.read().encode())
    made, ok, log = gl.glCreateShader(kind), c_int(), ctypes.create_string_buffer(1000)
    gl.glShaderSource(made, 1, byref(text), None)
    gl.glCompileShader(made)
    gl.glGetShaderiv(made, COMPILED, byref(ok))
    if not ok.value:
        gl.glGetShaderInfoLog(made, len(log), None, log)
        sys.exit(log.value.decode())
    return made


def main():
    """See above. A driver compiles when something is drawn, and not before."""
    asked, gl = json.load(sys.stdin), context()
    textures, target = (c_uint * MOST)(), c_uint()
    gl.glGenTextures(MOST, textures)
    gl.glGenFramebuffers(1, byref(target))
    gl.glBindFramebuffer(FRAMEBUFFER, target)
    for index, texture in enumerate(textures):
        gl.glBindTexture(TEXTURE_2D, texture)
        gl.glTexStorage2D(TEXTURE_2D, 1, RGBA16F, SIZE, SIZE)
        gl.glFramebufferTexture2D(FRAMEBUFFER, COLOR_ATTACHMENT + index, TEXTURE_2D, texture, 0)
    vertex = shader(gl, VERTEX, asked["vertex"][0])
    for name, file, _, targets in asked["fragments"]:
        program = gl.glCreateProgram()
        gl.glAttachShader(program, vertex)
        gl.glAttachShader(program, shader(gl, FRAGMENT, file))
        gl.glLinkProgram(program)
        gl.glUseProgram(program)
        gl.glDrawBuffers(targets, (c_uint * targets)(*range(COLOR_ATTACHMENT, COLOR_ATTACHMENT + targets)))
        gl.glDrawArrays(TRIANGLES, 0, 3)
        gl.glFinish()
        print(f"## {name}", file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
