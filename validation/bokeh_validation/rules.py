"""What every shader file has to keep on its own, whatever the other languages do."""

import re
from collections.abc import Iterator

import bokeh_validation
from bokeh_validation import listing

MAX_LINE = 100
TOO_LONG = "characters in a line"
SPDX = "// SPDX-License-Identifier: MIT"
VERSION = re.compile(r"\bVersion (\d+\.\d+\.\d+)\.")
# A user counts what they have to write in a call: with samplers beside the textures WGSL needs more
MAX_PARAMETERS = {"glsl": 8, "hlsl": 8, "wgsl": 12}
# Everything that reads or asks a texture, or needs derivatives; section [2] is the one place for it
SAMPLING = re.compile(
    r"\b(tex(?:1D|2D|3D|CUBE)\w*|texture\w*|texelFetch\w*|shadow[12]D\w*|image(?:Load|Store)\w*|Gather\w*|Load\w*"
    r"|Sample(?:Level|Grad|Bias|Cmp\w*)?|GetDimensions|CalculateLevelOfDetail\w*|dd[xy](?:_\w+)?|dFd[xy]\w*|dpd[xy]\w*|fwidth\w*)\b"
    r"(?!<f32>)",
    re.ASCII,
)
BIT_OPERATOR = re.compile(r"(?<![&|<>])(?:[&|](?![&|])|\^|~|<<|>>)")
SWIZZLE = re.compile(r"\.((?:[xyzw]{2,4}|[rgba]{2,4}|[stpq]{2,4})) *(?:[-+*/%]?=(?!=)|\+\+|--)")
# What the common text of a library, or of the layers, begins with
COMMON = re.compile(r"^// (?:\[3\]|Layers:) ", re.MULTILINE)
# Words that the comments do without: a loop has iterations, and one thing comes after another. 'Turns off' is right,
# and 'behind' where it means deeper in the scene.
WORDS = re.compile(
    r"\bturns\b(?! (?:it|them|the [a-z ]+?) (?:off|on)\b)"
    r"|(?<!from )\bbehind\b(?! the focus\b| the camera\b| an? \w+ (?:object|pixel)\b| it\b| them\b)"
    r"|\bcounts? as\b|\bat hand\b|\bhands on\b|\btold\b|\bspelt\b",
    re.IGNORECASE,
)
DECLARED = re.compile(
    r"^#(?:define|undef) (\w+)|^(?:cbuffer|struct) (\w+)|^(?:const|override|alias) (\w+)"
    r"|^(?:@\w+(?:\([^)]*\))? ?)*(?:fn|var(?:<[^>]*>)?) (\w+)"
    r"|^(?:layout\([^)]*\) )?(?!layout|precision|struct|return)(?:\w+ )+(\w+) *(?=[(=;:\[]|$)"
    r"|^BOKEH_PARAMETER\(\w+, (\w+)",
    re.MULTILINE,
)

# (line, what, text of the line)
Finding = tuple[int, str, str]


def findings(text: str, language: str, is_library: bool) -> Iterator[Finding]:
    """All that is wrong with a file. `is_library`: bokeh.* or bokeh_layers.*."""
    lines = text.split("\n")
    yield from _lines(lines)
    yield from _version(lines)
    yield from _words(lines)
    plain = listing.code(text)
    start = 0
    if is_library:
        common = COMMON.search(text)
        start = listing.line_of(text, common.start()) if common else 0
        yield from _library(text, start, language)
    for number, line in enumerate(plain.split("\n"), 1):
        if "/*" in line or "*/" in line:
            yield number, "a block comment: use //", line
        if number > start and (found := SAMPLING.search(line)):
            yield number, f"{found[1]}: only section [2] of the library reads a texture", line
    for found in DECLARED.finditer(plain):
        name = next(group for group in found.groups() if group)
        if not re.match(r"Bokeh|BOKEH_|bokeh", name) and not (name == "main" and language == "glsl" and not is_library):
            yield listing.line_of(plain, found.start()), f"{name} does not begin with Bokeh, BOKEH_ or bokeh", found[0]


def _lines(lines: list[str]) -> Iterator[Finding]:
    """Rules on characters and lines."""
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
            yield number, f"{len(line)} {TOO_LONG}, {MAX_LINE} at most", line
    if lines[0] != SPDX:
        yield 1, f"the first line is not {SPDX!r}", lines[0]
    if lines[-1]:
        yield len(lines), "no line end at the end of the file: the next one begins right there", lines[-1]


def _version(lines: list[str]) -> Iterator[Finding]:
    header = next((i for i, line in enumerate(lines) if not line.startswith("//")), len(lines))
    found = [(i + 1, match[1]) for i, line in enumerate(lines[:header]) for match in VERSION.finditer(line)]
    if len(found) != 1:
        yield 1, f"{len(found)} times 'Version x.y.z.' in the header, once is right", ""
    for number, version in found:
        if version != bokeh_validation.__version__:
            yield number, f"not the version of the package, {bokeh_validation.__version__}", lines[number - 1]


def _words(lines: list[str]) -> Iterator[Finding]:
    """Of the comments, over line breaks."""
    joined, begins = "", []
    for line in lines:
        found = listing.COMMENT.search(line)
        begins.append(len(joined))
        joined += found[0].lstrip("/ ").rstrip() + " " if found else "\n"
    for found in WORDS.finditer(joined):
        number = sum(begin <= found.start() for begin in begins)
        yield number, f"{found[0]!r} in a comment: say it in plainer words", lines[number - 1]


def _library(text: str, start: int, language: str) -> Iterator[Finding]:
    """The common text, which line `start` begins: functions and structs that every language can say."""
    start -= 1 if start else 0
    offset = sum(len(line) + 1 for line in text.split("\n")[:start])
    seen = set()
    for function in listing.functions(text[offset:]):
        line = start + function.line
        if function.name in seen:
            yield line, f"{function.name} is there already: no overloads", function.head
        seen.add(function.name)
        if not re.match(r"// \S[^:\n]*: \S", function.doc):
            yield line, f"{function.name} has no tag line '// Listing n: what it is'", function.head
        count = function.head.count(",") + 1
        if count > MAX_PARAMETERS[language]:
            yield line, f"{function.name} has {count} parameters, {MAX_PARAMETERS[language]} at most", function.head
    rest = listing.FUNCTION.sub("", text[offset:])
    for found in re.finditer(r"^(?!//|    |[{}]|struct \w+$)\S.*$", rest, re.MULTILINE):
        yield start + 1, f"neither a function nor a struct: {found[0]}", found[0]
    for number, line in enumerate(listing.code(text[offset:]).split("\n"), start + 1):
        if found := BIT_OPERATOR.search(re.sub(r"<f32>", "", line)):
            yield number, f"bit operator {found[0]}: SM3 has none", line
        if found := SWIZZLE.search(line):
            yield number, f"assignment to .{found[1]}: WGSL has none", line
