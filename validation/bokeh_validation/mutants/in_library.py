"""Mistakes in the library, alike in all three languages: the parity check is blind to them, only numbers show them."""

from functools import partial

from bokeh_validation.mutants.killers import ADAPTIVE, COUNTED, DEPTH_ENDS, HEXAGON, HOSTILE, LIMITS, OUT_OF_RANGE, STAR, TINY
from bokeh_validation.mutants.mutant import row as any_row

row = partial(any_row, "library")
DEFAULTS, PRESETS = "test_survivors.py::test_defaults", "test_survivors.py::test_presets"
# fmt: off

CONFIGURATION = (
    # in the table of section [1] and in the definition
    row("largest-color", "configuration", None, "65504.0", "60000.0", HOSTILE, count=2),
    row("largest-depth", "configuration", None, "1000000000.0", "1000000.0", DEPTH_ENDS, count=2),
    row("smallest-depth", "configuration", None, "0.000001", "0.001", TINY, LIMITS, count=2),
    row("default-sensor", "configuration", None, "0.024", "0.036", DEFAULTS, count=2),
    row("default-bleeding", "configuration", None, "30.0", "20.0", DEFAULTS, count=2),
    # WGSL has the presets in its table only
    row("preset-row", "configuration", None, "22 20", "22 25", PRESETS),
)

CIRCLE_OF_CONFUSION = (
    row("coc-sign", "sign", "CoC", "abs(S2 - focus)", "abs(S2 + focus)"),
    row("coc-near-field", "sign", "CoC", "abs(S2 - focus)", "(S2 - focus)"),
    row("coc-over-focus", "axis", "CoC", "/ S2)", "/ focus)"),
    row("coc-radius", "constant", "CoC", "A * magnification", "0.5 * A * magnification"),
    row("coc-magnification", "sign", "CoC", "focus - f", "focus + f"),
    row("coc-focus-guard", "guard", "CoC", "max(focus - f, BOKEH_MIN_DEPTH)", "(focus - f)"),
    row("coc-infinite-focus", "guard", "CoC", "min(S1, BOKEH_MAX_DEPTH)", "S1"),
    row("coc-sensor-guard", "guard", "CoC", "max(sensorHeight, BOKEH_MIN_DEPTH)", "sensorHeight"),
    row("coc-clamp", "guard", "CoC", "0.0, MaxCoC)", "0.0, 1.0)"),
    row("channel-negative", "guard", "SafeChannel", "value >= 0.0", "value >= -1000.0"),
    row("channel-nan", "guard", "SafeChannel", "(value >= 0.0)", "(!(value < 0.0))"),
    row("channel-infinite", "guard", "SafeChannel", "min(value, BOKEH_MAX_COLOR)", "value"),
    row("channel-max", "min for max", "SafeChannel", "min(value", "max(value"),
    row("depth-negative", "guard", "SafeDepth", ">= BOKEH_MIN_DEPTH", ">= -1000.0"),
    row("depth-infinite", "guard", "SafeDepth", "min(S2, BOKEH_MAX_DEPTH)", "S2"),
    row("depth-fallback", "constant", "SafeDepth", "= BOKEH_MIN_DEPTH;", "= BOKEH_MAX_DEPTH;"),
    row("window-sign", "sign", "DepthFromWindow", "zFar - depth", "zFar + depth"),
    row("reversed-plane", "axis", "DepthFromReversed", "zNear + depth", "zFar + depth"),
    row("infinite-guard", "guard", "DepthFromInfinite", "depth >= stored", "depth >= -1000.0"),
    row("infinite-sky", "guard", "DepthFromInfinite", "zNear / BOKEH_MAX_DEPTH", "zNear * 0.01"),
    row("linear-unsafe", "guard", "LinearDepth", "return BokehSafeDepth(S2)", "return (S2)"),
    row("clip-half", "constant", "DepthFromClip", "2.0 * zNear", "zNear"),
    row("clip-sign", "sign", "DepthFromClip", "zFar + zNear", "zFar - zNear"),
    row("orthographic-sign", "sign", "DepthFromOrthographic", "zFar - zNear", "zFar + zNear"),
    row("fraction-reversed", "sign", "DepthFromFraction", "depth * zFar", "(1.0 - depth) * zFar"),
    row("logarithm-plane", "constant", "DepthFromLogarithmic", "zFar + 1.0", "zFar"),
    row("logarithm-base", "constant", "DepthFromLogarithmic", ") - 1.0", ")"),
    row("kind-not-reversed", "sign", "LinearDepth", "1.0 - depth", "depth"),
    row("kind-off-by-one", "off-by-one", "LinearDepth", "kind == 4", "kind == 9"),
    row("pack-green", "axis", "PackCoC", "color.g", "color.r"),
    row("pack-blue-unsafe", "guard", "PackCoC", "BokehSafeChannel(color.b)", "color.b"),
    row("pack-alpha", "axis", "PackCoC", "CoC)", "color.a)"),
    row("cocmap-arguments", "axis", "CoCMap", "A, f, S1", "A, S1, f"),
    row("cocmap-raw-depth", "guard", "CoCMap", "BokehSafeDepth(", "("),
    row("signed-no-sign", "sign", "SignedCoC", "CoC = -CoC;", "CoC = CoC;"),
    row("signed-far", "condition", "SignedCoC", "S2 < S1", "S2 > S1"),
    row("signed-focus", "axis", "SignedCoC", "S2 < S1", "S2 < f"),
    row("signed-arguments", "axis", "SignedCoC", "A, f, S1", "f, A, S1"),
    row("signed-map-unsigned", "sign", "SignedCoCMap", "BokehSignedCoC(S2", "BokehCoC(S2"),
    row("signed-map-arguments", "axis", "SignedCoCMap", "A, f, S1", "A, S1, f"),
    row("signed-map-raw-depth", "guard", "SignedCoCMap", "BokehSafeDepth(", "("),
)

