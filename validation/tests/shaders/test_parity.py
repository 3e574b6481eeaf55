"""The parity check passes on the checkout, and no change to one language gets past it."""

import io
import re

import pytest
from rich.console import Console

from bokeh_validation import listing, parity, paths, rules
from bokeh_validation.errors import UserError

LANGUAGES = paths.LANGUAGES
TEXTS = {
    key: (paths.shaders() / key).read_text(encoding="ascii")
    for key in (*parity.LIBRARY.values(), *parity.LAYERS.values(), *parity.PASSES.values())
}
BEFORE = parity.check()


def new_differences(texts: dict[str, str]) -> list[parity.Difference]:
    """What a change brings in beside what is there without it."""
    return [difference for difference in parity.check(texts) if difference not in BEFORE]


def replaced(text: str, old: str, new: str) -> str:
    """The text with the first `old` replaced; it has to be there."""
    assert old in text, f"{old!r} is not in the text"
    return text.replace(old, new, 1)


def mutated(language: str, old: str, new: str) -> dict[str, str]:
    """The library of a language with one change."""
    key = parity.LIBRARY[language]
    return {key: replaced(TEXTS[key], old, new)}


def spelled(text: str, language: str) -> str:
    """GLSL's names of types as another language has them."""
    if language == "wgsl":
        return re.sub(r"\bvec([234])\(", r"vec\1f(", text.replace("float(", "f32("))
    return re.sub(r"\bvec([234])\(", r"float\1(", text) if language == "hlsl" else text


def test_the_checkout_passes():
    assert not parity.check(), "\n" + "\n".join(map(str, parity.check()))


def test_every_deviation_is_listed():
    marks = sum(text.count("// differs: ") for text in TEXTS.values())
    assert len(parity.deviations()) == marks


