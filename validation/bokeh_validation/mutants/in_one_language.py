"""Mistakes made in one language: the parity check finds those in what it compares; porting and bindings it does not."""

from bokeh_validation.mutants.killers import LEAKS, PARITY, on_device
from bokeh_validation.mutants.mutant import Mutant

DRIVERS = {"hlsl": "dxc", "glsl": "egl", "wgsl": "wgpu"}
D3D9 = on_device("d3d9")
MANY = "test_survivors.py::test_many_offsets[d3d9]"


def row(
    name: str, kind: str, file: str, within: str | None, old: str, new: str, *killers: str, count: int = 1
) -> Mutant:
    """In the language that the name begins with; parity is asked first, then the tests named or those of a device."""
    return _mutant(name, kind, file, within, ((old, new),), killers, count)


def swap(name: str, kind: str, file: str, within: str | None, one: str, other: str, *killers: str) -> Mutant:
    """Two texts in each other's place."""
    return _mutant(name, kind, file, within, ((one, "$"), (other, one), ("$", other)), killers)


def _mutant(name, kind, file, within, edits, killers, count=1) -> Mutant:
    language = name.partition("-")[0]
    asked = (PARITY, *(killers or on_device(DRIVERS[language])))
    return Mutant(name, kind, file, within, edits, asked, (language,), count)