SAMPLE_OFFSETS = (
    row("line-no-aspect", "aspect", "LineEnd", " / aspectRatio", ""),
    row("line-aspect-inverted", "aspect", "LineEnd", "/ aspectRatio", "* aspectRatio"),
    row("line-axes", "axis", "LineEnd", "cos(angle) / aspectRatio, 0.5 * sin(angle)",
        "sin(angle) / aspectRatio, 0.5 * cos(angle)"),
    row("line-mirrored", "sign", "LineEnd", "0.5 * sin(angle)", "-0.5 * sin(angle)"),
    row("line-length", "constant", "LineEnd", "(0.5 * cos(angle)", "(cos(angle)"),
    row("offsets-guard", "guard", "MakeOffsets", "max(numSamples, 2)", "numSamples"),
    row("offsets-last", "off-by-one", "MakeOffsets", "max(numSamples, 2) - 1", "max(numSamples, 2)"),
    row("offsets-shifted", "off-by-one", "MakeOffsets", "2 * i - last", "2 * i - last + 1"),
    row("filter-aspect", "aspect", "DefaultFilter", "imageSize.x / imageSize.y", "imageSize.y / imageSize.x"),
    row("filter-height", "axis", "DefaultFilter", "imageHeight = imageSize.y", "imageHeight = imageSize.x"),
    row("filter-spacing", "constant", "DefaultFilter", "spacing = BOKEH_SPACING", "spacing = 0.0"),
    row("filter-jitter", "constant", "DefaultFilter", "jitter = 0.0", "jitter = 1.0"),
    row("filter-bleeding", "axis", "DefaultFilter", "= BOKEH_BLEEDING_MULT", "= BOKEH_BLEEDING_BIAS"),
    row("fade-half", "constant", "FilterCoC", ") * 2.0", ")"),
    row("fade-begin", "constant", "FilterCoC", "imageHeight - 0.5", "imageHeight"),
    row("fade-negative", "guard", "FilterCoC", ", 0.0, 1.0)", ", -1.0, 1.0)",
        argument="Below half a pixel the CoC is negative then and not 0. All callers blur where it is above 0."),
    row("fade-unbounded", "guard", "FilterCoC", ", 0.0, 1.0)", ", 0.0, 2.0)"),
    row("fade-always", "condition", "FilterCoC", "spacing > 0.0", "spacing >= 0.0"),
    row("fade-compiled-out", "condition", "FilterCoC", "BOKEH_ADAPTIVE_SAMPLES > 0 && spacing",
        "BOKEH_ADAPTIVE_SAMPLES < 1 && spacing"),
    row("cells-inverted", "sign", "Cells", "lengthInPixels / spacing", "lengthInPixels * spacing"),
    row("cells-guard", "guard", "Cells", "spacing, 1.0,", "spacing, 0.0,"),
    row("cells-most", "constant", "Cells", "1.0, float(BOKEH_NUM_SAMPLES))", "1.0, float(BOKEH_NUM_SAMPLES) - 1.0)"),
    row("cells-condition", "condition", "Cells", "spacing > 0.0", "spacing > 1.0"),
    row("noise-axes", "axis", "Noise", "0.06711056, 0.00583715", "0.00583715, 0.06711056"),
    row("noise-bias", "constant", "Noise", " - 0.5", ""),
    row("noise-frames", "constant", "Noise", "(frame - 64.0 * floor(frame / 64.0))", "frame"),
    row("noise-size", "axis", "Noise", "uv * imageSize", "uv * imageSize.yx"),
    row("noise-index", "dropped sample", "Noise", "(8.0 * passIndex + 1.0) *", ""),
    row("noise-index-offset", "dropped sample", "Noise", " + passIndex;", ";"),
    row("noise-step", "constant", "Noise", "0.515625", "0.5"),
    row("segment-axis", "axis", "Segment", "lineLength * sin(angle)", "lineLength * cos(angle)"),
    row("segment-length", "constant", "Segment", "lineLength * cos(angle)", "cos(angle)"),
    row("segment-squeeze", "aspect", "Segment", "squeeze, 1.0, squeeze, 1.0", "squeeze, 1.0, 1.0, 1.0"),
    row("segment-squeezed-axis", "axis", "Segment", "squeeze, 1.0, squeeze, 1.0", "1.0, squeeze, 1.0, squeeze"),
)

