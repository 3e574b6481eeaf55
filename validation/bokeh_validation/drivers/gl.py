"""Run GLSL 330 on OpenGL through moderngl: `egl` (Mesa or a GPU, no display needed) and `osmesa` (Mesa, off-screen)."""

import ctypes
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from functools import lru_cache
from itertools import count
from typing import NamedTuple

import moderngl
import numpy as np

from bokeh_validation import needs, shaders
from bokeh_validation.drivers.base import PROGRAMS, DeviceDriver, Draw, Image
from bokeh_validation.errors import Unavailable
from bokeh_validation.numerics.images import STORAGE
from bokeh_validation.process import uninterrupted
from bokeh_validation.shaders.passes import SLOTS, Pass, is_linear


class GLDriver(DeviceDriver):
    """Implement what both drivers share: programs, textures, the pass loop. A subclass creates the context."""

    def __init__(self, context: moderngl.Context):
        self.context = context
        self.adapter = f"{context.info['GL_RENDERER']}, OpenGL {context.info['GL_VERSION']}"
        self.program = lru_cache(PROGRAMS)(self._linked)
        # unreferenced objects are freed by gc(), while their context is current
        context.gc_mode = "context_gc"
        # keyed by whether the filter is linear; clamped, without mip levels
        clamp = {"repeat_x": False, "repeat_y": False}
        kinds = {True: (moderngl.LINEAR,) * 2, False: (moderngl.NEAREST,) * 2}
        self.samplers = {key: context.sampler(**clamp, filter=kind) for key, kind in kinds.items()}

    def make_current(self) -> None:
        """Make this driver's context current, since both drivers may live in one process."""
        self.context.__enter__()
        self.context.gc()

    def _linked(self, text: str) -> moderngl.VertexArray:
        """Link a fragment shader into a program, returned as a vertex array without buffers."""
        vertex = shaders.glsl("BokehFullScreen", "330")
        # moderngl makes the objects of the uniforms by calls of Python, and crashes if one of them is interrupted
        with uninterrupted():
            program = self.context.program(vertex_shader=vertex, fragment_shader=text)
        for unit, slot in enumerate(SLOTS):
            if f"Bokeh{slot}" in program:
                program[f"Bokeh{slot}"] = unit
        return self.context.vertex_array(program, [])

    def texture(self, image: Image) -> moderngl.Texture:
        dtype = np.dtype(STORAGE[image.storage])
        # targets are initialised to zeros, since OpenGL leaves new textures undefined
        data = bytes(dtype.itemsize * image.channels * image.size[0] * image.size[1])
        if image.pixels is not None:
            data = image.pixels.tobytes()
        texture = self.context.texture(image.size, image.channels, data, alignment=1, dtype=f"f{dtype.itemsize}")
        texture.repeat_x = texture.repeat_y = False
        return texture

    def step(self, draw: Draw, handles: Sequence) -> "Step":
        render_pass = draw.item
        text = (
            render_pass.sources["glsl"]
            if render_pass.sources
            else shaders.glsl(render_pass.entry, "330", render_pass.constants)
        )
        framebuffer = self.context.framebuffer([handles[number] for number in draw.targets])
        # the full-screen triangle is clipped to the viewport; its y counts from the first row in memory, like v
        framebuffer.viewport = draw.area
        bound = {slot: handles[number] for slot, number in draw.inputs.items()}
        return Step(render_pass, self.program(text), bound, framebuffer)

    def draw(self, steps: Sequence["Step"]) -> None:
        for render_pass, array, bound, target in steps:
            for unit, slot in enumerate(SLOTS):
                if slot in bound:
                    bound[slot].use(unit)
                    self.samplers[is_linear(render_pass.entry, slot)].use(unit)
            for name, value in render_pass.values().items():
                # set every time: it is cheap, and the program may have other values from an earlier pass
                if name in array.program:
                    array.program[name] = value
            target.use()
            array.render(moderngl.TRIANGLES, vertices=3)

    def pixels(self, handle: moderngl.Texture, image: Image) -> np.ndarray:
        return np.frombuffer(handle.read(alignment=1), STORAGE[image.storage])


