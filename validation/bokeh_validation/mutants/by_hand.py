"""Mistakes that no operator makes: in the settings, and in one language when porting to it."""

import re
from collections.abc import Iterator

from bokeh_validation import shaders
from bokeh_validation.errors import UserError
from bokeh_validation.mutants import operators
from bokeh_validation.mutants.mutant import Mutant, originals

LIBRARY, LAYERS, PASSES = "bokeh", "bokeh_layers", "bokeh_passes"
DRIVERS = {"glsl": "egl", "hlsl": "dxc", "wgsl": "wgpu"}
# Every slot and every way to read a texture
HOSTILE = ("hostile depth, paper", "hostile depth, adaptive", "hostile depth, naive", "hostile depth, naive-grid")
PORTED = ("map, lens", "paper star", "naive", "naive, many", "exact decagon", "layered hexagon")
# language, file, function or '' for all of the file, what stands there, and what does now; '<->': each for the other
FORGOTTEN = (
    ("hlsl", LIBRARY, "ChannelSecond", "BOKEH_SHARED(T3Samp", "BOKEH_SHARED(T4Samp"),
    ("hlsl", LIBRARY, "", "#define BOKEH_PRESET_SPACING 2.0", "#define BOKEH_PRESET_SPACING 3.0"),
    ("hlsl", LAYERS, "LayerSecond", "BOKEH_SHARED(T3Samp", "BOKEH_SHARED(T4Samp"),
    ("hlsl", PASSES, "", "(float, BokehAngle, 7)", "<->(float, BokehAngleB, 8)"),
    ("hlsl", PASSES, "DecagonFirst_PS", "targets.T5", "targets.T4"),
    ("glsl", LIBRARY, "", "#define BOKEH_PRESET_SAMPLES 17", "#define BOKEH_PRESET_SAMPLES 16"),
    ("glsl", LIBRARY, "", "22       20", "22       25"),
    ("glsl", LAYERS, "", "#define BOKEH_PRESET_CELLS 8", "#define BOKEH_PRESET_CELLS 12"),
    ("wgsl", LIBRARY, "LineEnd", " / aspectRatio", ""),
    ("wgsl", LIBRARY, "", "BOKEH_MAX_COC: f32 = 0.1;", "BOKEH_MAX_COC: f32 = 0.2;"),
    ("wgsl", LIBRARY, "", "BOKEH_SPACING: f32 = 1.0;", "BOKEH_SPACING: f32 = 2.0;"),
    ("wgsl", LIBRARY, "", "    spacing: f32,", "<->    jitter: f32,"),
    ("wgsl", LAYERS, "", "BOKEH_LAYER_RINGS: i32 = 3;", "BOKEH_LAYER_RINGS: i32 = 2;"),
    ("wgsl", PASSES, "LinearDepth_PS", "BokehNear", "<->BokehFar"),
)
# The same with the driver that has to show it, since the parity check leaves a language its own way here
PORTING = (
    ("hlsl", LIBRARY, "FetchTexture", "coords, 0.0", "coords + 0.01, 0.0"),
    ("hlsl", LIBRARY, "FetchTexture", "coords, 0.0, 0.0", "coords + 0.01, 0.0, 0.0", "d3d9"),
    ("hlsl", LIBRARY, "FetchNearest", "min(texel,", "min(texel + int2(1, 0),"),
    ("hlsl", LIBRARY, "FetchTable", "float(i) + 0.5", "float(i) + 1.5", "d3d9"),
    ("hlsl", LIBRARY, "NaiveGather", "int i = j;", "int i = 0;", "d3d9"),
    ("hlsl", LIBRARY, "NaiveGather", "j + BOKEH_LOOP_LIMIT, BOKEH", "j + BOKEH_LOOP_LIMIT - 1, BOKEH", "d3d9"),
    ("glsl", LIBRARY, "FetchTexture", "coords, 0.0", "coords + 0.01, 0.0"),
    ("glsl", LIBRARY, "FetchNearest", "min(texel,", "min(texel + ivec2(1, 0),"),
    ("glsl", LIBRARY, "FetchTable", "min(i, count - 1)", "min(i, count - 2)"),
    ("wgsl", LIBRARY, "FetchTexture", "coords, 0.0", "coords + 0.01, 0.0"),
    ("wgsl", LIBRARY, "FetchNearest", "(uv)", "(uv.yx)"),
    ("wgsl", LIBRARY, "FetchNearest", "min(texel,", "min(texel + vec2i(1, 0),"),
    ("wgsl", LIBRARY, "FetchTable", "min(i, count - 1)", "min(i, count - 2)"),
    ("hlsl", PASSES, "", "BokehColorSampB : register(t", "<->BokehColorSampC : register(t"),
    ("hlsl", PASSES, "", "BokehColorSampB : register(s", "<->BokehColorSampC : register(s", "d3d9"),
    ("hlsl", PASSES, "", "BokehKernelSamp : register(t", "<->BokehColorSampD : register(t"),
    ("wgsl", PASSES, "", " var BokehColorSampB:", "<-> var BokehColorSampC:"),
    ("wgsl", PASSES, "", " var BokehDepthSamp:", "<-> var BokehColorSampD:"),
    ("hlsl", PASSES, "FullScreen_VS", "1.0 - uv.y * 2.0", "uv.y * 2.0 - 1.0"),
    ("hlsl", PASSES, "FullScreen_VS", "float2(-1.0, 1.0)", "float2(0.0, 0.0)", "d3d9"),
    ("glsl", PASSES, "FullScreen_VS", "vec4(BokehUV * 2.0 - 1.0,", "vec4(vec2(2.0, -2.0) * BokehUV + vec2(-1.0, 1.0),"),
    ("glsl", PASSES, "FullScreen_VS", "== 1 ? 2.0", "== 1 ? 1.0"),
    ("wgsl", PASSES, "FullScreen_VS", "1.0 - uv.y * 2.0", "uv.y * 2.0 - 1.0"),
    ("wgsl", PASSES, "FullScreen_VS", "uv.x * 2.0 - 1.0", "1.0 - uv.x * 2.0"),
)
# Alike in all languages, but only Direct3D 9 takes NaN for farther than every sample
ON_DIRECT3D_9 = tuple(
    ("hlsl", LIBRARY, function, "BokehSafeDepth(BokehFetchNearest", "(BokehFetchNearest", "d3d9")
    for function in ("DepthOfField", "DepthOfFieldAdaptive", "NaiveGather", "NaiveGrid")
)
# Alike in all languages: what a user gets who sets nothing, and what the reference takes for its limits
DEFAULTS = (
    *(
        ("glsl", LIBRARY, "", f"#define BOKEH_{name} {value}", f"#define BOKEH_{name} {other}")
        for name, value, other in (
            ("MAX_COLOR", "65504.0", "60000.0"),
            ("MAX_DEPTH", "1000000000.0", "1000000.0"),
            ("MIN_DEPTH", "0.000001", "0.001"),
            ("SENSOR_HEIGHT", "0.024", "0.036"),
            ("MAX_COC", "0.1", "0.2"),
            ("BLEEDING_BIAS", "0.02", "0.03"),
            ("BLEEDING_MULT", "30.0", "20.0"),
            ("PRESET_SAMPLES", "13", "12"),
        )
    ),
    (
        "glsl",
        LAYERS,
        "",
        "BOKEH_PRESET_RINGS 3\n#define BOKEH_PRESET_CELLS 12",
        "BOKEH_PRESET_RINGS 2\n#define BOKEH_PRESET_CELLS 12",
    ),
)
# kind -> mistakes, and the frames that are asked
KINDS = {
    "one language": (FORGOTTEN, ()),
    "porting": (PORTING, PORTED),
    "NaN": (ON_DIRECT3D_9, HOSTILE),
    "default": (DEFAULTS, ("values", "map, lens", "depth, infinite")),
}


