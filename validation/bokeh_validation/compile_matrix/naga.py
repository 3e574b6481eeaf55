"""naga, the shader compiler of wgpu (and of Firefox, Bevy), asked through a live device."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache

from bokeh_validation.compilers.tool import CompileResult, Tool, accepted, refused
from bokeh_validation.drivers.webgpu import WGPU
from bokeh_validation.process import once

TARGET_FORMAT = "rgba16float"
PROGRAM = Tool("naga", "cargo install naga-cli")


@dataclass(frozen=True)
class Stage:
    """One stage of a pipeline: WGSL text or SPIR-V, its override constants, and how many targets it writes."""

    code: str | bytes
    entry: str
    constants: Mapping[str, float] = field(default_factory=dict)
    targets: int = 1


@once
def driver() -> WGPU:
    """A device of the usual choice. Raises Unavailable."""
    return WGPU()


def version() -> str:
    """wgpu and its device: naga has the version of wgpu-native. Raises Unavailable."""
    device = driver()
    from wgpu.backends import wgpu_native

    native = ".".join(map(str, wgpu_native.lib_version_info))
    return f"wgpu-native {native}, {device.adapter}"


def build(vertex: Stage, fragment: Stage) -> CompileResult:
    """Make the modules and a render pipeline of them, with the bindings that the package documents.

    The pipeline is where override constants, bindings and the interface between the stages are checked.
    """
    device = driver()
    try:
        stages = [
            {"module": _module(stage.code), "entry_point": stage.entry, "constants": dict(stage.constants)}
            for stage in (vertex, fragment)
        ]
        device.make_pipeline(*stages, [TARGET_FORMAT] * fragment.targets)
    except (device.wgpu.GPUError, device.wgpu.GPUPipelineError) as error:
        # without the frame 'Validation Error / Caused by / In wgpu...' that stands before each
        return refused(re.sub(r"\A\s*Validation Error\s+Caused by:\s+In \w+\s+", "", str(error)))
    return accepted("")


def module(code: str) -> CompileResult:
    """Make a module of WGSL, which checks all of it but its bindings and its interface between the stages."""
    device = driver()
    try:
        _module(code)
    except device.wgpu.GPUError as error:
        return refused(str(error))
    return accepted("")


@lru_cache(maxsize=4)  # a WGSL module has all entry points, and the vertex stage of SPIR-V is always the same
def _module(code: str | bytes):
    return driver().device.create_shader_module(code=code)


def spirv(source: str, entry: str, constants: Mapping[str, int]) -> CompileResult:
    """SPIR-V of an entry point of WGSL, with its override constants, by naga's own program. Raises Unavailable."""
    values = [word for name, value in constants.items() for word in ("--override", f"{name}={value}")]
    return PROGRAM.run(["--entry-point", entry, *values, "in.wgsl", "out.spv"], {"in.wgsl": source.encode()}, "out.spv")
