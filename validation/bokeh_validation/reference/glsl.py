"""The GLSL files as syntax trees: after a small preparation a function of GLSL is one of C, which pycparser reads."""

import re
from collections.abc import Mapping
from functools import cache, cached_property, lru_cache
from typing import NamedTuple

from pycparser import c_ast, c_parser

from bokeh_validation import shaders

TYPES = ("float", "int", "bool", "vec2", "vec3", "vec4", "BOKEH_TEXTURE", "BOKEH_DEPTH_TEXTURE")
# what reads texels by their numbers: section [2], the porting
TEXELS = ("BokehFetchTexel", "BokehFetchDepth")


class Function(NamedTuple):
    """A function of the shaders; the names of its parameters in order."""

    name: str
    parameters: tuple[str, ...]
    body: c_ast.Compound


class Library:
    """What the interpreter runs: the text of all files, whose functions are parsed when they are first called."""

    def __init__(self, text: str):
        self.text = text
        self.function, self.main = cache(self._function), cache(self._main)

    @cached_property
    def _found(self) -> Mapping[str, re.Match]:
        matches = shaders.FUNCTION.finditer(self.text)
        return {match["name"]: match for match in matches if match["name"] not in ("main", *TEXELS)}

    def _function(self, name: str) -> Function:
        """One of those of all files but main()."""
        return self._parsed(self._found[name])

    def _main(self, entry: str) -> Function:
        """main() of one of entries.ENTRIES. Raises KeyError where this text has no such entry."""
        head = re.search(rf"^#(?:el)?if BOKEH_PASS == {shaders.glsl_pass(entry)}\n\n", self.text, re.MULTILINE)
        if not head:
            raise KeyError(entry)
        return self._parsed(shaders.FUNCTION.search(self.text, head.end()))

    @cached_property
    def constants(self) -> Mapping[str, float | int]:
        """The defaults of the configuration."""
        found = shaders.settings("glsl", self.text)
        return {name: float(value) if "." in value else int(value) for name, value in found.items()}

    @cached_property
    def structs(self) -> frozenset[str]:
        """Their names."""
        return frozenset(re.findall(r"^struct (\w+)$", self.text, re.MULTILINE))

    def _parsed(self, function: re.Match) -> Function:
        """A constructor, `vec2(...)`, is a type where C wants a function: it gets another name."""
        text = shaders.COMMENT.sub("", f"{function['head']}\n{function['body']}")
        # every file is there
        text = re.sub(r"^#.*\n", "", text, flags=re.MULTILINE)
        text = re.sub(rf"\b({'|'.join(TYPES)})\(", r"new_\1(", text)
        types = (*TYPES[2:], *self.structs)
        typedefs = "".join(f"typedef float {name};\n" for name in types)
        definition = c_parser.CParser().parse(typedefs + text).ext[-1]
        arguments = definition.decl.type.args
        parameters = tuple(item.name for item in arguments.params) if arguments else ()
        return Function(function["name"], parameters, definition.body)


@lru_cache(maxsize=4)
def library(text: str) -> Library:
    """That of a text."""
    return Library(text)
