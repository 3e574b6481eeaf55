"""Check each shader file for what compilers and users trip over, independently of the other languages."""

import re
from collections.abc import Iterator

import bokeh_validation
from bokeh_validation import shaders
from bokeh_validation.shaders.entries import ENTRIES
from bokeh_validation.shaders.passes import PARAMETERS

SPDX = "// SPDX-License-Identifier: MIT\n"
TOO_LONG = "more than 100 characters in a line"
# Most parameters of a function, as a user writes them in a call; WGSL needs more, since it has samplers next to
# textures
MAX_PARAMETERS = {"glsl": 8, "hlsl": 8, "wgsl": 12}
# Everything that samples or queries a texture, or needs derivatives; allowed in section [2] only
SAMPLING = (
    r"\b(?a:tex(?:1D|2D|3D|CUBE)\w*|texture\w*|texelFetch\w*|shadow[12]D\w*|image(?:Load|Store)\w*|Gather(?:Red|Green|Blue|Alpha|Cmp\w*)?|Load\w*"
    r"|Sample(?:Level|Grad|Bias|Cmp\w*)?|GetDimensions|CalculateLevelOfDetail\w*|dd[xy](?:_\w+)?|dFd[xy]\w*|dpd[xy]\w*"
    r"|fwidth\w*)\b(?!<f32>)"
)
# Patterns forbidden in a line, and in the code of the common text
LINE = {
    "a tab, a carriage return or a character that is not ASCII": r"[^\n -~]",
    "a backslash at the end of a line: GLSL would join the next one to it": r"\\[ \t\r]*$",
    TOO_LONG: r".{101}",
    "a block comment: use //": r"/\*|\*/",
}
COMMON = {
    "only section [2] of the library reads a texture": SAMPLING,
    "a bit operator: SM3 has none": r"(?<![&|<>])(?:[&|](?![&|])|\^|~|<<|>>)",
    "WGSL cannot assign to a swizzle": r"\.(?:[xyzw]{2,4}|[rgba]{2,4}|[stpq]{2,4}) *(?:[-+*/%]?=(?!=)|\+\+|--)",
}
# bokeh_passes.* is exempt from these two, since neither ReShade nor LOVE uses it
RESHADE = "a member of a function's result: ReShade's compiler makes invalid SPIR-V of it"
LOVE = "a word that LOVE redefines by a macro"
LOVE_MACROS = re.compile(r"\b(?:number|extern|Image|(?:Array|Cube|Volume)Image)\b")
MEMBER_OF_RESULT = re.compile(r"\)\.(?![xyzwrgba]{1,4}\b)[A-Za-z]")
DECLARED = re.compile(
    r"^#(?:define|undef) (\w+)|^(?:cbuffer|struct) (\w+)|^(?:const|override|alias) (\w+)"
    r"|^(?:@\w+(?:\([^)]*\))? ?)*(?:fn|var(?:<[^>]*>)?) (\w+)"
    r"|^(?:layout\([^)]*\) )?(?!layout|precision|struct|return)(?:\w+ )+(\w+) *(?=[(=;:\[]|$)"
    r"|^BOKEH_(?:PARAMETER|SLOT)\(\w+, (\w+)",
    re.MULTILINE,
)


def findings(text: str, language: str, is_library: bool) -> Iterator[tuple[int, str, str]]:
    """Yield every broken rule of a file, as (line number, rule, text of the line).

    is_library  True for all files except bokeh_passes.*
    """
    lines = text.split("\n")
    for offset, rule in _findings(text, language, is_library):
        number = text.count("\n", 0, offset)
        yield number + 1, rule, lines[number]


def _findings(text: str, language: str, is_library: bool) -> Iterator[tuple[int, str]]:
    """Yield (offset, rule) for every broken rule."""
    version, header = f"Version {bokeh_validation.__version__}.", re.match(r"(?://.*\n)*", text)[0]
    if not text.startswith(SPDX) or re.findall(r"Version [\d.]+", header) != [version]:
        yield 0, f"not {SPDX.strip()!r} first, and {version!r} once in the header"
    if not text.endswith("\n"):
        yield len(text), "no line end at the end of the file: the next one begins right there"
    code = re.sub("//.*", lambda comment: " " * len(comment[0]), text)
    begins = re.search(r"^// (?:\[3\]|Layers:|Listing 1:|Lens:) ", text, re.MULTILINE) if is_library else None
    common = begins.start() if begins else 0
    for rule, pattern in LINE.items():
        yield from ((match.start(), rule) for match in re.compile(pattern, re.MULTILINE).finditer(text))
    for rule, pattern in COMMON.items():
        yield from ((match.start(), rule) for match in re.compile(pattern).finditer(code, common))
    for declaration in DECLARED.finditer(code):
        name = declaration[declaration.lastindex]
        if not re.match(r"Bokeh|BOKEH_|bokeh", name) and (is_library or name != "main"):
            yield declaration.start(), f"{name} does not begin with Bokeh, BOKEH_ or bokeh"
    if not is_library:
        yield from _interface(text, language)
        return
    yield from ((match.start(), RESHADE) for match in MEMBER_OF_RESULT.finditer(code, common))
    yield from ((match.start(), LOVE) for match in LOVE_MACROS.finditer(code, common))
    for function in shaders.FUNCTION.finditer(text, common):
        if not re.match(r"// \S[^:\n]*: \S", function["doc"]):
            yield function.start("head"), f"{function['name']} has no tag line '// Listing n: what it is'"
        if function["head"].count(",") >= MAX_PARAMETERS[language]:
            yield function.start("head"), f"more than {MAX_PARAMETERS[language]} parameters"


def _interface(text: str, language: str) -> Iterator[tuple[int, str]]:
    """Check that parameters, and in GLSL the values of BOKEH_PASS, match the harness in names and order."""
    form = {"hlsl": "BOKEH_PARAMETER(float, {0}, {1})", "glsl": "BOKEH_PARAMETER(float, {0})", "wgsl": "    {0}: f32,"}
    names = [*map(shaders.glsl_pass, ENTRIES), "BOKEH_FULL_SCREEN"]
    blocks = {"parameters": [form[language].format(name, number) for number, name in enumerate(PARAMETERS)]}
    if language == "glsl":
        blocks["values of BOKEH_PASS"] = [f"#define {name} {number}" for number, name in enumerate(names, 1)]
    for list_name, rows in blocks.items():
        if not re.search(r"[\n{]\n" + re.escape("\n".join(rows)) + r"\n[\n}]", text):
            yield 0, f"{list_name}: not those of the harness"
