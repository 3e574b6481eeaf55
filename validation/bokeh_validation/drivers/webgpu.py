"""Run WGSL on WebGPU (`wgpu`), and HLSL compiled by DXC to SPIR-V on the same runtime (`dxc`): lavapipe or a GPU."""

import os
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache

import numpy as np

from bokeh_validation import needs, shaders
from bokeh_validation.drivers.base import PROGRAMS, DeviceDriver, Draw, Image
from bokeh_validation.errors import Unavailable
from bokeh_validation.numerics.images import STORAGE
from bokeh_validation.shaders.passes import BINDINGS, FIRST_SAMPLER, PARAMETERS, SAMPLE_TYPES, SLOTS, Pass

# WebGPU's limit on the bytes per pixel of all targets of a pass together. Its default, 32, allows four half-float
# targets, but only two of 32-bit floats.
ATTACHMENT_BYTES = "max-color-attachment-bytes-per-sample"
FILTERABLE = "float32-filterable"
# Half precision in WGSL; few passes are drawn with it
HALF = "shader-f16"


def _import():
    """Import wgpu with a runtime folder set, without which Mesa complains on standard error."""
    os.environ.setdefault("XDG_RUNTIME_DIR", "/tmp")
    import wgpu

    return wgpu


def _choose(adapter: str | None):
    """Choose a GPU, else a software device, or the adapter whose name contains `adapter`. Raises Unavailable.

    Only Vulkan, Metal and Direct3D 12 are considered: the OpenGL backend lacks what the passes need.
    """
    adapters = [
        candidate
        for candidate in _import().gpu.enumerate_adapters_sync()
        if candidate.info["backend_type"] in ("Vulkan", "Metal", "D3D12") and FILTERABLE in candidate.features
    ]
    fitting = [candidate for candidate in adapters if (adapter or "").lower() in candidate.info["device"].lower()]
    if not adapters:
        raise Unavailable(f"no Vulkan adapter that filters 32-bit floats; {WGPU.install}")
    if not fitting:
        names = ", ".join(candidate.info["device"] for candidate in adapters)
        raise Unavailable(f"no adapter named like {adapter!r}; there are: {names}")
    return min(fitting, key=lambda candidate: candidate.info["adapter_type"] == "CPU")


def texture_format(storage: str, channels: int) -> str:
    """Return WebGPU's name of a format with 1 or 4 channels."""
    return {4: "rgba", 1: "r"}[channels] + {"half": "16float", "float": "32float"}[storage]


