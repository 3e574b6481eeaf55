"""Mistakes made alike in all three languages: the parity check is blind to them, only numbers show them."""

from dataclasses import replace

from bokeh_validation.mutants.killers import (
    ADAPTIVE_HEXAGON,
    ADAPTIVE_STAR,
    ADAPTIVE_TRIANGLE,
    BAD_DEPTHS,
    CLIPPED,
    COUNTED,
    DEBUG,
    DEFAULTS,
    DEPTH_ENDS,
    DEPTHS,
    EXACT_DECAGON,
    EXACT_FIXED,
    EXACT_HEXAGON,
    EXACT_TARGETS,
    GRID,
    HOSTILE,
    LIMITS,
    NAIVE,
    PAPER,
    REJECTED,
    STAR,
    SURVIVORS,
    TINY,
    VIEWPORTS,
    on,
)
from bokeh_validation.mutants.model import Edit, Mutant, Selection


def _mutant(name: str, kind: str, function: str, old: str, new: str, *killers: Selection, count: int = 1) -> Mutant:
    return Mutant(name, kind, (Edit("library", function, old, new, count),), killers)


def _argued(name: str, kind: str, function: str, old: str, new: str, *killers: Selection, argument: str) -> Mutant:
    return replace(_mutant(name, kind, function, old, new, *killers), argument=argument)


def _configured(name: str, old: str, new: str, *killers: Selection) -> Mutant:
    return Mutant(name, "configuration", (Edit("library", None, old, new, 2),), killers)


def _raw_depth(name: str, function: str) -> Mutant:
    """Without the guard on the centre's depth: only on Direct3D 9 is every sample nearer than NaN."""
    edit = ("BokehSafeDepth(BokehFetchNearest", "(BokehFetchNearest")
    return _mutant(f"{name}-raw-depth", "guard", function, *edit, COUNTED)


def _survivor(test: str) -> Selection:
    return on("egl", SURVIVORS, test)


# A mutant is a row or two.
# fmt: off
CONFIGURATION = (
    # in the table of section [1] and in the definition
    _configured("largest-color", "65504.0", "60000.0", HOSTILE),
    _configured("largest-depth", "1000000000.0", "1000000.0", DEPTH_ENDS),
    _configured("smallest-depth", "0.000001", "0.001", TINY, LIMITS),
    _configured("default-sensor", "0.024", "0.036", DEFAULTS),
    _configured("default-bleeding", "30.0", "20.0", DEFAULTS),
)