def mutants() -> Iterator[Mutant]:
    """Each of them. Raises UserError where one does not fit the shaders."""
    for kind, (mistakes, asked) in KINDS.items():
        for number, (language, file, function, old, new, *driver) in enumerate(mistakes, 1):
            key, place = f"{language}/{file}.{language}", f"Bokeh{function}" if function else file
            pairs = {old: new.removeprefix("<->")}
            if new.startswith("<->"):
                pairs |= {after: before for before, after in pairs.items()}
            text = before = originals()[key]
            for start, end in reversed(_bodies(key, place) if function else [(0, len(text))]):
                pattern = "|".join(map(re.escape, pairs))
                body = re.sub(pattern, lambda found, pairs=pairs: pairs[found[0]], text[start:end])
                text = text[:start] + body + text[end:]
            if text == before:
                raise UserError(f"mutants: {old!r} is not in {place} of {key}. Bring mutants/by_hand.py up to date.")
            name = f"{kind.replace(' ', '-')}-{number}"
            asks = driver[0] if driver else DRIVERS[language] if asked else ""
            yield Mutant(name, kind, language, place, (old, new), {key: text}, asks, kind != "porting", asked)


def _bodies(key: str, place: str) -> list[tuple[int, int]]:
    """(start, end) of those of a function or entry; HLSL may have two of a name, in two branches of an #if."""
    if key.startswith("glsl"):
        return [operators.functions()[place][2:]]
    return [found.span("body") for found in shaders.FUNCTION.finditer(originals()[key]) if found["name"] == place]
