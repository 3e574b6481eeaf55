"""Mistakes in the layers and their passes: alike in all three languages, and forgotten in one."""

from dataclasses import replace

from bokeh_validation.mutants.killers import (
    LAYERED,
    LAYERED_INVERSE,
    LAYERED_LEAKS,
    LAYERED_LEVELS,
    LAYERED_MADE,
    LAYERED_MANY,
    LAYERED_MUTANTS,
    LAYERED_ONE_TARGET,
    LAYERED_PLACE,
    PARITY,
    on,
)
from bokeh_validation.mutants.model import Edit, Mutant, Selection


def _mutant(name: str, kind: str, function: str, old: str, new: str, *killers: Selection, count: int = 1) -> Mutant:
    edit = Edit("layers", f"Bokeh{function}", old, new, count)
    return Mutant(f"layers-{name}", kind, (edit,), killers or (LAYERED, LAYERED_MANY))


def _argued(name: str, kind: str, function: str, old: str, new: str, *killers: Selection, argument: str) -> Mutant:
    return replace(_mutant(name, kind, function, old, new, *killers), argument=argument)


def _pass(name: str, kind: str, function: str, old: str, new: str, *killers: Selection) -> Mutant:
    return Mutant(f"layers-{name}", kind, (Edit("passes", function, old, new),), killers or (LAYERED, LAYERED_MANY))


def _forgotten(name: str, language: str, function: str | None, old: str, new: str, *killers: Selection) -> Mutant:
    edit = Edit("layers", function, old, new)
    return Mutant(f"{language}-layers-{name}", "one language", (edit,), killers, (language,))


# A mutant is a row or two.
# fmt: off
GRIDS = (
    _mutant("reduced-size", "off-by-one", "ReducedGrid", "ceil(full.size / scale)", "floor(full.size / scale)"),
    _mutant("reduced-texel", "off-by-one", "ReducedGrid", "1.0 / ceil(floor(", "1.0 / floor(floor("),
    _argued("reduced-rounding", "guard", "ReducedGrid", "floor(1.0 / full.texel + 0.5)", "(1.0 / full.texel)",
            LAYERED_INVERSE,
            argument="1 / (1 / 122) is above 122 in float32, and half of it would be 62. All compilers here fold it to "
            "122. On a device whose compiler does not, test_a_size_whose_inverse_is_small notices."),
    _mutant("reduced-origin", "constant", "ReducedGrid", "full.origin / scale", "full.origin", LAYERED_PLACE),
    _mutant("viewport-texel", "axis", "MakeGrid", "1.0 / wholeSize", "1.0 / viewport.zw", LAYERED_PLACE),
    _mutant("viewport-origin", "axis", "MakeGrid", "= viewport.xy", "= viewport.yx", LAYERED_PLACE),
    _mutant("inset", "constant", "FetchGrid", "vec2(0.5078125, 0.5078125)", "vec2(0.25, 0.25)", LAYERED_LEAKS),
    _mutant("far-side", "guard", "FetchGrid", "grid.size - inset", "grid.size", LAYERED_LEAKS),
    _mutant("largest", "axis", "MakeLayers", "MaxCoC * imageSize.y", "MaxCoC * imageSize.x"),
    _mutant("no-jitter", "constant", "MakeLayers", "= 0.0;", "= 1.0;", LAYERED_MADE),
)

SHARES = (
    _mutant("brightest", "min for max", "Brightest", "max(max(", "min(max("),
    _mutant("slope", "constant", "LayerSlope", "5.0 / max", "4.0 / max"),
    _mutant("gate", "condition", "LayerSlope", "(whole - none)", "whole"),
    _mutant("slope-largest", "constant", "LayerSlope", "largest / gate, 2.0", "largest / gate, 20.0"),
    _mutant("near-none", "condition", "NearSlope", "6.0, 12.0", "4.0, 12.0"),
    _mutant("near-whole", "condition", "NearSlope", "6.0, 12.0", "6.0, 10.0"),
    _mutant("far-none", "condition", "FarSlope", "10.0, 16.0", "6.0, 16.0"),
    _mutant("far-whole", "condition", "FarSlope", "10.0, 16.0", "10.0, 12.0"),
    _mutant("share-from", "condition", "LayerShare", "- 2.0", "- 1.5"),
    _mutant("share-clamp", "guard", "LayerShare", "0.0, 1.0)", "0.0, 2.0)"),
)

