"""Mistakes made in one language: the parity check finds those in what it compares; porting and bindings it does not."""

import re

from bokeh_validation.mutants.killers import DRIVERS, EXACT, HOSTILE, PAPER, PARITY, SURVIVORS, on
from bokeh_validation.mutants.model import Edit, Mutant, Selection

SIZES = "test_sizes"
VIEWPORT = "test_nothing_leaks_in"
NOISE = "test_exact_on_noise"


def _mutant(name: str, kind: str, language: str, edits: tuple[Edit, ...] | Edit, *killers: Selection) -> Mutant:
    return Mutant(name, kind, edits if isinstance(edits, tuple) else (edits,), killers, (language,))


def _swapped(file: str, within: str | None, one: str, other: str) -> tuple[Edit, ...]:
    """Two texts in each other's place."""
    return (Edit(file, within, one, "$"), Edit(file, within, other, one), Edit(file, within, "$", other))


def _renumbered(one: str, other: str) -> tuple[Edit, ...]:
    """Two declarations with each other's number, the only one in each."""
    first, second = (re.search(r"\d", text)[0] for text in (one, other))
    return (
        Edit("passes", None, one, one.replace(first, second)),
        Edit("passes", None, other, other.replace(second, first)),
    )


# A mutant is a row or two.
# fmt: off
# The parity check sees them, and so do the drivers of the language
FORGOTTEN = (
    _mutant("hlsl-coc-sign", "one language", "hlsl", Edit("library", "BokehCoC", "S2 - focus", "S2 + focus"),
            on("dxc", "test_inputs.py", "test_camera_at_its_limits")),
    _mutant("hlsl-combine", "one language", "hlsl", Edit("library", "BokehCombine", "min(a, b)", "max(a, b)"),
            on("d3d11", DRIVERS, SIZES, "paper")),
    _mutant("glsl-leakage", "one language", "glsl",
            Edit("library", "BokehLeakageWeight", "sampleDepth < centerDepth", "sampleDepth > centerDepth"), PAPER),
    _mutant("glsl-last-sample", "one language", "glsl",
            Edit("library", "BokehNaiveGrid", "i < BOKEH_NUM_SAMPLES", "i < BOKEH_NUM_SAMPLES - 1"), PARITY),
    _mutant("wgsl-aspect", "one language", "wgsl", Edit("library", "BokehLineEnd", " / aspectRatio", ""),
            on("wgpu", DRIVERS, SIZES, "paper")),
    _mutant("wgsl-offsets", "one language", "wgsl",
            Edit("library", "BokehMakeOffsets", "max(numSamples, 2) - 1", "max(numSamples, 2)"), PARITY),
    _mutant("wgsl-default", "one language", "wgsl",
            Edit("library", None, "BOKEH_MAX_COC: f32 = 0.1;", "BOKEH_MAX_COC: f32 = 0.2;"), PARITY),
    _mutant("glsl-signed", "one language", "glsl",
            Edit("library", "BokehSignedCoC", "CoC = -CoC;", "CoC = CoC;"), PARITY),
    _mutant("hlsl-member", "one language", "hlsl",
            Edit("library", "BokehLineSum", "settings.imageHeight", "settings.aspectRatio"), PARITY),
    _mutant("wgsl-struct", "one language", "wgsl",
            _swapped("library", None, "    spacing: f32,", "    jitter: f32,"), PARITY),
    _mutant("hlsl-shared-texture", "one language", "hlsl",
            Edit("library", "BokehExactSecond", "BOKEH_SHARED(T3Samp", "BOKEH_SHARED(T4Samp"), PARITY),
    _mutant("glsl-preset", "one language", "glsl",
            Edit("library", None, "#define BOKEH_PRESET_SAMPLES 17", "#define BOKEH_PRESET_SAMPLES 16"), PARITY),
    _mutant("hlsl-preset", "one language", "hlsl",
            Edit("library", None, "#define BOKEH_PRESET_SPACING 2.0", "#define BOKEH_PRESET_SPACING 3.0"), PARITY),
    _mutant("wgsl-spacing", "one language", "wgsl",
            Edit("library", None, "BOKEH_SPACING: f32 = 1.0;", "BOKEH_SPACING: f32 = 2.0;"), PARITY),
    # marked as a deviation, so the parity check leaves it alone
    _mutant("hlsl-first-loop", "one language", "hlsl",
            Edit("library", "BokehNaiveGather", "int i = j;", "int i = 0;"),
            on("d3d9", SURVIVORS, "test_many_offsets")),
    _mutant("hlsl-second-loop", "one language", "hlsl",
            Edit("library", "BokehNaiveGather", "min(j + BOKEH_LOOP_LIMIT, BOKEH_NUM_SAMPLES)",
                 "min(j + BOKEH_LOOP_LIMIT - 1, BOKEH_NUM_SAMPLES)"), on("d3d9", SURVIVORS, "test_many_offsets")),
    _mutant("hlsl-parameters", "one language", "hlsl",
            _swapped("passes", None, "(float, BokehAngle, 7)", "(float, BokehAngleB, 8)"), PARITY),
)

