"""The Khronos reference front end for GLSL, GLSL ES and HLSL (glslangValidator), and Google's glslc, made of it.

A start of either takes far longer than a shader, so both take several at once.
"""

from collections.abc import Sequence
from itertools import chain

from bokeh_validation.compilers import tool
from bokeh_validation.compilers.result import CompileResult, accepted, refused
from bokeh_validation.compilers.spirv import REGISTERS, facts

INSTALL = "apt-get install -y glslang-tools"
INSTALL_GLSLC = "apt-get install -y glslc"

# What the SPIR-V is for, as a client and as glslangValidator's options. OpenGL: GLSL 330 states no locations or
# bindings, so they are assigned. HLSL: those of the WGSL file; to what --rsb gives a texture its shift is added.
OPENGL = ("-G100", "--aml", "--amb")
VULKAN = ("-V",)
_FIRST = REGISTERS["t0"]
_TEXTURES = ((name, "0", str(binding - _FIRST)) for name, binding in REGISTERS.items() if name[0] == "t")
HLSL = (
    *("-D", "-V", "--stb", str(_FIRST), "--ssb", str(REGISTERS["s0"]), "--sub", "0"),
    *("--rsb", "frag", *chain.from_iterable(_TEXTURES)),
)


def _program() -> str:
    return tool.find("glslangValidator", INSTALL)


def version() -> str:
    """Such as 11:12.0.0. Raises Unavailable."""
    for line in tool.run(_program(), ["--version"]).output.splitlines():
        if line.startswith("Glslang Version:"):
            return line.partition(":")[2].strip()
    return "unknown"


def parse(source: str, stage: str) -> CompileResult:
    """Check GLSL or GLSL ES, the version as the text says, without making code. `stage` is 'vert' or 'frag'.

    -l links as well: without it a shader that lacks main() passes.
    """
    name = f"shader.{stage}"
    return tool.compiled(_program(), ["-l", "-S", stage, name], {name: source.encode()})


def all_parse(sources: Sequence[tuple[str, str]]) -> bool:
    """Whether glslang has nothing to say about any of some (text, stage); it does not link."""
    inputs = {f"{index}.{stage}": source.encode() for index, (source, stage) in enumerate(sources)}
    done = tool.run(_program(), list(inputs), inputs)
    return done.ok and not done.output


def spirv(source: str, stage: str, options: tuple[str, ...], entry: str | None = None) -> CompileResult:
    """Compile to SPIR-V. `options` is OPENGL, VULKAN or HLSL; HLSL takes the name of its entry point."""
    name = f"shader.{stage}"
    arguments = [*options, "-S", stage, *(("-e", entry) if entry else ()), "-o", "out.spv", name]
    result = tool.compiled(_program(), arguments, {name: source.encode()}, "out.spv")
    if not result.ok:
        return result
    try:
        return accepted(result.messages, result.binary, facts(result.binary))
    except ValueError as error:
        return refused(f"glslangValidator ended well but what it wrote is {error}\n{result.messages}")


def glsl(source: str, stage: str, profile: str) -> CompileResult:
    """GLSL of a profile of shaders.GLSL_VERSIONS: 450 to SPIR-V for Vulkan, 330 parsed and to SPIR-V for OpenGL.

    300es is parsed only: GLSL ES makes SPIR-V from 3.10 on.
    """
    if profile == "450":
        return spirv(source, stage, VULKAN)
    parsed = parse(source, stage)
    if profile == "300es" or not parsed.ok:
        return parsed
    return spirv(source, stage, OPENGL)


def hlsl(source: str, stage: str, entry: str) -> CompileResult:
    """HLSL with Texture2D and SamplerState (shader model 4 and 5) to SPIR-V.

    Not for shader model 3: glslang takes sampler2D and tex2D but makes SPIR-V of it that is not valid.
    """
    return spirv(source, stage, HLSL, entry)


def checked(texts: Sequence[tuple[CompileResult, str]], target: str) -> list[CompileResult]:
    """What spirv-cross wrote as GLSL ES, each with its stage, where glslang takes it.

    It always writes a main(), so all at once need not be linked.
    """
    if all_parse([(text.binary.decode(), stage) for text, stage in texts if text.ok]):
        return [text for text, _ in texts]
    return [_checked(text, stage, target) if text.ok else text for text, stage in texts]


def _checked(text: CompileResult, stage: str, target: str) -> CompileResult:
    parsed = parse(text.binary.decode(), stage)
    if not parsed.ok:
        return refused(f"spirv-cross wrote {target} that glslang refuses:\n{parsed.messages}")
    return accepted("\n".join(filter(None, (text.messages, parsed.messages))), text.binary, {"bytes": len(text.binary)})


def glslc_version() -> str:
    """Version of shaderc. Raises Unavailable."""
    lines = tool.run(tool.find("glslc", INSTALL_GLSLC), ["--version"]).output.splitlines()
    return lines[0] if lines else "unknown"


def glslc(sources: Sequence[tuple[str, str]]) -> list[CompileResult]:
    """GLSL for Vulkan, each (text, stage), to SPIR-V by glslc."""
    program, options = tool.find("glslc", INSTALL_GLSLC), ["--target-env=vulkan1.0", "-c"]
    inputs = {f"{index}.{stage}": source.encode("ascii") for index, (source, stage) in enumerate(sources)}
    outputs = [f"{name}.spv" for name in inputs]
    done = tool.run(program, [*options, *inputs], inputs, outputs)
    if done.ok and not done.output and len(done.files) == len(outputs):
        return [accepted("", done.files[name], {"bytes": len(done.files[name])}) for name in outputs]
    # one of them is not as it should be: by itself each says what is its own
    return [
        tool.compiled(program, [*options, f"shader.{stage}"], {f"shader.{stage}": source.encode("ascii")},
                      f"shader.{stage}.spv")
        for source, stage in sources
    ]  # fmt: skip
