"""Compile GLSL, GLSL ES and HLSL with glslangValidator, Khronos's reference front end."""

from collections.abc import Sequence

from bokeh_validation import needs
from bokeh_validation.compilers.spirv import REGISTERS
from bokeh_validation.compilers.tool import CompileResult, Tool

GLSLANG = Tool("glslangValidator", needs.install("glslang"))

# Options of glslangValidator for each use of the SPIR-V. For OpenGL they assign locations and bindings, since GLSL 330
# states none. For HLSL they assign the bindings of the WGSL file; the texture shift is added to those that --rsb gives.
OPENGL = ("-G100", "--aml", "--amb")
VULKAN = ("-V",)
_FIRST = REGISTERS["t0"]
_TEXTURES = ((name, "0", str(binding - _FIRST)) for name, binding in REGISTERS.items() if name[0] == "t")
HLSL = (
    *("-D", "-V", "--stb", str(_FIRST), "--ssb", str(REGISTERS["s0"]), "--sub", "0"),
    *("--rsb", "frag", *(word for words in _TEXTURES for word in words)),
)


def parse(source: str, stage: str) -> CompileResult:
    """Check GLSL or GLSL ES without generating code; the text states its version. `stage` is 'vert' or 'frag'.

    -l links as well; without it, a shader that lacks main() is accepted.
    """
    name = f"shader.{stage}"
    return GLSLANG.run(["-l", name], {name: source.encode()})


def spirv(source: str, stage: str, options: Sequence[str], entry: str | None = None) -> CompileResult:
    """Compile to SPIR-V. `options` is OPENGL, VULKAN or HLSL; HLSL needs the name of its entry point."""
    name = f"shader.{stage}"
    arguments = [*options, *(("-e", entry) if entry else ()), "-o", "out.spv", name]
    return GLSLANG.run(arguments, {name: source.encode()}, "out.spv")


def hlsl(source: str, stage: str, entry: str) -> CompileResult:
    """Compile HLSL with Texture2D and SamplerState (shader models 4 and 5) to SPIR-V.

    Not for shader model 3: glslang accepts sampler2D and tex2D but generates invalid SPIR-V from them.
    """
    return spirv(source, stage, HLSL, entry)