# fmt: off
IN_ONE_LANGUAGE: tuple[Mutant, ...] = (
    # layers forgotten
    row("hlsl-layers-share", "one language", "layers", "LayerShare", "- 2.0", "- 1.0"),
    row("glsl-layers-share", "one language", "layers", "LayerShare", "- 2.0", "- 1.0"),
    row("wgsl-layers-share", "one language", "layers", "LayerShare", "- 2.0", "- 1.0"),
    row("hlsl-layers-texture", "one language", "layers", "LayerSecond", "BOKEH_SHARED(T3Samp", "BOKEH_SHARED(T4Samp"),
    row("glsl-layers-constant", "one language", "layers", None, "#define BOKEH_PRESET_CELLS 8",
        "#define BOKEH_PRESET_CELLS 12"),
    row("wgsl-layers-constant", "one language", "layers", None, "BOKEH_LAYER_RINGS: i32 = 3;",
        "BOKEH_LAYER_RINGS: i32 = 2;"),
    row("hlsl-layers-gather", "one language", "layers", "Layered", "outer * outer - inner * inner", "outer * outer"),
    row("wgsl-layers-cubic", "one language", "layers", "FetchLayer", "texel.y + 2.0", "texel.y + 1.0"),
    # forgotten; the parity check sees them
    row("hlsl-coc-sign", "one language", "library", "CoC", "S2 - focus", "S2 + focus"),
    row("hlsl-combine", "one language", "library", "Combine", "min(a, b)", "max(a, b)"),
    row("glsl-leakage", "one language", "library", "LeakageWeight", "sampleDepth < centerDepth",
        "sampleDepth > centerDepth"),
    row("glsl-last-sample", "one language", "library", "NaiveGrid", "i < BOKEH_NUM_SAMPLES",
        "i < BOKEH_NUM_SAMPLES - 1"),
    row("wgsl-aspect", "one language", "library", "LineEnd", " / aspectRatio", ""),
    row("wgsl-offsets", "one language", "library", "MakeOffsets", "max(numSamples, 2) - 1", "max(numSamples, 2)"),
    row("wgsl-default", "one language", "library", None, "BOKEH_MAX_COC: f32 = 0.1;", "BOKEH_MAX_COC: f32 = 0.2;"),
    row("glsl-signed", "one language", "library", "SignedCoC", "CoC = -CoC;", "CoC = CoC;"),
    row("hlsl-member", "one language", "library", "LineSum", "settings.imageHeight", "settings.aspectRatio"),
    swap("wgsl-struct", "one language", "library", None, "    spacing: f32,", "    jitter: f32,"),
    row("hlsl-shared-texture", "one language", "library", "ChannelSecond", "BOKEH_SHARED(T3Samp",
        "BOKEH_SHARED(T4Samp"),
    row("glsl-preset", "one language", "library", None, "#define BOKEH_PRESET_SAMPLES 17",
        "#define BOKEH_PRESET_SAMPLES 16"),
    row("hlsl-preset", "one language", "library", None, "#define BOKEH_PRESET_SPACING 2.0",
        "#define BOKEH_PRESET_SPACING 3.0"),
    row("wgsl-spacing", "one language", "library", None, "BOKEH_SPACING: f32 = 1.0;", "BOKEH_SPACING: f32 = 2.0;"),
    row("hlsl-first-loop", "one language", "library", "NaiveGather", "int i = j;", "int i = 0;", MANY),
    row("hlsl-second-loop", "one language", "library", "NaiveGather", "min(j + BOKEH_LOOP_LIMIT, BOKEH_NUM_SAMPLES)",
        "min(j + BOKEH_LOOP_LIMIT - 1, BOKEH_NUM_SAMPLES)", MANY),
    swap("hlsl-parameters", "one language", "passes", None, "(float, BokehAngle, 7)", "(float, BokehAngleB, 8)"),
    # porting
    row("hlsl-fetch", "porting", "library", "FetchTexture", "coords, 0.0", "coords + 0.01, 0.0", count=2),
    row("hlsl-fetch-sm3", "porting", "library", "FetchTexture", "coords, 0.0, 0.0", "coords + 0.01, 0.0, 0.0", *D3D9),
    row("glsl-fetch", "porting", "library", "FetchTexture", "coords, 0.0", "coords + 0.01, 0.0"),
    row("wgsl-fetch", "porting", "library", "FetchTexture", "coords, 0.0", "coords + 0.01, 0.0"),
    row("glsl-raw-depth", "porting", "library", "FetchNearest", "BokehToTexture(uv)", "uv", LEAKS),
    row("wgsl-fetch-nearest", "porting", "library", "FetchNearest", "(uv)", "(uv.yx)"),
    row("glsl-texel", "porting", "library", "FetchNearest", "min(texel,", "min(texel + ivec2(1, 0),"),
    row("hlsl-texel", "porting", "library", "FetchNearest", "min(texel,", "min(texel + int2(1, 0),"),
    row("wgsl-texel", "porting", "library", "FetchNearest", "min(texel,", "min(texel + vec2i(1, 0),"),
    row("glsl-last-texel", "guard", "library", "FetchNearest", "size - ivec2(1, 1)", "size",
        "test_drivers.py::test_every_entry[osmesa paper]"),
    row("glsl-table", "porting", "library", "FetchTable", "min(i, count - 1)", "min(i, count - 2)"),
    row("hlsl-table-sm3", "porting", "library", "FetchTable", "float(i) + 0.5", "float(i) + 1.5", *D3D9),
    row("wgsl-table", "porting", "library", "FetchTable", "min(i, count - 1)", "min(i, count - 2)"),
    # bindings: two declarations with each other's number
    swap("hlsl-textures", "binding", "passes", None, "BokehColorSampB : register(t", "BokehColorSampC : register(t"),
    swap("hlsl-textures-sm3", "binding", "passes", None, "BokehColorSampB : register(s", "BokehColorSampC : register(s",
         *D3D9),
    swap("wgsl-textures", "binding", "passes", None, " var BokehColorSampB:", " var BokehColorSampC:"),
    swap("wgsl-depth", "binding", "passes", None, " var BokehDepthSamp:", " var BokehColorSampD:"),
    swap("hlsl-kernel", "binding", "passes", None, "BokehKernelSamp : register(t", "BokehColorSampD : register(t"),
    # vertex shaders
    row("hlsl-upside-down", "vertex shader", "passes", "FullScreen", "1.0 - uv.y * 2.0", "uv.y * 2.0 - 1.0"),
    row("hlsl-half-pixel", "vertex shader", "passes", "FullScreen", "float2(-1.0, 1.0)", "float2(0.0, 0.0)", *D3D9),
    row("glsl-upside-down", "vertex shader", "passes", "FullScreen", "vec4(BokehUV * 2.0 - 1.0,",
        "vec4(vec2(2.0, -2.0) * BokehUV + vec2(-1.0, 1.0),"),
    row("glsl-small-triangle", "vertex shader", "passes", "FullScreen", "== 1 ? 2.0", "== 1 ? 1.0"),
    row("wgsl-upside-down", "vertex shader", "passes", "FullScreen", "1.0 - uv.y * 2.0", "uv.y * 2.0 - 1.0"),
    row("wgsl-mirrored", "vertex shader", "passes", "FullScreen", "uv.x * 2.0 - 1.0", "1.0 - uv.x * 2.0"),
    # passes; the parity check sees them
    row("hlsl-viewport", "pass", "passes", "UseViewport", "BokehViewportX, BokehViewportY",
        "BokehViewportY, BokehViewportX"),
    row("glsl-viewport-forgotten", "pass", "passes", "Begin", "BokehUseViewport();", ""),
    row("wgsl-viewport-forgotten", "pass", "passes", "CoCMap", "BokehUseViewport();", ""),
    row("hlsl-last-target", "pass", "passes", "DecagonFirst", "targets.T5", "targets.T4"),
    row("hlsl-squeeze", "pass", "passes", "NaiveGather", " / BokehSqueeze", ""),
    row("glsl-second-target", "pass", "passes", "HexagonSecond", "BokehColorSamp, BokehColorSampB,",
        "BokehColorSamp, BokehColorSamp,"),
    row("glsl-sides", "pass", "passes", "OctagonFirst", ", 8)", ", 10)"),
    row("glsl-use-max", "pass", "passes", "DepthOfFieldFinal", "BokehUseMax > 0.5", "BokehUseMax > 1.5"),
    row("glsl-grid-angle", "pass", "passes", "NaiveGrid", "BokehAngleB", "BokehAngle"),
    row("glsl-grid-squeeze", "pass", "passes", "NaiveGrid", " / BokehSqueeze", "", count=2),
    row("glsl-constant-coc", "pass", "passes", "ConstantCoC", "0.0, BokehMaxCoC", "-1.0, BokehMaxCoC"),
    swap("wgsl-near-far", "pass", "passes", "LinearDepth", "BokehNear", "BokehFar"),
    row("wgsl-jitter", "pass", "passes", "Begin", "BokehJitter * noise", "0.0 * noise"),
    row("wgsl-debug-depth", "pass", "passes", "Debug", "BokehDebugMode > 1.5", "BokehDebugMode > 0.75"),
)
