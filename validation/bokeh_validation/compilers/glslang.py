"""The Khronos reference front end for GLSL, GLSL ES and HLSL (glslangValidator), and Google's glslc, made of it."""

from collections.abc import Sequence

from bokeh_validation.compilers.spirv import REGISTERS, facts
from bokeh_validation.compilers.tool import CompileResult, Source, Tool, accepted, refused

GLSLANG = Tool("glslangValidator", "glslang-tools", "--version", r"^Glslang Version: *(.*)")
GLSLC = Tool("glslc", "glslc", "--version", r"^(.*)")

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
    return GLSLANG.compile(["-l", name], {name: source.encode()})


def spirv(source: str, stage: str, options: Sequence[str], entry: str | None = None) -> CompileResult:
    """Compile to SPIR-V. `options` is OPENGL, VULKAN or HLSL; HLSL takes the name of its entry point."""
    name = f"shader.{stage}"
    arguments = [*options, *(("-e", entry) if entry else ()), "-o", "out.spv", name]
    result = GLSLANG.compile(arguments, {name: source.encode()}, "out.spv")
    if not result.ok:
        return result
    try:
        return accepted(result.messages, result.binary, facts(result.binary))
    except ValueError as error:
        return refused(f"glslangValidator ended well but what it wrote is {error}\n{result.messages}")


def glsl(sources: Sequence[Source], profile: str) -> list[CompileResult]:
    """GLSL of a profile of shaders.GLSL_VERSIONS: 450 to SPIR-V for Vulkan, 330 parsed and to SPIR-V for OpenGL.

    300es is parsed only: GLSL ES makes SPIR-V from 3.10 on.
    """
    if profile == "300es":
        return [parse(*source) for source in sources]
    if profile == "450":
        return [spirv(*source, VULKAN) for source in sources]
    parsed = zip(sources, GLSLANG.each((), sources), strict=True)
    return [spirv(*source, OPENGL) if result.ok else result for source, result in parsed]


def hlsl(source: str, stage: str, entry: str) -> CompileResult:
    """HLSL with Texture2D and SamplerState (shader model 4 and 5) to SPIR-V.

    Not for shader model 3: glslang takes sampler2D and tex2D but makes SPIR-V of it that is not valid.
    """
    return spirv(source, stage, HLSL, entry)


def checked(texts: Sequence[tuple[CompileResult, str]], target: str) -> list[CompileResult]:
    """What spirv-cross wrote as GLSL ES, each with its stage, where glslang takes it."""
    parsed = iter(GLSLANG.each((), [(text.binary.decode(), stage) for text, stage in texts if text.ok]))
    return [_checked(text, next(parsed), target) if text.ok else text for text, _ in texts]


def _checked(text: CompileResult, parsed: CompileResult, target: str) -> CompileResult:
    if not parsed.ok:
        return refused(f"spirv-cross wrote {target} that glslang refuses:\n{parsed.messages}")
    return accepted("\n".join(filter(None, (text.messages, parsed.messages))), text.binary, {"bytes": len(text.binary)})


def glslc(sources: Sequence[Source]) -> list[CompileResult]:
    """GLSL for Vulkan to SPIR-V by glslc."""
    return GLSLC.each(("--target-env=vulkan1.0", "-c"), sources, ".spv")
