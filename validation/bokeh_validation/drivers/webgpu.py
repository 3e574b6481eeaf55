"""WGSL on WebGPU (`wgpu`), and HLSL compiled by DXC to SPIR-V on the same runtime (`dxc`): lavapipe or a GPU."""

import os
from collections.abc import Iterable, Sequence
from functools import cached_property

import numpy as np

from bokeh_validation import shaders
from bokeh_validation.drivers.base import Textures, half_rounding, require_targets, storage_type
from bokeh_validation.errors import Unavailable
from bokeh_validation.passes import FIRST_SAMPLER, FIRST_TEXTURE, PARAMETERS, SAMPLE_TYPES, SLOTS, Pass

FORMATS = {
    (np.dtype(np.float16), 4): "rgba16float",
    (np.dtype(np.float32), 4): "rgba32float",
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


class WGPU:
    """WGSL: the two files as they are, one module."""

    name = "wgpu"
    install = "apt-get install -y mesa-vulkan-drivers libvulkan1"

    def __init__(self, adapter: str | None = None):
        self.wgpu = _import()
        chosen = _choose(adapter)
        self.adapter = f"{chosen.info['device']}, {chosen.info['backend_type']}, {chosen.info['description']}"
        self.software = "llvmpipe" in self.adapter
        wanted = {"float32-filterable", "timestamp-query"} & set(chosen.features)
        self.attachment_bytes = chosen.limits[ATTACHMENT_BYTES]
        self.device = chosen.request_device_sync(
            required_features=sorted(wanted), required_limits={ATTACHMENT_BYTES: self.attachment_bytes}
        )
        self.float_filterable = "float32-filterable" in wanted
        self._pipelines: dict[tuple, object] = {}
        self.layout = self._make_layout()
        self._samplers = {
            linear: self.device.create_sampler(min_filter=kind, mag_filter=kind)
            for linear, kind in {True: "linear", False: "nearest"}.items()
        }
        self._dummy = self.upload(np.zeros((1, 1, 4), np.float16))

    @cached_property
    def rounding(self) -> str:
        """See drivers.base.Driver."""
        return half_rounding(self)

    def _make_layout(self):
        """One layout for every pass: parameters, all texture slots, two samplers. Depth need not be filterable."""
        stage = self.wgpu.ShaderStage.FRAGMENT
        entries = [{"binding": 0, "visibility": stage, "buffer": {"type": "uniform"}}]
        for binding, kind in enumerate(SAMPLE_TYPES.values(), FIRST_TEXTURE):
            entries.append({"binding": binding, "visibility": stage, "texture": {"sample_type": kind}})
        for binding, kind in enumerate(("filtering", "non-filtering"), FIRST_SAMPLER):
            entries.append({"binding": binding, "visibility": stage, "sampler": {"type": kind}})
        return self.device.create_bind_group_layout(entries=entries)

    def modules(self, entry: str, samples: int) -> tuple:
        """(vertex module, its entry, fragment module, its entry, pipeline constants)."""
        if not hasattr(self, "_module"):
            self._module = self.device.create_shader_module(code=shaders.wgsl())
        constants = {"BOKEH_NUM_SAMPLES": float(samples)}
        return self._module, "BokehFullScreen_VS", self._module, entry + "_PS", constants

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
        key = (item.entry, item.samples, *formats)
        if key not in self._pipelines:
            vertex, vertex_entry, fragment, fragment_entry, constants = self.modules(item.entry, item.samples)
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

    def target(self, size: tuple[int, int], storage: str):
        """An RGBA render target that can be sampled and read back."""
        usage = self.wgpu.TextureUsage
        return self.device.create_texture(
            size=(*size, 1),
            format=FORMATS[np.dtype(storage_type(storage)), 4],
            usage=usage.RENDER_ATTACHMENT | usage.TEXTURE_BINDING | usage.COPY_SRC,
        )

    def bind(self, item: Pass, live: dict):
        """Bind group of a pass; slots it does not read get a dummy."""
        values = np.zeros(-(-len(PARAMETERS) // 4) * 4, np.float32)  # a uniform block has a multiple of 16 bytes
        values[: len(PARAMETERS)] = list(item.values().values())
        buffer = self.device.create_buffer_with_data(data=values.tobytes(), usage=self.wgpu.BufferUsage.UNIFORM)
        entries = [{"binding": 0, "resource": {"buffer": buffer, "offset": 0, "size": values.nbytes}}]
        for binding, slot in enumerate(SLOTS, FIRST_TEXTURE):
            texture = live[item.inputs[slot]] if slot in item.inputs else self._dummy
            entries.append({"binding": binding, "resource": texture.create_view()})
        for binding, linear in enumerate((True, False), FIRST_SAMPLER):
            entries.append({"binding": binding, "resource": self._samplers[linear]})
        return self.device.create_bind_group(layout=self.layout, entries=entries)

    def encode(self, encoder, item: Pass, live: dict, targets: Sequence) -> None:
        """Record one pass into its targets."""
        how = {"load_op": "clear", "store_op": "store", "clear_value": (0, 0, 0, 0)}
        render = encoder.begin_render_pass(color_attachments=[{"view": t.create_view(), **how} for t in targets])
        render.set_pipeline(self.pipeline(item, [target.format for target in targets]))
        render.set_bind_group(0, self.bind(item, live))
        render.draw(3)
        render.end()

    def run(
        self,
        passes: Sequence[Pass],
        textures: Textures,
        size: tuple[int, int],
        storage: str = "half",
        keep: Iterable[str] = ("result",),
    ) -> dict[str, np.ndarray]:
        """See drivers.base.Driver.run."""
        wide = storage == "float" or any(
            t.ndim == 3 and t.dtype == np.float32 and len(t) > 1 for t in textures.values()
        )
        if wide and not self.float_filterable:
            raise Unavailable("this adapter cannot filter 32-bit float textures; use half floats")
        require_targets(self, passes, storage, self.attachment_bytes)
        live = {name: self.upload(pixels) for name, pixels in textures.items()}
        encoder = self.device.create_command_encoder()
        for item in passes:
            targets = [self.target(size, storage) for _ in item.outputs]
            self.encode(encoder, item, live, targets)
            live.update(zip(item.outputs, targets, strict=True))
        self.device.queue.submit([encoder.finish()])
        return {name: self._read(live[name], size, storage) for name in keep}

    def _read(self, texture, size: tuple[int, int], storage: str) -> np.ndarray:
        dtype = np.dtype(storage_type(storage))
        layout = {"bytes_per_row": size[0] * 4 * dtype.itemsize, "rows_per_image": size[1]}
        data = self.device.queue.read_texture({"texture": texture}, layout, (*size, 1))
        return np.frombuffer(data, dtype).reshape(size[1], size[0], 4).copy()


class DXC(WGPU):
    """HLSL, shader model 6, compiled by DXC to SPIR-V."""

    name = "dxc"

    def __init__(self, adapter: str | None = None):
        from bokeh_validation.compilers import dxc

        self.compiler = dxc.load()
        super().__init__(adapter)
        self.adapter += f", DXC {self.compiler.version}"
        self._vertex = None

    def modules(self, entry: str, samples: int) -> tuple:
        if self._vertex is None:
            self._vertex = self._compile("BokehFullScreen_VS", "vs_6_0", {})
        fragment = self._compile(entry + "_PS", "ps_6_0", {"BOKEH_NUM_SAMPLES": samples})
        return self._vertex, "BokehFullScreen_VS", fragment, entry + "_PS", {}

    def _compile(self, entry: str, profile: str, values: dict):
        result = self.compiler.compile(shaders.hlsl(6, values), profile, entry, spirv=True)
        if not result.ok:
            raise RuntimeError(f"DXC refused {entry} ({profile}):\n{result.messages}")
        return self.device.create_shader_module(code=result.binary)