# Changes that read the same in every language: name -> (old, new). The first occurrence is replaced.
EVERYWHERE = {
    "a literal": ("sampleCoC * settings.bleedingMult, 0.0, 1.0)", "sampleCoC * settings.bleedingMult, 0.0, 2.0)"),
    "the spelling of a literal": ("(0.5 * cos(angle)", "(.5 * cos(angle)"),
    "a suffix of a literal": ("0.5 * sin(angle)", "0.5f * sin(angle)"),
    "a comparison": ("sampleDepth < centerDepth", "sampleDepth <= centerDepth"),
    "a comparison in a loop": ("i < BOKEH_NUM_SAMPLES", "i <= BOKEH_NUM_SAMPLES"),
    "an operator": ("> sampleCoC + settings.bleedingBias", "> sampleCoC - settings.bleedingBias"),
    "another joint": ("< centerDepth && centerCoC", "< centerDepth || centerCoC"),
    "min for max": ("result = max(a, b);", "result = min(a, b);"),
    "a swapped pair of arguments": (
        "clamp(c / max(sensorHeight, BOKEH_MIN_DEPTH), 0.0, MaxCoC)",
        "clamp(c / max(sensorHeight, BOKEH_MIN_DEPTH), MaxCoC, 0.0)",
    ),
    "a component": ("uv).r);", "uv).g);"),
    "parentheses": ("float(2 * i - last)", "float(2 * (i - last))"),
    "a condition reversed": ("if (!blurCoC)", "if (blurCoC)"),
    "a statement dropped": ("        totalWeight += weight;\n", ""),
    "a statement twice": ("        totalWeight += weight;\n", "        totalWeight += weight;\n" * 2),
    "statements swapped": (
        "        color += samplePixel * weight;\n        totalWeight += weight;\n",
        "        totalWeight += weight;\n        color += samplePixel * weight;\n",
    ),
    "a branch dropped": ("    if (useMax)\n    {\n        result = max(a, b);\n    }\n", ""),
    "an empty statement": ("        totalWeight += weight;\n", "        totalWeight += weight;;\n"),
    "another accumulation": ("color += samplePixel * weight;", "color = samplePixel * weight;"),
    "a commented-out statement": ("        totalWeight += weight;", "        // totalWeight += weight;"),
    "a comment in a body": ("        totalWeight += weight;", "        totalWeight += weight; // counts"),
    "a swizzle assigned": ("        totalWeight += weight;", "        color.rgb += weight; totalWeight += weight;"),
    "a tag line": ("// Listing 2: the end of a line", "// Listing 3: the end of a line"),
    "a tag line dropped": ("// Listing 2: the end of a line of length 1 centred on this pixel\n", ""),
    "a doc comment": ("//   MaxCoC        largest CoC allowed", "//   MaxCoC        smallest CoC allowed"),
    "a doc comment cut off": ("//   returns       -0.5 .. 0.5\n", "//   returns       -0.5 .. 0.5\n\n"),
    "a picture": ("^ this pixel", "^ that pixel"),
    "a heading": ("// [7] naive gather\n", "// [7] gather\n"),
    "a section number": ("// [8] exact polygons", "// [7] exact polygons"),
    "the contract": ("CoC   circle of confusion: a DIAMETER", "CoC   circle of confusion: a RADIUS"),
    "the contents": ("BokehDebugDepth, BokehDebugCoC, BokehDebugFocus", "BokehDebugCoC, BokehDebugFocus"),
    "a default in the table": ("//   BOKEH_MAX_COC           0.1 ", "//   BOKEH_MAX_COC           0.2 "),
    "a range in the table": ("0.02       0 .. 1  Listing 3;", "0.02       0 .. 2  Listing 3;"),
    "a row of the table": ("//   BOKEH_MAX_COLOR         65504.0            largest half float\n", ""),
    "a tab": ("    return lineEnd * t;", "\treturn lineEnd * t;"),
    "a tab in a comment": ("// [7] naive gather", "// [7]\tnaive gather"),
    "a character that is not ASCII": ("Listing 1: CoC of a thin lens", "Listing 1: CoC of a thin lens \u00e9"),
    "a backslash at the end of a line": ("length 1 centred on this pixel\n", "length 1 centred on this pixel\\\n"),
    "a long line": ("    return lineEnd * t;", "    return lineEnd * t;" + " " * 100 + "//"),
    "a carriage return": ("    return lineEnd * t;\n", "    return lineEnd * t;\r\n"),
    "no licence line": ("// SPDX-License-Identifier: MIT\n", ""),
    "a version": ("Version 0.2.0.", "Version 0.2.1."),
    "no version": (" Version 0.2.0.", ""),
    "a block comment": ("    return lineEnd * t;", "    /* why */ return lineEnd * t;"),
    "a misspelt call": ("BokehResolve(color,", "BokehResolved(color,"),
    "an unmarked deviation": ("float(last)", "max(float(last), 1.0)"),
    "a mark with nothing on its line": ("    return lineEnd * t;", "    // differs: because\n    return lineEnd + t;"),
    "a mark without a reason": ("    return lineEnd * t;", "    return lineEnd + t; // differs:"),
    "a mark that no paper tells of": ("    return lineEnd * t;", "    return lineEnd + t; // differs: no such reason"),
    "a mark on a brace": ("    return lineEnd * t;\n}", "    return lineEnd + t;\n} // differs: because"),
    "a stray character": ("    return lineEnd * t;", "    return lineEnd * t $;"),
    "a bracket without its other": ("    return lineEnd * t;", "    return lineEnd * (t;"),
    "a brace without its other": ("    return lineEnd * t;\n}", "    return lineEnd * t;\n"),
    "a derivative": ("    return lineEnd * t;", "    return lineEnd * t + dFdx(t);"),
    "a member for another": ("settings.bleedingBias = BOKEH", "settings.bleedingMult = BOKEH"),
    "a member read for another": (
        "2.0 * length(segment.zw) * CoC * settings.imageHeight",
        "2.0 * length(segment.zw) * CoC * settings.spacing",
    ),
    "a row of the presets": (
        "//   BOKEH_PRESET_LOW        5          2.0 ",
        "//   BOKEH_PRESET_LOW        5          1.0 ",
    ),
    "a bound of a viewport": ("vec2(0.5078125, 0.5078125)", "vec2(0.5, 0.5)"),
    "a comment of the porting section": ("// Porting: image uv to texture uv", "// Porting: texture uv to image uv"),
    "a loop's iterations said to be turns": (
        "// Section 3: gather with",
        "// Section 3, 255 turns at most: gather with",
    ),
    "a macro": ("// Debug: linear depth", "#define BOKEH_MORE 1\n\n// Debug: linear depth"),
    "a condition in a body": ("    return lineEnd * t;", "#if 0\n    return lineEnd * t;\n#endif"),
}


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("name", EVERYWHERE)
def test_a_change_in_one_language_is_found(name, language):
    old, new = EVERYWHERE[name]
    old, new = (spelled(text, language) for text in (old, new))
    found = new_differences(mutated(language, old, new))
    assert found, f"{name} in {language} was not found"
    assert all(difference.where and difference.what for difference in found)


