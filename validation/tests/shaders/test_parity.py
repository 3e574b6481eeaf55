"""Test the parity check: it passes on the checkout, and notices every change to one language."""

import re

import pytest

from bokeh_validation import paths, shaders
from bokeh_validation.shaders import parity, passes

# the passes from their entries on, and the whole file
FILES = {**parity.FILES, "passes": parity.PASSES, "bindings": parity.PASSES}
# where the common text begins
COMMON = re.compile(r"^// \[(?:3|6|11|15)\] |^// (?:pixel|fragment) shaders\n", re.MULTILINE)
TEXTS = {key: (paths.shaders() / key).read_text(encoding="ascii") for keys in FILES.values() for key in keys.values()}


def mutated(file: str, language: str, change: str | tuple[str, ...]) -> dict[str, str]:
    """Return a file with its first match of `change`, '...[[old=>new]]...', replaced.

    The change is in GLSL's words; a tuple has one for HLSL and GLSL and one for WGSL, or one per language, in that
    language's own words.
    """
    own = not isinstance(change, str)
    change = {"hlsl": change[0], "glsl": change[-2], "wgsl": change[-1]}[language] if own else change
    before, old, new, after = re.fullmatch(r"(?s)(.*)\[\[(.*)=>(.*?)\]\](.*)", change).groups()
    old, new = (before + text + after if own else spelled(before + text + after, language) for text in (old, new))
    key = FILES[file][language]
    start = COMMON.search(TEXTS[key]).end() if file == "passes" else 0
    assert old in TEXTS[key][start:], f"{old!r} is not in {key}"
    return {key: TEXTS[key][:start] + TEXTS[key][start:].replace(old, new, 1)}


def spelled(text: str, language: str) -> str:
    """Translate types, parameters and members from GLSL into another language."""
    if language == "hlsl":
        return re.sub(r"\bvec([234])\b", r"float\1", text)
    if language == "wgsl":
        for own, common in (("f32", "float"), ("i32", "int")):
            text = re.sub(rf"\b{common} (\w+);", rf"\1: {own},", text)
            text = re.sub(rf"\b{common} (\w+)(?=[,)])", rf"\1: {own}", text)
        return re.sub(r"\bvec([234])\(", r"vec\1f(", text).replace("float(", "f32(")
    return text


def test_the_checkout_passes():
    """Check that the checkout has no differences."""
    assert not parity.check(), "\n" + "\n".join(map(str, parity.check()))


HELPER = [f"{head}\n{{{{\n    return x;\n}}}}\n\n" for head in ("float {}(float x)", "fn {}(x: f32) -> f32")]
# Description -> the change as mutated() takes it, for changes that test_hardly_a_token_can_go_unnoticed does not cover
LIBRARY = {
    "the spelling of a literal": "(0.0, [[0.5=>.5]] * halfStep.x",
    "a macro of LOVE": "        [[safe=>number]] = min(value, maximum);",
    "a swizzle assigned": "        [[=>sum.rgb += weight; ]]sum = sum / samples;",
    "a default in the table": "//   BOKEH_MAX_COLOR          [[65504=>65500]].0",
    "a character that is not ASCII": "Listing 1: computes the CoC of a thin lens[[=> \u00e9]]",
    "a backslash at the end of a line": "and a maxCoC of 0.1; metres[[=>\\]]\n",
    "no licence line": "[[// SPDX-License-Identifier: MIT\n=>]]",
    "a version": "Version 0.3.[[0=>1]].",
    "a block comment": "    [[=>/* why */ ]]return filterCoC;",
    "a derivative": "    return BokehSanitize(depth[[=> + dFdx(depth)]], ",
    "a default": ("BOKEH_MAX_COLOR [[65504=>65500]].0\n", "BOKEH_MAX_COLOR: f32 = [[65504=>65500]].0"),
    "a type of a parameter": "float lengthInPixels, [[float=>int]] spacing)",
    "a type of another language": ("[[float4=>vec4]] sum =", "[[vec4=>float4]] sum =", "sum: [[vec4f=>float4]]"),
    "the sampler": ("settings[[ BOKEH_LINEAR=>]]);", "Line[[Sum=>Sums]](", "settings[[, BokehLinearClamp=>]]);"),
    "sampling past BokehFetch": "PackCoC([[BokehFetchTexel=>texture]](ColorSamp, ",
    "a value of a preset": ("#define BOKEH_PRESET_SAMPLES [[9=>8]]", "//   BOKEH_PRESET_MEDIUM     [[9=>8]] "),
    "a helper without the prefix": tuple(
        f"[[=>// Lines: x\n{one.format('saturated')}]]// Lines: divides" for one in HELPER
    ),
    "a global": (
        "[[=>const float bokehX = 1.0;\n]]// Lines: divides",
        "[[=>const bokehX: f32 = 1.0;\n]]// Lines: divides",
    ),
}
PAPER = {
    "a default": ("BOKEH_PAPER_SAMPLES [[13=>12]]\n", "BOKEH_PAPER_SAMPLES: i32 = [[13=>12]]"),
}
LAYERS = {
    "a row of the presets": "//   BOKEH_PRESET_LOW        [[1=>2]] ",
    "the configuration": (
        "#define BOKEH_PRESET_LAYER_SAMPLES [[11=>9]]",
        "override BOKEH_LAYER_SAMPLES: i32 = [[11=>13]];",
    ),
}
PASSES = {
    "a parameter of the block": "Bokeh[[BlurCoC=>UseMax]] > 0.5",
    "an entry point renamed": (
        "float4 Bokeh[[NaiveGrid=>Grid]]_PS(",
        "#elif BOKEH_PASS == BOKEH_[[NAIVE_GRID=>GRID]]\n",
        "fn Bokeh[[NaiveGrid=>Grid]]_PS(",
    ),
    "sampling past BokehFetch": "[[BokehFetchTexel=>texture]](BokehColorSamp, ",
}
# In the part before the entries of the passes
PARAMETERS = [f"BOKEH_PARAMETER(float, BokehAngleB{one})\n" for one in (", 8", "")] + ["    BokehAngleB: f32,\n"]
BINDINGS = {
    "a row of the table": "over a[[ grid=>]]",
    "a parameter dropped": tuple(f"[[{row}=>]]" for row in PARAMETERS),
    "a parameter of another type": tuple(f"[[{row}=>{re.sub('float|f32', 'int', row)}]]" for row in PARAMETERS),
    "a number": ("BokehAngleB, [[8=>9]])", "#define BOKEH_DEBUG [[13=>6]]\n", "BokehAngle[[B=>A]]: f32"),
    "a global without the prefix": (
        "TEXTURE, [[Bokeh=>]]KernelSamp,",
        "uniform BOKEH_TEXTURE [[Bokeh=>]]KernelSamp;",
        "var [[Bokeh=>]]KernelSamp:",
    ),
}
TABLES = dict(zip(FILES, (LIBRARY, PAPER, LAYERS, {}, {}, PASSES, BINDINGS), strict=True))