LINE_FILTER = (
    row("leakage-depth", "sign", "LeakageWeight", "sampleDepth < centerDepth", "sampleDepth > centerDepth"),
    row("leakage-bias", "sign", "LeakageWeight", "sampleCoC + settings.bleedingBias",
        "sampleCoC - settings.bleedingBias"),
    row("leakage-or", "condition", "LeakageWeight", "&&", "||"),
    row("leakage-coc", "axis", "LeakageWeight", "clamp(sampleCoC", "clamp(centerCoC"),
    row("leakage-member", "axis", "LeakageWeight", "sampleCoC * settings.bleedingMult",
        "sampleCoC * settings.bleedingBias"),
    row("signed-leakage-less", "condition", "SignedLeakageWeight", "< centerCoC", "> centerCoC"),
    row("signed-leakage-sample-sign", "sign", "SignedLeakageWeight", "(abs(sampleCoC) <", "(sampleCoC <"),
    row("signed-leakage-centre-sign", "sign", "SignedLeakageWeight", "< centerCoC", "< abs(centerCoC)"),
    row("signed-leakage-weight-sign", "sign", "SignedLeakageWeight", "clamp(abs(sampleCoC)", "clamp(sampleCoC"),
    row("signed-leakage-bias", "sign", "SignedLeakageWeight", "- settings.bleedingBias", "+ settings.bleedingBias"),
    row("signed-leakage-member", "axis", "SignedLeakageWeight", "settings.bleedingMult", "settings.bleedingBias"),
    row("signed-leakage-square", "dropped sample", "SignedLeakageWeight", "weight = weight * weight;", ""),
    row("signed-leakage-clamp", "guard", "SignedLeakageWeight", "0.0, 1.0)", "0.0, 2.0)"),
    row("leakage-clamp", "guard", "LeakageWeight", "0.0, 1.0)", "0.0, 2.0)"),
    row("resolve-guard", "guard", "Resolve", "totalWeight > 0.0", "totalWeight > -1.0"),
    row("resolve-threshold", "condition", "Resolve", "totalWeight > 0.0", "totalWeight > 0.01"),
    row("resolve-blur-coc", "condition", "Resolve", "!blurCoC", "blurCoC"),
    row("filter-last-sample", "dropped sample", "DepthOfField", "i < BOKEH_NUM_SAMPLES", "i < BOKEH_NUM_SAMPLES - 1"),
    row("filter-first-sample", "dropped sample", "DepthOfField", " = 0; i", " = 1; i"),
    row("filter-weight", "dropped sample", "DepthOfField", "totalWeight += weight", "totalWeight += 1.0"),
    row("filter-radius", "constant", "DepthOfField", "* centerPixel.a", "* 0.5 * centerPixel.a"),
    row("filter-swapped-coc", "axis", "DepthOfField", "samplePixel.a, centerDepth, centerPixel.a",
        "centerPixel.a, centerDepth, samplePixel.a"),
    row("filter-swapped-depth", "axis", "DepthOfField", "(sampleDepth, samplePixel.a, centerDepth,",
        "(centerDepth, samplePixel.a, sampleDepth,"),
    row("filter-raw-depth", "guard", "DepthOfField", "BokehSafeDepth(BokehFetchNearest", "(BokehFetchNearest", COUNTED),
    row("adaptive-raw-depth", "guard", "DepthOfFieldAdaptive", "BokehSafeDepth(BokehFetchNearest", "(BokehFetchNearest",
        COUNTED),
    row("adaptive-leakage", "dropped sample", "DepthOfFieldAdaptive", "(sampleDepth,", "(centerDepth,"),
    row("adaptive-total", "dropped sample", "DepthOfFieldAdaptive", "totalWeight += weight", "totalWeight += cell"),
    row("adaptive-blur-coc", "condition", "DepthOfFieldAdaptive", "centerPixel, blurCoC)", "centerPixel, true)"),
    row("adaptive-threshold", "condition", "DepthOfFieldAdaptive", "CoC > 0.0", "CoC > 0.05"),
)

