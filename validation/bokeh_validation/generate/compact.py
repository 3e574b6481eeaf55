"""Shorten shaders for packages that contain them as text: the npm package, since a browser loads it, and others."""

import re
from collections.abc import Iterable, Iterator, Mapping

from bokeh_validation import shaders

# A tuned constant in GLSL or in WGSL: name, value
TUNED = r"^(?:#define |const )(BOKEH_TUNED_\w+)(?:: f32 =)? ([\d.]+);?$"
# A vector of equal numbers
VECTOR = r"\b(vec(\d)f?)\(([\d.]+)((?:,\3)+)\)"
# What options and methods add that these packages do not have. Half precision: its constant, its types, and a function,
# which would only return its argument. Own fetch functions: a name for the type of a texture. Viewports, and `naive`.
OPTIONS = (
    (r"^#ifndef BOKEH_HALF_PRECISION\n.*\n#endif\n", ""),
    (r"^#if BOKEH_HALF_PRECISION > 0 && (?s:.*?)^#define BOKEH_TO_HALF4 vec4\n#endif\n", ""),
    (r"^override BOKEH_HALF_PRECISION.*\n|^alias BokehHalf.*\n", ""),
    (r"^(?:fn|BOKEH_HALF4) BokehHalfTexel\((?s:.*?)^\}\n", ""),
    (r"\bBokehHalfTexel\(", "("),
    (r"\bBOKEH_(?:TO_)?HALF(\d)\b", r"vec\1"),
    (r"\bBokehHalf(\d)\b", r"vec\1f"),
    (r"^#define BOKEH_TEXTURE sampler2D\n", ""),
    (r"\bBOKEH_TEXTURE\b", "sampler2D"),
    (r"^ +if \(BOKEH_VIEWPORT > 0\)\n +\{\n(?s:.*?)^ +\}\n", ""),
    (r"^(?:vec4|var<private>) BokehViewport.*\n", ""),
    (r"^(?:void|fn) BokehSetViewport\((?s:.*?)^\}\n", ""),
    (r"^(?:vec4|fn) BokehNaive\w+\((?s:.*?)^\}\n", ""),
)


def shortened(texts: Mapping[str, str]) -> dict[str, list[str]]:
    """Return the lines of each of a language's texts, without what only readers need and without OPTIONS."""
    full = _with_values({name: _without_options(text) for name, text in texts.items()})
    joined = {name: _joined(map(_compact, code(text))) for name, text in full.items()}
    return {name: [re.sub(VECTOR, _one_component, line) for line in lines] for name, lines in joined.items()}


def _without_options(text: str) -> str:
    """Return a text in GLSL or WGSL without OPTIONS, which the classes do not have."""
    for pattern, new in OPTIONS:
        text = re.sub(pattern, new, text, flags=re.MULTILINE)
    return text


def _with_values(texts: Mapping[str, str]) -> dict[str, str]:
    """Return the texts with each tuned constant's name replaced by its value, and without its declaration."""
    whole = "".join(texts.values())
    values = dict(re.findall(TUNED, whole, re.MULTILINE))
    without = {name: re.sub(TUNED, "", text, flags=re.MULTILINE) for name, text in texts.items()}
    return {name: re.sub(r"\bBOKEH_TUNED_\w+", lambda match: values[match[0]], text) for name, text in without.items()}


def code(text: str) -> Iterator[str]:
    """Yield the lines of a text without comments and blank lines."""
    return filter(None, (line.strip() for line in shaders.COMMENT.sub("", text).splitlines()))


def _compact(line: str) -> str:
    """Return a line of code without what the language does not need: pages download it. That is spaces, zeros at the
    ends of numbers, and in WGSL the types of variables that have a value.

    An #error needs no message, since the classes check their options. Other lines of the preprocessor, and in WGSL the
    lines whose values the classes replace, stay as they are.
    """
    if line.startswith(("#", "override", "alias")):
        return "#error" if line.startswith("#error") else line
    line = re.sub(r"\b(if|for) \(", r"\1(", re.sub(r"(?<=[,:;]) ", "", line))
    line = re.sub(r"^((?:for\()?(?:let|var) \w+):\w+ = ", r"\1 = ", line)
    line = re.sub(r"(?<![\w.])0(\.\d*[1-9])|(?<![\w.])(\d+\.)0\b", r"\1\2", line)
    # not before a minus: a - -b
    return re.sub(r" ([-+*/=<>]=?|&&|->) (?=[\w(.])", r"\1", line)


def _one_component(match: re.Match) -> str:
    """Return a vector of equal numbers with one of them, if it has as many as its type says."""
    constructor, size, number, others = match.groups()
    return f"{constructor}({number})" if others.count(",") == int(size) - 1 else match[0]


def _joined(lines: Iterable[str]) -> list[str]:
    """Return lines of code with each brace, and the rest of a statement, at the end of the line before it.

    Lines of the preprocessor stay on their own.
    """
    joined = [""]
    for line in lines:
        continues = line in ("{", "}") or joined[-1].endswith((",", "(", "+", "-", "*"))
        if continues and not joined[-1].startswith("#") and not line.startswith("#"):
            # the operator at the end of a line has a space before it
            joined[-1] = re.sub(r" ([+*])$", r"\1", joined[-1]) + line
        else:
            joined.append(line)
    return joined[1:]
