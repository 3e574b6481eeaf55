"""Compare the three languages as one text: HLSL, GLSL and WGSL are rewritten to common words and compared statement by
statement.

Comments, blank lines and the order of everything are part of the text; spaces and line breaks within a statement are
not. Two languages are compared in what both can express: samplers as parameters and arguments between HLSL and WGSL,
`#` lines between HLSL and GLSL. Code that does not follow the style of its language cannot be rewritten and shows as a
difference. Not compared, because each language needs its own, are

  in the library   the header's PASTE block, and section [2] up to where the image lies in its textures
  in the passes    everything before the last heading (bindings, vertex shader), except the rows of the table of passes
  in both          of a function that reads a texture itself, which rules.py allows in section [2] only: its body, and
                   its comment after the first line

Every other deviation needs a rule here, and its reason in docs/paper.md.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from difflib import SequenceMatcher
from functools import lru_cache
from itertools import combinations
from typing import NamedTuple

from bokeh_validation import paths, shaders, terminal
from bokeh_validation.shaders import rules
from bokeh_validation.shaders.entries import ENTRIES

FILES = {stem: {language: f"{language}/{stem}.{language}" for language in paths.LANGUAGES} for stem in paths.STEMS}
PASSES = FILES["bokeh_passes"]
_HEADING = re.compile(r"^// (?:pixel|fragment) shaders\n", re.MULTILINE)

_PASS_NAMES = {shaders.glsl_pass(entry): f"{entry}_PS" for entry in ENTRIES}
_TABLE_ROW = re.compile(rf"//   (?:{'|'.join(_PASS_NAMES)}|Bokeh\w+_PS)  ")

# Common words, and the equivalents of each language
_WORDS = ("<float>", "<2>", "<3>", "<4>", "<int>", "<texture>", "<depth texture>", "<half 2>", "<half 4>")
# types, and constructors of them
_HALVES = (r"BOKEH_(?:TO_)?HALF2", r"BOKEH_(?:TO_)?HALF4")
_TYPES = {
    "hlsl": ("float", "float2", "float3", "float4", "int", "BOKEH_TEXTURE", "BOKEH_DEPTH_TEXTURE", *_HALVES),
    "glsl": ("float", "vec2", "vec3", "vec4", "int", "BOKEH_TEXTURE", "BOKEH_DEPTH_TEXTURE", *_HALVES),
    "wgsl": (
        "f32",
        "vec2f",
        "vec3f",
        "vec4f",
        "i32",
        "texture_2d<f32>",
        "BokehDepthTexture",
        "BokehHalf2",
        "BokehHalf4",
    ),
}


def _own_body(match: re.Match) -> str:
    """Reduce a function that reads a texture to its head and the first line of its comment."""
    first = match["doc"].partition("\n")[0]
    return f"{first}\n{match['head']};" if re.search(rf"{rules.SAMPLING}\(", match["body"]) else match[0]


def _wgsl_head(match: re.Match) -> str:
    parameters = re.sub(r"(\w+): ([\w<>]+)", r"\2 \1", match[2])
    return f"{match[3] or 'void'} {match[1]}({parameters})"


def _wgsl_targets(match: re.Match) -> str:
    return " ".join(f"target{i} = {value};" for i, value in enumerate(re.split(r",\s+", match[1])))


# the part of section [2] that is different in each language
PORTING = r"^(// \[2\] .*\n)(?s:.*?)(?=^// where the image lies in its textures)"
# (pattern, replacement) in the order of application: first to the whole text, then to the code
_Rewrites = tuple[tuple[str, str | Callable[[re.Match], str]], ...]
_EVERYWHERE: _Rewrites = (
    (r"^// PASTE(?s:.*?)(?=^// CONTENTS)", ""),
    (PORTING, r"\1"),
    (rf"(?s:{shaders.FUNCTION.pattern})", _own_body),
    # shader model 3 limits a loop to 255 iterations, so HLSL's naive gather has two nested loops
    (
        r"BOKEH_LOOP for.*BOKEH_LOOP_LIMIT\) // differs: 255 loops\n"
        r"(.*)j; i < min\(j \+ BOKEH_LOOP_LIMIT, (\w+)\)",
        r"\g<1>0; i < \2",
    ),
    (r"(?<=^//   )BOKEH_\w+", lambda found: _PASS_NAMES.get(found[0], found[0])),
    (r"^#define BOKEH_LOOP_LIMIT.*// differs: .*$", " "),
    (rf"^#define ({shaders.FIXED}) (\S+)$", r"\1 = \2;"),
    # WGSL has no preprocessor, so a program always contains all files
    (r"^#ifdef BOKEH_LENS\n((?: .*\n)* .*)\n#endif$", r"\1"),
    (r"^#ifdef BOKEH_(?:PAPER|LENS|LAYERS)\n((?:(?!#).*\n)*)#endif\n", r"\n\1\n"),
)
_CODE: Mapping[str, _Rewrites] = {
    "hlsl": (
        (r"^static ", ""),
        (r"\bBOKEH_LOOP for\b", "for"),
        (r" BOKEH_SAMPLER\)", ", sampler BokehLinearClamp)"),
        (r" BOKEH_LINEAR\)", ", BokehLinearClamp)"),
        (r"^float4 (Bokeh\w+_PS)\(BOKEH_INPUT\) : BOKEH_OUTPUT$", r"ENTRY \1()"),
        (r"^// what passes of \d targets return\nstruct BokehTargets\d\n\{\n(?:    float4 target(\d) .*\n)+\};$", ""),
        (r"^BokehTargets\d (Bokeh\w+_PS)\(BOKEH_INPUT\)$", r"ENTRY \1()"),
        (r"^    BokehTargets\d result;\n((?:    result\.target\d = [^;]*;\n)*.*;)\n    return result;$", r"\1"),
        (r"\bresult\.target(?=\d = )", "target"),
    ),
    "glsl": (
        (
            r"^#(?:el)?if BOKEH_PASS == (\w+)\n\n((?://\d+\n)*)void main\(\)$",
            lambda head: f"\n\n{head[2]}ENTRY {_PASS_NAMES.get(head[1], head[1])}()",
        ),
        (r"\n#endif\n#endif\n\Z", "\n"),
        (r"\bBokehUV\b", "uv"),
        (r"\bBokehResult = (?=[^;]*;\n\})", "return "),
        (r"\bBokehResult([BCD]?) =", lambda found: f"target{'_BCD'.index(found[1] or '_')} ="),
    ),
    "wgsl": (
        (r"^struct BokehTargets\d\n\{\n(?:    @location\((\d)\) target\1: vec4f,\n)+\}$", ""),
        (r"^@fragment fn (\w+)\(input: BokehVertex\) -> (?:@location\(0\) vec4f|BokehTargets\d)$", r"ENTRY \1()"),
        (r"\breturn BokehTargets\d\(([^()]*)\);", _wgsl_targets),
        (r"\binput\.uv\b", "uv"),
        (r"\bbokehParameters\.", ""),
        (r"^fn (\w+)\(([^)]*)\)(?: -> (\w+))?(?=;?$)", _wgsl_head),
        (r"^(    \w+: \w+,\n)\}$", r"\1};"),
        (r"^    (\w+): (\w+),$", r"    \2 \1;"),
        (shaders.WGSL_SETTING, r"\1 = \2\3;"),
        (r"(^ *|\bfor \()(?:let|var|var<private>) (\w+): (\w+)(?=;| =)", r"\1\3 \2"),
    ),
}
# A blank line, comment or `#` line; the head of a loop; any other statement or head
_LINE = re.compile(
    r"^\n|//\d+|^#.*|for\b(?:(?!//)[^{}])*[{}]?|(?!//)[^\s{};](?:(?!//)[^{};])*[{};]?|[{};]", re.MULTILINE
)


class Difference(NamedTuple):
    """Hold one difference between the languages, or one broken rule; `lines` are the positions and their text."""

    where: str
    what: str
    lines: tuple[str, ...]

    def __str__(self) -> str:
        return "\n    ".join([f"{self.where}: {self.what}", *self.lines])


class TextLine(NamedTuple):
    """Hold a match of _LINE in common words, with number and text of its line."""

    common: str
    number: int
    source: str


def check(texts: Mapping[str, str] | None = None) -> list[Difference]:
    """Return every difference between the languages, and every broken rule; empty if all is well.

    texts  path from the top of the checkout, such as 'hlsl/bokeh.hlsl' -> text to check instead of that file; other
           files are read from the checkout
    """
    files: dict[str, str] = dict(texts or {})
    for key in (key for keys in FILES.values() for key in keys.values()):
        if key not in files:
            # read without conversion, so that the rules see what is not UTF-8 and every kind of line end
            files[key] = (paths.shaders() / key).read_bytes().decode("utf-8", errors="surrogateescape")
    differences: list[Difference] = []
    for keys in FILES.values():
        for language, key in keys.items():
            differences += _ruled(language, key, files[key])
        for pair in combinations(keys, 2):
            differences += _compared(pair, tuple((keys[language], files[keys[language]]) for language in pair))
    return differences


def parity() -> None:
    """Compare the three languages statement by statement."""
    differences = check()
    terminal.tell(*map(str, differences), f"{len(differences)} differences between HLSL, GLSL and WGSL")
    terminal.end(not differences)


# Mutants and tests change one file a thousand times; what was found in the others is cached.
@lru_cache(maxsize=64)
def _ruled(language: str, key: str, text: str) -> list[Difference]:
    broken_rules = rules.findings(text, language, key != PASSES[language])
    return [Difference(f"{key}:{number}", rule, (row,)) for number, rule, row in broken_rules]


@lru_cache(maxsize=64)
def _compared(pair: tuple[str, str], files: tuple[tuple[str, str], ...]) -> list[Difference]:
    """Compare the files of two languages, each a path and a text."""
    sides = [_said(_lines(pair[i], files[i][1]), pair[1 - i]) for i in (0, 1)]
    first_texts, second_texts = ([line.common for line in side] for side in sides)
    differences = []
    for tag, i, j, k, m in (
        SequenceMatcher(None, first_texts, second_texts, autojunk=False).get_opcodes()
        if first_texts != second_texts
        else ()
    ):
        if tag == "equal":
            continue
        places = [
            f"{path}:{part[0].number}  {' '.join(line.source for line in part[:4])}" if part else f"{path}  (nothing)"
            for (path, _), part in zip(files, (sides[0][i:j], sides[1][k:m]), strict=True)
        ]
        differences.append(Difference(" and ".join(pair), "not the same", tuple(places)))
    return differences


def _said(lines: Sequence[TextLine], other: str) -> list[TextLine]:
    """Keep the lines that the other language can express too, and reduce several blank lines to one."""
    comparable: list[TextLine] = []
    for line in lines:
        if other == "glsl":
            line = line._replace(common=re.sub(r",(?:sampler )?BokehLinearClamp\b", "", line.common))
        if other == "wgsl" and line.common.startswith("#"):
            continue
        if line.common or (comparable and comparable[-1].common):
            comparable.append(line)
    return comparable if comparable and comparable[-1].common else comparable[:-1]


@lru_cache(maxsize=64)
def _lines(language: str, text: str) -> tuple[TextLine, ...]:
    """Split a file into lines in common words."""
    sources = text.split("\n")
    if heading := _HEADING.search(text):
        head_rows = text[: heading.end()].split("\n")
        text = "\n".join(row if _TABLE_ROW.match(row) else "" for row in head_rows) + text[heading.end() :]
    plain = shaders.presets(text).get("", {})
    language_name = rf"\b{language.upper()}(?=\. Version )|(?<=\.){language}\b"
    setting = (shaders.SETTING, lambda match: f"{match[1]} = {plain.get(match[2], match[2])};")
    text = _rewritten(text, (*_EVERYWHERE, (language_name, "LANGUAGE"), setting))
    comments = shaders.COMMENT.findall(text)
    numbers = iter(range(len(comments)))
    words = tuple((rf"\b{spelling}(?!\w)", word) for spelling, word in zip(_TYPES[language], _WORDS, strict=True))
    text = _rewritten(shaders.COMMENT.sub(lambda _: f"//{next(numbers)}", text), (*_CODE[language], *words[::-1]))
    text_lines = []
    for match in _LINE.finditer(text):
        if match[0].startswith("//"):
            common = " ".join(comments[int(match[0][2:])].split())
        else:
            common = re.sub(r"\s*([^\w\s])\s*", r"\1", " ".join(match[0].split()))
        line = text.count("\n", 0, match.start())
        text_lines.append(TextLine(common, line + 1, sources[line].strip() or "(empty)"))
    return tuple(text_lines)


def _rewritten(text: str, rewrites: _Rewrites) -> str:
    """Apply rewrites, keeping the number of lines."""
    for pattern, new in rewrites:

        def same_height(match: re.Match, new: str | Callable = new) -> str:
            changed = match.expand(new) if isinstance(new, str) else new(match)
            return changed + "\n " * (match[0].count("\n") - changed.count("\n"))

        text = re.sub(pattern, same_height, text, flags=re.MULTILINE)
    return text
