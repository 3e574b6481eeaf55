"""Mistakes made in one language: what the parity check compares it finds; porting, bindings and passes it does not."""

import re

from bokeh_validation.mutants.killers import DRIVERS, EXACT, HOSTILE, PAPER, PARITY, SURVIVORS, on
from bokeh_validation.mutants.model import Edit, Mutant, Selection

SIZES = "test_sizes"
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
# In a library the parity check sees them, and so do the drivers of the language
FORGOTTEN = (
    _mutant("hlsl-coc-sign", "one language", "hlsl", Edit("library", "BokehCoC", "S2 - focus", "S2 + focus"),
            on("dxc", "test_inputs.py", "test_camera_at_its_limits")),
    _mutant("hlsl-combine", "one language", "hlsl", Edit("library", "BokehCombine", "min(a, b)", "max(a, b)"),
            on("d3d11", DRIVERS, SIZES, "paper")),
    _mutant("glsl-leakage", "one language", "glsl",
            Edit("library", "BokehLeakageWeight", "sampleDepth < centerDepth", "sampleDepth > centerDepth"), PAPER),
    _mutant("glsl-last-sample", "one language", "glsl",
            Edit("library", "BokehNaiveGrid", "i < side", "i < side - 1"), PARITY),
    _mutant("wgsl-aspect", "one language", "wgsl", Edit("library", "BokehLineEnd", " / aspectRatio", ""),
            on("wgpu", DRIVERS, SIZES, "paper")),
    _mutant("wgsl-offsets", "one language", "wgsl",
            Edit("library", "BokehMakeOffsets", "max(numSamples, 2) - 1", "max(numSamples, 2)"), PARITY),
    _mutant("wgsl-default", "one language", "wgsl",
            Edit("library", None, "BOKEH_MAX_COC: f32 = 0.1;", "BOKEH_MAX_COC: f32 = 0.2;"), PARITY),
    _mutant("hlsl-parameters", "one language", "hlsl",
            _swapped("passes", None, "(float, BokehAngle, 7)", "(float, BokehAngleB, 8)"), PARITY),
)

PORTING = (
    _mutant("hlsl-fetch", "porting", "hlsl", Edit("library", "BokehFetch", "uv", "(uv + 0.01)", 2),
            on("dxc", DRIVERS, SIZES, "paper")),
    _mutant("hlsl-fetch-sm3", "porting", "hlsl", Edit("library", "BokehFetch", ", 0.0, 0.0", " + 0.01, 0.0, 0.0"),
            on("d3d9", DRIVERS, SIZES, "paper")),
    _mutant("glsl-fetch", "porting", "glsl", Edit("library", "BokehFetch", "uv", "(uv + 0.01)"),
            on("egl", DRIVERS, SIZES, "paper")),
    _mutant("wgsl-fetch", "porting", "wgsl", Edit("library", "BokehFetch", "uv", "(uv + 0.01)"),
            on("wgpu", DRIVERS, SIZES, "paper")),
    _mutant("glsl-raw-depth", "porting", "glsl", Edit("library", "BokehFetchNearest", "BokehToTexture(uv)", "uv"),
            on("egl", "test_viewport.py", "test_nothing_leaks_in")),
    _mutant("wgsl-fetch-nearest", "porting", "wgsl", Edit("library", "BokehFetchNearest", "uv", "uv.yx"),
            on("wgpu", DRIVERS, SIZES, "paper")),
)

