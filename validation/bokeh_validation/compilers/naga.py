"""naga, the shader compiler of wgpu (and of Firefox, Bevy), asked through a live device."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from bokeh_validation.compilers.result import CompileResult, accepted, refused
from bokeh_validation.drivers.webgpu import WGPU

INSTALL = WGPU.install
TARGET_FORMAT = "rgba16float"


@dataclass(frozen=True)
class Stage:
    """One stage of a pipeline.

    code       WGSL text or SPIR-V
    entry      its entry point
    constants  values of its override constants
    targets    how many targets it writes, of a fragment stage
    """

    code: str | bytes
    entry: str
    constants: Mapping[str, float] = field(default_factory=dict)
    targets: int = 1


def driver() -> WGPU:
    """A device of the usual choice. Raises Unavailable."""
    return WGPU()


def version(device: WGPU | None = None) -> str:
    """wgpu and its device, or a new one: naga has the version of wgpu-native. Raises Unavailable."""
    device = device or driver()
    from wgpu.backends import wgpu_native

    native = ".".join(str(part) for part in wgpu_native.lib_version_info)
    return f"wgpu-native {native}, {device.adapter}"


def build(vertex: Stage, fragment: Stage, device: WGPU) -> CompileResult:
    """Make the modules and a render pipeline of them, with the bindings that the package documents.

    The pipeline is where override constants, bindings and the interface between the stages are checked.
    """
    errors = (device.wgpu.GPUError, device.wgpu.GPUPipelineError)
    gpu = device.device
    try:
        vertex_module = gpu.create_shader_module(code=vertex.code)
        same = fragment.code == vertex.code
        fragment_module = vertex_module if same else gpu.create_shader_module(code=fragment.code)
        device.make_pipeline(
            {"module": vertex_module, "entry_point": vertex.entry, "constants": dict(vertex.constants)},
            {"module": fragment_module, "entry_point": fragment.entry, "constants": dict(fragment.constants)},
            [TARGET_FORMAT] * fragment.targets,
        )
    except errors as error:
        return refused(_message(str(error)))
    return accepted("")


def _message(text: str) -> str:
    """Without the frame 'Validation Error / Caused by / In wgpu...' that stands before each."""
    return re.sub(r"\A\s*Validation Error\s+Caused by:\s+In \w+\s+", "", text).rstrip()