# Of the samples along a line, which two functions have
LINE = tuple(
    row(f"{prefix}-{name}", kind, function, old, new)
    for prefix, function in (("sum", "LineSum"), ("adaptive", "DepthOfFieldAdaptive"))
    for name, kind, old, new in (
        ("half-length", "constant", "2.0 * length", "length"),
        ("length-unit", "axis", "CoC * settings.imageHeight;", "CoC * settings.aspectRatio;"),
        ("spacing", "axis", "lengthInPixels, settings.spacing", "lengthInPixels, settings.jitter"),
        ("last-cell", "dropped sample", "float(i) >= cells", "float(i) + 1.0 >= cells"),
        ("no-aspect", "aspect", "CoC / settings.aspectRatio", "CoC"),
        ("axis", "axis", "segment.xy", "segment.yx"),
        ("sign", "sign", "uv + (segment.xy - ", "uv - (segment.xy - "),
        ("start", "sign", "(segment.xy - segment.zw)", "(segment.xy + segment.zw)"),
        ("cell-length", "constant", "(2.0 / cells)", "(1.0 / cells)"),
        ("cell-weight", "dropped sample", "= cell * Bokeh", "= Bokeh"),
        ("middle", "constant", "= 0.5 + settings.jitter", "= settings.jitter"),
        ("jitter", "sign", "0.5 + settings.jitter", "0.5 - settings.jitter"),
        ("jitter-member", "axis", "settings.jitter", "settings.spacing"),
        ("dense-jitter", "guard", "cells - 1.0, 0.0, 1.0)", "cells, 0.0, 1.0)"),
    )
) + tuple(
    row(name, "off-by-one", function, "float(i) >= cells", "float(i) > cells", killer,
        argument="One sample more, past the end of the line, weighs clamp(cells - i, 0, 1) = 0. It costs an iteration, "
        "and that is all.")
    for name, function, killer in (
        ("sum-one-more", "LineSum", HEXAGON), ("adaptive-one-more", "DepthOfFieldAdaptive", ADAPTIVE)
    )
)

