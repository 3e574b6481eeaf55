"""List all compilers: what each accepts, how it is run, and its version."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache, partial

from bokeh_validation.compile_matrix import angle_tint, mesa, naga
from bokeh_validation.compilers import dxc, fxc, glslang, slang, spirv
from bokeh_validation.compilers.tool import CompileResult
from bokeh_validation.shaders.variants import VERTEX, Program


@dataclass(frozen=True)
class Compiler:
    """Describe a column of the table.

    tool     the program or library
    version  returns its version; raises Unavailable
    run      compiles a program, given its source or another compiler's output; raises Unavailable
    takes    the compilers whose output it accepts, if the program goes through one of them; else it takes the source
    """

    name: str
    tool: str
    version: Callable[[], str]
    run: Callable[[Program, str | bytes], CompileResult]
    takes: tuple[str, ...] = ()


def _glslang(program: Program, source: str | bytes) -> CompileResult:
    if program.profile == "slang":
        return glslang.spirv(source.decode(), program.stage, glslang.VULKAN)
    if program.language == "hlsl":
        return glslang.hlsl(source, program.stage, program.function)
    if program.profile == "300es":
        return glslang.parse(source, program.stage)
    return glslang.spirv(source, program.stage, glslang.OPENGL if program.profile == "330" else glslang.VULKAN)


def linked_with(program: Program) -> Program:
    """Return the program of the other stage that a program is linked with, with the package's defaults."""
    return replace(program, entry=VERTEX if program.stage == "frag" else "BokehCoCMap", samples=None)


def _linked(link: Callable[[str, str], CompileResult], program: Program, source: str) -> CompileResult:
    """Link GLSL with its other stage."""
    other = linked_with(program)
    pair = {program.stage: source, other.stage: other.source}
    return link(pair["vert"], pair["frag"])


def _pipeline(build: Callable[..., CompileResult], program: Program, code: str | bytes) -> CompileResult:
    """Build a pipeline of WGSL, or of DXC's SPIR-V, with its other stage.

    Slang's WGSL has bindings of its own choice, so only its module is created.
    """
    if program.profile == "slang":
        return naga.module(code.decode())
    other, constants, partner = linked_with(program), program.configuration, code
    if program.language == "hlsl":
        constants, partner = {}, _dxc_once(other.source, other.stage, other.function).binary
    pair = {
        program.stage: naga.Stage(code, program.function, constants, program.targets),
        other.stage: naga.Stage(partner, other.function),
    }
    return build(pair["vert"], pair["frag"])


_dxc_once = lru_cache(maxsize=4)(dxc.build)


def _slang(target: str) -> Callable[[Program, str], CompileResult]:
    return lambda program, source: slang.build(source, program.stage, program.function, target)


SPIRV = ("glslang", "dxc-spirv", "slang-spirv")
COMPILERS = (
    # Slang generates code for each target
    *(Compiler(f"slang-{target}", "slang", slang.version, _slang(target)) for target in slang.TARGETS),
    # Microsoft's d3dcompiler_47, Direct3D 9 to 11: it must generate bytecode, in sm3 within the shader model's limits
    Compiler("fxc", "fxc", fxc.version, lambda p, source: fxc.build(source, p.stage, p.function, int(p.profile[-1]))),
    # Khronos's reference front end: it must generate SPIR-V for 330, 450, sm5 and Slang's GLSL; 300es must parse and
    # link
    Compiler("glslang", "glslang", glslang.GLSLANG.version, _glslang, ("slang-glsl",)),
    # Microsoft's DXC: it must generate SPIR-V, and DXIL for Direct3D 12
    Compiler("dxc-spirv", "dxc", dxc.version, lambda p, source: dxc.build(source, p.stage, p.function)),
    Compiler("dxc-dxil", "dxc", dxc.version, lambda p, source: dxc.build(source, p.stage, p.function, False)),
    # Khronos's validator must find nothing in the SPIR-V, by the rules of OpenGL 4.5 for 330, Vulkan 1.2 for Slang
    # (which generates SPIR-V 1.5), and Vulkan 1.0 otherwise
    Compiler("spirv-val", "spirv-val", spirv.VAL.version, lambda p, module: spirv.validate(module, p.profile), SPIRV),
    # SPIR-V must translate to the Metal Shading Language; only Apple's tools could compile the text
    Compiler("msl", "spirv-cross", spirv.CROSS.version, lambda _, module: spirv.msl(module), SPIRV),
    # an OpenGL driver's compiler, and Chromium's for GLSL ES: both stages must compile and link
    Compiler("mesa", "mesa", mesa.version, partial(_linked, mesa.build)),
    Compiler("angle", "angle", angle_tint.version, partial(_linked, angle_tint.angle)),
    # wgpu's compiler, on WGSL or DXC's SPIR-V, and Chromium's WGSL compiler: module and render pipeline must be
    # created; for Slang's WGSL only the module
    Compiler("naga", "naga", naga.version, partial(_pipeline, naga.build), ("dxc-spirv", "slang-wgsl")),
    Compiler("tint", "tint", angle_tint.version, partial(_pipeline, angle_tint.tint)),
)
