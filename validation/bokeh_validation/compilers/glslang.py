"""The Khronos reference front end for GLSL, GLSL ES and HLSL: glslangValidator."""

from itertools import chain

from bokeh_validation.compilers import spirv_facts, tool
from bokeh_validation.compilers.registers import BINDINGS
from bokeh_validation.compilers.result import CompileResult, accepted, refused

INSTALL = "apt-get install -y glslang-tools"

# What the SPIR-V is for, as a client and as glslangValidator's options. OpenGL: GLSL 330 states no locations or
# bindings, so they are assigned. HLSL: those of the WGSL file; to what --rsb gives a texture its shift is added.
OPENGL = ("-G100", "--aml", "--amb")
VULKAN = ("-V",)
_TEXTURES = ((name, "0", str(binding - BINDINGS["t0"])) for name, binding in BINDINGS.items() if name[0] == "t")
HLSL = (
    *("-D", "-V", "--stb", str(BINDINGS["t0"]), "--ssb", str(BINDINGS["s0"]), "--sub", "0"),
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
    done = tool.run(_program(), ["-l", "-S", stage, name], {name: source.encode()})
    return accepted(done.output) if done.ok else refused(done.output)


def spirv(source: str, stage: str, options: tuple[str, ...], entry: str | None = None) -> CompileResult:
    """Compile to SPIR-V. `options` is OPENGL, VULKAN or HLSL; HLSL takes the name of its entry point."""
    name = f"shader.{stage}"
    arguments = [*options, "-S", stage, *(("-e", entry) if entry else ()), "-o", "out.spv", name]
    done = tool.run(_program(), arguments, {name: source.encode()}, ["out.spv"])
    binary = done.files.get("out.spv", b"")
    if not done.ok:
        return refused(done.output)
    if not binary:
        return refused(f"glslangValidator ended well but wrote no SPIR-V\n{done.output}")
    try:
        return accepted(done.output, binary, spirv_facts.facts(binary))
    except ValueError as error:
        return refused(f"glslangValidator ended well but what it wrote is {error}\n{done.output}")


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