# Changes that are written in each language's own way: name -> language -> (old, new).
WRITTEN = {
    "a default": {
        "hlsl": ("#define BOKEH_MAX_COC 0.1", "#define BOKEH_MAX_COC 0.2"),
        "glsl": ("#define BOKEH_MAX_COC 0.1", "#define BOKEH_MAX_COC 0.2"),
        "wgsl": ("BOKEH_MAX_COC: f32 = 0.1", "BOKEH_MAX_COC: f32 = 0.2"),
    },
    "the spelling of a default": {
        "hlsl": ("BOKEH_BLEEDING_MULT 30.0\n", "BOKEH_BLEEDING_MULT 30.\n"),
        "glsl": ("BOKEH_BLEEDING_MULT 30.0\n", "BOKEH_BLEEDING_MULT 30.\n"),
        "wgsl": ("BOKEH_BLEEDING_MULT: f32 = 30.0", "BOKEH_BLEEDING_MULT: f32 = 30."),
    },
    "the name of a setting": {
        "hlsl": ("#ifndef BOKEH_MAX_COC\n", "#ifndef BOKEH_MAXCOC\n"),
        "glsl": ("#ifndef BOKEH_MAX_COC\n", "#ifndef BOKEH_MAXCOC\n"),
        "wgsl": ("const BOKEH_MAX_COC:", "const BOKEH_MAXCOC:"),
    },
    "an extra setting": {
        "hlsl": ("#if BOKEH_NUM_SAMPLES < 2", "#ifndef BOKEH_X\n#define BOKEH_X 1\n#endif\n#if BOKEH_NUM_SAMPLES < 2"),
        "glsl": ("#if BOKEH_NUM_SAMPLES < 2", "#ifndef BOKEH_X\n#define BOKEH_X 1\n#endif\n#if BOKEH_NUM_SAMPLES < 2"),
        "wgsl": ("const BOKEH_MAX_COC:", "const BOKEH_X: i32 = 1;\nconst BOKEH_MAX_COC:"),
    },
    "a check of a setting, or its type": {
        "hlsl": ("BOKEH_NUM_SAMPLES < 2", "BOKEH_NUM_SAMPLES < 1"),
        "glsl": ("BOKEH_NUM_SAMPLES < 2", "BOKEH_NUM_SAMPLES < 1"),
        "wgsl": ("override BOKEH_NUM_SAMPLES: i32", "override BOKEH_NUM_SAMPLES: f32"),
    },
    "parameters in another order": {
        "hlsl": ("BokehDebugDepth(float S2, float S1)", "BokehDebugDepth(float S1, float S2)"),
        "glsl": ("BokehDebugDepth(float S2, float S1)", "BokehDebugDepth(float S1, float S2)"),
        "wgsl": ("BokehDebugDepth(S2: f32, S1: f32)", "BokehDebugDepth(S1: f32, S2: f32)"),
    },
    "textures in another order": {
        "hlsl": (
            "BokehCoCMap(BOKEH_TEXELS(ColorSamp), BOKEH_TEXELS(DepthSamp),",
            "BokehCoCMap(BOKEH_TEXELS(DepthSamp), BOKEH_TEXELS(ColorSamp),",
        ),
        "glsl": (
            "BokehCoCMap(sampler2D ColorSamp, sampler2D DepthSamp,",
            "BokehCoCMap(sampler2D DepthSamp, sampler2D ColorSamp,",
        ),
        "wgsl": (
            "BokehCoCMap(ColorSamp: texture_2d<f32>, DepthSamp: texture_2d<f32>,",
            "BokehCoCMap(DepthSamp: texture_2d<f32>, ColorSamp: texture_2d<f32>,",
        ),
    },
    "a parameter renamed": {
        "hlsl": ("BokehDebugDepth(float S2, float S1)", "BokehDebugDepth(float S2, float focus)"),
        "glsl": ("BokehDebugDepth(float S2, float S1)", "BokehDebugDepth(float S2, float focus)"),
        "wgsl": ("BokehDebugDepth(S2: f32, S1: f32)", "BokehDebugDepth(S2: f32, focus: f32)"),
    },
    "a type of a parameter": {
        "hlsl": ("int i, int numSamples)", "int i, float numSamples)"),
        "glsl": ("int i, int numSamples)", "int i, float numSamples)"),
        "wgsl": ("i: i32, numSamples: i32)", "i: i32, numSamples: f32)"),
    },
    "a type of a local": {
        "hlsl": ("    int last =", "    float last ="),
        "glsl": ("    int last =", "    float last ="),
        "wgsl": ("    let last: i32 =", "    let last: f32 ="),
    },
    "a type of another language": {
        "hlsl": ("    float4 color = float4(", "    vec4 color = vec4("),
        "glsl": ("    vec4 color = vec4(", "    float4 color = float4("),
        "wgsl": ("    var color: vec4f = vec4f(", "    var color: float4 = float4("),
    },
    "a type of a result": {
        "hlsl": ("float BokehSafeDepth(", "float2 BokehSafeDepth("),
        "glsl": ("float BokehSafeDepth(", "vec2 BokehSafeDepth("),
        "wgsl": ("fn BokehSafeDepth(S2: f32) -> f32", "fn BokehSafeDepth(S2: f32) -> vec2f"),
    },
    "a half": {
        "hlsl": ("    float totalWeight =", "    half totalWeight ="),
        "glsl": ("    float totalWeight =", "    mediump float totalWeight ="),
        "wgsl": ("    var totalWeight: f32 =", "    var totalWeight: f16 ="),
    },
    "no type": {
        "hlsl": ("    float totalWeight =", "    totalWeight ="),
        "glsl": ("    float totalWeight =", "    totalWeight ="),
        "wgsl": ("    var totalWeight: f32 =", "    var totalWeight ="),
    },
    "a fetch without its coordinates": {
        language: ("SafeDepth(BokehFetchNearest(DepthSamp, uv)", "SafeDepth(BokehFetchNearest(DepthSamp)")
        for language in LANGUAGES
    },
    "a fetch of the other texture": {
        language: ("SafeDepth(BokehFetchNearest(DepthSamp, uv)", "SafeDepth(BokehFetchNearest(ColorSamp, uv)")
        for language in LANGUAGES
    },
    "a texture without its sampler": {
        "hlsl": ("BokehFetch(BOKEH_ARGUMENT(ColorSamp), uv)", "BokehFetch(ColorSamp, uv)"),
        "glsl": ("BokehFetch(ColorSamp, uv)", "BokehFetch(ColorSamp, ColorSampSampler, uv)"),
        "wgsl": ("BokehFetch(ColorSamp, ColorSampSampler, uv)", "BokehFetch(ColorSamp, uv)"),
    },
    "the sampler of another texture": {
        "hlsl": ("BOKEH_SHARED(T3Samp, T2Samp)", "BOKEH_SHARED(T3Samp, T3Samp)"),
        "glsl": ("BokehFetch(ColorSamp, uv)", "BokehFetch(ColorSamp, DepthSampSampler, uv)"),
        "wgsl": ("BokehLineSum(T3Samp, T2SampSampler,", "BokehLineSum(T3Samp, T3SampSampler,"),
    },
    "another texture with the shared sampler": {
        "hlsl": ("BOKEH_SHARED(T3Samp, T2Samp)", "BOKEH_SHARED(T4Samp, T2Samp)"),
        "glsl": ("BokehLineSum(T3Samp,", "BokehLineSum(T4Samp,"),
        "wgsl": ("BokehLineSum(T3Samp, T2SampSampler,", "BokehLineSum(T4Samp, T2SampSampler,"),
    },
    "a sampler too many": {
        "hlsl": (
            "SafeDepth(BokehFetchNearest(DepthSamp, uv)",
            "SafeDepth(BokehFetchNearest(BOKEH_ARGUMENT(DepthSamp), uv)",
        ),
        "glsl": (
            "SafeDepth(BokehFetchNearest(DepthSamp, uv)",
            "SafeDepth(BokehFetchNearest(DepthSamp, DepthSampSampler, uv)",
        ),
        "wgsl": (
            "SafeDepth(BokehFetchNearest(DepthSamp, uv)",
            "SafeDepth(BokehFetchNearest(DepthSamp, DepthSampSampler, uv)",
        ),
    },
    "a parameter with a sampler for one without": {
        "hlsl": (
            "BOKEH_TEXTURE(MapSamp), float2 uv, float4 segment",
            "BOKEH_TEXELS(MapSamp), float2 uv, float4 segment",
        ),
        "glsl": ("BokehLineSum(sampler2D MapSamp,", "BokehLineSum(sampler2D MapSamp, sampler MapSampSampler,"),
        "wgsl": (
            "BokehLineSum(MapSamp: texture_2d<f32>, MapSampSampler: sampler,",
            "BokehLineSum(MapSamp: texture_2d<f32>,",
        ),
    },
    "sampling past BokehFetch": {
        "hlsl": ("SafeDepth(BokehFetchNearest(DepthSamp, uv)", "SafeDepth(tex2D(DepthSamp, uv)"),
        "glsl": ("SafeDepth(BokehFetchNearest(DepthSamp, uv)", "SafeDepth(texture(DepthSamp, uv)"),
        "wgsl": (
            "SafeDepth(BokehFetchNearest(DepthSamp, uv)",
            "SafeDepth(textureSample(DepthSamp, DepthSampSampler, uv)",
        ),
    },
    "a member of a struct": {
        "hlsl": ("    float spacing;\n", "    float jitter;\n"),
        "glsl": ("    float spacing;\n", "    float jitter;\n"),
        "wgsl": ("    spacing: f32,\n", "    jitter: f32,\n"),
    },
    "members in another order": {
        "hlsl": ("    float rotation;\n    float squeeze;\n", "    float squeeze;\n    float rotation;\n"),
        "glsl": ("    float rotation;\n    float squeeze;\n", "    float squeeze;\n    float rotation;\n"),
        "wgsl": ("    rotation: f32,\n    squeeze: f32,\n", "    squeeze: f32,\n    rotation: f32,\n"),
    },
    "a type of a member": {
        "hlsl": ("    int sides;\n", "    float sides;\n"),
        "glsl": ("    int sides;\n", "    float sides;\n"),
        "wgsl": ("    sides: i32,\n", "    sides: f32,\n"),
    },
    "a value of a preset": {
        "hlsl": ("#define BOKEH_PRESET_SAMPLES 9", "#define BOKEH_PRESET_SAMPLES 8"),
        "glsl": ("#define BOKEH_PRESET_SAMPLES 9", "#define BOKEH_PRESET_SAMPLES 8"),
        "wgsl": ("//   BOKEH_PRESET_MEDIUM     9 ", "//   BOKEH_PRESET_MEDIUM     8 "),
    },
    "the default of the presets": {
        "hlsl": ("#define BOKEH_PRESET_SAMPLES 13", "#define BOKEH_PRESET_SAMPLES 12"),
        "glsl": ("#define BOKEH_PRESET_SAMPLES 13", "#define BOKEH_PRESET_SAMPLES 12"),
        "wgsl": ("BOKEH_NUM_SAMPLES: i32 = 13;", "BOKEH_NUM_SAMPLES: i32 = 12;"),
    },
    "an initial value of the viewport": {
        "hlsl": ("BokehViewport = float4(0.0, 0.0, 1.0, 1.0)", "BokehViewport = float4(0.0, 0.0, 1.0, 0.5)"),
        "glsl": ("BokehViewport = vec4(0.0, 0.0, 1.0, 1.0)", "BokehViewport = vec4(0.0, 0.0, 1.0, 0.5)"),
        "wgsl": ("vec4f = vec4f(0.0, 0.0, 1.0, 1.0)", "vec4f = vec4f(0.0, 0.0, 1.0, 0.5)"),
    },
    "a size of a texture": {
        "hlsl": ("    return lineEnd * t;", "    tex.GetDimensions(t);\n    return lineEnd * t;"),
        "glsl": ("    return lineEnd * t;", "    textureSize(tex, 0);\n    return lineEnd * t;"),
        "wgsl": ("    return lineEnd * t;", "    textureDimensions(tex);\n    return lineEnd * t;"),
    },
    "a parameter of the fetch": {
        "hlsl": ("BokehFetch(BOKEH_TEXTURE(tex), float2 uv)", "BokehFetch(BOKEH_TEXTURE(tex), float2 st)"),
        "glsl": ("BokehFetch(sampler2D tex, vec2 uv)", "BokehFetch(sampler2D tex, vec2 st)"),
        "wgsl": (
            "BokehFetch(tex: texture_2d<f32>, texSampler: sampler, uv: vec2f)",
            "BokehFetch(tex: texture_2d<f32>, texSampler: sampler, st: vec2f)",
        ),
    },
    "a helper without the prefix": {
        "hlsl": ("// Debug: linear", "// Debug: x\nfloat saturated(float x)\n{\n    return x;\n}\n\n// Debug: linear"),
        "glsl": ("// Debug: linear", "// Debug: x\nfloat saturated(float x)\n{\n    return x;\n}\n\n// Debug: linear"),
        "wgsl": (
            "// Debug: linear",
            "// Debug: x\nfn saturated(x: f32) -> f32\n{\n    return x;\n}\n\n// Debug: linear",
        ),
    },
    "a helper in the porting section": {
        "hlsl": ("// Porting: entry i", "float BokehX(float x)\n{\n    return x;\n}\n\n// Porting: entry i"),
        "glsl": ("// Porting: entry i", "float BokehX(float x)\n{\n    return x;\n}\n\n// Porting: entry i"),
        "wgsl": ("// Porting: entry i", "fn BokehX(x: f32) -> f32\n{\n    return x;\n}\n\n// Porting: entry i"),
    },
    "a global": {
        "hlsl": ("// Debug: linear", "static const float bokehX[2] = { 1.0, 2.0 };\n\n// Debug: linear"),
        "glsl": ("// Debug: linear", "const float bokehX = 1.0;\n\n// Debug: linear"),
        "wgsl": ("// Debug: linear", "const bokehX: f32 = 1.0;\n\n// Debug: linear"),
    },
    "a bit trick": {
        "hlsl": ("int last = max(numSamples, 2) - 1;", "int last = (numSamples | 2) - 1;"),
        "glsl": ("int last = max(numSamples, 2) - 1;", "int last = (numSamples | 2) - 1;"),
        "wgsl": ("let last: i32 = max(numSamples, 2) - 1;", "let last: i32 = (numSamples | 2) - 1;"),
    },
}


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("name", WRITTEN)
def test_a_change_written_in_a_language_is_found(name, language):
    assert new_differences(mutated(language, *WRITTEN[name][language])), f"{name} in {language} was not found"


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_renamed_local_is_found(language):
    key = parity.LIBRARY[language]
    found = new_differences({key: re.sub(r"\bsampleCoords\b", "coords", TEXTS[key])})
    assert any("BokehDepthOfField" in difference.where for difference in found)


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_function_dropped_moved_or_repeated_is_found(language):
    key = parity.LIBRARY[language]
    moved = parity.columns("BokehDebugCoC")[language] + "\n\n"
    assert new_differences({key: replaced(TEXTS[key], moved, "")})
    before = replaced(replaced(TEXTS[key], moved, ""), "// Debug: linear depth", moved + "// Debug: linear depth")
    assert new_differences({key: before})
    rule = listing.RULE + "// [8]"
    assert new_differences({key: replaced(replaced(TEXTS[key], moved, ""), rule, moved + rule)})
    again = replaced(TEXTS[key], moved, moved + moved)
    assert any("overload" in difference.what for difference in new_differences({key: again}))


