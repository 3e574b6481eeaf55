"""Compile HLSL of shader model 6 to SPIR-V and DXIL with Microsoft's DXC, called through its C++ interface by ctypes.

The Linux library is part of the source package of compushady.
"""

import ctypes
import platform
import re
import sys
import uuid
from collections.abc import Sequence
from pathlib import Path

from bokeh_validation import locks
from bokeh_validation.compilers import spirv
from bokeh_validation.compilers.tool import CompileResult, accepted, refused
from bokeh_validation.errors import Unavailable
from bokeh_validation.packages import Package
from bokeh_validation.process import once

VERSION = "0.17.5"
RELEASE = "1.7"  # of DXC, in that version of the package
PACKAGE = Package(
    "dxc",
    "compushady",
    VERSION,
    "5052caf9e955d8e7a48e22f536e82b44b72e83af46e824a9e99157c7809de691",
    ("--no-binary=:all:",),
    f"compushady-{VERSION}/compushady/backends/libdxcompiler_{platform.machine()}.so.3.7",
)

CLSID_COMPILER = uuid.UUID("73e22d93-e6ce-47f3-b5bf-f0664f39c1b0").bytes_le
IID_COMPILER3 = uuid.UUID("228B4687-5A6A-4730-900C-9702B2203F54").bytes_le
IID_RESULT = uuid.UUID("58346CDA-DDE7-4497-9461-6F87AF5E0659").bytes_le
IID_BLOB = uuid.UUID("8BA5FB08-5195-40e2-AC58-0D989C3A0102").bytes_le
OUT_OBJECT, OUT_ERRORS = 1, 2
UTF8 = 65001

# Slots of the virtual tables. Outside Windows, IUnknown also has a virtual destructor, in slots 3 and 4.
SLOT_RELEASE, SLOT_FIRST = 2, 5
# IDxcResult inherits GetStatus and two more methods; GetOutput follows HasOutput. IDxcBlob: pointer, size.
SLOT_OUTPUT = SLOT_FIRST + 4

# Printed for every shader on Linux; it concerns signing for Windows, not the shader.
UNSIGNED = "warning: DXIL.dll not found.  Resulting DXIL will not be signed for use in release environments."


def spirv_options(source: str) -> list[str]:
    """Return the options that bind HLSL's registers as in the WGSL file, all in set 0, if the text names its
    registers.

    If it names none, DXC refuses to bind them. Textures then have the bindings of their registers, followed by the
    samplers.
    """
    if "register(b0)" not in source:
        return ["-spirv", "-fvk-s-shift", str(spirv.REGISTERS["s0"]), "0"]
    bound = (("-fvk-bind-register", name, "0", str(binding), "0") for name, binding in spirv.REGISTERS.items())
    return ["-spirv", *(word for words in bound for word in words)]


class Buffer(ctypes.Structure):
    """Mirror DxcBuffer: pointer, size, code page."""

    _fields_ = [("pointer", ctypes.c_char_p), ("size", ctypes.c_size_t), ("encoding", ctypes.c_uint32)]


def _call(pointer: ctypes.c_void_p, slot: int, *arguments, returns=ctypes.c_int32):
    """Call a method of a COM object by its slot in the virtual table."""
    table = ctypes.cast(pointer, ctypes.POINTER(ctypes.POINTER(ctypes.c_void_p))).contents
    kinds = [type(a) if isinstance(a, ctypes._SimpleCData) else ctypes.c_void_p for a in arguments]
    return ctypes.CFUNCTYPE(returns, ctypes.c_void_p, *kinds)(table[slot])(pointer, *arguments)


def _output(result: ctypes.c_void_p, kind: int) -> bytes:
    blob = ctypes.c_void_p()
    status = _call(result, SLOT_OUTPUT, ctypes.c_uint32(kind), IID_BLOB, ctypes.byref(blob), ctypes.c_void_p(None))
    if status or not blob:
        return b""
    start = _call(blob, SLOT_FIRST, returns=ctypes.c_void_p)
    size = _call(blob, SLOT_FIRST + 1, returns=ctypes.c_size_t)
    data = ctypes.string_at(start, size) if start and size else b""
    _call(blob, SLOT_RELEASE, returns=ctypes.c_uint32)
    return data


