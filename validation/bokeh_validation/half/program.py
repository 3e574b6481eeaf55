"""The GLSL library as syntax trees: after a small preparation it is C, which pycparser reads."""

import re
from collections.abc import Mapping
from functools import cache
from typing import NamedTuple

from pycparser import c_ast, c_parser

from bokeh_validation import paths, shaders

TYPES = ("bool", "vec2", "vec3", "vec4", "sampler2D")
INTEGERS = ("int", "bool")
# sections of the library that hold formulas; [1] and [2] are configuration and porting
FORMULAS = range(3, 10)


class Function(NamedTuple):
    """A function of the shaders; parameters: name -> type, in order."""

    name: str
    parameters: Mapping[str, str]
    body: c_ast.Compound


def type_name(node: c_ast.Decl) -> str:
    """Type of a declaration as GLSL names it."""
    return node.type.type.names[0]


@cache
def structs() -> Mapping[str, Mapping[str, str]]:
    """Name -> member -> type."""
    found = re.finditer(r"^struct (\w+)\n\{\n(.*?)^\};", _library(), re.MULTILINE | re.DOTALL)
    return {one[1]: {name: kind for kind, name in re.findall(r"(\w+) (\w+);", one[2])} for one in found}


@cache
def library() -> Mapping[str, Function]:
    """Every function of sections [3] to [9] of glsl/bokeh.glsl by name, in the order of the text."""
    text = shaders.sections(_library())
    return _functions("\n".join(text[number] for number in FORMULAS))


@cache
def helpers() -> Mapping[str, Function]:
    """The functions of glsl/bokeh_passes.glsl that its entries call, without those of the layered method."""
    text = re.sub(r"^#ifdef BOKEH_LAYERS\n.*?^#endif\n", "", _passes(), flags=re.MULTILINE | re.DOTALL)
    return _functions(text, but="main")


@cache
def main(entry: str) -> Function:
    """main() of one of entries.ENTRIES, from glsl/bokeh_passes.glsl."""
    head = rf"^#(?:el)?if BOKEH_PASS == {shaders.glsl_pass(entry)}\n\n"
    branch = re.search(head, _passes(), re.MULTILINE)
    if branch is None:
        raise KeyError(f"glsl/bokeh_passes.glsl has no pass {entry}")
    return _parsed(shaders.FUNCTION.search(_passes(), branch.end()))


@cache
def constants() -> Mapping[str, float | int]:
    """Section [1]: the defaults of the library's defines."""
    found = shaders.settings("glsl", _library())
    return {name: float(value) if "." in value else int(value) for name, value in found.items()}


def _library() -> str:
    return paths.library("glsl").read_text(encoding="ascii")


def _passes() -> str:
    return paths.passes("glsl").read_text(encoding="ascii")


def _functions(text: str, but: str = "") -> Mapping[str, Function]:
    return {one["name"]: _parsed(one) for one in shaders.FUNCTION.finditer(text) if one["name"] != but}


def _parsed(function: re.Match) -> Function:
    """A constructor, `vec2(...)`, is a type where C wants a function: it gets another name."""
    text = shaders.COMMENT.sub("", f"{function['head']}\n{function['body']}")
    text = re.sub(rf"\b({'|'.join(('float', 'int', *TYPES))})\(", r"new_\1(", text)
    types = (*TYPES, *structs())
    typedefs = "".join(f"typedef float {name};\n" for name in types)
    (definition,) = c_parser.CParser().parse(typedefs + text).ext[len(types) :]
    arguments = definition.decl.type.args
    parameters = {item.name: type_name(item) for item in arguments.params} if arguments else {}
    return Function(definition.decl.name, parameters, definition.body)