@pytest.mark.parametrize("language", LANGUAGES)
def test_line_breaks_and_spaces_do_not_matter(language):
    old = "BokehSafeChannel(color.r), BokehSafeChannel(color.g),"
    new = "BokehSafeChannel( color.r ),\n        BokehSafeChannel(color.g),"
    assert not new_differences(mutated(language, old, new))


@pytest.mark.parametrize("language", LANGUAGES)
def test_hardly_a_token_can_go_unnoticed(language):
    """Every 23rd token of sections [3] to [9] dropped, but for the statement of a marked line."""
    key = parity.LIBRARY[language]
    text = TEXTS[key]
    start = text.index("// [3] Listing 1")
    later = list(re.finditer(r"//[^\n]*|[\w.]+|[^\w\s]", text[start:]))
    assert len(later) > 2000
    marked = {one.line + more for one in parity.deviations() if one.file == key for more in (0, 1)}
    for token in later[::23]:
        if listing.line_of(text, start + token.start()) in marked:
            continue
        dropped = text[: start + token.start()] + text[start + token.end() :]
        assert new_differences({key: dropped}), f"{token[0]} dropped at {start + token.start()}"


# ----------------------------------------------------------------------------------------------------------------------
# layers
# ----------------------------------------------------------------------------------------------------------------------

