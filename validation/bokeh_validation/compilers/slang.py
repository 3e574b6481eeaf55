"""Compile HLSL to SPIR-V, GLSL, WGSL and Metal with Slang, called through its C interface by ctypes.

The library is part of the wheel of slangpy, which has no slangc.
"""

import ctypes
import platform
import struct
import sys
import tempfile
from functools import lru_cache
from pathlib import Path

from bokeh_validation.compilers.tool import CompileResult, accepted, refused
from bokeh_validation.errors import Unavailable
from bokeh_validation.packages import Package
from bokeh_validation.process import once

VERSION = "0.43.1"
RELEASE = "2026.12"  # of Slang, in that version of the package
# Machine -> hash of its wheel. The wheel's Python version does not matter, since the library does not use Python.
WHEELS = {
    "x86_64": "965dbbd1d907c90e17027945780146a67c66baf766f3d0b8af3f52ea2c4a8eb9",
    "aarch64": "d5dbffd31d3ee8488d4b6a6648f78e49bffa055ee3036fde839bef9de57973ff",
}
# Targets of every program, by Slang's names
TARGETS = ("spirv", "glsl", "wgsl", "metal")
STAGES = {"vert": "vertex", "frag": "fragment"}
# Bindings of registers in set 0: the buffer at 0, textures from 1 on, the sampler after the eighth
SHIFTS = ("-fvk-b-shift", "0", "0", "-fvk-t-shift", "1", "0", "-fvk-s-shift", "9", "0")
# Opcode of OpSource in SPIR-V, and its number for HLSL
OP_SOURCE, HLSL = 3, 5
# Slots of a blob's virtual table
SLOT_RELEASE, SLOT_POINTER, SLOT_SIZE = 2, 3, 4


def fetch() -> Path:
    """Return the path of the library, downloading it first if necessary. Raises Unavailable."""
    machine = platform.machine()
    if sys.platform != "linux" or machine not in WHEELS:
        raise Unavailable(f"no Slang library for {sys.platform} {machine} is pinned")
    options = ("--only-binary=:all:", "--platform", f"manylinux_2_34_{machine}", "--python-version", "3.11")
    member = f"slangpy/libslang-compiler.so.0.{RELEASE}"
    return Package("slang", "slangpy", VERSION, WHEELS[machine], options, member).fetch()


@once
def load() -> tuple[ctypes.CDLL, ctypes.c_void_p]:
    """Return the library, downloaded on first use, and a session. Raises Unavailable."""
    try:
        library = ctypes.CDLL(str(fetch()))
    except OSError as error:
        raise Unavailable(f"Slang's library does not load: {error}") from error
    for name in ("spCreateSession", "spCreateCompileRequest"):
        getattr(library, name).restype = ctypes.c_void_p
    library.spGetDiagnosticOutput.restype = ctypes.c_char_p
    session = ctypes.c_void_p(library.spCreateSession(None))
    if not session:
        raise Unavailable("Slang's library gave no session")
    return library, session


def version() -> str:
    """Return the release of Slang. Raises Unavailable."""
    load()
    return RELEASE


def build(source: str, stage: str, entry: str, target: str) -> CompileResult:
    """Compile HLSL to one of TARGETS. `stage` is 'vert' or 'frag'; in the result, texts are UTF-8 in `binary`.

    All targets are compiled together, since most of the time is spent on reading the source. Not thread-safe, since
    there is one session. Raises Unavailable.
    """
    messages, codes = _built(source, stage, entry, TARGETS)
    if not codes:  # any one of the targets may have been rejected
        messages, codes = _built(source, stage, entry, (target,))
    return accepted(messages, codes[target]) if codes.get(target) else refused(messages)


@lru_cache(maxsize=2)
def _built(source: str, stage: str, entry: str, targets: tuple[str, ...]) -> tuple[str, dict[str, bytes]]:
    """Return the compiler's messages and its code for each target; no code if any target was rejected."""
    library, session = load()
    request = ctypes.c_void_p(library.spCreateCompileRequest(session))
    try:
        with tempfile.TemporaryDirectory(prefix="bokeh-") as folder:
            file = Path(folder, "bokeh.hlsl")
            file.write_text(source, encoding="ascii")
            words = [str(file), "-entry", entry, "-fvk-use-entrypoint-name", "-stage", STAGES[stage], *SHIFTS]
            words += [word for target in targets for word in ("-target", target)]
            arguments = (ctypes.c_char_p * len(words))(*(word.encode() for word in words))
            status = library.spProcessCommandLineArguments(request, arguments, ctypes.c_int(len(words)))
            status = status or library.spCompile(request)
            messages = (library.spGetDiagnosticOutput(request) or b"").decode("utf-8", "replace")
            messages = messages.replace(f"{folder}/", "")
        codes = {} if status else {name: _code(library, request, i) for i, name in enumerate(targets)}
    finally:
        library.spDestroyCompileRequest(request)
    if "spirv" in codes:
        codes["spirv"] = without_source_language(codes["spirv"])
    return messages, codes


def _code(library: ctypes.CDLL, request: ctypes.c_void_p, index: int) -> bytes:
    """Return the code for target number `index`, or b"" if there is none."""
    blob, number = ctypes.c_void_p(), ctypes.c_int(index)
    library.spGetTargetCodeBlob(request, number, ctypes.byref(blob))
    if not blob:  # GLSL is generated per entry point
        library.spGetEntryPointCodeBlob(request, ctypes.c_int(0), number, ctypes.byref(blob))
    if not blob:
        return b""

    def call(slot: int, returns: type) -> int:
        table = ctypes.cast(blob, ctypes.POINTER(ctypes.POINTER(ctypes.c_void_p))).contents
        return ctypes.CFUNCTYPE(returns, ctypes.c_void_p)(table[slot])(blob)

    code = ctypes.string_at(call(SLOT_POINTER, ctypes.c_void_p), call(SLOT_SIZE, ctypes.c_size_t))
    call(SLOT_RELEASE, ctypes.c_uint32)
    return code


def without_source_language(module: bytes) -> bytes:
    """Return SPIR-V whose source language is HLSL instead of Slang, a number that older validators reject."""
    words = list(struct.unpack(f"<{len(module) // 4}I", module))
    at = 5
    while at < len(words):
        if words[at] & 0xFFFF == OP_SOURCE:
            words[at + 1] = HLSL
        at += max(words[at] >> 16, 1)
    return struct.pack(f"<{len(words)}I", *words)