TILES = (
    _mutant("tiles-sign", "sign", "LayerTiles", "max(found.r, -s)", "max(found.r, s)"),
    _mutant("tiles-last", "dropped sample", "LayerTiles", "x < 8", "x < 7"),
    _mutant("tiles-mean", "constant", "LayerTiles", "/ 64.0", "/ 63.0"),
    _mutant("tiles-height", "axis", "LayerTiles", "layers.full.size.y", "layers.full.size.x"),
    _mutant("tiles-black", "guard", "LayerTiles", "0.00001", "0.001", LAYERED_LEVELS),
    _mutant("reaching-margin", "constant", "Reaching", "tiles - 2.0", "tiles - 1.0"),
    _mutant("reaching-fade", "dropped sample", "Reaching", "CoC / 16.0 + 1.0", "CoC / 16.0"),
    _mutant("reaching-radius", "constant", "Reaching", "CoC / 16.0", "CoC / 32.0"),
    _mutant("reach-margin", "off-by-one", "ReachTiles", "+ 2.0", "+ 1.0"),
    _mutant("reach-radius", "constant", "ReachTiles", "/ 16.0", "/ 32.0"),
    _mutant("reach-last", "off-by-one", "LayerReach", "tiles > radius", "tiles >= radius"),
    _mutant("reach-axis", "axis", "LayerReach", "axis * tiles", "axis.yx * tiles"),
    _mutant("reach-level", "constant", "LayerReach", "(2.0 * radius + 1.0)", "(2.0 * radius)"),
    _mutant("weight-least", "constant", "BlurWeight", "0.01 +", "0.1 +"),
    _mutant("weight-most", "guard", "BlurWeight", "10000.0", "100.0", LAYERED_LEVELS),
)

SPLIT = (
    _mutant("split-unit", "sign", "LayerSplit", "exp2(-reach.b)", "exp2(reach.b)"),
    _mutant("split-slopes", "axis", "LayerSplit", "BokehFarSlope(reach.g)", "BokehFarSlope(reach.r)"),
    _mutant("split-leftovers", "constant", "LayerSplit", "4.0 - 4.0 * nearShare", "1.0 - nearShare"),
    _mutant("split-leftover-sign", "sign", "LayerSplit", "vec2(-s, s)", "vec2(s, s)"),
    _mutant("split-behind", "condition", "LayerSplit", "0.5 * largestShare", "0.9 * largestShare"),
    _mutant("split-darkest", "dropped sample", "LayerSplit", "min(color, darkest)", "color"),
    _mutant("split-darkest-max", "min for max", "LayerSplit", "min(darkest,", "max(darkest,"),
    _mutant("split-clean-always", "condition", "LayerSplit", "if (behind > brightest)", "if (behind >= 0.0)"),
    _mutant("split-part", "constant", "LayerSplit", "(behind - brightest) /", "(behind) /"),
    _mutant("split-near-sign", "sign", "LayerSplit", "vec4(-weight * s", "vec4(weight * s"),
    _mutant("split-row", "dropped sample", "LayerSplit", "row < 2", "row < 1"),
    _mutant("split-mean", "constant", "LayerSplit", "far * 0.25", "far * 0.5"),
    _mutant("split-targets", "axis", "LayerSplit", "T3 = far", "T3 = near"),
    _mutant("kernels-last", "dropped sample", "LayerKernels", "x < 4", "x < 3"),
    _mutant("kernels-max", "min for max", "LayerKernels", "max(left", "min(left"),
    _mutant("kernels-mean", "constant", "LayerKernels", "/ 16.0", "/ 15.0"),
    _mutant("spread-sigma", "constant", "LayerSpread", "0.0375", "0.075"),
    _mutant("spread-narrowest", "constant", "LayerSpread", "vec2(0.6, 0.6)", "vec2(0.3, 0.3)"),
    _mutant("spread-exponent", "constant", "LayerSpread", "exp(-0.5 *", "exp(-1.0 *"),
    _mutant("spread-weights", "axis", "LayerSpread", "weight.x, weight.x, weight.y, weight.y",
            "weight.y, weight.y, weight.x, weight.x"),
    _mutant("sizes-near", "condition", "LayerSizes", "reach.r > 6.0", "reach.r > 12.0"),
    _mutant("sizes-far", "condition", "LayerSizes", "reach.g > 10.0", "reach.g > 16.0"),
    _mutant("sizes-layer", "axis", "LayerSizes", "128.0 * sums.b", "128.0 * sums.r"),
    _mutant("sizes-leftovers", "axis", "LayerSizes", "vec4(reach, targets.T2.rg)", "vec4(targets.T2.rg, reach)"),
)

