"""The GLSL files as syntax trees: after a small preparation a function of GLSL is one of C, which pycparser reads."""

import re
from collections.abc import Mapping
from functools import cache
from typing import NamedTuple

from pycparser import c_ast, c_parser

from bokeh_validation import paths, shaders

TYPES = ("float", "int", "bool", "vec2", "vec3", "vec4", "BOKEH_TEXTURE", "BOKEH_DEPTH_TEXTURE")


class Function(NamedTuple):
    """A function of the shaders; the names of its parameters in order."""

    name: str
    parameters: tuple[str, ...]
    body: c_ast.Compound


@cache
def functions() -> Mapping[str, Function]:
    """By name: those of all files but main()."""
    matches = shaders.FUNCTION.finditer(shaders.text("glsl"))
    return {match["name"]: _parsed(match) for match in matches if match["name"] not in ("main", *TEXELS)}


# what reads texels by their numbers: section [2], the porting
TEXELS = ("BokehFetchTexel", "BokehFetchDepth")


@cache
def main(entry: str) -> Function:
    """main() of one of entries.ENTRIES."""
    text = shaders.text("glsl")
    head = rf"^#(?:el)?if BOKEH_PASS == {shaders.glsl_pass(entry)}\n\n"
    return _parsed(shaders.FUNCTION.search(text, re.search(head, text, re.MULTILINE).end()))


@cache
def constants() -> Mapping[str, float | int]:
    """The defaults of the configuration."""
    found = {}
    for stem in paths.STEMS:
        found |= shaders.settings("glsl", shaders.file_text("glsl", stem))
    return {name: float(value) if "." in value else int(value) for name, value in found.items()}


@cache
def structs() -> frozenset[str]:
    """Their names."""
    return frozenset(re.findall(r"^struct (\w+)$", shaders.text("glsl"), re.MULTILINE))


def _parsed(function: re.Match) -> Function:
    """A constructor, `vec2(...)`, is a type where C wants a function: it gets another name."""
    text = shaders.COMMENT.sub("", f"{function['head']}\n{function['body']}")
    # every file is there
    text = re.sub(r"^#.*\n", "", text, flags=re.MULTILINE)
    text = re.sub(rf"\b({'|'.join(TYPES)})\(", r"new_\1(", text)
    types = (*TYPES[2:], *structs())
    typedefs = "".join(f"typedef float {name};\n" for name in types)
    definition = c_parser.CParser().parse(typedefs + text).ext[-1]
    arguments = definition.decl.type.args
    parameters = tuple(item.name for item in arguments.params) if arguments else ()
    return Function(function["name"], parameters, definition.body)
