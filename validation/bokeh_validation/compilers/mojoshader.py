"""MojoShader: translates Direct3D 9 bytecode for other APIs, as FNA and its games do at run time."""

import ctypes

from bokeh_validation.compilers.tool import CompileResult, accepted, once, refused
from bokeh_validation.errors import Unavailable

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


@once
def load() -> ctypes.CDLL:
    """The library. Raises Unavailable."""
    for name in LIBRARIES:
        try:
            library = ctypes.CDLL(name)
        except OSError:
            continue
        library.MOJOSHADER_parse.restype = ctypes.POINTER(ParseData)
        library.MOJOSHADER_changeset.restype = ctypes.c_char_p
        return library
    raise Unavailable("libmojoshader is not on this machine; apt-get install -y libmojoshader-dev")


def version() -> str:
    """Its Mercurial changeset. Raises Unavailable."""
    return (load().MOJOSHADER_changeset() or b"unknown").decode().replace("???", "unknown changeset")


def build(bytecode: bytes) -> CompileResult:
    """Translate ps_3_0 or vs_3_0 to all of TARGETS. Raises Unavailable.

    The facts are MojoShader's instruction count and the bytes of each output.
    """
    library = load()
    facts: dict[str, object] = {}
    for target in TARGETS:
        nothing = (None, 0, None, 0, None, None, None)  # no other names, no allocator
        parsed = library.MOJOSHADER_parse(target.encode(), b"main", bytecode, len(bytecode), *nothing)
        data = parsed.contents
        errors = [f"{target} at byte {e.position}: {e.text.decode()}" for e in data.errors[: data.error_count]]
        facts |= {"instructions": data.instruction_count, target: data.output_len if data.output else 0}
        library.MOJOSHADER_freeParseData(parsed)
        if errors or not facts[target]:
            return refused("\n".join(errors) or f"{target}: nothing came out")
    return accepted("", b"", facts)