HOLES = (
    _mutant("holes-near", "constant", "LayerHoles", "1.0 - 2.0 * nearShare", "1.0 - nearShare"),
    _mutant("holes-least", "guard", "LayerHoles", "0.0625 - 0.0625 * nearShare", "0.0"),
    _mutant("holes-bright", "dropped sample", "LayerHoles", "(1.0 + BokehBrightest(pixel.rgb) * unit)", "1.0"),
    _mutant("holes-middle", "dropped sample", "LayerHoles", "(weight * (1.0 - farShare))", "weight"),
    _mutant("holes-shares", "dropped sample", "LayerHoles", "farShare) * notNear", "farShare)"),
    _mutant("corner", "angle", "FirstCorner", "- 3.14159265 / float(polygon.sides)", "- 0.0"),
    _mutant("corner-step", "angle", "CornerStep", "6.28318531", "3.14159265"),
    _mutant("on-edge", "constant", "OnEdge", "6.0 * float(ring)", "4.0 * float(ring)"),
    _mutant("on-edge-rounding", "off-by-one", "OnEdge", "+ 0.5", "+ 0.0"),
    _mutant("fill-reach", "constant", "LayerFill", "reach / 16.0", "reach / 8.0"),
    _mutant("fill-weight", "constant", "LayerFill", "16.0 * radius * radius", "radius * radius"),
    _mutant("fill-gate", "condition", "LayerFill", "reach < 6.0", "reach < 12.0"),
    _mutant("fill-rings", "off-by-one", "LayerFill", "ring < 3", "ring < 2"),
    _mutant("fill-squeeze", "aspect", "LayerFill", "vec2(layers.polygon.squeeze, 1.0)", "vec2(1.0, 1.0)"),
    _mutant("fill-share", "axis", "LayerFill", "shares.r / max", "shares.g / max"),
    _mutant("fill-middle", "dropped sample", "LayerFill", "vec4(middle.rgb / middle.a, share)", "vec4(both, share)"),
    _mutant("fill-nothing", "guard", "LayerFill", "if (far.a > 0.000001)", "if (far.a >= 0.0)"),
)

POLYGONS = (
    _mutant("line-cells", "constant", "LayerLine", "lengthInTexels, 2.0,", "lengthInTexels, 4.0,"),
    _mutant("line-weight", "dropped sample", "LayerLine", "sum += cell *", "sum +="),
    _mutant("line-start", "sign", "LayerLine", "segment.xy - segment.zw", "segment.xy + segment.zw"),
    _mutant("line-length", "constant", "LayerLine", "(2.0 / cells)", "(1.0 / cells)"),
    _mutant("line-jitter", "sign", "LayerLine", "0.5 + layers.jitter", "0.5 - layers.jitter"),
    _mutant("blur-of-its-own", "constant", "LayerCoC", "CoC * CoC - 8.0", "CoC * CoC"),
    _mutant("blur-layer", "axis", "LayerCoC", "0.5 * sizes.g", "0.5 * sizes.r"),
    _mutant("blur-place", "constant", "LayerCoC", "center / 4.0", "center / 2.0"),
    _mutant("target-line", "off-by-one", "LayerTarget", "float(k) - 2.0", "float(k) - 1.0"),
    _mutant("target-total", "dropped sample", "LayerTarget", "(w1 + w2 + w3 + w4)", "(w1 + w2)"),
    _mutant("first-edge", "off-by-one", "LayerFirst", "BokehPolygonEdge(2,", "BokehPolygonEdge(3,"),
    _mutant("first-target", "off-by-one", "LayerFirst", "BokehLayerTarget(4,", "BokehLayerTarget(3,"),
    _mutant("first-lines", "axis", "LayerFirst", "L1, L2, none, none", "L2, L1, none, none"),
    _mutant("second-edge", "sign", "LayerSecond", "BokehPolygonEdge(3, polygon, true)",
            "BokehPolygonEdge(3, polygon, false)"),
    _mutant("second-weight", "off-by-one", "LayerSecond", "BokehExactWeight(3,", "BokehExactWeight(2,"),
    _mutant("second-total", "dropped sample", "LayerSecond", "total += weight", "total += 0.0", count=3),
    _mutant("edge-lines", "off-by-one", "LayerEdge", "min(k, 5)", "min(k, 4)", LAYERED),
    _mutant("edge-area", "dropped sample", "LayerEdge", "max(sin(float(k - i) * angle), 0.0)", "1.0",
            LAYERED),
    _mutant("pick", "off-by-one", "PickTarget", "k == 4", "k == 6", LAYERED_ONE_TARGET),
)