# name -> (old, new), the same in every language
IN_LAYERS = {
    "a literal": ("min(0.01 + brightness, 10000.0)", "min(0.02 + brightness, 10000.0)"),
    "a texture": ("BokehNearSlope(tile.r)", "BokehNearSlope(tile.g)"),
    "a function": ("BokehNearSlope(tile.r)", "BokehFarSlope(tile.r)"),
    "a doc comment": ("MaxCoC        fraction of", "MaxCoC        part of"),
    "the first comment": ("// Layers: where the image lies", "// Layers: where an image lies"),
    "a heading": ("[13] the picture\n// ---", "[13] a picture\n// ---"),
    "a section number": ("[13] the picture\n// ---", "[14] the picture\n// ---"),
    "the contract": ("Places and CoC are in pixels here.", "Places and CoC are in texels here."),
    "a default in the table": ("//   BOKEH_LAYER_CELLS       12 ", "//   BOKEH_LAYER_CELLS       13 "),
    "a row of the presets": ("//   BOKEH_PRESET_LOW        2 ", "//   BOKEH_PRESET_LOW        1 "),
    "the default row of the presets": ("//   BOKEH_PRESET_MEDIUM     3 ", "//   BOKEH_PRESET_MEDIUM     4 "),
    "sampling past BokehFetchTexture": ("BokehFetchTexture(tex, ", "textureLod(tex, "),
    "the version": ("Version 0.2.0.", "Version 0.3.0."),
    "a tag line": ("// Layers: largest of the three channels", "// Largest of the three channels"),
}
CONFIGURED = {
    "hlsl": ("#define BOKEH_PRESET_CELLS 8", "#define BOKEH_PRESET_CELLS 9"),
    "glsl": ("#define BOKEH_PRESET_CELLS 12", "#define BOKEH_PRESET_CELLS 13"),
    "wgsl": ("override BOKEH_LAYER_CELLS: i32 = 12;", "override BOKEH_LAYER_CELLS: i32 = 13;"),
}


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("name", IN_LAYERS)
def test_a_change_in_the_layers_is_found(name, language):
    key = parity.LAYERS[language]
    old, new = IN_LAYERS[name]
    if language == "hlsl" and old.endswith("(tex, "):
        old = "BokehFetchTexture(BOKEH_ARGUMENT(tex), "
    assert new_differences({key: replaced(TEXTS[key], old, new)})


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_change_in_the_configuration_of_the_layers_is_found(language):
    key = parity.LAYERS[language]
    assert new_differences({key: replaced(TEXTS[key], *CONFIGURED[language])})


