"""All compilers: what each takes, how it is run, and which version it is."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache, partial

from bokeh_validation.compile_matrix import angle_tint, mesa, naga
from bokeh_validation.compilers import dxc, fxc, glslang, slang, spirv
from bokeh_validation.compilers.tool import CompileResult
from bokeh_validation.shaders.variants import VERTEX, Program


@dataclass(frozen=True)
class Compiler:
    """A column of the table.

    tool   the program or library that it is, which `version` asks; raises Unavailable
    run    what it says of a program, given its source or what another compiler has made of it; raises Unavailable
    takes  the compilers whose output it takes, if the program goes through one of them; else the source
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


def _other(program: Program) -> Program:
    """A program is a vertex and a fragment shader: what one is linked with, taken as the package has it."""
    return replace(program, entry=VERTEX if program.stage == "frag" else "BokehCoCMap", samples=None)


def _linked(link: Callable[[str, str], CompileResult], program: Program, source: str) -> CompileResult:
    """GLSL with its other stage."""
    other = _other(program)
    pair = {program.stage: source, other.stage: other.source}
    return link(pair["vert"], pair["frag"])


def _pipeline(build: Callable[..., CompileResult], program: Program, code: str | bytes) -> CompileResult:
    """WGSL, or SPIR-V of DXC, with its other stage; of Slang's WGSL, whose bindings are its own, the module alone."""
    if program.profile == "slang":
        return naga.module(code.decode())
    other, constants, partner = _other(program), program.configuration, code
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
    # Slang: code comes out
    *(Compiler(f"slang-{target}", "slang", slang.version, _slang(target)) for target in slang.TARGETS),
    # Microsoft's d3dcompiler_47, Direct3D 9 to 11: ok when bytecode comes out, in sm3 within the shader model's budget
    Compiler("fxc", "fxc", fxc.version, lambda p, source: fxc.build(source, p.stage, p.function, int(p.profile[-1]))),
    # the Khronos reference front end. 330, 450, sm5, GLSL of Slang: SPIR-V comes out; 300es: it parses, links
    Compiler("glslang", "glslang", glslang.GLSLANG.version, _glslang, ("slang-glsl",)),
    # Microsoft's DXC: SPIR-V comes out; DXIL for Direct3D 12 comes out
    Compiler("dxc-spirv", "dxc", dxc.version, lambda p, source: dxc.build(source, p.stage, p.function)),
    Compiler("dxc-dxil", "dxc", dxc.version, lambda p, source: dxc.build(source, p.stage, p.function, False)),
    # the Khronos validator finds nothing in the SPIR-V, by the rules of OpenGL 4.5 for 330, of Vulkan 1.2 for Slang
    # (it makes SPIR-V 1.5), else of Vulkan 1.0
    Compiler("spirv-val", "spirv-val", spirv.VAL.version, lambda p, module: spirv.validate(module, p.profile), SPIRV),
    # the SPIR-V to the Metal Shading Language: text comes out; nothing outside Apple's tools compiles it
    Compiler("msl", "spirv-cross", spirv.CROSS.version, lambda _, module: spirv.msl(module), SPIRV),
    # the compiler of an OpenGL driver, and the GLSL ES compiler of Chromium: both stages compile and link to a program
    Compiler("mesa", "mesa", mesa.version, partial(_linked, mesa.build)),
    Compiler("angle", "angle", angle_tint.version, partial(_linked, angle_tint.angle)),
    # wgpu's compiler, on WGSL or on DXC's SPIR-V, and Chromium's WGSL compiler: module and render pipeline are made; of
    # Slang's WGSL the module
    Compiler("naga", "naga", naga.version, partial(_pipeline, naga.build), ("dxc-spirv", "slang-wgsl")),
    Compiler("tint", "tint", angle_tint.version, partial(_pipeline, angle_tint.tint)),
)