PICTURE = (
    _mutant("cubic-before", "constant", "FetchLayer", "1.0 - 0.5 * f", "1.0 - 0.25 * f"),
    _mutant("cubic-texel", "off-by-one", "FetchLayer", "texel.x + 2.0", "texel.x + 1.0"),
    _mutant("cubic-axes", "axis", "FetchLayer", "(t * w0.y + b * w3.y)", "(t * w0.x + b * w3.x)"),
    _mutant("cubic-total", "dropped sample", "FetchLayer", "sum / total", "sum"),
    _mutant("cubic-darkest", "guard", "FetchLayer", "min(min(c, min(l, r)), min(t, b))",
            "vec4(-1.0, -1.0, -1.0, -1.0)"),
    _mutant("cubic-brightest", "guard", "FetchLayer", "max(max(c, max(l, r)), max(t, b))",
            "vec4(65504.0, 65504.0, 65504.0, 65504.0)"),
    _mutant("spread-radius", "constant", "SpreadRadius", "0.5 * abs(s) - 0.5", "0.5 * abs(s)"),
    _mutant("ring-last", "constant", "RingRadius", "(float(BOKEH_LAYER_RINGS) + 0.5)", "float(BOKEH_LAYER_RINGS)"),
    _mutant("ring-pixel", "guard", "RingRadius", ", float(ring));", ", 0.0);"),
    _mutant("ring-power", "constant", "RingRadius", "power * log2(share)", "log2(share)"),
    _mutant("nothing-spreads", "condition", "Layered", "max(tile.r, tile.g) > 1.0", "max(tile.r, tile.g) > 4.0"),
    _mutant("near-of-far", "axis", "Layered", "BokehFarSlope(tile.g)", "BokehFarSlope(tile.r)"),
    _mutant("add-far", "dropped sample", "Layered", "max(farShare, nearShare)", "farShare"),
    _mutant("rest-far", "constant", "Layered", "16.0 - 16.0 * farShare", "1.0 - farShare"),
    _mutant("rest-near", "dropped sample", "Layered", "farShare, 1.0) * (1.0 - nearShare)", "farShare, 1.0)"),
    _mutant("radius-far", "dropped sample", "Layered", "tile.a * farShare", "tile.a"),
    _mutant("radius-leftovers", "dropped sample", "Layered", "max(tile.b, tile.a", "max(0.0, tile.a"),
    _mutant("covered", "condition", "Layered", "near.a > 0.998", "near.a > 0.5"),
    _mutant("power", "constant", "Layered", "max(restRadius, 1.0)), 0.0, 1.0)", "max(restRadius, 1.0)), 0.0, 2.0)"),
    _mutant("area", "constant", "Layered", "0.25 * current * current", "current * current"),
    _mutant("own-weight", "dropped sample", "Layered", "area / max(ownRadius * ownRadius, area)", "1.0"),
    _mutant("steepness", "dropped sample", "Layered", "3.0 * clamp((tile.r", "0.0 * clamp((tile.r"),
    _mutant("steepest", "condition", "Layered", "(tile.r - 16.0)", "(tile.r - 32.0)"),
    _mutant("gather-squeeze", "aspect", "Layered", "vec2(layers.polygon.squeeze, 1.0)", "vec2(1.0, 1.0)"),
    _mutant("ring-outer", "constant", "Layered", "1.5 * current - 0.5 * before", "current"),
    _mutant("ring-break", "condition", "Layered", "if (inner > radius)", "if (current > radius)"),
    _mutant("ring-count", "off-by-one", "Layered", "ring <= BOKEH_LAYER_RINGS", "ring < BOKEH_LAYER_RINGS"),
    _mutant("ring-area", "constant", "Layered", "(outer * outer - inner * inner)", "(outer * outer)"),
    _mutant("ring-slope", "constant", "Layered", "1.0 / (outer - inner)", "0.5 / (outer - inner)"),
    _mutant("ring-jitter", "dropped sample", "Layered", "float(i) + phase", "float(i)"),
    _mutant("behind", "sign", "Layered", "(q - s) * 2.0", "(s - q) * 2.0"),
    _mutant("behind-fade", "constant", "Layered", "(q - s) * 2.0", "(q - s) * 0.5"),
    _mutant("behind-near", "dropped sample", "Layered", "0.0, 1.0) * (1.0 - nearShare);", "0.0, 1.0);"),
    _mutant("sample-near", "sign", "Layered", "BokehLayerShare(-q, nearSlope)", "BokehLayerShare(q, nearSlope)"),
    _mutant("sample-far", "dropped sample", "Layered", "BokehLayerShare(q, farSlope) * addFar",
            "BokehLayerShare(q, farSlope)"),
    _mutant("sample-area", "constant", "Layered", "max(spread * spread, area)", "max(spread, area)"),
    _mutant("plain-far", "dropped sample", "Layered", "sum + far * addFar", "sum + far"),
    _mutant("cover", "condition", "Layered", "(middle.a - 0.3)", "(middle.a - 0.5)"),
    _mutant("missing", "constant", "Layered", "farAlpha / 0.05", "farAlpha / 0.5"),
    _mutant("background", "dropped sample", "Layered", "(empty - cover)", "empty"),
    _mutant("stack", "dropped sample", "Layered", "(stack - result) * nearShare", "(stack - result)"),
    _mutant("near-alpha", "constant", "Layered", "near.a * 1.002", "near.a"),
    _mutant("near-over", "dropped sample", "Layered", "result * (1.0 - alpha) + near", "result + near"),
    _mutant("coc", "axis", "Layered", "vec4(result, centerPixel.a)", "vec4(result, 1.0)"),
)

