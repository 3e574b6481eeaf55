"""What a SPIR-V module holds, counted from its words."""

import struct
from collections import Counter

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
