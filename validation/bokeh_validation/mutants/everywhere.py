"""Mistakes made alike in all three languages: the parity check is blind to them, only numbers show them."""

from dataclasses import replace

from bokeh_validation.mutants.killers import (
    ADAPTIVE_HEXAGON,
    ADAPTIVE_TRIANGLE,
    BAD_DEPTHS,
    COUNTED,
    DEBUG,
    DEFAULTS,
    DENSE,
    DEPTH_ENDS,
    DEPTHS,
    EACH_PASS,
    EXACT_DECAGON,
    EXACT_FIXED,
    EXACT_HEXAGON,
    EXACT_TARGETS,
    GRID,
    HOSTILE,
    JITTER,
    LIMITS,
    NAIVE,
    OUT_OF_RANGE,
    PAPER,
    PRESETS,
    REJECTED,
    SIGNED,
    STAR,
    STRUCTS,
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


def _pass(name: str, kind: str, function: str, old: str, new: str, *killers: Selection, count: int = 1) -> Mutant:
    return Mutant(name, kind, (Edit("passes", function, old, new, count),), killers)


def _configured(name: str, old: str, new: str, *killers: Selection) -> Mutant:
    return Mutant(name, "configuration", (Edit("library", None, old, new, 2),), killers)


def _raw_depth(name: str, function: str) -> Mutant:
    """Without the guard on the centre's depth: only on Direct3D 9 is every sample nearer than NaN."""
    edit = ("BokehSafeDepth(BokehFetchNearest", "(BokehFetchNearest")
    return _mutant(f"{name}-raw-depth", "guard", function, *edit, COUNTED)


def _survivor(test: str) -> Selection:
    return on("egl", SURVIVORS, test)


def _line(
    prefix: str, function: str, always: Selection, moved: Selection, jittered: Selection, dense: Selection
) -> tuple[Mutant, ...]:
    """The samples along a line, which two functions have.

    moved     tests of lines that are not in the middle
    jittered  of samples that are far apart
    dense     of samples that are a pixel apart
    """

    def made(name: str, kind: str, old: str, new: str, killer: Selection = always) -> Mutant:
        return _mutant(f"{prefix}-{name}", kind, function, old, new, killer)

    one_more = replace(
        made("one-more", "off-by-one", "float(i) >= cells", "float(i) > cells"),
        argument="One sample more, past the end of the line, weighs clamp(cells - i, 0, 1) = 0. It costs an iteration, "
        "and that is all.",
    )
    return (
        made("half-length", "constant", "2.0 * length", "length"),
        made("length-unit", "axis", "CoC * settings.imageHeight;", "CoC * settings.aspectRatio;"),
        made("spacing", "axis", "lengthInPixels, settings.spacing", "lengthInPixels, settings.jitter"),
        made("last-cell", "dropped sample", "float(i) >= cells", "float(i) + 1.0 >= cells"),
        one_more,
        made("no-aspect", "aspect", "CoC / settings.aspectRatio", "CoC"),
        made("axis", "axis", "segment.xy", "segment.yx", moved),
        made("sign", "sign", "uv + (segment.xy - ", "uv - (segment.xy - ", moved),
        made("start", "sign", "(segment.xy - segment.zw)", "(segment.xy + segment.zw)", moved),
        made("cell-length", "constant", "(2.0 / cells)", "(1.0 / cells)"),
        made("cell-weight", "dropped sample", "= cell * Bokeh", "= Bokeh"),
        made("middle", "constant", "= 0.5 + settings.jitter", "= settings.jitter"),
        made("jitter", "sign", "0.5 + settings.jitter", "0.5 - settings.jitter", jittered),
        made("jitter-member", "axis", "settings.jitter", "settings.spacing", jittered),
        made("dense-jitter", "guard", "cells - 1.0, 0.0, 1.0)", "cells, 0.0, 1.0)", dense),
    )


# A mutant is a row or two.
# fmt: off
CONFIGURATION = (
    # in the table of section [1] and in the definition
    _configured("largest-color", "65504.0", "60000.0", HOSTILE),
    _configured("largest-depth", "1000000000.0", "1000000.0", DEPTH_ENDS),
    _configured("smallest-depth", "0.000001", "0.001", TINY, LIMITS),
    _configured("default-sensor", "0.024", "0.036", DEFAULTS),
    _configured("default-bleeding", "30.0", "20.0", DEFAULTS),
    # WGSL has the presets in its table only
    Mutant("preset-row", "configuration", (Edit("library", None, "22 20", "22 25"),), (PRESETS,)),
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
    _mutant("kind-off-by-one", "off-by-one", "BokehLinearDepth", "kind == 4", "kind == 9", DEPTHS),
    _mutant("pack-green", "axis", "BokehPackCoC", "color.g", "color.r", HOSTILE),
    _mutant("pack-blue-unsafe", "guard", "BokehPackCoC", "BokehSafeChannel(color.b)", "color.b",
            _survivor("test_every_channel_is_made_safe")),
    _mutant("pack-alpha", "axis", "BokehPackCoC", "CoC)", "color.a)", HOSTILE),
    _mutant("cocmap-arguments", "axis", "BokehCoCMap", "A, f, S1", "A, S1, f", LIMITS),
    _mutant("cocmap-raw-depth", "guard", "BokehCoCMap", "BokehSafeDepth(", "(", HOSTILE),
    _mutant("signed-no-sign", "sign", "BokehSignedCoC", "CoC = -CoC;", "CoC = CoC;", SIGNED),
    _mutant("signed-far", "condition", "BokehSignedCoC", "S2 < S1", "S2 > S1", SIGNED),
    _mutant("signed-focus", "axis", "BokehSignedCoC", "S2 < S1", "S2 < f", SIGNED),
    _mutant("signed-arguments", "axis", "BokehSignedCoC", "A, f, S1", "f, A, S1", SIGNED),
    _mutant("signed-map-unsigned", "sign", "BokehSignedCoCMap", "BokehSignedCoC(S2", "BokehCoC(S2", SIGNED),
    _mutant("signed-map-arguments", "axis", "BokehSignedCoCMap", "A, f, S1", "A, S1, f", SIGNED),
    _mutant("signed-map-raw-depth", "guard", "BokehSignedCoCMap", "BokehSafeDepth(", "(", SIGNED),
)

SAMPLE_OFFSETS = (
    _mutant("line-no-aspect", "aspect", "BokehLineEnd", " / aspectRatio", "", PAPER),
    _mutant("line-aspect-inverted", "aspect", "BokehLineEnd", "/ aspectRatio", "* aspectRatio", PAPER),
    _mutant("line-axes", "axis", "BokehLineEnd", "cos(angle) / aspectRatio, 0.5 * sin(angle)",
            "sin(angle) / aspectRatio, 0.5 * cos(angle)", PAPER),
    _mutant("line-mirrored", "sign", "BokehLineEnd", "0.5 * sin(angle)", "-0.5 * sin(angle)", PAPER),
    _mutant("line-length", "constant", "BokehLineEnd", "(0.5 * cos(angle)", "(cos(angle)", PAPER),
    _mutant("offsets-guard", "guard", "BokehMakeOffsets", "max(numSamples, 2)", "numSamples",
            _survivor("test_a_line_of_one_sample")),
    _mutant("offsets-last", "off-by-one", "BokehMakeOffsets", "max(numSamples, 2) - 1", "max(numSamples, 2)", PAPER),
    _mutant("offsets-shifted", "off-by-one", "BokehMakeOffsets", "2 * i - last", "2 * i - last + 1", PAPER),
    _mutant("filter-aspect", "aspect", "BokehDefaultFilter", "imageSize.x / imageSize.y", "imageSize.y / imageSize.x",
            STRUCTS),
    _mutant("filter-height", "axis", "BokehDefaultFilter", "imageHeight = imageSize.y", "imageHeight = imageSize.x",
            STRUCTS),
    _mutant("filter-spacing", "constant", "BokehDefaultFilter", "spacing = BOKEH_SPACING", "spacing = 0.0", STRUCTS),
    _mutant("filter-jitter", "constant", "BokehDefaultFilter", "jitter = 0.0", "jitter = 1.0", STRUCTS),
    _mutant("filter-bleeding", "axis", "BokehDefaultFilter", "= BOKEH_BLEEDING_MULT", "= BOKEH_BLEEDING_BIAS", STRUCTS),
    _mutant("fade-half", "constant", "BokehFilterCoC", ") * 2.0", ")", ADAPTIVE_HEXAGON),
    _mutant("fade-begin", "constant", "BokehFilterCoC", "imageHeight - 0.5", "imageHeight",
            _survivor("test_half_a_pixel_is_in_focus")),
    _argued("fade-negative", "guard", "BokehFilterCoC", ", 0.0, 1.0)", ", -1.0, 1.0)", ADAPTIVE_HEXAGON,
            argument="Below half a pixel the CoC is negative then and not 0. All callers blur where it is above 0."),
    _mutant("fade-unbounded", "guard", "BokehFilterCoC", ", 0.0, 1.0)", ", 0.0, 2.0)", ADAPTIVE_HEXAGON),
    _mutant("fade-always", "condition", "BokehFilterCoC", "spacing > 0.0", "spacing >= 0.0",
            EXACT_HEXAGON),
    _mutant("fade-compiled-out", "condition", "BokehFilterCoC", "BOKEH_ADAPTIVE_SAMPLES > 0 && spacing",
            "BOKEH_ADAPTIVE_SAMPLES < 1 && spacing", ADAPTIVE_HEXAGON, EXACT_HEXAGON),
    _mutant("cells-inverted", "sign", "BokehCells", "lengthInPixels / spacing", "lengthInPixels * spacing",
            ADAPTIVE_HEXAGON, EXACT_HEXAGON),
    _mutant("cells-guard", "guard", "BokehCells", "spacing, 1.0,", "spacing, 0.0,",
            _survivor("test_a_line_of_no_length")),
    _mutant("cells-most", "constant", "BokehCells", "1.0, float(BOKEH_NUM_SAMPLES))",
            "1.0, float(BOKEH_NUM_SAMPLES) - 1.0)", JITTER),
    _mutant("cells-condition", "condition", "BokehCells", "spacing > 0.0", "spacing > 1.0", ADAPTIVE_HEXAGON),
    _mutant("noise-axes", "axis", "BokehNoise", "0.06711056, 0.00583715", "0.00583715, 0.06711056",
            ADAPTIVE_HEXAGON, EXACT_HEXAGON),
    _mutant("noise-bias", "constant", "BokehNoise", " - 0.5", "", ADAPTIVE_HEXAGON, EXACT_HEXAGON),
    _mutant("noise-frames", "constant", "BokehNoise", "(frame - 64.0 * floor(frame / 64.0))", "frame",
            _survivor("test_noise_comes_again")),
    _mutant("noise-size", "axis", "BokehNoise", "uv * imageSize", "uv * imageSize.yx", ADAPTIVE_HEXAGON, EXACT_HEXAGON),
    _mutant("noise-index", "dropped sample", "BokehNoise", "(8.0 * passIndex + 1.0) *", "", JITTER),
    _mutant("noise-index-offset", "dropped sample", "BokehNoise", " + passIndex;", ";", JITTER),
    _mutant("noise-step", "constant", "BokehNoise", "0.515625", "0.5", JITTER),
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
    _mutant("leakage-bias", "sign", "BokehLeakageWeight", "sampleCoC + settings.bleedingBias",
            "sampleCoC - settings.bleedingBias",
            PAPER),
    _mutant("leakage-or", "condition", "BokehLeakageWeight", "&&", "||", PAPER),
    _mutant("leakage-coc", "axis", "BokehLeakageWeight", "clamp(sampleCoC", "clamp(centerCoC", PAPER),
    _mutant("leakage-member", "axis", "BokehLeakageWeight", "sampleCoC * settings.bleedingMult",
            "sampleCoC * settings.bleedingBias", PAPER),
    _mutant("signed-leakage-less", "condition", "BokehSignedLeakageWeight", "< centerCoC", "> centerCoC", EXACT_FIXED),
    _mutant("signed-leakage-sample-sign", "sign", "BokehSignedLeakageWeight", "(abs(sampleCoC) <", "(sampleCoC <",
            EXACT_FIXED),
    _mutant("signed-leakage-centre-sign", "sign", "BokehSignedLeakageWeight", "< centerCoC", "< abs(centerCoC)",
            EXACT_FIXED),
    _mutant("signed-leakage-weight-sign", "sign", "BokehSignedLeakageWeight", "clamp(abs(sampleCoC)", "clamp(sampleCoC",
            EXACT_FIXED),
    _mutant("signed-leakage-bias", "sign", "BokehSignedLeakageWeight", "- settings.bleedingBias",
            "+ settings.bleedingBias", EXACT_FIXED),
    _mutant("signed-leakage-member", "axis", "BokehSignedLeakageWeight", "settings.bleedingMult",
            "settings.bleedingBias", EXACT_FIXED),
    _mutant("signed-leakage-square", "dropped sample", "BokehSignedLeakageWeight", "weight = weight * weight;", "",
            EXACT_FIXED),
    _mutant("signed-leakage-clamp", "guard", "BokehSignedLeakageWeight", "0.0, 1.0)", "0.0, 2.0)", EXACT_FIXED),
    _mutant("leakage-clamp", "guard", "BokehLeakageWeight", "0.0, 1.0)", "0.0, 2.0)", PAPER),
    _mutant("resolve-guard", "guard", "BokehResolve", "totalWeight > 0.0", "totalWeight > -1.0", REJECTED),
    _mutant("resolve-threshold", "condition", "BokehResolve", "totalWeight > 0.0", "totalWeight > 0.01", REJECTED),
    _mutant("resolve-blur-coc", "condition", "BokehResolve", "!blurCoC", "blurCoC", PAPER),
    _mutant("filter-last-sample", "dropped sample", "BokehDepthOfField", "i < BOKEH_NUM_SAMPLES",
            "i < BOKEH_NUM_SAMPLES - 1", PAPER),
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
    *_line("adaptive", "BokehDepthOfFieldAdaptive", ADAPTIVE_HEXAGON, ADAPTIVE_TRIANGLE, ADAPTIVE_HEXAGON,
           ADAPTIVE_HEXAGON),
    _mutant("adaptive-leakage", "dropped sample", "BokehDepthOfFieldAdaptive", "(sampleDepth,", "(centerDepth,",
            ADAPTIVE_HEXAGON),
    _mutant("adaptive-total", "dropped sample", "BokehDepthOfFieldAdaptive", "totalWeight += weight",
            "totalWeight += cell", ADAPTIVE_HEXAGON),
    _mutant("adaptive-blur-coc", "condition", "BokehDepthOfFieldAdaptive", "centerPixel, blurCoC)",
            "centerPixel, true)",
            ADAPTIVE_HEXAGON),
    _mutant("adaptive-threshold", "condition", "BokehDepthOfFieldAdaptive", "CoC > 0.0", "CoC > 0.05",
            ADAPTIVE_HEXAGON),
)

COMBINE = (
    _mutant("combine-max", "min for max", "BokehCombine", "min(a, b)", "max(a, b)", PAPER),
    _mutant("combine-star", "min for max", "BokehCombine", "max(a, b)", "min(a, b)", STAR),
    _mutant("combine-condition", "condition", "BokehCombine", "if (useMax)", "if (!useMax)", PAPER),
    _mutant("final-one-side", "axis", "BokehDepthOfFieldFinal", "BokehCombine(a, Bokeh",
            "BokehCombine(a, a + 0.0 * Bokeh", PAPER),
)

NAIVE_GATHER = (
    _mutant("naive-no-aspect", "aspect", "BokehNaiveGather", " / settings.aspectRatio", "", NAIVE),
    _mutant("naive-member", "axis", "BokehNaiveGather", "settings.aspectRatio", "settings.imageHeight", NAIVE),
    _mutant("naive-next-texel", "off-by-one", "BokehNaiveGather", "KernelSamp, i,", "KernelSamp, i + 1,", NAIVE),
    _mutant("naive-weight", "dropped sample", "BokehNaiveGather", "totalWeight += weight", "totalWeight += 1.0", NAIVE),
    _mutant("naive-axes", "axis", "BokehNaiveGather", ".rg", ".gr", NAIVE),
    _raw_depth("naive", "BokehNaiveGather"),
    _mutant("grid-one-side", "axis", "BokehNaiveGrid", "lineEndU, i", "lineEndV, i", GRID),
    _raw_depth("grid", "BokehNaiveGrid"),
    _mutant("grid-row", "dropped sample", "BokehNaiveGrid", "j < BOKEH_NUM_SAMPLES", "j < BOKEH_NUM_SAMPLES - 1", GRID),
    _mutant("grid-column", "dropped sample", "BokehNaiveGrid", "i < BOKEH_NUM_SAMPLES",
            "i < BOKEH_NUM_SAMPLES - 1", GRID),
    _mutant("grid-weight", "dropped sample", "BokehNaiveGrid", "totalWeight += weight", "totalWeight += 1.0", GRID),
)

EXACT_POLYGONS = (
    _mutant("polygon-squeeze", "axis", "BokehMakePolygon", "squeeze = squeeze", "squeeze = rotation", EXACT_HEXAGON),
    _mutant("polygon-rotation", "axis", "BokehMakePolygon", "rotation = rotation", "rotation = squeeze", EXACT_FIXED),
    _mutant("polygon-sides", "off-by-one", "BokehMakePolygon", "sides = sides", "sides = sides + 2", EXACT_FIXED),
    _mutant("rotated-mirrored", "sign", "BokehRotated", "axis.x - direction", "axis.x + direction", EXACT_FIXED),
    _mutant("rotated-sheared", "sign", "BokehRotated", "* axis.y + direction.y", "* axis.y - direction.y", EXACT_FIXED),
    _mutant("edge-angle", "angle", "BokehPolygonEdge", "2.0 * halfStep * float(k)", "halfStep * float(k)", EXACT_FIXED),
    _mutant("edge-step", "angle", "BokehPolygonEdge", "float(polygon.sides);", "(float(polygon.sides) + 1.0);",
            EXACT_FIXED),
    _mutant("edge-middle", "sign", "BokehPolygonEdge", "- vec2(0.0, meanOfFirst)",
            "+ vec2(0.0, meanOfFirst)", EXACT_FIXED),
    _mutant("edge-mean", "off-by-one", "BokehPolygonEdge", "0.5 * float(polygon.sides) - 1.0",
            "0.5 * float(polygon.sides)", EXACT_FIXED),
    _mutant("edge-second-pass", "sign", "BokehPolygonEdge", "-middle -", "middle -", EXACT_FIXED),
    _mutant("edge-pass-condition", "condition", "BokehPolygonEdge", "if (secondPass)", "if (!secondPass)", EXACT_FIXED),
    _mutant("edge-length", "constant", "BokehPolygonEdge", "(0.5 * sin(halfStep));", "sin(halfStep);", EXACT_FIXED),
    _mutant("edge-rotation", "angle", "BokehPolygonEdge", "BokehRotated(halfEdge, axis)", "halfEdge", EXACT_FIXED),
    _mutant("edge-squeeze", "aspect", "BokehPolygonEdge", "polygon.squeeze, 1.0, polygon.squeeze, 1.0",
            "1.0, 1.0, polygon.squeeze, 1.0", EXACT_HEXAGON),
    _mutant("edge-member", "axis", "BokehPolygonEdge", "sin(polygon.rotation)", "sin(polygon.squeeze)", EXACT_FIXED),
    _mutant("weight-off-by-one", "off-by-one", "BokehExactWeight", "- 1.0", "+ 1.0", EXACT_FIXED),
    _argued("weight-scale", "constant", "BokehExactWeight", " / sin(halfStep)", "", EXACT_HEXAGON,
            argument="All weights of a polygon get the same factor, and BokehResolve divides by their sum."),
    *_line("sum", "BokehLineSum", EXACT_HEXAGON, EXACT_FIXED, JITTER, DENSE),
    _mutant("sum-false-halo", "dropped sample", "BokehLineSum", "sum / cells", "sum / max(sum.a, BOKEH_MIN_DEPTH)",
            EXACT_FIXED),
    _mutant("sum-not-a-mean", "dropped sample", "BokehLineSum", "sum / cells", "sum",
            _survivor("test_squeezed_lines_have_means")),
    _mutant("sum-weight", "dropped sample", "BokehLineSum", "samplePixel.rgb, 1.0) * weight",
            "samplePixel.rgb * weight, cell)", EXACT_FIXED),
    _mutant("sum-leakage-order", "axis", "BokehLineSum", "(samplePixel.a, centerCoC,", "(centerCoC, samplePixel.a,",
            EXACT_FIXED),
    _mutant("target-first-weight", "off-by-one", "BokehExactTarget", "(float(k) - 1.0) * angle", "float(k) * angle",
            EXACT_FIXED),
    _mutant("target-second-weight", "off-by-one", "BokehExactTarget", "(float(k) - 2.0) * angle",
            "(float(k) - 1.0) * angle", EXACT_TARGETS),
    _argued("target-guard", "guard", "BokehExactTarget", "max(sin((float(k) - 4.0) * angle), 0.0)",
            "sin((float(k) - 4.0) * angle)", EXACT_FIXED,
            argument="Where the sine is negative the line is one from edge k on, and all calls pass 0 for those."),
    _mutant("target-third", "dropped sample", "BokehExactTarget", " + L3 * w3", "", EXACT_TARGETS),
    _mutant("target-coc", "axis", "BokehExactTarget", "centerPixel, false", "centerPixel, true", EXACT_FIXED),
    _mutant("first-unsigned", "sign", "BokehExactFirst", "abs(centerPixel.a)", "centerPixel.a", EXACT_FIXED),
    _mutant("first-member", "axis", "BokehExactFirst", "settings.imageHeight, settings.spacing",
            "settings.aspectRatio, settings.spacing", EXACT_HEXAGON),
    _mutant("first-spacing", "axis", "BokehExactFirst", "settings.imageHeight, settings.spacing",
            "settings.imageHeight, settings.jitter", EXACT_HEXAGON),
    _mutant("first-edge", "angle", "BokehExactFirst", "BokehPolygonEdge(2,", "BokehPolygonEdge(1,", EXACT_FIXED),
    _mutant("first-pass", "condition", "BokehExactFirst", "BokehPolygonEdge(1, polygon, false)",
            "BokehPolygonEdge(1, polygon, true)", EXACT_FIXED),
    _mutant("first-order", "axis", "BokehExactFirst", "T3 = BokehExactTarget(3", "T4 = BokehExactTarget(3",
            EXACT_TARGETS),
    _mutant("first-octagon", "off-by-one", "BokehExactFirst", "polygon.sides > 6", "polygon.sides > 8", EXACT_TARGETS),
    _mutant("first-hexagon", "off-by-one", "BokehExactFirst", "polygon.sides > 4", "polygon.sides > 6", EXACT_TARGETS),
    _mutant("first-decagon", "axis", "BokehExactFirst", "L1, L2, L3, L4", "L1, L2, L3, L3", EXACT_TARGETS),
    _mutant("first-threshold", "condition", "BokehExactFirst", "CoC > 0.0", "CoC > 0.05", EXACT_FIXED),
    _mutant("second-unsigned", "sign", "BokehExactSecond", "abs(centerPixel.a)", "centerPixel.a", EXACT_FIXED),
    _mutant("second-texture", "axis", "BokehExactSecond", "T3Samp", "T4Samp", EXACT_TARGETS),
    _mutant("second-last-texture", "axis", "BokehExactSecond", "T5Samp", "T4Samp", EXACT_TARGETS),
    _mutant("second-weight", "off-by-one", "BokehExactSecond", "BokehExactWeight(3,",
            "BokehExactWeight(2,", EXACT_FIXED),
    _mutant("second-line", "dropped sample", "BokehExactSecond", "sum += BokehExactWeight(4,",
            "sum += 0.0 * BokehExactWeight(4,", EXACT_TARGETS),
    _mutant("second-edge", "angle", "BokehExactSecond", "BokehPolygonEdge(5,", "BokehPolygonEdge(4,", EXACT_DECAGON),
    _mutant("second-pass", "condition", "BokehExactSecond", "BokehPolygonEdge(3, polygon, true)",
            "BokehPolygonEdge(3, polygon, false)", EXACT_FIXED),
    _mutant("second-coc", "axis", "BokehExactSecond", "CoC, centerPixel.a", "CoC, CoC", EXACT_FIXED, count=4),
    _mutant("second-total", "dropped sample", "BokehExactSecond", "sum.a, center", "1.0, center", EXACT_FIXED),
    _mutant("one-by-one-unsigned", "sign", "BokehExactEdge", "abs(centerPixel.a)", "centerPixel.a", EXACT_DECAGON),
    _mutant("one-by-one-last", "dropped sample", "BokehExactEdge", "min(k, 5)", "min(k - 1, 5)", EXACT_DECAGON),
    _argued("one-by-one-most", "guard", "BokehExactEdge", "min(k, 5)", "min(k, 6)", OUT_OF_RANGE,
            argument="It keeps a wrong BokehEdge from a loop of minutes. k is 5 at most in exact polygons: a "
            "larger limit changes none of them."),
    _mutant("one-by-one-area", "guard", "BokehExactEdge", "max(sin(float(k - i) * angle), 0.0)",
            "sin(float(k - i) * angle)", OUT_OF_RANGE),
    _mutant("one-by-one-first", "dropped sample", "BokehExactEdge", "= 1; i", "= 2; i", EXACT_DECAGON),
    _mutant("one-by-one-weight", "off-by-one", "BokehExactEdge", "float(k - i)", "float(k - i + 1)", EXACT_DECAGON),
    _mutant("one-by-one-angle", "angle", "BokehExactEdge", "6.28318531", "3.14159265", EXACT_DECAGON),
    _mutant("one-by-one-edge", "axis", "BokehExactEdge", "BokehPolygonEdge(i,", "BokehPolygonEdge(k,", EXACT_DECAGON),
    _mutant("one-by-one-pass", "condition", "BokehExactEdge", "polygon, false)", "polygon, true)", EXACT_DECAGON),
)

# the same in all languages since the parity check compares the bodies of the passes
READY_MADE = (
    _pass("begin-no-viewport", "dropped sample", "BokehBegin", "BokehUseViewport();", "", VIEWPORTS),
    _pass("begin-index", "dropped sample", "BokehBegin", "BokehFrame, passIndex", "BokehFrame, 0.0", JITTER),
    _pass("begin-frame", "dropped sample", "BokehBegin", "BokehFrame, passIndex", "0.0, passIndex", JITTER),
    _pass("begin-size", "axis", "BokehBegin", "BokehImageWidth, BokehImageHeight", "BokehImageHeight, BokehImageWidth",
          JITTER),
    _pass("begin-aspect", "aspect", "BokehBegin", "= BokehAspectRatio", "= 1.0",
          EXACT_FIXED),
    _pass("begin-height", "axis", "BokehBegin", "settings.imageHeight = BokehImageHeight",
          "settings.imageHeight = BokehImageWidth", EXACT_HEXAGON),
    _pass("begin-spacing", "axis", "BokehBegin", "= BokehSpacing", "= BokehJitter", EXACT_HEXAGON),
    _pass("begin-jitter", "dropped sample", "BokehBegin", "BokehJitter * noise", "noise", JITTER),
    _pass("begin-noise", "dropped sample", "BokehBegin", "BokehJitter * noise", "BokehJitter", JITTER),
    _pass("begin-bias", "axis", "BokehBegin", "= BokehBleedingBias", "= BokehBleedingMult", EXACT_FIXED),
    _pass("begin-mult", "axis", "BokehBegin", "= BokehBleedingMult", "= BokehBleedingBias", EXACT_FIXED),
    _pass("viewport-place", "axis", "BokehUseViewport", "BokehViewportX, BokehViewportY",
          "BokehViewportY, BokehViewportX", VIEWPORTS),
    _pass("viewport-textures", "axis", "BokehUseViewport", "BokehTextureWidth, BokehTextureHeight",
          "BokehTextureHeight, BokehTextureWidth", VIEWPORTS),
    _pass("first-index", "constant", "BokehFirst", "BokehBegin(uv, 0.0)", "BokehBegin(uv, 1.0)", JITTER),
    _pass("second-index", "constant", "BokehSecond", "BokehBegin(uv, 1.0)", "BokehBegin(uv, 0.0)", JITTER),
    _pass("edge-index", "constant", "BokehExactEdge", ", 0.0)", ", 1.0)", JITTER),
    _pass("line-index", "constant", "BokehAdaptiveLine", "BokehPassIndex", "0.0", EACH_PASS, ADAPTIVE_HEXAGON),
    _pass("first-squeeze", "aspect", "BokehFirst", "BokehSqueeze", "1.0", EXACT_HEXAGON),
    _pass("second-angle", "angle", "BokehSecond", "BokehAngle", "BokehAngleB", EXACT_FIXED),
    _pass("line-center", "axis", "BokehAdaptiveLine", "BokehLineCenterX, BokehLineCenterY",
          "BokehLineCenterY, BokehLineCenterX", ADAPTIVE_TRIANGLE),
    _pass("line-squeeze", "aspect", "BokehAdaptiveLine", "BokehSqueeze", "1.0", ADAPTIVE_HEXAGON),
    _pass("signed-entry", "pass", "BokehSignedCoCMap", "BokehSignedCoCMap(", "BokehCoCMap(", SIGNED),
    _pass("decagon-last-target", "axis", "BokehDecagonFirst", "targets.T5", "targets.T4", EXACT_TARGETS),
    _pass("octagon-sides", "off-by-one", "BokehOctagonFirst", ", 8)", ", 10)", EXACT_TARGETS),
    _pass("linear-kind", "off-by-one", "BokehLinearDepth", "BokehDepthKind + 0.5", "BokehDepthKind - 0.5", DEPTHS),
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
    _mutant("viewport-kernel", "porting", "BokehNaiveGather", "BokehFetchTable(KernelSamp, i, BOKEH_NUM_SAMPLES)",
            "BokehFetchNearest(KernelSamp, vec2((float(i) + 0.5) / float(BOKEH_NUM_SAMPLES), 0.5))",
            on("egl", "test_viewport.py", "test_nothing_leaks_in", "naive")),
)

DEBUG_VIEWS = (
    _mutant("debug-depth", "axis", "BokehDebugDepth", "S2 / (", "S1 / (", DEBUG),
    _mutant("debug-coc", "constant", "BokehDebugCoC", "clamp(abs(CoC) /", "clamp(0.5 * abs(CoC) /", DEBUG),
    _mutant("debug-coc-guard", "guard", "BokehDebugCoC", "max(MaxCoC, BOKEH_MIN_DEPTH)", "MaxCoC",
            _survivor("test_debug_views_of_a_pinhole")),
    _mutant("debug-coc-sign", "sign", "BokehDebugCoC", "abs(CoC)", "CoC",
            _survivor("test_debug_views_of_the_near_field")),
    _mutant("debug-focus-sign", "sign", "BokehDebugFocus", "abs(CoC)", "CoC",
            _survivor("test_debug_views_of_the_near_field")),
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
    *READY_MADE,
    *VIEWPORT,
    *DEBUG_VIEWS,
)