LAYER_PASSES = (
    _pass("pass-noise", "pass", "BokehBeginLayers", "ceil(imageSize / scale)", "imageSize"),
    _pass("pass-first-layer", "pass", "BokehLayerPolygon", "BokehLayer > 0.5", "BokehLayer < 0.5"),
    _pass("pass-second-layer", "pass", "BokehHexagonLayerSecond", "BokehLayer > 0.5", "BokehLayer < 0.5"),
    _pass("pass-reach", "pass", "BokehLayerReach", "vec2(1.0 - BokehAxis, BokehAxis)",
          "vec2(BokehAxis, 1.0 - BokehAxis)"),
    _pass("pass-sides", "pass", "BokehDecagonLayerSecond", "10, 2.0", "8, 2.0"),
    _pass("pass-pick", "pass", "BokehLayerHolesOne", "BokehEdge + 0.5", "BokehEdge - 0.5", LAYERED_ONE_TARGET),
    _pass("pass-edge", "pass", "BokehLayerEdge", "int(BokehEdge + 0.5)", "int(BokehEdge - 0.5)", LAYERED),
)

LAYERS_FORGOTTEN = (
    _forgotten("share", "hlsl", "BokehLayerShare", "- 2.0", "- 1.0", PARITY),
    _forgotten("share", "glsl", "BokehLayerShare", "- 2.0", "- 1.0", PARITY),
    _forgotten("share", "wgsl", "BokehLayerShare", "- 2.0", "- 1.0", PARITY),
    _forgotten("texture", "hlsl", "BokehLayerSecond", "BOKEH_SHARED(T3Samp", "BOKEH_SHARED(T4Samp", PARITY),
    _forgotten("constant", "glsl", None, "#define BOKEH_PRESET_CELLS 8", "#define BOKEH_PRESET_CELLS 12", PARITY),
    _forgotten("constant", "wgsl", None, "BOKEH_LAYER_RINGS: i32 = 3;", "BOKEH_LAYER_RINGS: i32 = 2;", PARITY),
    _forgotten("gather", "hlsl", "BokehLayered", "outer * outer - inner * inner", "outer * outer",
               on("dxc", LAYERED_MUTANTS, "test_both_layers")),
    _forgotten("cubic", "wgsl", "BokehFetchLayer", "texel.y + 2.0", "texel.y + 1.0",
               on("wgpu", LAYERED_MUTANTS, "test_both_layers")),
)
# fmt: on

LAYERS: tuple[Mutant, ...] = (
    *GRIDS,
    *SHARES,
    *TILES,
    *SPLIT,
    *HOLES,
    *POLYGONS,
    *PICTURE,
    *LAYER_PASSES,
    *LAYERS_FORGOTTEN,
)
