"""SPIR-V: what a module holds, and what comes after it: spirv-val checks it, spirv-cross turns it into text."""

import shutil
import struct
from collections import Counter

from bokeh_validation.compilers.tool import CompileResult, Tool, run
from bokeh_validation.shaders import passes

VAL = Tool("spirv-val", "spirv-tools", "--version", r"^SPIRV-Tools (\S+)")
CROSS = Tool("spirv-cross", "spirv-cross", "--revision", r"^(.*)")

# HLSL's registers on the bindings of the WGSL file, all in set 0
REGISTERS = {"b0": 0, "s0": passes.FIRST_SAMPLER} | {
    f"t{register}": binding for register, binding in enumerate(passes.BINDINGS.values())
}

OPENGL_RULES, VULKAN_RULES = "opengl4.5", "vulkan1.0"
# spirv-cross options by the name of the target
TARGETS = {
    "essl300": ("--es", "--version", "300"),
    "essl310": ("--es", "--version", "310"),
    "msl": ("--msl",),
    "hlsl50": ("--hlsl", "--shader-model", "50"),
}

MAGIC = 0x07230203
HEADER = 5  # words
# opcodes of the SPIR-V specification, section 3.42
IMPLICIT_LOD = (87, 89, 91, 93)  # OpImageSample[Dref|Proj|ProjDref]ImplicitLod
EXPLICIT_LOD = (88, 90, 92, 94)  # ...ExplicitLod
FETCH = 95  # OpImageFetch
LOOP_MERGE = 246  # OpLoopMerge: one for each loop


def facts(binary: bytes) -> dict[str, object]:
    """Counts of a module as it is written: a loop's body, or a function's, counts once.

    bytes         size of the module
    instructions  all of them, declarations too
    samples       texture samples and fetches
    implicit_lod  those of them whose level comes from derivatives
    loops         loops
    """
    found = Counter(opcodes(binary))
    implicit = sum(found[code] for code in IMPLICIT_LOD)
    return {
        "bytes": len(binary),
        "instructions": found.total(),
        "samples": implicit + sum(found[code] for code in (*EXPLICIT_LOD, FETCH)),
        "implicit_lod": implicit,
        "loops": found[LOOP_MERGE],
    }


def opcodes(binary: bytes) -> list[int]:
    """Opcode of every instruction. Raises ValueError where the words are not a SPIR-V module."""
    words = struct.unpack(f"<{len(binary) // 4}I", binary[: len(binary) // 4 * 4])
    if len(words) < HEADER or words[0] != MAGIC:
        raise ValueError("not SPIR-V (no magic number)")
    found = []
    index = HEADER
    while index < len(words):
        length, opcode = words[index] >> 16, words[index] & 0xFFFF
        if length == 0:
            raise ValueError(f"not SPIR-V (instruction of length 0 at word {index})")
        found.append(opcode)
        index += length
    return found


def version_cross() -> str:
    """Version of spirv-cross. Raises Unavailable."""
    said = CROSS.version()
    # Debian's build says only that it is Debian's
    if "Debian" in said and shutil.which("dpkg-query"):
        package = run("dpkg-query", ["-W", "-f=${Version}", "spirv-cross"])
        said = package.output if package.ok else said
    return said


def validate(binary: bytes, environment: str = VULKAN_RULES) -> CompileResult:
    """Check a module against the rules of an environment that spirv-val knows."""
    return VAL.compile(["--target-env", environment, "shader.spv"], {"shader.spv": binary})


def cross(binary: bytes, target: str) -> CompileResult:
    """Turn a module into another language, one of TARGETS; the text is the result's `binary`."""
    return CROSS.compile(["shader.spv", *TARGETS[target], "--output", "out.txt"], {"shader.spv": binary}, "out.txt")