COMBINE = (
    row("combine-max", "min for max", "Combine", "min(a, b)", "max(a, b)"),
    row("combine-star", "min for max", "Combine", "max(a, b)", "min(a, b)", STAR),
    row("combine-condition", "condition", "Combine", "if (useMax)", "if (!useMax)"),
    row("final-one-side", "axis", "DepthOfFieldFinal", "BokehCombine(a, Bokeh", "BokehCombine(a, a + 0.0 * Bokeh"),
)

NAIVE_GATHER = (
    row("naive-no-aspect", "aspect", "NaiveGather", " / settings.aspectRatio", ""),
    row("naive-member", "axis", "NaiveGather", "settings.aspectRatio", "settings.imageHeight"),
    row("naive-next-texel", "off-by-one", "NaiveGather", "KernelSamp, i,", "KernelSamp, i + 1,"),
    row("naive-weight", "dropped sample", "NaiveGather", "totalWeight += weight", "totalWeight += 1.0"),
    row("naive-axes", "axis", "NaiveGather", ".rg", ".gr"),
    row("naive-raw-depth", "guard", "NaiveGather", "BokehSafeDepth(BokehFetchNearest", "(BokehFetchNearest", COUNTED),
    row("grid-one-side", "axis", "NaiveGrid", "lineEndU, i", "lineEndV, i"),
    row("grid-raw-depth", "guard", "NaiveGrid", "BokehSafeDepth(BokehFetchNearest", "(BokehFetchNearest", COUNTED),
    row("grid-row", "dropped sample", "NaiveGrid", "j < BOKEH_NUM_SAMPLES", "j < BOKEH_NUM_SAMPLES - 1"),
    row("grid-column", "dropped sample", "NaiveGrid", "i < BOKEH_NUM_SAMPLES", "i < BOKEH_NUM_SAMPLES - 1"),
    row("grid-weight", "dropped sample", "NaiveGrid", "totalWeight += weight", "totalWeight += 1.0"),
)