CIRCLE_OF_CONFUSION = (
    _mutant("coc-sign", "sign", "BokehCoC", "abs(S2 - focus)", "abs(S2 + focus)", LIMITS),
    _mutant("coc-near-field", "sign", "BokehCoC", "abs(S2 - focus)", "(S2 - focus)", LIMITS),
    _mutant("coc-over-focus", "axis", "BokehCoC", "/ S2)", "/ focus)", LIMITS),
    _mutant("coc-radius", "constant", "BokehCoC", "A * magnification", "0.5 * A * magnification", LIMITS),
    _mutant("coc-magnification", "sign", "BokehCoC", "focus - f", "focus + f", LIMITS),
    _mutant("coc-focus-guard", "guard", "BokehCoC", "max(focus - f, BOKEH_MIN_DEPTH)", "(focus - f)", LIMITS),
    _mutant("coc-infinite-focus", "guard", "BokehCoC", "min(S1, BOKEH_MAX_DEPTH)", "S1", LIMITS),
    _mutant("coc-sensor-guard", "guard", "BokehCoC", "max(sensorHeight, BOKEH_MIN_DEPTH)", "sensorHeight",
            _survivor("test_a_sensor_of_no_height")),
    _mutant("coc-clamp", "guard", "BokehCoC", "0.0, MaxCoC)", "0.0, 1.0)", LIMITS),
    _mutant("channel-negative", "guard", "BokehSafeChannel", "value >= 0.0", "value >= -1000.0", HOSTILE),
    _mutant("channel-nan", "guard", "BokehSafeChannel", "(value >= 0.0)", "(!(value < 0.0))", HOSTILE),
    _mutant("channel-infinite", "guard", "BokehSafeChannel", "min(value, BOKEH_MAX_COLOR)", "value", HOSTILE),
    _mutant("channel-max", "min for max", "BokehSafeChannel", "min(value", "max(value", HOSTILE),
    _mutant("depth-negative", "guard", "BokehSafeDepth", ">= BOKEH_MIN_DEPTH", ">= -1000.0", HOSTILE),
    _mutant("depth-infinite", "guard", "BokehSafeDepth", "min(S2, BOKEH_MAX_DEPTH)", "S2", HOSTILE),
    _mutant("depth-fallback", "constant", "BokehSafeDepth", "= BOKEH_MIN_DEPTH;", "= BOKEH_MAX_DEPTH;", HOSTILE),
    _mutant("window-sign", "sign", "BokehDepthFromWindow", "zFar - depth", "zFar + depth", DEPTHS),
    _mutant("reversed-plane", "axis", "BokehDepthFromReversed", "zNear + depth", "zFar + depth", DEPTHS),
    _mutant("infinite-guard", "guard", "BokehDepthFromInfinite", "depth >= stored", "depth >= -1000.0",
            BAD_DEPTHS),
    _mutant("infinite-sky", "guard", "BokehDepthFromInfinite", "zNear / BOKEH_MAX_DEPTH", "zNear * 0.01", DEPTH_ENDS),
    _mutant("linear-unsafe", "guard", "BokehLinearDepth", "return BokehSafeDepth(S2)", "return (S2)", BAD_DEPTHS),
    _mutant("clip-half", "constant", "BokehDepthFromClip", "2.0 * zNear", "zNear", DEPTHS),
    _mutant("clip-sign", "sign", "BokehDepthFromClip", "zFar + zNear", "zFar - zNear", DEPTHS),
    _mutant("orthographic-sign", "sign", "BokehDepthFromOrthographic", "zFar - zNear", "zFar + zNear", DEPTHS),
    _mutant("fraction-reversed", "sign", "BokehDepthFromFraction", "depth * zFar", "(1.0 - depth) * zFar", DEPTHS),
    _mutant("logarithm-plane", "constant", "BokehDepthFromLogarithmic", "zFar + 1.0", "zFar", DEPTHS),
    _mutant("logarithm-base", "constant", "BokehDepthFromLogarithmic", ") - 1.0", ")", DEPTHS),
    _mutant("kind-not-reversed", "sign", "BokehLinearDepth", "1.0 - depth", "depth", DEPTHS),
    _mutant("kind-off-by-one", "off-by-one", "BokehLinearDepth", "kind > 3.5", "kind > 4.25", DEPTHS),
    _mutant("pack-green", "axis", "BokehPackCoC", "color.g", "color.r", HOSTILE),
    _mutant("pack-blue-unsafe", "guard", "BokehPackCoC", "BokehSafeChannel(color.b)", "color.b",
            _survivor("test_every_channel_is_made_safe")),
    _mutant("pack-alpha", "axis", "BokehPackCoC", "CoC)", "color.a)", HOSTILE),
    _mutant("cocmap-arguments", "axis", "BokehCoCMap", "A, f, S1", "A, S1, f", LIMITS),
    _mutant("cocmap-raw-depth", "guard", "BokehCoCMap", "BokehSafeDepth(", "(", HOSTILE),
)

