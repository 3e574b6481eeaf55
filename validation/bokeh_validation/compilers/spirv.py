"""What comes after SPIR-V: spirv-val checks a module, spirv-cross turns it into the text of Metal."""

from bokeh_validation.compilers.tool import CompileResult, Tool
from bokeh_validation.shaders import passes

VAL = Tool("spirv-val", "apt-get install -y spirv-tools", "--version", r"^SPIRV-Tools (\S+)")
CROSS = Tool("spirv-cross", "apt-get install -y spirv-cross", "--revision", r"^(.*)")

# HLSL's registers on the bindings of the WGSL file, all in set 0
REGISTERS = {"b0": 0, "s0": passes.FIRST_SAMPLER} | {
    f"t{register}": binding for register, binding in enumerate(passes.BINDINGS.values())
}

OPENGL_RULES, VULKAN_RULES = "opengl4.5", "vulkan1.0"


def validate(binary: bytes, environment: str = VULKAN_RULES) -> CompileResult:
    """Check a module against the rules of an environment that spirv-val knows."""
    return VAL.compile(["--target-env", environment, "shader.spv"], {"shader.spv": binary})


def msl(binary: bytes) -> CompileResult:
    """The Metal Shading Language of a module; the text is the result's `binary`."""
    return CROSS.compile(["shader.spv", "--msl", "--output", "out.txt"], {"shader.spv": binary}, "out.txt")