class WGPU(DeviceDriver):
    """Run WGSL, with the text of all entries as one module."""

    name = "wgpu"
    install = needs.install("vulkan")

    def __init__(self, adapter: str | None = None):
        self.wgpu = _import()
        device_adapter = _choose(adapter)
        info = device_adapter.info
        self.adapter = f"{info['device']}, {info['backend_type']}, {info['description']}"
        self.attachment_bytes = device_adapter.limits[ATTACHMENT_BYTES]
        self.device = device_adapter.request_device_sync(
            required_features=[FILTERABLE, *({HALF} & set(device_adapter.features))],
            required_limits={ATTACHMENT_BYTES: self.attachment_bytes},
        )
        self.programs: dict[tuple, object] = {}
        self.module = lru_cache(PROGRAMS)(lambda code: self.device.create_shader_module(code=code))
        self.layout = self._make_layout()
        self._sampler = self.device.create_sampler(min_filter="linear", mag_filter="linear")
        self._dummy = self.texture(Image.of("", np.zeros((1, 1, 4), np.float16)))

    def _make_layout(self):
        """Create one bind group layout for every pass: parameters, all texture slots, the sampler.

        Depth need not be filterable.
        """
        stage = self.wgpu.ShaderStage.FRAGMENT
        entries = [{"binding": 0, "visibility": stage, "buffer": {"type": "uniform"}}]
        for slot, kind in SAMPLE_TYPES.items():
            entries.append({"binding": BINDINGS[slot], "visibility": stage, "texture": {"sample_type": kind}})
        entries.append({"binding": FIRST_SAMPLER, "visibility": stage, "sampler": {"type": "filtering"}})
        return self.device.create_bind_group_layout(entries=entries)

    def modules(self, render_pass: Pass) -> tuple:
        """Return (vertex module, fragment module, pipeline constants) of a pass."""
        module = self.module(
            shaders.wgsl(render_pass.constants) if render_pass.sources is None else render_pass.sources["wgsl"]
        )
        return module, module, {name: float(value) for name, value in render_pass.constants.items()}

    def make_pipeline(self, vertex: dict, fragment: dict, formats: Sequence[str]):
        """Create a render pipeline of two stages, each {'module', 'entry_point', 'constants'}, with a target per
        format.

        Raises the device's GPUError or GPUPipelineError.
        """
        return self.device.create_render_pipeline(
            layout=self.device.create_pipeline_layout(bind_group_layouts=[self.layout]),
            vertex=vertex,
            fragment={**fragment, "targets": [{"format": kind} for kind in formats]},
            primitive={"topology": "triangle-list"},
        )

    def pipeline(self, render_pass: Pass, formats: Sequence[str]):
        """Return the pipeline that draws a pass into targets of these formats; the latest PROGRAMS are cached."""
        key = (render_pass.entry, str(render_pass.constants), str(render_pass.sources), *formats)
        if key not in self.programs:
            if len(self.programs) == PROGRAMS:
                self.programs.pop(next(iter(self.programs)))
            vertex, fragment, constants = self.modules(render_pass)
            self.programs[key] = self.make_pipeline(
                {"module": vertex, "entry_point": "BokehFullScreen_VS"},
                {"module": fragment, "entry_point": f"{render_pass.entry}_PS", "constants": constants},
                formats,
            )
        return self.programs[key]

    def texture(self, image: Image):
        """Create a texture or a target; WebGPU initialises both to zeros."""
        usage = self.wgpu.TextureUsage
        use = usage.RENDER_ATTACHMENT | usage.COPY_SRC if image.pixels is None else usage.COPY_DST
        name = texture_format(image.storage, image.channels)
        texture = self.device.create_texture(size=(*image.size, 1), format=name, usage=use | usage.TEXTURE_BINDING)
        if image.pixels is not None:
            height, data = image.size[1], image.pixels.tobytes()
            layout = {"bytes_per_row": len(data) // height, "rows_per_image": height}
            self.device.queue.write_texture({"texture": texture}, data, layout, texture.size)
        return texture

    def bind(self, render_pass: Pass, bound: Mapping[str, object]):
        """Create the bind group of a pass; slots that it does not read get a dummy texture."""
        values = np.zeros(-(-len(PARAMETERS) // 4) * 4, np.float32)  # a uniform block is a multiple of 16 bytes
        values[: len(PARAMETERS)] = list(render_pass.values().values())
        buffer = self.device.create_buffer_with_data(data=values.tobytes(), usage=self.wgpu.BufferUsage.UNIFORM)
        entries = [{"binding": 0, "resource": {"buffer": buffer, "offset": 0, "size": values.nbytes}}]
        for slot in SLOTS:
            view = bound.get(slot, self._dummy).create_view()
            entries.append({"binding": BINDINGS[slot], "resource": view})
        entries.append({"binding": FIRST_SAMPLER, "resource": self._sampler})
        return self.device.create_bind_group(layout=self.layout, entries=entries)

    def step(self, draw: Draw, handles: Sequence) -> Callable:
        """Return a function that records the pass with an encoder; see DeviceDriver.step()."""
        targets = [handles[number] for number in draw.targets]
        pipeline = self.pipeline(draw.item, [target.format for target in targets])
        bindings = self.bind(draw.item, {slot: handles[number] for slot, number in draw.inputs.items()})
        # load, to keep what is around the drawn area
        keep_content = {"load_op": "load", "store_op": "store"}
        attachments = [{"view": target.create_view(), **keep_content} for target in targets]

        def record(encoder) -> None:
            render = encoder.begin_render_pass(color_attachments=attachments)
            render.set_pipeline(pipeline)
            render.set_bind_group(0, bindings)
            render.set_viewport(*draw.area, 0.0, 1.0)  # clips the full-screen triangle
            render.draw(3)
            render.end()

        return record

    def draw(self, steps: Sequence[Callable]) -> None:
        encoder = self.device.create_command_encoder()
        for record in steps:
            record(encoder)
        self.device.queue.submit([encoder.finish()])

    def pixels(self, handle, image: Image) -> np.ndarray:
        (width, height), dtype = image.size, np.dtype(STORAGE[image.storage])
        layout = {"bytes_per_row": 4 * width * dtype.itemsize, "rows_per_image": height}
        return np.frombuffer(self.device.queue.read_texture({"texture": handle}, layout, handle.size), dtype)


class DXC(WGPU):
    """Run HLSL of shader model 6, compiled by DXC to SPIR-V."""

    name = "dxc"

    def __init__(self, adapter: str | None = None):
        from bokeh_validation.compilers import dxc

        dxc.fetch()
        self._spirv = dxc.kept_spirv
        super().__init__(adapter)
        self.adapter += f", DXC {dxc.RELEASE}"
        self.vertex = self._compile(shaders.hlsl(6, {}), "BokehFullScreen_VS", "vert")

    def modules(self, render_pass: Pass) -> tuple:
        code = render_pass.sources["hlsl"] if render_pass.sources else shaders.hlsl(6, render_pass.constants)
        return self.vertex, self._compile(code, render_pass.entry + "_PS", "frag"), {}

    def _compile(self, code: str, entry: str, stage: str):
        return self.module(self._spirv(code, stage, entry))
