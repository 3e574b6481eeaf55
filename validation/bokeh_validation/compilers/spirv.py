"""What comes after SPIR-V: spirv-val checks a module, spirv-cross turns it into the text of Metal."""

from bokeh_validation import needs
from bokeh_validation.compilers.tool import CompileResult, Tool
from bokeh_validation.shaders import passes

VAL = Tool("spirv-val", needs.install("glslang"))
CROSS = Tool("spirv-cross", needs.install("spirv-cross"), "--revision")

# HLSL's registers on the bindings of the WGSL file, all in set 0
REGISTERS = {"b0": 0, "s0": passes.FIRST_SAMPLER} | {
    f"t{register}": binding for register, binding in enumerate(passes.BINDINGS.values())
}


def validate(binary: bytes, profile: str = "450") -> CompileResult:
    """Check a module by the rules of OpenGL 4.5 for the profile 330, of Vulkan 1.2 for slang, else of Vulkan 1.0."""
    environment = {"330": "opengl4.5", "slang": "vulkan1.2"}.get(profile, "vulkan1.0")
    return VAL.run(["--target-env", environment, "shader.spv"], {"shader.spv": binary})


def msl(binary: bytes) -> CompileResult:
    """The Metal Shading Language of a module; the text is the result's `binary`."""
    return CROSS.run(["shader.spv", "--msl", "--output", "out.txt"], {"shader.spv": binary}, "out.txt")