SAMPLE_OFFSETS = (
    _mutant("line-no-aspect", "aspect", "BokehLineEnd", " / aspectRatio", "", PAPER),
    _mutant("line-aspect-turned", "aspect", "BokehLineEnd", "/ aspectRatio", "* aspectRatio", PAPER),
    _mutant("line-axes", "axis", "BokehLineEnd", "cos(angle) / aspectRatio, 0.5 * sin(angle)",
            "sin(angle) / aspectRatio, 0.5 * cos(angle)", PAPER),
    _mutant("line-mirrored", "sign", "BokehLineEnd", "0.5 * sin(angle)", "-0.5 * sin(angle)", PAPER),
    _mutant("line-length", "constant", "BokehLineEnd", "(0.5 * cos(angle)", "(cos(angle)", PAPER),
    _mutant("offsets-guard", "guard", "BokehMakeOffsets", "max(numSamples, 2)", "numSamples",
            _survivor("test_a_line_of_one_sample")),
    _mutant("offsets-last", "off-by-one", "BokehMakeOffsets", "max(numSamples, 2) - 1", "max(numSamples, 2)", PAPER),
    _mutant("offsets-shifted", "off-by-one", "BokehMakeOffsets", "2 * i - last", "2 * i - last + 1", PAPER),
    _mutant("fade-half", "constant", "BokehFilterCoC", "2.0 * CoC", "CoC", ADAPTIVE_HEXAGON),
    _mutant("fade-unbounded", "guard", "BokehFilterCoC", "imageHeight, 0.0, 1.0)", "imageHeight, -1.0, 1.0)",
            ADAPTIVE_HEXAGON),
    _mutant("fade-always", "condition", "BokehFilterCoC", "spacing > 0.0", "spacing >= 0.0", EXACT_HEXAGON),
    _mutant("cells-turned", "sign", "BokehCells", "lengthInPixels / spacing", "lengthInPixels * spacing",
            ADAPTIVE_HEXAGON, EXACT_HEXAGON),
    _mutant("cells-guard", "guard", "BokehCells", "spacing, 1.0,", "spacing, 0.0,",
            _survivor("test_a_line_of_no_length")),
    _mutant("cells-condition", "condition", "BokehCells", "spacing > 0.0", "spacing > 1.0", ADAPTIVE_HEXAGON),
    _mutant("cell-length", "off-by-one", "BokehCell", "low + 1.0", "low + 2.0", ADAPTIVE_HEXAGON),
    _mutant("cell-sign", "sign", "BokehCell", "- 0.5 * cells", "+ 0.5 * cells", ADAPTIVE_HEXAGON),
    _mutant("cell-max", "min for max", "BokehCell", "min(low", "max(low", ADAPTIVE_HEXAGON),
    _argued("cell-behind-the-end", "guard", "BokehCell", "min(float(i), cells)", "float(i)", ADAPTIVE_HEXAGON,
            argument="The loop around it ends before such a cell. It matters where a compiler loses that break, as fxc "
            "has been seen to; no program of the package is one, and the compile matrix refuses those that are."),
    _mutant("cell-weight", "constant", "BokehCell", ", high - low)", ", 1.0)", ADAPTIVE_HEXAGON),
    _mutant("noise-axes", "axis", "BokehNoise", "0.06711056, 0.00583715", "0.00583715, 0.06711056",
            ADAPTIVE_HEXAGON, EXACT_HEXAGON),
    _mutant("noise-bias", "constant", "BokehNoise", " - 0.5", "", ADAPTIVE_HEXAGON, EXACT_HEXAGON),
    _mutant("noise-frames", "constant", "BokehNoise", "frame - 64.0 * floor(frame / 64.0)", "frame", ADAPTIVE_STAR),
    _mutant("noise-size", "axis", "BokehNoise", "imageWidth, imageHeight", "imageHeight, imageWidth",
            ADAPTIVE_HEXAGON, EXACT_HEXAGON),
    _mutant("segment-axis", "axis", "BokehSegment", "lineLength * sin(angle)", "lineLength * cos(angle)",
            ADAPTIVE_HEXAGON),
    _mutant("segment-length", "constant", "BokehSegment", "lineLength * cos(angle)", "cos(angle)", ADAPTIVE_TRIANGLE),
    _mutant("segment-squeeze", "aspect", "BokehSegment", "squeeze, 1.0, squeeze, 1.0", "squeeze, 1.0, 1.0, 1.0",
            ADAPTIVE_HEXAGON),
    _mutant("segment-squeezed-axis", "axis", "BokehSegment", "squeeze, 1.0, squeeze, 1.0",
            "1.0, squeeze, 1.0, squeeze", ADAPTIVE_HEXAGON),
)