class Step(NamedTuple):
    """Hold one pass with its program, its textures by slot and its targets."""

    item: Pass
    array: moderngl.VertexArray
    bound: Mapping[str, moderngl.Texture]
    target: moderngl.Framebuffer


class EGL(GLDriver):
    """Run GLSL 330 through EGL, on the first device or on the one chosen by a part of its name."""

    name = "egl"
    install = needs.install("opengl")

    def __init__(self, adapter: str | None = None):
        renderers = []
        for context in _egl_contexts():
            renderers.append(context.info["GL_RENDERER"])
            if adapter is None or adapter.lower() in renderers[-1].lower():
                super().__init__(context)
                return
            context.release()
        reason = (
            f" on a device named like {adapter!r}; there are: {', '.join(renderers)}"
            if renderers
            else f"; {self.install}"
        )
        raise Unavailable(f"EGL gave no OpenGL 3.3 context{reason}")


def _egl_contexts() -> Iterator[moderngl.Context]:
    """Yield a context on each EGL device in turn."""
    with suppress(Exception):
        for index in count():
            yield moderngl.create_context(standalone=True, require=330, backend="egl", device_index=index)


def _unbind_egl() -> None:
    """Tell EGL that its context is no longer current.

    OSMesa takes over the thread's OpenGL without telling EGL. EGL would then skip making the same context current
    again, and its commands would reach OSMesa's objects with the same numbers.
    """
    try:
        egl = ctypes.CDLL("libEGL.so.1")
    except OSError:
        return
    egl.eglGetCurrentDisplay.restype = ctypes.c_void_p
    display = egl.eglGetCurrentDisplay()
    if display:
        egl.eglMakeCurrent(ctypes.c_void_p(display), None, None, None)


class OSMesaContext:
    """Create an off-screen Mesa context in the form in which moderngl accepts a foreign context."""

    # from GL/osmesa.h
    FORMAT, DEPTH_BITS, PROFILE, CORE_PROFILE, MAJOR, MINOR = 0x22, 0x30, 0x33, 0x34, 0x36, 0x37
    RGBA, UNSIGNED_BYTE = 0x1908, 0x1401

    def __init__(self) -> None:
        try:
            self.library = ctypes.CDLL("libOSMesa.so.8")
        except OSError as error:
            raise Unavailable(f"libOSMesa is not on this machine; {OSMesa.install}") from error
        self.library.OSMesaCreateContextAttribs.restype = ctypes.c_void_p
        self.library.OSMesaGetProcAddress.restype = ctypes.c_void_p
        attributes = [
            self.FORMAT, self.RGBA, self.DEPTH_BITS, 0, self.PROFILE, self.CORE_PROFILE,
            self.MAJOR, 3, self.MINOR, 3, 0,
        ]  # fmt: skip
        array = (ctypes.c_int * len(attributes))(*attributes)
        self.handle = ctypes.c_void_p(self.library.OSMesaCreateContextAttribs(array, None))
        if not self.handle:
            raise Unavailable("OSMesa has no OpenGL 3.3 core context: update Mesa")
        self.buffer = (ctypes.c_ubyte * 4)()
        self.__enter__()

    def load(self, name: str) -> int:
        """Return the address of a GL function, or 0 if there is none."""
        return self.library.OSMesaGetProcAddress(name.encode()) or 0

    def __enter__(self) -> None:
        _unbind_egl()
        self.library.OSMesaMakeCurrent(self.handle, self.buffer, self.UNSIGNED_BYTE, 1, 1)

    def __exit__(self, *_) -> None:
        pass

    def release(self) -> None:
        """Destroy the context."""
        self.library.OSMesaDestroyContext(self.handle)


class OSMesa(GLDriver):
    """Run GLSL 330 on Mesa's off-screen software renderer."""

    name = "osmesa"
    install = needs.install("opengl")

    def __init__(self, adapter: str | None = None):
        self.foreign = OSMesaContext()
        super().__init__(moderngl.create_context(require=330, context=self.foreign))
        self.require_adapter(adapter)

    def make_current(self) -> None:
        self.foreign.__enter__()
        self.context.gc()