EXACT_POLYGONS = (
    row("polygon-squeeze", "axis", "MakePolygon", "squeeze = squeeze", "squeeze = rotation"),
    row("polygon-rotation", "axis", "MakePolygon", "rotation = rotation", "rotation = squeeze"),
    row("polygon-sides", "off-by-one", "MakePolygon", "sides = sides", "sides = sides + 2"),
    row("rotated-mirrored", "sign", "Rotated", "axis.x - direction", "axis.x + direction"),
    row("rotated-sheared", "sign", "Rotated", "* axis.y + direction.y", "* axis.y - direction.y"),
    row("edge-angle", "angle", "PolygonEdge", "2.0 * halfStep * float(k)", "halfStep * float(k)"),
    row("edge-step", "angle", "PolygonEdge", "float(polygon.sides);", "(float(polygon.sides) + 1.0);"),
    row("edge-middle", "sign", "PolygonEdge", "- vec2(0.0, meanOfFirst)", "+ vec2(0.0, meanOfFirst)"),
    row("edge-mean", "off-by-one", "PolygonEdge", "0.5 * float(polygon.sides) - 1.0", "0.5 * float(polygon.sides)"),
    row("edge-second-pass", "sign", "PolygonEdge", "-middle -", "middle -"),
    row("edge-pass-condition", "condition", "PolygonEdge", "if (secondPass)", "if (!secondPass)"),
    row("edge-length", "constant", "PolygonEdge", "(0.5 * sin(halfStep));", "sin(halfStep);"),
    row("edge-rotation", "angle", "PolygonEdge", "BokehRotated(halfEdge, axis)", "halfEdge"),
    row("edge-squeeze", "aspect", "PolygonEdge", "polygon.squeeze, 1.0, polygon.squeeze, 1.0",
        "1.0, 1.0, polygon.squeeze, 1.0"),
    row("edge-member", "axis", "PolygonEdge", "sin(polygon.rotation)", "sin(polygon.squeeze)"),
    row("weight-off-by-one", "off-by-one", "ExactWeight", "- 1.0", "+ 1.0"),
    row("weight-scale", "constant", "ExactWeight", " / sin(halfStep)", "",
        argument="All weights of a polygon get the same factor, and BokehResolve divides by their sum."),
    row("sum-false-halo", "dropped sample", "LineSum", "sum / cells", "sum / max(sum.a, BOKEH_MIN_DEPTH)"),
    row("sum-not-a-mean", "dropped sample", "LineSum", "sum / cells", "sum"),
    row("sum-weight", "dropped sample", "LineSum", "samplePixel.rgb, 1.0) * weight", "samplePixel.rgb * weight, cell)"),
    row("sum-leakage-order", "axis", "LineSum", "(samplePixel.a, centerCoC,", "(centerCoC, samplePixel.a,"),
    row("target-first-weight", "off-by-one", "ExactTarget", "(float(k) - 1.0) * angle", "float(k) * angle"),
    row("target-second-weight", "off-by-one", "ExactTarget", "(float(k) - 2.0) * angle", "(float(k) - 1.0) * angle"),
    row("target-guard", "guard", "ExactTarget", "max(sin((float(k) - 4.0) * angle), 0.0)",
        "sin((float(k) - 4.0) * angle)",
        argument="Where the sine is negative the line is one from edge k on, and all calls pass 0 for those."),
    row("target-third", "dropped sample", "ExactTarget", " + L3 * w3", ""),
    row("target-coc", "axis", "ExactTarget", "centerPixel, false", "centerPixel, true"),
    row("first-unsigned", "sign", "ExactFirst", "abs(centerPixel.a)", "centerPixel.a"),
    row("first-member", "axis", "ExactFirst", "settings.imageHeight, settings.spacing",
        "settings.aspectRatio, settings.spacing"),
    row("first-spacing", "axis", "ExactFirst", "settings.imageHeight, settings.spacing",
        "settings.imageHeight, settings.jitter"),
    row("first-edge", "angle", "ExactFirst", "BokehPolygonEdge(2,", "BokehPolygonEdge(1,"),
    row("first-pass", "condition", "ExactFirst", "BokehPolygonEdge(1, polygon, false)",
        "BokehPolygonEdge(1, polygon, true)"),
    row("first-order", "axis", "ExactFirst", "T3 = BokehExactTarget(3", "T4 = BokehExactTarget(3"),
    row("first-octagon", "off-by-one", "ExactFirst", "polygon.sides > 6", "polygon.sides > 8"),
    row("first-hexagon", "off-by-one", "ExactFirst", "polygon.sides > 4", "polygon.sides > 6"),
    row("first-decagon", "axis", "ExactFirst", "L1, L2, L3, L4", "L1, L2, L3, L3"),
    row("first-threshold", "condition", "ExactFirst", "CoC > 0.0", "CoC > 0.05"),
    row("second-unsigned", "sign", "ExactSecond", "abs(centerPixel.a)", "centerPixel.a"),
    row("second-texture", "axis", "ExactSecond", "T3Samp", "T4Samp"),
    row("second-last-texture", "axis", "ExactSecond", "T5Samp", "T4Samp"),
    row("second-weight", "off-by-one", "ExactSecond", "BokehExactWeight(3,", "BokehExactWeight(2,"),
    row("second-line", "dropped sample", "ExactSecond", "sum += BokehExactWeight(4,",
        "sum += 0.0 * BokehExactWeight(4,"),
    row("second-edge", "angle", "ExactSecond", "BokehPolygonEdge(5,", "BokehPolygonEdge(4,"),
    row("second-pass", "condition", "ExactSecond", "BokehPolygonEdge(3, polygon, true)",
        "BokehPolygonEdge(3, polygon, false)"),
    row("second-coc", "axis", "ExactSecond", "CoC, centerPixel.a", "CoC, CoC", count=4),
    row("second-total", "dropped sample", "ExactSecond", "sum.a, center", "1.0, center"),
    row("one-by-one-unsigned", "sign", "ExactEdge", "abs(centerPixel.a)", "centerPixel.a"),
    row("one-by-one-last", "dropped sample", "ExactEdge", "min(k, 5)", "min(k - 1, 5)"),
    row("one-by-one-most", "guard", "ExactEdge", "min(k, 5)", "min(k, 6)", *OUT_OF_RANGE,
        argument="It keeps a wrong BokehEdge from a loop of minutes. k is 5 at most in exact polygons: a larger limit "
        "changes none of them."),
    row("one-by-one-area", "guard", "ExactEdge", "max(sin(float(k - i) * angle), 0.0)",
        "sin(float(k - i) * angle)", *OUT_OF_RANGE),
    row("one-by-one-first", "dropped sample", "ExactEdge", "= 1; i", "= 2; i"),
    row("one-by-one-weight", "off-by-one", "ExactEdge", "float(k - i)", "float(k - i + 1)"),
    row("one-by-one-angle", "angle", "ExactEdge", "6.28318531", "3.14159265"),
    row("one-by-one-edge", "axis", "ExactEdge", "BokehPolygonEdge(i,", "BokehPolygonEdge(k,"),
    row("one-by-one-pass", "condition", "ExactEdge", "polygon, false)", "polygon, true)"),
)

