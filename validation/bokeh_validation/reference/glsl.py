"""Parse the GLSL files into syntax trees: after small changes, a GLSL function is a C function, which
pycparser reads.
"""

import re
from collections.abc import Mapping
from functools import cache, cached_property, lru_cache
from typing import NamedTuple

from pycparser import c_ast, c_parser

from bokeh_validation import shaders

TYPES = ("float", "int", "bool", "vec2", "vec3", "vec4", "BOKEH_TEXTURE", "BOKEH_DEPTH_TEXTURE")
# functions that fetch texels by their coordinates: section [2], the porting layer
TEXELS = ("BokehFetchTexel", "BokehFetchDepth")


class Function(NamedTuple):
    """Hold a function of the shaders with the names of its parameters in order."""

    name: str
    parameters: tuple[str, ...]
    body: c_ast.Compound


class Library:
    """Hold the text of all GLSL files for the interpreter; a function is parsed on its first call."""

    def __init__(self, text: str):
        self.text = text
        self.function, self.main = cache(self._function), cache(self._main)

    @cached_property
    def _found(self) -> Mapping[str, re.Match]:
        matches = shaders.FUNCTION.finditer(self.text)
        return {match["name"]: match for match in matches if match["name"] not in ("main", *TEXELS)}

    def _function(self, name: str) -> Function:
        """Parse a function other than main()."""
        return self._parsed(self._found[name])

    def _main(self, entry: str) -> Function:
        """Parse main() of one of entries.ENTRIES. Raises KeyError if the text has no such entry."""
        head = re.search(rf"^#(?:el)?if BOKEH_PASS == {shaders.glsl_pass(entry)}\n\n", self.text, re.MULTILINE)
        if not head:
            raise KeyError(entry)
        return self._parsed(shaders.FUNCTION.search(self.text, head.end()))

    @cached_property
    def constants(self) -> Mapping[str, float | int]:
        """Return the default values of the configuration."""
        found = shaders.settings("glsl", self.text)
        return {name: float(value) if "." in value else int(value) for name, value in found.items()}

    @cached_property
    def structs(self) -> frozenset[str]:
        """Return the names of the structs."""
        return frozenset(re.findall(r"^struct (\w+)$", self.text, re.MULTILINE))

    def _parsed(self, function: re.Match) -> Function:
        """Parse a function as C.

        A constructor, `vec2(...)`, would be a type where C expects a function, so it is renamed to `new_vec2(...)`.
        """
        text = shaders.COMMENT.sub("", f"{function['head']}\n{function['body']}")
        # all files are in the text, so its # lines can be dropped
        text = re.sub(r"^#.*\n", "", text, flags=re.MULTILINE)
        # the reference has one precision
        text = re.sub(r"\bBOKEH_(?:TO_)?HALF(\d)\b", r"vec\1", text)
        text = re.sub(rf"\b({'|'.join(TYPES)})\(", r"new_\1(", text)
        types = (*TYPES[2:], *self.structs)
        typedefs = "".join(f"typedef float {name};\n" for name in types)
        definition = c_parser.CParser().parse(typedefs + text).ext[-1]
        arguments = definition.decl.type.args
        parameters = tuple(parameter.name for parameter in arguments.params) if arguments else ()
        return Function(function["name"], parameters, definition.body)


@lru_cache(maxsize=4)
def library(text: str) -> Library:
    """Return the library of a text, cached."""
    return Library(text)