BINDINGS = (
    _mutant("hlsl-textures", "binding", "hlsl",
            _renumbered("BokehColorSampB : register(t2)", "BokehColorSampC : register(t3)"),
            on("dxc", DRIVERS, "test_several_targets")),
    _mutant("hlsl-textures-sm3", "binding", "hlsl",
            _renumbered("BokehColorSampB : register(s2)", "BokehColorSampC : register(s3)"),
            on("d3d9", DRIVERS, SIZES, "paper")),
    _mutant("hlsl-first-pass-filter", "binding", "hlsl",
            Edit("passes", None, "(name) name, BokehNearestClamp", "(name) name, BokehLinearClamp"),
            on("dxc", DRIVERS, "hostile")),
    _mutant("hlsl-third-target-filter", "binding", "hlsl",
            Edit("passes", None, "BokehColorSampCSampler BokehLinearClamp", "BokehColorSampCSampler BokehNearestClamp"),
            on("dxc", DRIVERS, "test_several_targets")),
    _mutant("wgsl-textures", "binding", "wgsl",
            _renumbered("@binding(3) var BokehColorSampB", "@binding(4) var BokehColorSampC"),
            on("wgpu", DRIVERS, "test_several_targets")),
    _mutant("wgsl-first-pass-filter", "binding", "wgsl",
            Edit("passes", "BokehCoCMap", "BokehColorSamp, BokehNearestClamp", "BokehColorSamp, BokehLinearClamp"),
            on("wgpu", DRIVERS, "hostile")),
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

PLACE = "{}(BokehViewportX, BokehViewportY, BokehImageWidth, BokehImageHeight)"
SWAPPED = "{}(BokehViewportY, BokehViewportX, BokehImageWidth, BokehImageHeight)"
VIEWPORT = "test_nothing_leaks_in"

PASSES = (
    _mutant("hlsl-viewport", "pass", "hlsl", Edit("passes", None, PLACE.format("float4"), SWAPPED.format("float4")),
            on("dxc", "test_viewport.py", VIEWPORT)),
    _mutant("glsl-viewport", "pass", "glsl", Edit("passes", None, PLACE.format("vec4"), SWAPPED.format("vec4")),
            on("egl", "test_viewport.py", VIEWPORT)),
    _mutant("wgsl-texture-size", "pass", "wgsl",
            _swapped("passes", None, "bokehParameters.BokehTextureWidth", "bokehParameters.BokehTextureHeight"),
            on("wgpu", "test_viewport.py", VIEWPORT)),
    _mutant("glsl-viewport-forgotten", "pass", "glsl",
            Edit("passes", "BokehOctagonSecond", "BokehUseViewport();", ""),
            on("egl", "test_viewport.py", VIEWPORT, "one")),
    _mutant("hlsl-viewport-forgotten", "pass", "hlsl",
            Edit("passes", "BokehAdaptiveFinal", "BokehUseViewport();", ""),
            on("dxc", "test_viewport.py", VIEWPORT, "paper")),
    _mutant("wgsl-viewport-forgotten", "pass", "wgsl",
            Edit("passes", "BokehCoCMap", "BokehUseViewport();", ""), on("wgpu", "test_viewport.py", VIEWPORT)),
    _mutant("hlsl-last-target", "pass", "hlsl", Edit("passes", "BokehDecagonFirst", "T[3]", "T[2]"),
            on("dxc", DRIVERS, "test_several_targets", "decagon")),
    _mutant("hlsl-noise-size", "pass", "hlsl",
            Edit("passes", "BokehHexagonFirst", "ImageWidth, BokehImageHeight", "ImageHeight, BokehImageWidth"),
            on("dxc", SURVIVORS, "test_jitter_of_the_exact_passes", "hexagon")),
    _mutant("hlsl-squeeze", "pass", "hlsl", Edit("passes", "BokehNaiveGather", " / BokehSqueeze", ""),
            on("dxc", SURVIVORS, "test_squeeze_of_the_naive_methods")),
    _mutant("glsl-second-target", "pass", "glsl",
            Edit("passes", "BokehHexagonSecond", "BokehColorSamp, BokehColorSampB,", "BokehColorSamp, BokehColorSamp,"),
            on("egl", EXACT, NOISE, "hexagon")),
    _mutant("glsl-sides", "pass", "glsl", Edit("passes", "BokehOctagonFirst", "8.0", "10.0"),
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
    _mutant("wgsl-line-center", "pass", "wgsl",
            _swapped("passes", "BokehAdaptive", "BokehLineCenterX", "BokehLineCenterY"),
            on("wgpu", EXACT, "test_adaptive_paper_on_noise", "triangle")),
    _mutant("wgsl-near-far", "pass", "wgsl", 
            _swapped("passes", "BokehLinearDepth", "bokehParameters.BokehNear", "bokehParameters.BokehFar"),
            on("wgpu", "test_inputs.py", "test_ends_of_the_range")),
    _mutant("wgsl-jitter", "pass", "wgsl", Edit("passes", "BokehDecagonSecond", "bokehParameters.BokehJitter", "0.0"),
            on("wgpu", SURVIVORS, "test_jitter_of_the_exact_passes", "decagon")),
    _mutant("wgsl-debug-depth", "pass", "wgsl",
            Edit("passes", "BokehDebug", "BokehDebugMode > 1.5", "BokehDebugMode > 0.75"),
            on("wgpu", DRIVERS, "test_debug_views")),
    _mutant("wgsl-edges", "pass", "wgsl", _swapped("passes", "BokehExactEdge", "BokehColorSampB", "BokehColorSampC"),
            on("wgpu", EXACT, NOISE, "decagon")),
)
# fmt: on

ONE_LANGUAGE: tuple[Mutant, ...] = (*FORGOTTEN, *PORTING, *BINDINGS, *VERTEX_SHADERS, *PASSES)