def changes():
    """Yield file, name and language: a change in a language's own words for each language, all others for one language
    in turn.
    """
    for file, table in TABLES.items():
        for number, (name, change) in enumerate(table.items()):
            languages = [paths.LANGUAGES[number % 3]] if isinstance(change, str) else paths.LANGUAGES
            yield from ((file, name, language) for language in languages)


@pytest.mark.parametrize(("file", "name", "language"), list(changes()))
def test_a_change_in_one_language_is_found(file, name, language):
    """Check that a change to one language is reported."""
    found = parity.check(mutated(file, language, TABLES[file][name]))
    assert found and all(difference.where and difference.what for difference in found)


@pytest.mark.parametrize("language", paths.LANGUAGES)
@pytest.mark.parametrize("file", [*paths.STEMS[:-1], "passes"])
def test_hardly_a_token_can_go_unnoticed(file, language):
    """Check that dropping a token of the common text is reported; semicolons are left out, since every compiler misses
    them, and BOKEH_LOOP, which only HLSL has.
    """
    key = FILES[file][language]
    text = TEXTS[key]
    start = COMMON.search(text).end()
    tokens = re.finditer(r"//[^\n]*|[\w.]+|[^\w\s;]", text[start:])
    for token in [token for token in tokens if token[0] != "BOKEH_LOOP"][::251]:
        dropped = text[: start + token.start()] + text[start + token.end() :]
        assert parity.check({key: dropped}), f"{token[0]} dropped at {start + token.start()}"


@pytest.mark.parametrize("language", paths.LANGUAGES)
def test_line_breaks_do_not_matter_and_places_of_functions_do(language):
    """Check that line breaks are ignored, and that a missing or moved function is reported."""
    change = "BokehSanitize([[color.r, 0.0, BOKEH=> color.r , 0.0,\n        BOKEH]]_MAX_COLOR),"
    assert not parity.check(mutated("bokeh", language, change))
    key = FILES["bokeh"][language]
    (function,) = (one[0] for one in shaders.FUNCTION.finditer(TEXTS[key]) if one["name"] == "BokehPackCoC")
    without, before = TEXTS[key].replace(function + "\n\n", ""), "// Listing 1: converts a value"
    for text in (without, without.replace(before, f"{function}\n\n{before}")):
        assert parity.check({key: text})


@pytest.mark.parametrize("language", ["hlsl", "glsl"])
def test_the_layers_of_the_passes_can_be_left_out(language):
    """Check that the helpers in an #ifdef, which WGSL does not have, are compared."""
    assert parity.check(mutated("passes", language, "[[#ifdef BOKEH_LAYERS\n=>]]"))


# A change to all three languages, which only the rules can notice
MORE = "float a, float b, float c, float d,\n    float e, float f, float g, "
ALIKE = {
    "nine parameters": f"BokehSanitize([[=>{MORE}]]float value,",
    "a tag line": "// [[Lines: divides=>Divides]] a weighted sum",
    "a bit operator": "k > [[polygon.sides / 2=>(polygon.sides | 2)]])",
    "a macro of LOVE": "        [[safe=>number]] = min(value, maximum);",
    "a swizzle assigned": "        sum[[ *==>.xy =]] BokehEdgeArea(",
}


@pytest.mark.parametrize("name", ALIKE)
def test_a_rule_broken_in_all_languages_is_found(name):
    """Check that breaking a rule in all languages is reported."""
    texts = {}
    for language in paths.LANGUAGES:
        texts |= mutated("bokeh", language, ALIKE[name])
    found = {difference.where.partition("/")[0] for difference in parity.check(texts)}
    assert found == ({"hlsl", "glsl"} if name == "nine parameters" else set(paths.LANGUAGES))


@pytest.mark.parametrize(
    ("language", "pattern"),
    [
        ("glsl", r"binding = (\d)\) uniform BOKEH_\w+ Bokeh(\w+);"),
        ("wgsl", r"@binding\((\d)\) var Bokeh(\w+Samp\w?): "),
    ],
)
def test_bindings(language, pattern):
    """Compare the textures' bindings with those of the drivers. HLSL has registers, which compilers map."""
    found = re.findall(pattern, shaders.file_text(language, "bokeh_passes"))
    assert {slot: int(binding) for binding, slot in found} == passes.BINDINGS