def fetch() -> Path:
    """Return the path of the library, downloading it first if necessary. Raises Unavailable."""
    if sys.platform != "linux" or platform.machine() not in ("x86_64", "aarch64"):
        raise Unavailable(f"no DXC library for {sys.platform} {platform.machine()} in {PACKAGE.name} {VERSION}")
    return PACKAGE.fetch()


@once
def load() -> ctypes.c_void_p:
    """Return the library's compiler object; the library is downloaded on first use. Raises Unavailable."""
    library, program, instance = ctypes.CDLL(str(fetch())), ctypes.CDLL(None), ctypes.c_void_p()
    # If Mesa's LLVM is loaded too, the library's clean-up at exit waits forever for a lock that is gone, or aborts a
    # process that had succeeded. So the process exits before that clean-up: GNU's on_exit calls its handlers with the
    # exit status, which _exit takes.
    if hasattr(program, "on_exit"):
        program.on_exit(program._exit, None)
    status = library.DxcCreateInstance(CLSID_COMPILER, IID_COMPILER3, ctypes.byref(instance))
    if status or not instance:
        raise Unavailable(f"libdxcompiler gave no compiler (status {status & 0xFFFFFFFF:08x})")
    return instance


def version() -> str:
    """Return the release of DXC. Raises Unavailable."""
    load()
    return RELEASE


def build(source: str, stage: str, entry: str, to_spirv: bool = True) -> CompileResult:
    """Compile HLSL of shader model 6 to SPIR-V or DXIL. `stage` is 'vert' or 'frag'. Raises Unavailable.

    Not thread-safe, since there is one compiler object.
    """
    profile = {"vert": "vs_6_0", "frag": "ps_6_0"}[stage]
    return _compile(source, ["-T", profile, "-E", entry, *(spirv_options(source) if to_spirv else ())])


def kept_spirv(source: str, stage: str, entry: str) -> bytes:
    """Return the SPIR-V of a program that must compile, cached in the cache folder.

    Raises RuntimeError with DXC's messages if it rejects the program, and Unavailable.
    """

    def make() -> bytes:
        result = build(source, stage, entry)
        if not result.ok:
            raise RuntimeError(f"DXC refused {entry}:\n{result.messages}")
        return result.binary

    options = " ".join(spirv_options(source))
    return locks.kept("bytecode", f".{stage}.spv", (VERSION, options, stage, entry, source), make).read_bytes()


def command(words: Sequence[str]) -> str | None:
    """Run DXC's command line as far as `OPTIONS -Fo OUTPUT INPUT`; returns its messages if it rejects the input, else
    None.

    Raises Unavailable.
    """
    *options, _, output, file = words

    def included(match: re.Match) -> str:
        return Path(file).parent.joinpath(match[1]).read_text(encoding="ascii")

    text = Path(file).read_text(encoding="ascii")
    result = _compile(re.sub(r'^#include "(.*)"', included, text, flags=re.MULTILINE), options)
    Path(output).write_bytes(result.binary)
    return None if result.ok else result.messages


def _compile(source: str, options: Sequence[str]) -> CompileResult:
    options = ["bokeh.hlsl", *options]
    arguments = ((ctypes.c_wchar_p * len(options))(*options), ctypes.c_uint32(len(options)))
    data = source.encode("ascii")
    buffer, result = Buffer(data, len(data), UTF8), ctypes.c_void_p()
    compile_arguments = (ctypes.byref(buffer), *arguments, ctypes.c_void_p(None), IID_RESULT, ctypes.byref(result))
    status = _call(load(), SLOT_FIRST, *compile_arguments)
    if status or not result:
        return refused(f"Compile() failed with status {status & 0xFFFFFFFF:08x}")
    outcome = ctypes.c_int32()
    _call(result, SLOT_FIRST, ctypes.byref(outcome))
    lines = _output(result, OUT_ERRORS).rstrip(b"\0").decode("utf-8", "replace").splitlines()
    messages = "\n".join(line for line in lines if line.strip() != UNSIGNED)
    binary = _output(result, OUT_OBJECT)
    _call(result, SLOT_RELEASE, returns=ctypes.c_uint32)
    return accepted(messages, binary) if outcome.value == 0 else refused(messages)