LINE_FILTER = (
    _mutant("leakage-depth", "sign", "BokehLeakageWeight", "sampleDepth < centerDepth", "sampleDepth > centerDepth",
            PAPER),
    _mutant("leakage-bias", "sign", "BokehLeakageWeight", "sampleCoC + bleedingBias", "sampleCoC - bleedingBias",
            PAPER),
    _mutant("leakage-or", "condition", "BokehLeakageWeight", "&&", "||", PAPER),
    _mutant("leakage-coc", "axis", "BokehLeakageWeight", "clamp(sampleCoC", "clamp(centerCoC", PAPER),
    _mutant("leakage-clamp", "guard", "BokehLeakageWeight", "0.0, 1.0)", "0.0, 2.0)", PAPER),
    _mutant("resolve-guard", "guard", "BokehResolve", "totalWeight > 0.0", "totalWeight > -1.0", REJECTED),
    _mutant("resolve-threshold", "condition", "BokehResolve", "totalWeight > 0.0", "totalWeight > 0.01", REJECTED),
    _mutant("resolve-blur-coc", "condition", "BokehResolve", "!blurCoC", "blurCoC", PAPER),
    _mutant("filter-last-sample", "dropped sample", "BokehDepthOfField", "i < numSamples", "i < numSamples - 1",
            PAPER),
    _mutant("filter-first-sample", "dropped sample", "BokehDepthOfField", " = 0; i", " = 1; i", PAPER),
    _mutant("filter-weight", "dropped sample", "BokehDepthOfField", "totalWeight += weight", "totalWeight += 1.0",
            PAPER),
    _mutant("filter-radius", "constant", "BokehDepthOfField", "* centerPixel.a", "* 0.5 * centerPixel.a", PAPER),
    _mutant("filter-swapped-coc", "axis", "BokehDepthOfField", "samplePixel.a, centerDepth, centerPixel.a",
            "centerPixel.a, centerDepth, samplePixel.a", PAPER),
    _mutant("filter-swapped-depth", "axis", "BokehDepthOfField", "(sampleDepth, samplePixel.a, centerDepth,",
            "(centerDepth, samplePixel.a, sampleDepth,", PAPER),
    _raw_depth("filter", "BokehDepthOfField"),
    _raw_depth("adaptive", "BokehDepthOfFieldAdaptive"),
    _mutant("mean-half-length", "constant", "BokehLineMean", "2.0 * length", "length", ADAPTIVE_HEXAGON),
    _mutant("mean-last-cell", "dropped sample", "BokehLineMean", "ceil(cells)", "floor(cells)", ADAPTIVE_HEXAGON),
    _argued("mean-one-more", "off-by-one", "BokehLineMean", "i >= count", "i > count", ADAPTIVE_HEXAGON,
            argument="One cell more, behind the end, has the length 0 (BokehCell): its sample counts nothing. It costs "
            "a turn of the loop and no more."),
    _mutant("mean-no-aspect", "aspect", "BokehLineMean", "CoC / aspectRatio", "CoC", ADAPTIVE_HEXAGON),
    _mutant("mean-axis", "axis", "BokehLineMean", "segment.xy", "segment.yx", ADAPTIVE_TRIANGLE),
    _mutant("mean-sign", "sign", "BokehLineMean", "uv + segment", "uv - segment", ADAPTIVE_TRIANGLE),
    _mutant("mean-cell-weight", "dropped sample", "BokehLineMean", "cell.y * leakageWeight", "leakageWeight",
            ADAPTIVE_HEXAGON),
    _mutant("mean-leakage", "dropped sample", "BokehLineMean", "cell.y * leakageWeight", "cell.y", ADAPTIVE_HEXAGON),
    _mutant("mean-jitter", "constant", "BokehLineMean", "0.5 + jitter", "0.5 - jitter", ADAPTIVE_HEXAGON,
            EXACT_HEXAGON),
    _mutant("mean-dense-jitter", "guard", "BokehLineMean", "cells - 1.0, 0.0, 1.0)", "cells, 0.0, 1.0)",
            Selection(("test_exact.py",), "test_jitter_leaves_dense_samples_alone")),
    _mutant("adaptive-blur-coc", "condition", "BokehDepthOfFieldAdaptive", "result, blurCoC)", "result, true)",
            ADAPTIVE_HEXAGON),
    _mutant("adaptive-threshold", "condition", "BokehDepthOfFieldAdaptive", "CoC > 0.0", "CoC > 0.05",
            ADAPTIVE_HEXAGON),
)

COMBINE = (
    _mutant("combine-max", "min for max", "BokehCombine", "min(a, b)", "max(a, b)", PAPER),
    _mutant("combine-star", "min for max", "BokehCombine", "max(a, b)", "min(a, b)", STAR),
    _mutant("combine-condition", "condition", "BokehCombine", "if (useMax)", "if (!useMax)", PAPER),
    _mutant("final-one-side", "axis", "BokehDepthOfFieldFinal", "BokehCombine(a, b,", "BokehCombine(a, a,", PAPER),
)