PORTING = (
    _mutant("hlsl-fetch", "porting", "hlsl",
            Edit("library", "BokehFetchTexture", "coords, 0.0", "coords + 0.01, 0.0", 2),
            on("dxc", DRIVERS, SIZES, "paper")),
    _mutant("hlsl-fetch-sm3", "porting", "hlsl",
            Edit("library", "BokehFetchTexture", "coords, 0.0, 0.0", "coords + 0.01, 0.0, 0.0"),
            on("d3d9", DRIVERS, SIZES, "paper")),
    _mutant("glsl-fetch", "porting", "glsl", Edit("library", "BokehFetchTexture", "coords, 0.0", "coords + 0.01, 0.0"),
            on("egl", DRIVERS, SIZES, "paper")),
    _mutant("wgsl-fetch", "porting", "wgsl", Edit("library", "BokehFetchTexture", "coords, 0.0", "coords + 0.01, 0.0"),
            on("wgpu", DRIVERS, SIZES, "paper")),
    _mutant("glsl-raw-depth", "porting", "glsl", Edit("library", "BokehFetchNearest", "BokehToTexture(uv)", "uv"),
            on("egl", "test_viewport.py", "test_nothing_leaks_in")),
    _mutant("wgsl-fetch-nearest", "porting", "wgsl", Edit("library", "BokehFetchNearest", "(uv)", "(uv.yx)"),
            on("wgpu", DRIVERS, SIZES, "paper")),
    _mutant("glsl-texel", "porting", "glsl", Edit("library", "BokehFetchNearest", "min(texel,",
            "min(texel + ivec2(1, 0),"), HOSTILE),
    _mutant("hlsl-texel", "porting", "hlsl", Edit("library", "BokehFetchNearest", "min(texel,",
            "min(texel + int2(1, 0),"), on("dxc", DRIVERS, "hostile")),
    _mutant("wgsl-texel", "porting", "wgsl", Edit("library", "BokehFetchNearest", "min(texel,",
            "min(texel + vec2i(1, 0),"), on("wgpu", DRIVERS, "hostile")),
    _mutant("glsl-last-texel", "guard", "glsl", Edit("library", "BokehFetchNearest", "size - ivec2(1, 1)", "size"),
            on("egl", DRIVERS, SIZES)),
    _mutant("glsl-table", "porting", "glsl",
            Edit("library", "BokehFetchTable", "min(i, count - 1)", "min(i, count - 2)"),
            on("egl", DRIVERS, "test_settings", "naive")),
    _mutant("hlsl-table-sm3", "porting", "hlsl", Edit("library", "BokehFetchTable", "float(i) + 0.5", "float(i) + 1.5"),
            on("d3d9", DRIVERS, SIZES, "naive")),
    _mutant("wgsl-table", "porting", "wgsl",
            Edit("library", "BokehFetchTable", "min(i, count - 1)", "min(i, count - 2)"),
            on("wgpu", DRIVERS, SIZES, "naive")),
)

BINDINGS = (
    _mutant("hlsl-textures", "binding", "hlsl",
            _renumbered("BokehColorSampB : register(t2)", "BokehColorSampC : register(t3)"),
            on("dxc", DRIVERS, "test_several_targets")),
    _mutant("hlsl-textures-sm3", "binding", "hlsl",
            _renumbered("BokehColorSampB : register(s2)", "BokehColorSampC : register(s3)"),
            on("d3d9", DRIVERS, SIZES, "paper")),
    _mutant("wgsl-textures", "binding", "wgsl",
            _renumbered("@binding(3) var BokehColorSampB", "@binding(4) var BokehColorSampC"),
            on("wgpu", DRIVERS, "test_several_targets")),
    _mutant("wgsl-depth", "binding", "wgsl",
            _renumbered("@binding(2) var BokehDepthSamp", "@binding(5) var BokehColorSampD"),
            on("wgpu", DRIVERS, SIZES, "paper")),
    _mutant("hlsl-kernel", "binding", "hlsl",
            _renumbered("BokehKernelSamp : register(t5)", "BokehColorSampD : register(t4)"),
            on("dxc", DRIVERS, SIZES, "naive")),
)

