"""Process SPIR-V: spirv-val checks a module, spirv-cross translates it to the Metal Shading Language."""

from bokeh_validation import needs
from bokeh_validation.compilers.tool import CompileResult, Tool
from bokeh_validation.shaders import passes

VAL = Tool("spirv-val", needs.install("glslang"))
CROSS = Tool("spirv-cross", needs.install("spirv-cross"), "--revision")

# HLSL's registers -> the bindings of the WGSL file, all in set 0
REGISTERS = {"b0": 0, "s0": passes.FIRST_SAMPLER} | {
    f"t{register}": binding for register, binding in enumerate(passes.BINDINGS.values())
}


def validate(binary: bytes, profile: str = "450") -> CompileResult:
    """Check a module by the rules of OpenGL 4.5 for profile 330, Vulkan 1.2 for slang, and Vulkan 1.0 otherwise."""
    environment = {"330": "opengl4.5", "slang": "vulkan1.2"}.get(profile, "vulkan1.0")
    return VAL.run(["--target-env", environment, "shader.spv"], {"shader.spv": binary})


def msl(binary: bytes) -> CompileResult:
    """Translate a module to the Metal Shading Language; the text is the result's `binary`."""
    return CROSS.run(["shader.spv", "--msl", "--output", "out.txt"], {"shader.spv": binary}, "out.txt")
