"""Google's glslc (shaderc): the front end that most Vulkan projects build with."""

from bokeh_validation.compilers import tool
from bokeh_validation.compilers.result import CompileResult, accepted, refused

INSTALL = "apt-get install -y glslc"


def version() -> str:
    """Version of shaderc. Raises Unavailable."""
    lines = tool.run(tool.find("glslc", INSTALL), ["--version"]).output.splitlines()
    return lines[0] if lines else "unknown"


def build(source: str, stage: str) -> CompileResult:
    """Compile GLSL for Vulkan (`stage`: 'vert' or 'frag') to SPIR-V."""
    arguments = [f"-fshader-stage={stage}", "--target-env=vulkan1.0", "shader.glsl", "-o", "out.spv"]
    done = tool.run(tool.find("glslc", INSTALL), arguments, {"shader.glsl": source.encode("ascii")}, ["out.spv"])
    if not done.ok:
        return refused(done.output)
    binary = done.files.get("out.spv", b"")
    return accepted(done.output, binary, {"bytes": len(binary)})