NAIVE_GATHER = (
    _mutant("naive-no-aspect", "aspect", "BokehNaiveGather", " / aspectRatio", "", NAIVE),
    _mutant("naive-next-texel", "off-by-one", "BokehNaiveGather", "(i) + 0.5", "(i) + 1.5", NAIVE),
    _mutant("naive-block", "dropped sample", "BokehNaiveGather", "start + 128", "start + 127", NAIVE),
    _mutant("naive-axes", "axis", "BokehNaiveGather", ".rg", ".gr", NAIVE),
    _raw_depth("naive", "BokehNaiveGather"),
    _mutant("grid-one-side", "axis", "BokehNaiveGrid", "lineEndU, i", "lineEndV, i", GRID),
    _raw_depth("grid", "BokehNaiveGrid"),
    _mutant("grid-row", "dropped sample", "BokehNaiveGrid", "j < side", "j < side - 1", GRID),
    _mutant("grid-column", "dropped sample", "BokehNaiveGrid", "i < side", "i < side - 1", GRID),
    _mutant("grid-weight", "dropped sample", "BokehNaiveGrid", "totalWeight += weight", "totalWeight += 1.0", GRID),
)

EXACT_POLYGONS = (
    _mutant("turned-mirrored", "sign", "BokehTurned", "* c - direction.y", "* c + direction.y", EXACT_FIXED),
    _mutant("turned-sheared", "sign", "BokehTurned", "* s + direction.y", "* s - direction.y", EXACT_FIXED),
    _mutant("edge-angle", "angle", "BokehPolygonEdge", "2.0 * halfStep * k", "halfStep * k", EXACT_FIXED),
    _mutant("edge-step", "angle", "BokehPolygonEdge", "3.14159265 / sides", "3.14159265 / (sides + 1.0)", EXACT_FIXED),
    _mutant("edge-middle", "sign", "BokehPolygonEdge", "- meanOfFirst", "+ meanOfFirst", EXACT_FIXED),
    _mutant("edge-mean", "off-by-one", "BokehPolygonEdge", "0.5 * sides - 1.0", "0.5 * sides", EXACT_FIXED),
    _mutant("edge-second-pass", "sign", "BokehPolygonEdge", "-middle -", "middle -", EXACT_FIXED),
    _mutant("edge-length", "constant", "BokehPolygonEdge", "(0.5 * sin(halfStep))", "sin(halfStep)", EXACT_FIXED),
    _mutant("edge-squeeze", "aspect", "BokehPolygonEdge", "squeeze, 1.0, squeeze, 1.0", "1.0, 1.0, squeeze, 1.0",
            EXACT_HEXAGON),
    _mutant("weight-off-by-one", "off-by-one", "BokehExactWeight", "(k - 1.0)", "(k + 1.0)", EXACT_FIXED),
    _mutant("weight-scale", "constant", "BokehExactWeight", " / sin(halfStep)", "", EXACT_HEXAGON),
    _mutant("target-first-weight", "off-by-one", "BokehExactTarget", "(k - 1.0) * turn", "k * turn", EXACT_FIXED),
    _mutant("target-guard", "guard", "BokehExactTarget", "max(sin((k - 4.0) * turn), 0.0)", "sin((k - 4.0) * turn)",
            EXACT_FIXED),
    _mutant("target-third", "dropped sample", "BokehExactTarget", " + B3 * w3", "", EXACT_TARGETS),
    _mutant("target-coc", "axis", "BokehExactTarget", "mean.rgb, CoC", "mean.rgb, mean.a", EXACT_FIXED),
    _raw_depth("first", "BokehExactFirst"),
    _mutant("first-edge", "angle", "BokehExactFirst", "BokehPolygonEdge(2.0", "BokehPolygonEdge(1.0", EXACT_FIXED),
    _mutant("first-axis", "axis", "BokehExactFirst", "cos(rotation), sin(rotation)", "sin(rotation), cos(rotation)",
            EXACT_FIXED),
    _mutant("first-order", "axis", "BokehExactFirst", "(T2, T3,", "(T3, T2,", EXACT_TARGETS),
    _mutant("first-octagon", "off-by-one", "BokehExactFirst", "sides > 7.0", "sides > 9.0", EXACT_TARGETS),
    _mutant("first-decagon", "axis", "BokehExactFirst", "B1, B2, B3, B4", "B1, B2, B3, B3", EXACT_TARGETS),
    _raw_depth("second", "BokehExactSecond"),
    _mutant("second-weight", "off-by-one", "BokehExactSecond", "BokehExactWeight(3.0", "BokehExactWeight(2.0",
            EXACT_FIXED),
    _mutant("second-total", "dropped sample", "BokehExactSecond", "totalWeight += weight;", "", EXACT_FIXED, count=3),
    _mutant("second-edge", "angle", "BokehExactSecond", "BokehPolygonEdge(5.0", "BokehPolygonEdge(4.0", EXACT_DECAGON),
    _mutant("second-coc", "axis", "BokehExactSecond", "totalWeight, centerPixel.a", "totalWeight, CoC",
            EXACT_HEXAGON),
    _raw_depth("one-by-one", "BokehExactEdge"),
    _mutant("one-by-one-earlier", "off-by-one", "BokehExactEdge", "k > 2.5", "k > 3.5", EXACT_DECAGON),
    _mutant("one-by-one-sign", "sign", "BokehExactEdge", "sum -=", "sum +=", EXACT_DECAGON),
    _mutant("one-by-one-angle", "angle", "BokehExactEdge", "cos(turn)", "sin(turn)", EXACT_HEXAGON),
    _mutant("one-by-one-largest", "guard", "BokehExactEdge", "clamp(sum / BokehExactWeight(k + 1.0, sides), "
            "vec4(0.0, 0.0, 0.0, 0.0), most)", "max(sum / BokehExactWeight(k + 1.0, sides), "
            "vec4(0.0, 0.0, 0.0, 0.0))", CLIPPED),
    _argued("one-by-one-guard", "guard", "BokehExactEdge", "clamp(sum / BokehExactWeight(k + 1.0, sides), "
            "vec4(0.0, 0.0, 0.0, 0.0), most)", "min(sum / BokehExactWeight(k + 1.0, sides), most)", EXACT_DECAGON,
            argument="The blur along every edge enters the sum with sin(2 pi / sides) or more, 0.58 in the decagon; "
            "what the two targets lost when they were stored, with less than 2.5 steps of 2^-11: no sum of normal "
            "numbers is below 0. Next to the smallest half float it can be, by half a step at most, where a device "
            "cuts off, and then it is stored as 0. Rounded to nearest it is never below."),
)

