"""The GLSL library as syntax trees: after a small preparation it is C, which pycparser reads."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

from pycparser import c_ast, c_parser

from bokeh_validation import paths, shaders
from bokeh_validation.listing import syntax

TYPES = ("bool", "vec2", "vec3", "vec4", "mat4", "sampler2D")
CONSTRUCTORS = ("float", "int", *TYPES)
_TYPEDEFS = "".join(f"typedef float {name};\n" for name in TYPES)
_DEFINE = re.compile(r"#define (BOKEH_\w+) ([\d.]+)$")
# sections of the library that hold formulas; [1] and [2] are configuration and porting
FORMULAS = range(3, 10)


@dataclass(frozen=True)
class Function:
    """A function of the shaders.

    section     number of its section; 0 for main() of a pass
    parameters  name -> type, in order
    body        syntax tree
    """

    name: str
    section: int
    parameters: Mapping[str, str]
    body: c_ast.Compound

    @property
    def locals(self) -> tuple[str, ...]:
        """Names of its local variables of a floating type, in the order of the text."""
        found = _Declarations()
        found.visit(self.body)
        return tuple(dict.fromkeys(found.names))


class _Declarations(c_ast.NodeVisitor):
    def __init__(self) -> None:
        self.names: list[str] = []

    def visit_Decl(self, node: c_ast.Decl) -> None:
        if type_name(node) not in ("int", "bool"):
            self.names.append(node.name)


def type_name(node: c_ast.Decl) -> str:
    """Type of a declaration as GLSL names it."""
    return node.type.type.names[0]


@cache
def library() -> Mapping[str, Function]:
    """Every function of sections [3] to [9] of glsl/bokeh.glsl by name, in the order of the text."""
    found: dict[str, Function] = {}
    _, sections = syntax.sections(syntax.tokenize(paths.library("glsl").read_text(encoding="ascii")))
    for section in sections:
        if section.number in FORMULAS:
            for item in section.items:
                if item.kind == "function":
                    parsed = _parsed(item.code, section.number)
                    found[parsed.name] = parsed
    return found


@cache
def main(entry: str) -> Function:
    """main() of one of shaders.ENTRIES, from glsl/bokeh_passes.glsl."""
    text = paths.passes("glsl").read_text(encoding="ascii")
    head = rf"^#(?:el)?if BOKEH_PASS == {shaders.glsl_pass(entry)}\n\n(?://[^\n]*\n)*"
    part = re.search(head + r"(void main.*?)^#", text, re.MULTILINE | re.DOTALL)
    if part is None:
        raise KeyError(f"glsl/bokeh_passes.glsl has no pass {entry}")
    return _parsed([token for token in syntax.tokenize(part[1]) if token.kind != "comment"], 0)


@cache
def constants() -> Mapping[str, float | int]:
    """Section [1]: the defaults of the library's defines."""
    tokens = syntax.tokenize(paths.library("glsl").read_text(encoding="ascii"))
    found = (_DEFINE.match(token.text) for token in tokens if token.kind == "directive")
    return {item[1]: float(item[2]) if "." in item[2] else int(item[2]) for item in found if item}


def _parsed(tokens: Sequence[syntax.Token], section: int) -> Function:
    """A constructor, `vec2(...)`, is a type where C wants a function: it gets another name."""
    words = []
    for token, following in zip(tokens, [*tokens[1:], None], strict=True):
        construct = token.text in CONSTRUCTORS and following is not None and following.text == "("
        words.append(f"new_{token.text}" if construct else token.text)
    (definition,) = c_parser.CParser().parse(_TYPEDEFS + " ".join(words)).ext[len(TYPES) :]
    arguments = definition.decl.type.args
    parameters = {item.name: type_name(item) for item in arguments.params} if arguments else {}
    return Function(definition.decl.name, section, parameters, definition.body)
