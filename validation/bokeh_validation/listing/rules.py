"""What every shader file has to keep on its own, whatever the other languages do."""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import bokeh_validation
from bokeh_validation.listing.normal import Function, split
from bokeh_validation.listing.syntax import Item, Token, items, matching, tokenize

MAX_LINE = 120
SPDX = "// SPDX-License-Identifier: MIT"
VERSION = re.compile(r"\bVersion (\d+\.\d+\.\d+)\.")
PREFIX = re.compile(r"Bokeh|BOKEH_|bokeh")

# Everything that reads or asks a texture, or needs derivatives. BokehFetch is the one place for it.
SAMPLING = re.compile(
    r"tex(1D|2D|3D|CUBE)\w*|texture\w*|texel\w*|shadow[12]D\w*|image(Load|Store|Size)\w*|Sample\w*|Gather\w*|Load\w*"
    r"|GetDimensions|CalculateLevelOfDetail\w*|dd[xy](_\w+)?|dFd[xy]\w*|dpd[xy]\w*|fwidth\w*",
    re.ASCII,
)
BIT_OPERATORS = ("&", "|", "^", "~", "<<", ">>", "&=", "|=", "^=", "<<=", ">>=")
ASSIGNMENTS = ("=", "+=", "-=", "*=", "/=", "%=", "++", "--")
SWIZZLE = re.compile(r"[xyzw]{2,4}|[rgba]{2,4}|[stpq]{2,4}")

# (line, what, text of the line)
Finding = tuple[int, str, str]


def text_findings(text: str) -> Iterator[Finding]:
    """Rules on characters and lines."""
    lines = text.split("\n")
    for number, line in enumerate(lines, 1):
        strange = [character for character in line if not (" " <= character <= "~" or character in "\t\r")]
        if strange:
            yield number, f"character {ascii(strange[0])}: ASCII only", line
        if "\t" in line:
            yield number, "a tab", line
        if "\r" in line:
            yield number, "a carriage return", line
        if line.rstrip().endswith("\\"):
            yield number, "a backslash at the end of a line: GLSL would join the next one to it", line
        if len(line) > MAX_LINE:
            yield number, f"{len(line)} characters in a line, {MAX_LINE} at most", line
    if lines[0] != SPDX:
        yield 1, f"the first line is not {SPDX!r}", lines[0]
    if lines[-1]:
        yield len(lines), "no line end at the end of the file: the next one is put right behind it", lines[-1]
    yield from _version_findings(lines)


def _version_findings(lines: Sequence[str]) -> Iterator[Finding]:
    header = next((i for i, line in enumerate(lines) if not line.startswith("//")), len(lines))
    found = [(i + 1, match[1]) for i, line in enumerate(lines[:header]) for match in VERSION.finditer(line)]
    if len(found) != 1:
        yield 1, f"{len(found)} times 'Version x.y.z.' in the header, once is right", ""
    for number, version in found:
        if version != bokeh_validation.__version__:
            yield number, f"not the version of the package, {bokeh_validation.__version__}", lines[number - 1]


def token_findings(tokens: Iterable[Token]) -> Iterator[Finding]:
    """Text that cannot be compared."""
    for token in tokens:
        if token.kind == "unknown":
            yield token.line, f"character {ascii(token.text)} belongs to no token", token.text
        if token.text.startswith("/*"):
            yield token.line, "a block comment: use //", token.text.split("\n")[0]


def name_findings(top: Sequence[Item], language: str, exempt: Sequence[str] = ()) -> Iterator[Finding]:
    """Names of functions, globals, blocks and macros that could clash with an engine's."""
    for item in top:
        for token in declared(item, language):
            if not PREFIX.match(token.text) and token.text not in exempt:
                yield token.line, f"{token.text} does not begin with Bokeh, BOKEH_ or bokeh", token.text
        if item.kind == "broken":
            yield item.line, "brackets that do not match, or a declaration without end", item.tokens[0].text


def declared(item: Item, language: str) -> list[Token]:
    """Tokens of the names that a top-level item brings into the world."""
    if item.kind == "directive":
        words = tokenize(item.tokens[0].text[1:])
        named = len(words) > 1 and words[0].text in ("define", "undef")
        return [replace(words[1], line=item.line)] if named else []
    if item.kind not in ("function", "block", "declaration", "call") or not item.code:
        return []
    return _wgsl_names(item.code) if language == "wgsl" else _c_names(item)


def _wgsl_names(code: Sequence[Token]) -> list[Token]:
    """`fn name`, `const name`, `var<uniform> name`, `struct name` ..., behind any attributes."""
    for index, token in enumerate(code):
        if token.text in ("fn", "var", "let", "const", "override", "struct", "alias"):
            rest = code[index + 1 :]
            closing = next((i for i, other in enumerate(rest) if other.text == ">"), -1)
            return [*rest[closing + 1 :][:1]] if rest[0].text == "<" else [rest[0]]
    return []


def _c_names(item: Item) -> list[Token]:
    code = list(item.code)
    if item.kind == "call":  # BOKEH_PARAMETER(type, name): the macro declares its second argument
        inner = [token for token in code if token.kind == "name"]
        return inner[2:3] if inner[0].text == "BOKEH_PARAMETER" else inner[:1]
    if code[0].text == "precision":
        return []
    if code[0].text == "layout":
        code = code[(matching(code, 1) or 0) + 1 :]
    if item.kind == "function":
        opening = next((i for i, token in enumerate(code) if token.text == "("), 0)
        return [code[opening - 1]] if opening else []
    if item.kind == "block":
        members = [] if code[0].text == "struct" else block_items(item)
        return [code[1], *(name for member in members for name in declared(member, "hlsl"))]
    return _declarators(code)


def _declarators(code: Sequence[Token]) -> list[Token]:
    """Names in `qualifiers type name[2] : register(x), name2 = value;`: the last one before what qualifies it."""
    names: list[Token] = []
    for part in split(code):
        end = next((i for i, token in enumerate(part) if token.text in (":", "=", "[", "(", "{", ";")), len(part))
        named = [token for token in part[:end] if token.kind == "name"]
        names += named[-1:]
    return names


def block_items(item: Item) -> list[Item]:
    """Members of a struct, buffer or interface block as items."""
    opening = next(i for i, token in enumerate(item.tokens) if token.text == "{")
    end = matching(item.tokens, opening) or len(item.tokens)
    return items(item.tokens[opening + 1 : end])


def sampling_findings(function: Function) -> Iterator[Finding]:
    """Texture access and derivatives in a function: only BokehFetch may."""
    for token in function.tokens:
        if token.kind == "name" and SAMPLING.fullmatch(token.text):
            yield token.line, f"{token.text} in {function.name}: only BokehFetch reads a texture", token.text


def portable_findings(function: Function) -> Iterator[Finding]:
    """What not every language can say: bit operators, assignment to a swizzle. And the tag line."""
    if not function.doc or not re.match(r"// \S[^:]*: \S", function.doc[0]):
        yield function.line, f"{function.name} has no tag line '// Listing n: what it is'", "".join(function.doc[:1])
    code = [token for token in function.tokens if token.kind not in ("comment", "directive")]
    for index, token in enumerate(code):
        if token.kind == "operator" and token.text in BIT_OPERATORS:
            yield token.line, f"bit operator {token.text} in {function.name}: SM3 has none", token.text
        before = [other.text for other in code[max(index - 2, 0) : index]]
        if token.text in ASSIGNMENTS and len(before) == 2 and before[0] == "." and SWIZZLE.fullmatch(before[1]):
            yield token.line, f"assignment to .{before[1]} in {function.name}: WGSL has none", token.text