# the uniforms reach it through the passes of one language: one_language.py
VIEWPORT = (
    _mutant("viewport-corner", "dropped sample", "BokehToTexture", "BokehViewport.xy + uv", "uv", VIEWPORTS),
    _mutant("viewport-size", "aspect", "BokehToTexture", "uv * BokehViewport.zw", "uv", VIEWPORTS),
    _mutant("viewport-low", "guard", "BokehToTexture", "BokehViewportBounds.xy, Bok", "vec2(0.0, 0.0), Bok", VIEWPORTS),
    _mutant("viewport-high", "guard", "BokehToTexture", "BokehViewportBounds.zw)", "vec2(1.0, 1.0))", VIEWPORTS),
    _mutant("viewport-inset", "constant", "BokehSetViewport", "0.5078125, 0.5078125", "0.5, 0.5", VIEWPORTS),
    _mutant("viewport-narrow", "guard", "BokehSetViewport", "min(vec2(0.5078125, 0.5078125), viewport.zw * 0.5)",
            "vec2(0.5078125, 0.5078125)", on("egl", "test_viewport.py", "test_a_column")),
    _mutant("viewport-texture", "axis", "BokehSetViewport", "viewport / textureSize.xyxy",
            "viewport / textureSize.yxyx", VIEWPORTS),
    _mutant("viewport-kernel", "porting", "BokehNaiveGather", "BokehFetchTable", "BokehFetchNearest",
            on("egl", "test_viewport.py", "test_nothing_leaks_in", "naive")),
)

DEBUG_VIEWS = (
    _mutant("debug-depth", "axis", "BokehDebugDepth", "S2 / (", "S1 / (", DEBUG),
    _mutant("debug-coc", "constant", "BokehDebugCoC", "clamp(CoC /", "clamp(0.5 * CoC /", DEBUG),
    _mutant("debug-coc-guard", "guard", "BokehDebugCoC", "max(MaxCoC, BOKEH_MIN_DEPTH)", "MaxCoC",
            _survivor("test_debug_views_of_a_pinhole")),
    _mutant("debug-sides", "condition", "BokehDebugFocus", "S2 < S1", "S2 > S1", DEBUG),
    _mutant("debug-focus-guard", "guard", "BokehDebugFocus", "max(MaxCoC, BOKEH_MIN_DEPTH)", "MaxCoC",
            _survivor("test_debug_views_of_a_pinhole")),
)
# fmt: on

EVERYWHERE: tuple[Mutant, ...] = (
    *CONFIGURATION,
    *CIRCLE_OF_CONFUSION,
    *SAMPLE_OFFSETS,
    *LINE_FILTER,
    *COMBINE,
    *NAIVE_GATHER,
    *EXACT_POLYGONS,
    *VIEWPORT,
    *DEBUG_VIEWS,
)
