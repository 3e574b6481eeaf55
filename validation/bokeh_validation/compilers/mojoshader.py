"""MojoShader: translates Direct3D 9 bytecode for other APIs, as FNA and its games do at run time."""

import ctypes
from functools import cache

from bokeh_validation.compilers.result import CompileResult, accepted, refused
from bokeh_validation.errors import Unavailable

INSTALL = "apt-get install -y libmojoshader-dev"
LIBRARIES = ("libmojoshader.so", "libmojoshader.so.0")
# what the bytecode is turned into; the shader is ok when all of them come out
TARGETS = ("glsl120", "spirv", "metal")


class Error(ctypes.Structure):
    """MOJOSHADER_error."""

    _fields_ = [("text", ctypes.c_char_p), ("file", ctypes.c_char_p), ("position", ctypes.c_int)]


class ParseData(ctypes.Structure):
    """The beginning of MOJOSHADER_parseData; the rest is not looked at."""

    _fields_ = [
        ("error_count", ctypes.c_int),
        ("errors", ctypes.POINTER(Error)),
        ("profile", ctypes.c_char_p),
        ("output", ctypes.c_void_p),
        ("output_len", ctypes.c_int),
        ("instruction_count", ctypes.c_int),
    ]


@cache
def load() -> ctypes.CDLL:
    """The library. Raises Unavailable."""
    for name in LIBRARIES:
        try:
            library = ctypes.CDLL(name)
        except OSError:
            continue
        library.MOJOSHADER_parse.restype = ctypes.POINTER(ParseData)
        library.MOJOSHADER_parse.argtypes = [
            ctypes.c_char_p, ctypes.c_char_p, ctypes.c_char_p, ctypes.c_uint, ctypes.c_void_p, ctypes.c_uint,
            ctypes.c_void_p, ctypes.c_uint, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p,
        ]  # fmt: skip
        library.MOJOSHADER_freeParseData.argtypes = [ctypes.POINTER(ParseData)]
        library.MOJOSHADER_changeset.restype = ctypes.c_char_p
        return library
    raise Unavailable(f"libmojoshader is not on this machine; {INSTALL}")


def version() -> str:
    """Its Mercurial changeset. Raises Unavailable."""
    return (load().MOJOSHADER_changeset() or b"unknown").decode().replace("???", "unknown changeset")


def translate(bytecode: bytes, target: str) -> CompileResult:
    """Translate ps_3_0 or vs_3_0 bytecode to one of MojoShader's profiles. Raises Unavailable."""
    library = load()
    parsed = library.MOJOSHADER_parse(
        target.encode(), b"main", bytecode, len(bytecode), None, 0, None, 0, None, None, None
    )
    data = parsed.contents
    errors = [f"{target} at byte {e.position}: {e.text.decode()}" for e in data.errors[: data.error_count]]
    output = ctypes.string_at(data.output, data.output_len) if data.output and data.output_len > 0 else b""
    instructions = data.instruction_count
    library.MOJOSHADER_freeParseData(parsed)
    if errors:
        return refused("\n".join(errors))
    if not output:
        return refused(f"{target}: nothing came out")
    return accepted("", output, {"instructions": instructions, "bytes": len(output)})


def build(bytecode: bytes) -> CompileResult:
    """Translate to all of TARGETS; the facts are MojoShader's instruction count and the bytes of each output."""
    facts: dict[str, object] = {}
    for target in TARGETS:
        result = translate(bytecode, target)
        if not result.ok:
            return result
        facts["instructions"] = result.facts["instructions"]
        facts[target] = result.facts["bytes"]
    return accepted("", b"", facts)