VIEWPORT = (
    row("viewport-corner", "dropped sample", "ToTexture", "BokehViewport.xy + uv", "uv"),
    row("viewport-size", "aspect", "ToTexture", "uv * BokehViewport.zw", "uv"),
    row("viewport-low", "guard", "ToTexture", "BokehViewportBounds.xy, Bok", "vec2(0.0, 0.0), Bok"),
    row("viewport-high", "guard", "ToTexture", "BokehViewportBounds.zw)", "vec2(1.0, 1.0))"),
    row("viewport-inset", "constant", "SetViewport", "0.5078125, 0.5078125", "0.5, 0.5"),
    row("viewport-narrow", "guard", "SetViewport", "min(vec2(0.5078125, 0.5078125), viewport.zw * 0.5)",
        "vec2(0.5078125, 0.5078125)"),
    row("viewport-texture", "axis", "SetViewport", "viewport / textureSize.xyxy", "viewport / textureSize.yxyx"),
    row("viewport-kernel", "porting", "NaiveGather", "BokehFetchTable(KernelSamp, i, BOKEH_NUM_SAMPLES)",
        "BokehFetchNearest(KernelSamp, vec2((float(i) + 0.5) / float(BOKEH_NUM_SAMPLES), 0.5))",
        "test_viewport.py::test_nothing_leaks_in[osmesa naive]"),
)

DEBUG_VIEWS = (
    row("debug-depth", "axis", "DebugDepth", "S2 / (", "S1 / ("),
    row("debug-coc", "constant", "DebugCoC", "clamp(abs(CoC) /", "clamp(0.5 * abs(CoC) /"),
    row("debug-coc-guard", "guard", "DebugCoC", "max(MaxCoC, BOKEH_MIN_DEPTH)", "MaxCoC"),
    row("debug-coc-sign", "sign", "DebugCoC", "abs(CoC)", "CoC"),
    row("debug-focus-sign", "sign", "DebugFocus", "abs(CoC)", "CoC"),
    row("debug-sides", "condition", "DebugFocus", "S2 < S1", "S2 > S1"),
    row("debug-focus-guard", "guard", "DebugFocus", "max(MaxCoC, BOKEH_MIN_DEPTH)", "MaxCoC"),
)
# fmt: on

IN_LIBRARY = (*CONFIGURATION, *CIRCLE_OF_CONFUSION, *SAMPLE_OFFSETS, *LINE_FILTER, *LINE, *COMBINE, *NAIVE_GATHER, *EXACT_POLYGONS, *VIEWPORT, *DEBUG_VIEWS)
