"""WGSL on WebGPU (`wgpu`), and HLSL compiled by DXC to SPIR-V on the same runtime (`dxc`): lavapipe or a GPU."""

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bokeh_validation import shaders
from bokeh_validation.drivers.base import (
    Job,
    Stopwatch,
    Textures,
    TimedDriver,
    Timing,
    drawn_over,
    require_targets,
    software_device,
    storage_type,
)
from bokeh_validation.errors import Unavailable
from bokeh_validation.passes import BINDINGS, FIRST_SAMPLER, PARAMETERS, SAMPLE_TYPES, SLOTS, Pass, target_area

FORMATS = {
    (np.dtype(np.float16), 4): "rgba16float",
    (np.dtype(np.float32), 4): "rgba32float",
    (np.dtype(np.float16), 2): "rg16float",
    (np.dtype(np.float32), 2): "rg32float",
    (np.dtype(np.float32), 1): "r32float",
}
# Bytes a pixel that all targets of a pass may have together; the name of WebGPU's limit. Its default, 32, is four
# half-float targets, but two of 32 bits.
ATTACHMENT_BYTES = "max-color-attachment-bytes-per-sample"


def _import():
    """wgpu wants a runtime folder for Mesa, or Mesa complains on standard error."""
    os.environ.setdefault("XDG_RUNTIME_DIR", "/tmp")
    import wgpu

    return wgpu


def wgpu_adapters() -> list:
    """Vulkan, Metal and Direct3D 12 adapters (its OpenGL backend lacks what the passes need)."""
    wgpu = _import()
    return [a for a in wgpu.gpu.enumerate_adapters_sync() if a.info["backend_type"] in ("Vulkan", "Metal", "D3D12")]


def _choose(adapter: str | None):
    found = wgpu_adapters()
    if not found:
        raise Unavailable(f"no Vulkan adapter; {WGPU.install}")
    if adapter is None:
        return min(found, key=lambda a: a.info["adapter_type"] == "CPU")
    if adapter.isdigit() and int(adapter) < len(found):
        return found[int(adapter)]
    for candidate in found:
        if adapter.lower() in candidate.info["device"].lower():
            return candidate
    names = ", ".join(a.info["device"] for a in found)
    raise Unavailable(f"no adapter named like {adapter!r}; there are: {names}")


@dataclass(frozen=True)
class Step:
    """One pass, ready to be recorded.

    views     of its targets
    kept      for each target whether it is drawn over with its contents kept
    viewport  see passes.target_area; None: all of the targets
    """

    pipeline: object
    bindings: object
    views: tuple
    kept: tuple[bool, ...]
    viewport: tuple[int, int, int, int] | None


