"""Compile the passes whose cost is counted, from GLSL, HLSL and WGSL, to input for a GPU's compiler."""

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from bokeh_validation import shaders
from bokeh_validation.compile_matrix import naga
from bokeh_validation.compilers import dxc, glslang
from bokeh_validation.compilers.tool import CompileResult
from bokeh_validation.errors import UserError
from bokeh_validation.frame import methods
from bokeh_validation.frame.methods import Settings
from bokeh_validation.shaders.entries import EXACT
from bokeh_validation.shaders.passes import BINDINGS, FIRST_SAMPLER, Pass

VERTEX = "BokehFullScreen"
SIZE = (1920, 1080)
# `exact` at MEDIUM: BOKEH_NUM_SAMPLES, pixels between samples
SAMPLES, SPACING = methods.EXACT_PRESETS["medium"]
# binding -> kind of descriptor; in HLSL and WGSL, textures are separate from the sampler
COMBINED = {0: "uniform"} | dict.fromkeys(BINDINGS.values(), "combined")
SEPARATE = {0: "uniform", FIRST_SAMPLER: "sampler"} | dict.fromkeys(BINDINGS.values(), "texture")
THREADS = 2  # for glslang and naga


@dataclass(frozen=True)
class Code:
    """Hold the input of a GPU's compiler: a vertex stage and fragment stages, each a code and its entry point.

    fragments  name of a pass -> (code, entry point, number of targets)
    bindings   binding -> kind of descriptor
    """

    vertex: tuple[bytes, str]
    fragments: Mapping[str, tuple[bytes, str, int]]
    bindings: Mapping[int, str]


def all_passes() -> dict[str, Pass]:
    """Return name -> pass of `paper`, and of `exact` and `layered` at MEDIUM, without duplicates."""
    every = [Settings("paper", shape) for shape in ("hexagon", "octagon")]
    every += [Settings("exact", shape, spacing=SPACING, samples=SAMPLES) for shape in EXACT]
    # the hexagon comes last, so that its final pass replaces the octagon's
    every += [Settings("layered", shape) for shape in ("octagon", "hexagon")]
    passes = [item for settings in every for item in methods.plan(settings, SIZE).passes]
    return {item.entry.removeprefix("Bokeh"): item for item in passes}


def code(passes: Mapping[str, Pass], language: str) -> Code:
    """Compile passes to SPIR-V: GLSL with glslang, HLSL with DXC, WGSL with naga.

    Raises Unavailable without these compilers, and UserError if they reject a pass.
    """

    def stage(entry: str, name: str, constants: Mapping[str, int]) -> tuple[bytes, str]:
        function = entry + {"vert": "_VS", "frag": "_PS"}[name]
        if language == "hlsl":
            return _binary(dxc.build(shaders.hlsl(6, constants), name, function)), function
        if language == "wgsl":
            return _binary(naga.spirv(shaders.wgsl(), function, constants)), function
        return _binary(glslang.spirv(shaders.glsl(entry, "450", constants), name, glslang.VULKAN)), "main"

    items = passes.values()
    # DXC is not thread-safe
    with ThreadPoolExecutor(1 if language == "hlsl" else THREADS) as pool:
        fragments = list(pool.map(lambda item: (*stage(item.entry, "frag", item.constants), item.spec.targets), items))
    vertex = stage(VERTEX, "vert", {})
    return Code(vertex, dict(zip(passes, fragments, strict=True)), COMBINED if language == "glsl" else SEPARATE)


def _binary(result: CompileResult) -> bytes:
    if not result.ok:
        raise UserError(f"a shader does not compile: {result.messages.splitlines()[0]}. See validation/run compile.")
    return result.binary
