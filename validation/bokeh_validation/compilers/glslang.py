"""The Khronos reference front end for GLSL, GLSL ES and HLSL: glslangValidator."""

from collections.abc import Sequence

from bokeh_validation import needs
from bokeh_validation.compilers.spirv import REGISTERS
from bokeh_validation.compilers.tool import CompileResult, Tool

GLSLANG = Tool("glslangValidator", needs.install("glslang"))

# What the SPIR-V is for, as a client and as glslangValidator's options. OpenGL: GLSL 330 states no locations or
# bindings, so they are assigned. HLSL: those of the WGSL file; to what --rsb gives a texture its shift is added.
OPENGL = ("-G100", "--aml", "--amb")
VULKAN = ("-V",)
_FIRST = REGISTERS["t0"]
_TEXTURES = ((name, "0", str(binding - _FIRST)) for name, binding in REGISTERS.items() if name[0] == "t")
HLSL = (
    *("-D", "-V", "--stb", str(_FIRST), "--ssb", str(REGISTERS["s0"]), "--sub", "0"),
    *("--rsb", "frag", *(word for words in _TEXTURES for word in words)),
)


def parse(source: str, stage: str) -> CompileResult:
    """Check GLSL or GLSL ES, the version as the text says, without making code. `stage` is 'vert' or 'frag'.

    -l links as well: without it a shader that lacks main() passes.
    """
    name = f"shader.{stage}"
    return GLSLANG.run(["-l", name], {name: source.encode()})


def spirv(source: str, stage: str, options: Sequence[str], entry: str | None = None) -> CompileResult:
    """Compile to SPIR-V. `options` is OPENGL, VULKAN or HLSL; HLSL takes the name of its entry point."""
    name = f"shader.{stage}"
    arguments = [*options, *(("-e", entry) if entry else ()), "-o", "out.spv", name]
    return GLSLANG.run(arguments, {name: source.encode()}, "out.spv")


def hlsl(source: str, stage: str, entry: str) -> CompileResult:
    """HLSL with Texture2D and SamplerState (shader model 4 and 5) to SPIR-V.

    Not for shader model 3: glslang takes sampler2D and tex2D but makes SPIR-V of it that is not valid.
    """
    return spirv(source, stage, HLSL, entry)