VERTEX_SHADERS = (
    _mutant("hlsl-upside-down", "vertex shader", "hlsl",
            Edit("passes", "BokehFullScreen", "1.0 - uv.y * 2.0", "uv.y * 2.0 - 1.0"), on("dxc", DRIVERS, "hostile")),
    _mutant("hlsl-half-pixel", "vertex shader", "hlsl",
            Edit("passes", "BokehFullScreen", "float2(-1.0, 1.0)", "float2(0.0, 0.0)"),
            on("d3d9", DRIVERS, SIZES, "paper")),
    _mutant("glsl-upside-down", "vertex shader", "glsl",
            Edit("passes", "BokehFullScreen", "vec4(BokehUV * 2.0 - 1.0,", "vec4(vec2(2.0, -2.0) * BokehUV + "
                 "vec2(-1.0, 1.0),"), HOSTILE),
    _mutant("glsl-small-triangle", "vertex shader", "glsl",
            Edit("passes", "BokehFullScreen", "== 1 ? 2.0", "== 1 ? 1.0"), on("egl", DRIVERS, SIZES, "paper")),
    _mutant("wgsl-upside-down", "vertex shader", "wgsl",
            Edit("passes", "BokehFullScreen", "1.0 - uv.y * 2.0", "uv.y * 2.0 - 1.0"), on("wgpu", DRIVERS, "hostile")),
    _mutant("wgsl-mirrored", "vertex shader", "wgsl",
            Edit("passes", "BokehFullScreen", "uv.x * 2.0 - 1.0", "1.0 - uv.x * 2.0"), on("wgpu", DRIVERS, "hostile")),
)

# The parity check sees these; a device of the language shows what they do
PASSES = (
    _mutant("hlsl-viewport", "pass", "hlsl",
            Edit("passes", "BokehUseViewport", "BokehViewportX, BokehViewportY", "BokehViewportY, BokehViewportX"),
            on("dxc", "test_viewport.py", VIEWPORT)),
    _mutant("glsl-viewport-forgotten", "pass", "glsl", Edit("passes", "BokehBegin", "BokehUseViewport();", ""),
            on("egl", "test_viewport.py", VIEWPORT, "one")),
    _mutant("wgsl-viewport-forgotten", "pass", "wgsl",
            Edit("passes", "BokehCoCMap", "BokehUseViewport();", ""), on("wgpu", "test_viewport.py", VIEWPORT)),
    _mutant("hlsl-last-target", "pass", "hlsl", Edit("passes", "BokehDecagonFirst", "targets.T5", "targets.T4"),
            on("dxc", DRIVERS, "test_several_targets", "decagon")),
    _mutant("hlsl-squeeze", "pass", "hlsl", Edit("passes", "BokehNaiveGather", " / BokehSqueeze", ""),
            on("dxc", SURVIVORS, "test_squeeze_of_the_naive_methods")),
    _mutant("glsl-second-target", "pass", "glsl",
            Edit("passes", "BokehHexagonSecond", "BokehColorSamp, BokehColorSampB,", "BokehColorSamp, BokehColorSamp,"),
            on("egl", EXACT, NOISE, "hexagon")),
    _mutant("glsl-sides", "pass", "glsl", Edit("passes", "BokehOctagonFirst", ", 8)", ", 10)"),
            on("egl", DRIVERS, "test_several_targets", "octagon")),
    _mutant("glsl-use-max", "pass", "glsl",
            Edit("passes", "BokehDepthOfFieldFinal", "BokehUseMax > 0.5", "BokehUseMax > 1.5"),
            on("egl", DRIVERS, "test_settings", "paper", "star")),
    _mutant("glsl-grid-angle", "pass", "glsl", Edit("passes", "BokehNaiveGrid", "BokehAngleB", "BokehAngle"),
            on("egl", DRIVERS, SIZES, "grid")),
    _mutant("glsl-grid-squeeze", "pass", "glsl", Edit("passes", "BokehNaiveGrid", " / BokehSqueeze", "", 2),
            on("egl", SURVIVORS, "test_squeeze_of_the_naive_methods")),
    _mutant("glsl-constant-coc", "pass", "glsl",
            Edit("passes", "BokehConstantCoC", "0.0, BokehMaxCoC", "-1.0, BokehMaxCoC"),
            on("egl", SURVIVORS, "test_constant_coc_is_clamped")),
    _mutant("wgsl-near-far", "pass", "wgsl", _swapped("passes", "BokehLinearDepth", "BokehNear", "BokehFar"),
            on("wgpu", "test_inputs.py", "test_ends_of_the_range")),
    _mutant("wgsl-jitter", "pass", "wgsl", Edit("passes", "BokehBegin", "BokehJitter * noise", "0.0 * noise"),
            on("wgpu", SURVIVORS, "test_jitter_of_the_exact_passes", "decagon")),
    _mutant("wgsl-debug-depth", "pass", "wgsl",
            Edit("passes", "BokehDebug", "BokehDebugMode > 1.5", "BokehDebugMode > 0.75"),
            on("wgpu", DRIVERS, "test_debug_views")),
)
# fmt: on

ONE_LANGUAGE: tuple[Mutant, ...] = (*FORGOTTEN, *PORTING, *BINDINGS, *VERTEX_SHADERS, *PASSES)