@pytest.mark.parametrize("language", LANGUAGES)
def test_hardly_a_token_of_the_layers_can_go_unnoticed(language):
    """Every 23rd token of the functions dropped."""
    key = parity.LAYERS[language]
    text = TEXTS[key]
    start = text.index(parity.SHARED_LAYERS)
    for token in list(re.finditer(r"//[^\n]*|[\w.]+|[^\w\s]", text[start:]))[::23]:
        dropped = text[: start + token.start()] + text[start + token.end() :]
        assert new_differences({key: dropped}), f"{token[0]} dropped at {start + token.start()}"


@pytest.mark.parametrize("language", ["hlsl", "glsl"])
def test_the_layers_of_the_passes_can_be_left_out(language):
    """Their helpers and entries are in an #ifdef, which WGSL has not."""
    key = parity.PASSES[language]
    start = parity.ENTRIES.search(TEXTS[key]).end()
    head, text = TEXTS[key][:start], TEXTS[key][start:]
    assert new_differences({key: head + replaced(text, "#ifdef BOKEH_LAYERS\n", "")})
    assert new_differences({key: head + replaced(text, "#ifdef BOKEH_LAYERS\n", "#ifdef BOKEH_LAYER\n")})


# One change to all three languages: name -> (old, new), written as in GLSL.
ALIKE = {
    "nine parameters": (
        "BokehDebugDepth(float S2, float S1)",
        "BokehDebugDepth(float a, float b, float c, float d, float e,\n    float f, float g, float S2, float S1)",
    ),
    "a tag line": ("// Exact: the samples along one line", "// The samples along one line"),
    "a bit operator": ("max(numSamples, 2) - 1;", "(numSamples | 2) - 1;"),
    "a swizzle assigned": ("    return lineEnd * t;", "    lineEnd.xy = lineEnd * t;\n    return lineEnd;"),
    "turns": ("// Debug: linear depth as", "// Debug: after 255 turns, linear depth as"),
    "turns over a line break": ("// Debug: linear depth as", "// Debug: after 255\n//   turns, linear depth as"),
    "behind": ("// Debug: linear depth as", "// Debug: behind the `#version` line, linear depth as"),
    "count as": ("// Debug: linear depth as", "// Debug: what does not count as metres, linear depth as"),
    "counts as": ("// Debug: linear depth as", "// Debug: what counts as metres, linear depth as"),
    "at hand": ("// Debug: linear depth as", "// Debug: with no GPU at hand, linear depth as"),
    "hands on": ("// Debug: linear depth as", "// Debug: what a pass hands on, linear depth as"),
    "told": ("// Debug: linear depth as", "// Debug: as told, linear depth as"),
    "spelt": ("// Debug: linear depth as", "// Debug: spelt, linear depth as"),
}


@pytest.mark.parametrize("name", ALIKE)
def test_a_rule_broken_in_all_languages_is_found(name):
    """Where the languages agree only the rules are left."""
    texts = {}
    for language, key in parity.LIBRARY.items():
        old, new = ALIKE[name]
        if language == "wgsl":
            old, new = (re.sub(r"\bfloat (\w+)", r"\1: f32", text) for text in (old, new))
        texts[key] = replaced(TEXTS[key], old, new)
    found = new_differences(texts)
    assert {difference.where.partition("/")[0] for difference in found} == set(LANGUAGES) - (
        {"wgsl"} if name == "nine parameters" else set()
    )


