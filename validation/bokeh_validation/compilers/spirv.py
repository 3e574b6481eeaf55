"""What comes after SPIR-V: spirv-val checks it, spirv-cross turns it into other languages."""

import shutil

from bokeh_validation.compilers import glslang, tool
from bokeh_validation.compilers.result import CompileResult, accepted, refused

INSTALL_VAL = "apt-get install -y spirv-tools"
INSTALL_CROSS = "apt-get install -y spirv-cross"

# spirv-cross options by the name of the target
TARGETS = {
    "essl300": ("--es", "--version", "300"),
    "essl310": ("--es", "--version", "310"),
    "msl": ("--msl",),
    "hlsl50": ("--hlsl", "--shader-model", "50"),
}


def version_val() -> str:
    """Version of spirv-val, such as v2023.1. Raises Unavailable."""
    words = tool.run(tool.find("spirv-val", INSTALL_VAL), ["--version"]).output.split()
    return words[1] if len(words) > 1 else "unknown"


def version_cross() -> str:
    """Version of spirv-cross. Raises Unavailable."""
    said = tool.run(tool.find("spirv-cross", INSTALL_CROSS), ["--revision"]).output
    # Debian's build says only that it is Debian's
    if "Debian" in said and shutil.which("dpkg-query"):
        package = tool.run("dpkg-query", ["-W", "-f=${Version}", "spirv-cross"])
        if package.ok:
            return package.output
    return said.splitlines()[0] if said else "unknown"


def version() -> str:
    """Versions of both tools. Raises Unavailable."""
    return f"spirv-val {version_val()}, spirv-cross {version_cross()}"


def validate(binary: bytes, environment: str = "vulkan1.0") -> CompileResult:
    """Check a module against the rules of an environment: 'vulkan1.0', 'opengl4.5' or another that spirv-val knows."""
    program = tool.find("spirv-val", INSTALL_VAL)
    done = tool.run(program, ["--target-env", environment, "shader.spv"], {"shader.spv": binary})
    return accepted(done.output) if done.ok else refused(done.output)


def cross(binary: bytes, target: str) -> CompileResult:
    """Turn a module into another language, one of TARGETS; the text is the result's `binary`."""
    program = tool.find("spirv-cross", INSTALL_CROSS)
    arguments = ["shader.spv", *TARGETS[target], "--output", "out.txt"]
    done = tool.run(program, arguments, {"shader.spv": binary}, ["out.txt"])
    text = done.files.get("out.txt", b"")
    if not done.ok:
        return refused(done.output)
    if not text.strip():
        return refused(f"spirv-cross ended well but wrote nothing\n{done.output}")
    return accepted(done.output, text, {"bytes": len(text)})


def cross_checked(binary: bytes, stage: str, target: str) -> CompileResult:
    """Turn a module into GLSL ES (essl300, essl310) and have glslang compile that."""
    text = cross(binary, target)
    if not text.ok:
        return text
    parsed = glslang.parse(text.binary.decode(), stage)
    if not parsed.ok:
        return refused(f"spirv-cross wrote {target} that glslang refuses:\n{parsed.messages}")
    return accepted("\n".join(filter(None, (text.messages, parsed.messages))), text.binary, {"bytes": len(text.binary)})
