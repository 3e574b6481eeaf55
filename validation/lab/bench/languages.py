"""Draw the frames of a pack in each language: WGSL with script.py itself, HLSL through DXC, GLSL on OpenGL."""

import time
import zlib
from collections.abc import Callable
from pathlib import Path

from bokeh_validation import shaders
from bokeh_validation.drivers import gl
from bokeh_validation.shaders.passes import SLOTS
from lab.bench import script

# Format -> channels and number type in moderngl
CHANNELS = {"RGBA16F": (4, "f2"), "R32F": (1, "f4")}
Frames = dict[str, "script.Frame | OpenGLFrame"]


def constants(plan: dict, item: dict) -> dict[str, float]:
    """Return the constants that the program of a pass is compiled with."""
    return (plan["preset"] or {}).get("stands_for", {}) | item["constants"]


class OpenGL:
    """Hold an OpenGL context with the images of a folder."""

    def __init__(self, adapter: str | None, folder: Path):
        self.driver, self.folder = gl.EGL(adapter), folder
        self.context, self.device = self.driver.context, self.driver.adapter

    def texture(self, size: list[int], kind: str, file: Path | None = None):
        """Create a texture of zeros, or with the content of a file; see script.GPU.texture()."""
        channels, number = CHANNELS[kind]
        data = zlib.decompress(file.read_bytes()) if file else bytes(size[0] * size[1] * script.FORMATS[kind][1])
        made = self.context.texture(tuple(size), channels, data, alignment=1, dtype=number)
        made.repeat_x = made.repeat_y = False
        return made


class OpenGLFrame:
    """Draw a plan of frames.json in GLSL; has the members of script.Frame that script.measured() uses."""

    def __init__(self, device: OpenGL, plan: dict, pool: dict):
        self.device, self.plan = device, plan
        device.driver.make_current()
        self.textures = script.textures(device, plan, pool)
        self.steps = [self._step(item, plan["parameters"] | item["changes"]) for item in plan["passes"]]

    def _step(self, item: dict, values: dict[str, float]) -> tuple:
        """Return (program, its values, (texture, unit, sampler) of each input, targets)."""
        array = self.device.driver.program(shaders.glsl(item["entry"], "330", constants(self.plan, item)))
        targets = self.device.context.framebuffer([self.textures[name] for name in item["targets"]])
        samplers = self.device.driver.samplers
        bound = [
            (self.textures[read["texture"]], SLOTS.index(read["slot"]), samplers[read["filter"] == "linear"])
            for read in item["inputs"]
        ]
        return array, {name: value for name, value in values.items() if name in array.program}, bound, targets

    def drawn(self, repeats: int = 1) -> tuple[float, list[list[float]]]:
        """Draw and time like script.Frame.drawn(); OpenGL times each pass alone, so gaps between passes are not
        included.
        """
        self.device.driver.make_current()
        context = self.device.context
        queries = [[context.query(time=True) for _ in self.steps] for _ in range(repeats)]
        context.finish()
        begin = time.perf_counter()
        for frame in queries:
            for query, (array, values, bound, targets) in zip(frame, self.steps, strict=True):
                for texture, unit, sampler in bound:
                    texture.use(unit)
                    sampler.use(unit)
                for name, value in values.items():
                    array.program[name] = value
                targets.use()
                with query:
                    array.render(vertices=self.plan["vertex"]["vertices"])
        context.finish()
        wall, ends = (time.perf_counter() - begin) * 1e3, [0.0]
        for query in (query for frame in queries for query in frame):
            ends += [ends[-1], ends[-1] + query.elapsed * 1e-6]
        count, stamps = 2 * len(self.steps), ends[1:]
        return wall, [stamps[first : first + count] for first in range(0, len(stamps), count)]


def glsl(adapter: str | None, folder: Path, plans: dict[str, dict]) -> tuple[str, Frames]:
    """Return (device, frames) on OpenGL through EGL. Raises Unavailable."""
    device, pool = OpenGL(adapter, folder), {}
    return device.device, {key: OpenGLFrame(device, plan, pool) for key, plan in plans.items()}


def wgsl(adapter: str | None, folder: Path, plans: dict[str, dict]) -> tuple[str, Frames]:
    """Return (device, frames) on Vulkan, Metal or Direct3D 12 through wgpu."""
    gpu, pool = script.GPU(adapter or "", folder), {}
    module = gpu.device.create_shader_module(code=shaders.wgsl())
    return gpu.name, {key: script.Frame(gpu, plan, module, pool) for key, plan in plans.items()}


def hlsl(adapter: str | None, folder: Path, plans: dict[str, dict]) -> tuple[str, Frames]:
    """Return (device, frames) of DXC's SPIR-V on the same devices as wgsl(). Raises Unavailable."""
    from bokeh_validation.compilers import dxc

    dxc.load()
    gpu, pool = script.GPU(adapter or "", folder), {}

    def stage(text: str, kind: str, entry: str) -> dict:
        built = dxc.build(text, kind, entry)
        if not built.ok:
            raise RuntimeError(f"DXC refused {entry}:\n{built.messages}")
        return {"module": gpu.device.create_shader_module(code=built.binary), "entry_point": entry}

    vertex = stage(shaders.hlsl(6, {}), "vert", "BokehFullScreen_VS")

    def stages(gpu: script.GPU, plan: dict, item: dict, _: object) -> tuple[dict, dict]:
        return vertex, stage(shaders.hlsl(6, constants(plan, item)), "frag", f"{item['entry']}_PS")

    return gpu.name, {key: script.Frame(gpu, plan, None, pool, stages) for key, plan in plans.items()}


# Name of a driver -> function that makes its frames
DRIVERS: dict[str, Callable] = {"egl": glsl, "wgpu": wgsl, "dxc": hlsl}
