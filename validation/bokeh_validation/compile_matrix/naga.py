"""Compile with naga, the shader compiler of wgpu, Firefox and Bevy, through a live device."""

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
    """Hold one stage of a pipeline: WGSL text or SPIR-V, its override constants, and its number of targets."""

    code: str | bytes
    entry: str
    constants: Mapping[str, float] = field(default_factory=dict)
    targets: int = 1


@once
def driver() -> WGPU:
    """Return a WGPU driver on its default device. Raises Unavailable."""
    return WGPU()


def version() -> str:
    """Return the versions of wgpu and its device; naga has the version of wgpu-native. Raises Unavailable."""
    device = driver()
    from wgpu.backends import wgpu_native

    native = ".".join(map(str, wgpu_native.lib_version_info))
    return f"wgpu-native {native}, {device.adapter}"


def build(vertex: Stage, fragment: Stage) -> CompileResult:
    """Create the modules and a render pipeline with the bindings that the package documents.

    Creating the pipeline checks override constants, bindings and the interface between the stages.
    """
    device = driver()
    try:
        stages = [
            {"module": _module(stage.code), "entry_point": stage.entry, "constants": dict(stage.constants)}
            for stage in (vertex, fragment)
        ]
        device.make_pipeline(*stages, [TARGET_FORMAT] * fragment.targets)
    except (device.wgpu.GPUError, device.wgpu.GPUPipelineError) as error:
        # drop the prefix 'Validation Error / Caused by / In wgpu...'
        return refused(re.sub(r"\A\s*Validation Error\s+Caused by:\s+In \w+\s+", "", str(error)))
    return accepted("")


def module(code: str) -> CompileResult:
    """Create a WGSL module, which checks all of it except its bindings and the interface between the stages."""
    device = driver()
    try:
        _module(code)
    except device.wgpu.GPUError as error:
        return refused(str(error))
    return accepted("")


@lru_cache(maxsize=4)  # a WGSL module has all entry points, and SPIR-V always has the same vertex stage
def _module(code: str | bytes):
    return driver().device.create_shader_module(code=code)


def spirv(source: str, entry: str, constants: Mapping[str, int]) -> CompileResult:
    """Compile an entry point of WGSL with its override constants to SPIR-V, with naga's command. Raises Unavailable."""
    values = [word for name, value in constants.items() for word in ("--override", f"{name}={value}")]
    return PROGRAM.run(["--entry-point", entry, *values, "in.wgsl", "out.spv"], {"in.wgsl": source.encode()}, "out.spv")