@pytest.mark.parametrize(
    "text",
    ["1 turns the leakage test off", "1 or more turns\n//   the test off", "behind the focus", "behind a near object"],
)
def test_words_in_their_plain_sense_may_stay(text):
    assert not list(
        rules.findings(
            replaced(TEXTS["glsl/bokeh.glsl"], "// Debug: linear", f"// Debug: {text}\n//\n// Debug: linear"),
            "glsl",
            True,
        )
    )


# ----------------------------------------------------------------------------------------------------------------------
# marked deviations
# ----------------------------------------------------------------------------------------------------------------------

REASON = "this compiler cannot multiply a vector by a scalar"


def marked(language: str, statement: str = "return t * lineEnd;") -> dict[str, str]:
    """A marked statement in one language, with its reason in docs/paper.md (over a line break)."""
    written = REASON.replace("cannot multiply", "cannot\nmultiply")
    return {
        **mutated(language, "return lineEnd * t;", f"{statement} // differs: {REASON}"),
        parity.PAPER: f"Deviations:\n- {written}.\n- 255 loops.\n",
    }


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_marked_statement_is_exempt_and_listed(language):
    texts = marked(language)
    assert not new_differences(texts)
    found = [(one.file, one.reason) for one in parity.deviations(texts)]
    assert sorted(found) == sorted([(parity.LIBRARY[language], REASON), (parity.LIBRARY["hlsl"], "255 loops")])


@pytest.mark.parametrize("language", LANGUAGES)
def test_an_extra_marked_statement_is_exempt(language):
    assert not new_differences(
        {
            **mutated(
                language, "    return lineEnd * t;", f"    t += 0.0; // differs: {REASON}\n    return lineEnd * t;"
            ),
            parity.PAPER: f"{REASON}, 255 loops",
        }
    )


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_mark_exempts_one_statement_only(language):
    texts = marked(language, "t *= 2.0; return t * lineEnd;")
    assert new_differences(texts)


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_mark_does_not_exempt_the_other_languages_from_each_other(language):
    texts = marked(language)
    other = next(one for one in LANGUAGES if one != language)
    assert new_differences({**texts, **mutated(other, "return lineEnd * t;", "return lineEnd - t;")})


def test_a_marked_signature_and_a_marked_default_are_exempt():
    texts = {
        **mutated(
            "glsl", "vec2 BokehLineEnd(float angle,", f"vec2 BokehLineEnd( // differs: {REASON}\n    highp float angle,"
        ),
        parity.PAPER: f"{REASON}, 255 loops",
    }
    assert not new_differences(texts)
    texts = {
        **mutated("wgsl", "BOKEH_MAX_COC: f32 = 0.1;", f"BOKEH_MAX_COC: f32 = 0.2; // differs: {REASON}"),
        parity.PAPER: f"{REASON}, 255 loops",
    }
    assert not new_differences(texts)


# ----------------------------------------------------------------------------------------------------------------------
# passes
# ----------------------------------------------------------------------------------------------------------------------

PARAMETER = {
    "hlsl": "BOKEH_PARAMETER(float, BokehAngleB, 8)\n",
    "glsl": "BOKEH_PARAMETER(float, BokehAngleB)\n",
    "wgsl": "    BokehAngleB: f32,\n",
}
BLUR_ENTRY = {
    "hlsl": ("float4 BokehNaiveGrid_PS(", "float4 BokehGrid_PS("),
    "glsl": ("#elif BOKEH_PASS == BOKEH_NAIVE_GRID", "#elif BOKEH_PASS == BOKEH_GRID"),
    "wgsl": ("fn BokehNaiveGrid_PS(", "fn BokehGrid_PS("),
}
UNPREFIXED = {
    "hlsl": ("Texture2D BokehKernelSamp :", "Texture2D KernelSamp :"),
    "glsl": ("uniform sampler2D BokehKernelSamp;", "uniform sampler2D KernelSamp;"),
    "wgsl": ("var BokehKernelSamp:", "var KernelSamp:"),
}
DIRECT = {
    "hlsl": ("BokehFetch(BOKEH_ARGUMENT(BokehColorSamp), uv)", "tex2D(BokehColorSamp, uv)"),
    "glsl": ("BokehFetch(BokehColorSamp, BokehUV)", "texture(BokehColorSamp, BokehUV)"),
    "wgsl": ("BokehFetch(BokehColorSamp, ", "textureSample(BokehColorSamp, "),
}


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize(
    "change",
    [
        lambda language: (PARAMETER[language], ""),
        lambda language: (PARAMETER[language], PARAMETER[language].replace("AngleB", "AngleC")),
        lambda language: (PARAMETER[language], re.sub("float|f32", "int", PARAMETER[language])),
        lambda language: (PARAMETER[language], PARAMETER[language] * 2),
        lambda language: BLUR_ENTRY[language],
        lambda language: UNPREFIXED[language],
        lambda language: DIRECT[language],
        lambda language: ("Version 0.2.0.", "Version 0.3.0."),
        lambda language: ("// BokehDebugMode: 0 colour", "// BokehDebugMode: 0\tcolour"),
        lambda language: ("// BokehDebugMode: 0 colour", "// BokehDebugMode: 0 colour\\\n"),
    ],
    ids=[
        "parameter dropped",
        "parameter renamed",
        "parameter of another type",
        "parameter twice",
        "entry point renamed",
        "global without the prefix",
        "sampling past BokehFetch",
        "version",
        "tab",
        "backslash",
    ],
)
def test_a_change_in_a_passes_file_is_found(change, language):
    key = parity.PASSES[language]
    assert new_differences({key: replaced(TEXTS[key], *change(language))})