class WGPU(TimedDriver):
    """WGSL: the two files as they are, one module."""

    name = "wgpu"
    install = "apt-get install -y mesa-vulkan-drivers libvulkan1"

    def __init__(self, adapter: str | None = None):
        self.wgpu = _import()
        chosen = _choose(adapter)
        self.adapter = f"{chosen.info['device']}, {chosen.info['backend_type']}, {chosen.info['description']}"
        self.software = software_device(self.adapter) == "Mesa"
        wanted = {"float32-filterable", "timestamp-query"} & set(chosen.features)
        self.attachment_bytes = chosen.limits[ATTACHMENT_BYTES]
        self.device = chosen.request_device_sync(
            required_features=sorted(wanted), required_limits={ATTACHMENT_BYTES: self.attachment_bytes}
        )
        self.float_filterable = "float32-filterable" in wanted
        self._pipelines: dict[tuple, object] = {}
        self._modules: dict[str, object] = {}
        self.timer = "timestamp-query" in wanted
        self.layout = self._make_layout()
        self._sampler = self.device.create_sampler(min_filter="linear", mag_filter="linear")
        self._dummy = self.upload(np.zeros((1, 1, 4), np.float16))
        self._fence = self.device.create_buffer(size=4, usage=self.wgpu.BufferUsage.COPY_SRC)

    def _make_layout(self):
        """One layout for every pass: parameters, all texture slots, the sampler. Depth need not be filterable."""
        stage = self.wgpu.ShaderStage.FRAGMENT
        entries = [{"binding": 0, "visibility": stage, "buffer": {"type": "uniform"}}]
        for slot, kind in SAMPLE_TYPES.items():
            entries.append({"binding": BINDINGS[slot], "visibility": stage, "texture": {"sample_type": kind}})
        entries.append({"binding": FIRST_SAMPLER, "visibility": stage, "sampler": {"type": "filtering"}})
        return self.device.create_bind_group_layout(entries=entries)

    def modules(self, item: Pass) -> tuple:
        """(vertex module, its entry, fragment module, its entry, pipeline constants)."""
        code = shaders.wgsl() if item.sources is None else item.sources["wgsl"]
        if code not in self._modules:
            self._modules[code] = self.device.create_shader_module(code=code)
        constants = {name: float(value) for name, value in item.constants.items()}
        return self._modules[code], "BokehFullScreen_VS", self._modules[code], item.entry + "_PS", constants

    def make_pipeline(self, vertex: dict, fragment: dict, formats: Sequence[str]):
        """A render pipeline of two stages, each {'module', 'entry_point', 'constants'}, with a target of each format.

        Raises the device's GPUError or GPUPipelineError.
        """
        return self.device.create_render_pipeline(
            layout=self.device.create_pipeline_layout(bind_group_layouts=[self.layout]),
            vertex=vertex,
            fragment={**fragment, "targets": [{"format": kind} for kind in formats]},
            primitive={"topology": "triangle-list"},
        )

    def pipeline(self, item: Pass, formats: Sequence[str]):
        """Render pipeline of a pass into targets of these formats, cached."""
        key = (item.entry, str(item.constants), str(item.sources), *formats)
        if key not in self._pipelines:
            vertex, vertex_entry, fragment, fragment_entry, constants = self.modules(item)
            self._pipelines[key] = self.make_pipeline(
                {"module": vertex, "entry_point": vertex_entry},
                {"module": fragment, "entry_point": fragment_entry, "constants": constants},
                formats,
            )
        return self._pipelines[key]

    def upload(self, pixels: np.ndarray):
        """Pixels as a texture; row 0 is v = 0."""
        pixels = np.ascontiguousarray(pixels)
        height, width = pixels.shape[:2]
        channels = 1 if pixels.ndim == 2 else pixels.shape[2]
        usage = self.wgpu.TextureUsage.TEXTURE_BINDING | self.wgpu.TextureUsage.COPY_DST
        texture = self.device.create_texture(
            size=(width, height, 1), format=FORMATS[pixels.dtype, channels], usage=usage
        )
        layout = {"bytes_per_row": pixels.nbytes // height, "rows_per_image": height}
        self.device.queue.write_texture({"texture": texture}, pixels.tobytes(), layout, (width, height, 1))
        return texture

    def target(self, size: tuple[int, int], storage: str, channels: int = 4):
        """A render target that can be sampled and read back: RGBA, or RG with two channels."""
        usage = self.wgpu.TextureUsage
        return self.device.create_texture(
            size=(*size, 1),
            format=FORMATS[np.dtype(storage_type(storage)), channels],
            usage=usage.RENDER_ATTACHMENT | usage.TEXTURE_BINDING | usage.COPY_SRC,
        )

    def bind(self, item: Pass, live: dict):
        """Bind group of a pass; slots it does not read get a dummy."""
        values = np.zeros(-(-len(PARAMETERS) // 4) * 4, np.float32)  # a uniform block has a multiple of 16 bytes
        values[: len(PARAMETERS)] = list(item.values().values())
        buffer = self.device.create_buffer_with_data(data=values.tobytes(), usage=self.wgpu.BufferUsage.UNIFORM)
        entries = [{"binding": 0, "resource": {"buffer": buffer, "offset": 0, "size": values.nbytes}}]
        for slot in SLOTS:
            texture = live[item.inputs[slot]] if slot in item.inputs else self._dummy
            entries.append({"binding": BINDINGS[slot], "resource": texture.create_view()})
        entries.append({"binding": FIRST_SAMPLER, "resource": self._sampler})
        return self.device.create_bind_group(layout=self.layout, entries=entries)

    def step(self, item: Pass, live: dict, targets: Sequence, kept: frozenset[str]) -> Step:
        """A pass with all that it needs; `kept` names the outputs that keep what is in them."""
        pipeline = self.pipeline(item, [target.format for target in targets])
        views = tuple(target.create_view() for target in targets)
        area = target_area(item.scale, item.viewport) if item.viewport else None
        return Step(pipeline, self.bind(item, live), views, tuple(name in kept for name in item.outputs), area)

    def wait(self) -> None:
        """Return when all that was submitted is done: a read of four bytes, which the queue puts behind it.

        on_submitted_work_done of wgpu 0.32.0 raises TypeError.
        """
        self.device.queue.read_buffer(self._fence)

    def prepared(self, passes, textures, size, storage="half", share=None) -> "WGPUJob":
        """See TimedDriver."""
        wide = storage == "float" or any(
            t.ndim == 3 and t.dtype == np.float32 and len(t) > 1 for t in textures.values()
        )
        if wide and not self.float_filterable:
            raise Unavailable("this adapter cannot filter 32-bit float textures; use half floats")
        require_targets(self, passes, storage, self.attachment_bytes)
        return WGPUJob(self, passes, textures, size, storage, share)


class WGPUJob(Job):
    """See base.Job."""

    def __init__(
        self, driver: WGPU, passes: Sequence[Pass], textures: Textures, size: tuple[int, int], storage: str, share
    ):
        over = drawn_over(passes, size)
        super().__init__(driver, storage, share)
        self.upload(textures)
        self.steps: list[Step] = []
        for item, kept in zip(passes, over, strict=True):
            targets = self.targets(item, kept, size)
            self.steps.append(driver.step(item, self.live, targets, kept))
            self.live.update(zip(item.outputs, targets, strict=True))

    def shape_of(self, texture) -> tuple[tuple[int, int], int]:
        """See base.Job."""
        channels = next(count for (_, count), known in FORMATS.items() if known == texture.format)
        return texture.size[:2], channels

    def _record(self, encoder, query_set=None, first: bool = False, last: bool = False) -> None:
        """Record all passes; with a query set, the time at which the first begins and the last ends."""
        for index, step in enumerate(self.steps):
            stamps = {}
            if first and index == 0:
                stamps["beginning_of_pass_write_index"] = 0
            if last and index == len(self.steps) - 1:
                stamps["end_of_pass_write_index"] = 1
            how = {"store_op": "store", "clear_value": (0, 0, 0, 0)}
            render = encoder.begin_render_pass(
                color_attachments=[
                    {"view": view, "load_op": "load" if kept else "clear", **how}
                    for view, kept in zip(step.views, step.kept, strict=True)
                ],
                timestamp_writes={"query_set": query_set, **stamps} if query_set is not None and stamps else None,
            )
            render.set_pipeline(step.pipeline)
            render.set_bind_group(0, step.bindings)
            if step.viewport:
                render.set_viewport(*step.viewport, 0.0, 1.0)  # a triangle is clipped to it
            render.draw(3)
            render.end()

    def draw(self) -> None:
        """See base.Job."""
        encoder = self.driver.device.create_command_encoder()
        self._record(encoder)
        self.driver.device.queue.submit([encoder.finish()])

    def timed(self, repeats: int) -> Timing:
        """See base.Job. What is recorded beforehand is not in the time."""
        device, usage = self.driver.device, self.driver.wgpu.BufferUsage
        encoder = device.create_command_encoder()
        queries = device.create_query_set(type="timestamp", count=2) if self.driver.timer else None
        for index in range(repeats):
            self._record(encoder, queries, index == 0, index == repeats - 1)
        stamps = None
        if queries is not None:
            stamps = device.create_buffer(size=16, usage=usage.QUERY_RESOLVE | usage.COPY_SRC)
            encoder.resolve_query_set(queries, 0, 2, stamps, 0)
        commands = encoder.finish()
        self.driver.wait()
        watch = Stopwatch()
        device.queue.submit([commands])
        self.driver.wait()
        passed = watch.timing(repeats)
        if stamps is None:
            return passed
        begin, end = (int(stamp) for stamp in np.frombuffer(device.queue.read_buffer(stamps), np.uint64))
        return replace(passed, query=(end - begin) * 1e-9 / repeats)

    def pixels(self, texture) -> np.ndarray:
        """See base.Job."""
        (width, height), channels = self.shape_of(texture)
        dtype = np.dtype(storage_type(self.storage))
        layout = {"bytes_per_row": width * channels * dtype.itemsize, "rows_per_image": height}
        data = self.driver.device.queue.read_texture({"texture": texture}, layout, texture.size)
        return np.frombuffer(data, dtype)

    def release(self) -> None:
        """See base.Job: textures go when nothing names them any more."""
        self.live.clear()
        self.made.clear()
        self.steps.clear()


class DXC(WGPU):
    """HLSL, shader model 6, compiled by DXC to SPIR-V."""

    name = "dxc"

    def __init__(self, adapter: str | None = None):
        from bokeh_validation.compilers import dxc

        self.compiler = dxc.load()
        super().__init__(adapter)
        self.adapter += f", DXC {self.compiler.version}"
        self._vertex = None

    def modules(self, item: Pass) -> tuple:
        """See WGPU.modules."""
        if self._vertex is None:
            self._vertex = self._compile(shaders.hlsl(6, {}), "BokehFullScreen_VS", "vs_6_0")
        code = item.sources["hlsl"] if item.sources else shaders.hlsl(6, item.constants)
        fragment = self._compile(code, item.entry + "_PS", "ps_6_0")
        return self._vertex, "BokehFullScreen_VS", fragment, item.entry + "_PS", {}

    def _compile(self, code: str, entry: str, profile: str):
        result = self.compiler.compile(code, profile, entry, spirv=True)
        if not result.ok:
            raise RuntimeError(f"DXC refused {entry} ({profile}):\n{result.messages}")
        return self.device.create_shader_module(code=result.binary)