# In the helpers and entries: name -> (old, new), the same in every language.
BODIES = {
    "an argument": ("BokehMakePolygon(sides, ", "BokehMakePolygon(sides + 0, "),
    "the index of a pass": ("BokehBegin(uv, 1.0)", "BokehBegin(uv, 0.0)"),
    "the sides": ("uv, 8)", "uv, 6)"),
    "a member": ("settings.bleedingBias = ", "settings.bleedingMult = "),
    "a target": ("targets.T3", "targets.T2"),
    "a texture": ("BokehColorSampC", "BokehColorSampB"),
    "a parameter of the block": ("settings, BokehBlurCoC > 0.5", "settings, BokehUseMax > 0.5"),
    "a comparison": ("BokehUseMax > 0.5", "BokehUseMax < 0.5"),
    "a statement dropped": ("    BokehUseViewport();\n", ""),
    "a comment": ("// exact, first pass", "// exact, second pass"),
    "a comment of an entry": ("// BokehDebugMode: 0 colour, 1 depth", "// BokehDebugMode: 0 depth, 1 colour"),
    "a row of the table": ("a grid of samples", "a grid"),
    "what a row reads": ("ColorSamp, DepthSamp, KernelSamp", "ColorSamp, KernelSamp"),
}


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("name", BODIES)
def test_a_change_in_the_body_of_a_pass_is_found(name, language):
    key = parity.PASSES[language]
    old, new = BODIES[name]
    text = TEXTS[key]
    if language == "wgsl":
        old = re.sub(r"\b(BokehUseMax|BokehBlurCoC)\b", r"bokehParameters.\1", old)
        new = re.sub(r"\b(BokehUseMax|BokehBlurCoC)\b", r"bokehParameters.\1", new)
    if language == "glsl" and old.startswith("uv,"):
        old, new = f"BokehUV, {old[4:]}", f"BokehUV, {new[4:]}"
    # past the bindings, where a texture has its name
    start = 0 if "Samp, " in old or "grid" in old else text.index(" shaders\n// ---")
    assert new_differences({key: text[:start] + replaced(text[start:], old, new)})


@pytest.mark.parametrize("language", LANGUAGES)
def test_hardly_a_token_of_a_pass_can_go_unnoticed(language):
    """Every 11th token of the helpers and entries dropped."""
    key = parity.PASSES[language]
    text = TEXTS[key]
    start = parity.ENTRIES.search(text).end()
    for token in list(re.finditer(r"//[^\n]*|[\w.]+|[^\w\s]", text[start:]))[::11]:
        dropped = text[: start + token.start()] + text[start + token.end() :]
        assert new_differences({key: dropped}), f"{token[0]} dropped at {start + token.start()}"


@pytest.mark.parametrize("language", LANGUAGES)
def test_parameters_in_another_order_are_found(language):
    key = parity.PASSES[language]
    text = re.sub(r"\bBokehAngleB\b", "BokehX", TEXTS[key])
    text = re.sub(r"\bBokehAspectRatio\b", "BokehAngleB", text)
    assert new_differences({key: re.sub(r"\bBokehX\b", "BokehAspectRatio", text)})


def test_hlsl_registers_and_glsl_pass_numbers_are_checked():
    key = parity.PASSES["hlsl"]
    assert new_differences({key: replaced(TEXTS[key], "BokehAngleB, 8)", "BokehAngleB, 9)")})
    key = parity.PASSES["glsl"]
    assert new_differences({key: replaced(TEXTS[key], "#define BOKEH_DEBUG 20", "#define BOKEH_DEBUG 6")})


# ----------------------------------------------------------------------------------------------------------------------
# columns
# ----------------------------------------------------------------------------------------------------------------------


def test_columns_are_the_text_of_the_files():
    found = parity.columns("BokehDepthOfField")
    assert list(found) == list(LANGUAGES)
    for language, text in found.items():
        assert text in TEXTS[parity.LIBRARY[language]]
        assert text.startswith("// Listing 3: DepthOfField,") and text.endswith("\n}")


def test_an_unknown_function_is_a_user_error_that_lists_the_names():
    with pytest.raises(UserError, match="BokehNoSuch.*BokehDepthOfField.*BokehDebugFocus"):
        parity.columns("BokehNoSuch")


def test_an_unknown_file_is_a_user_error():
    with pytest.raises(UserError, match="glsl/boke.glsl"):
        parity.check({"glsl/boke.glsl": ""})


def test_three_columns_are_printed():
    console = Console(file=io.StringIO(), width=300)
    parity.render_columns("BokehDepthOfField", console)
    printed = console.file.getvalue()
    rows = [line for line in printed.splitlines() if "BokehResolve(color, totalWeight" in line]
    assert len(rows) == 1 and rows[0].count("BokehResolve") == 3
    assert all(language.upper() in printed for language in LANGUAGES)
