"""The parameters of bokeh_passes.*: their order, which is the layout of the block, defaults, units and readers."""

from typing import NamedTuple


class Parameter(NamedTuple):
    """A row of the table in docs/reference/parameters.md.

    default  where a pass does not say otherwise
    unit     unit, meaning and range
    readers  entries that read it
    """

    default: float
    unit: str
    readers: str


# Parameter i is register c(i) of shader model 3 and byte offset 4 i of the block.
BLOCK = {
    "BokehApertureDiameter": Parameter(0.05, "m, A of Listing 1: f / the f-stop ([lens.md](../lens.md))", "CoCMap"),
    "BokehFocalLength": Parameter(0.05, "m, f", "CoCMap"),
    "BokehFocusDistance": Parameter(5.0, "m, S1, more than f", "CoCMap, Debug"),
    "BokehSensorHeight": Parameter(0.024, "m, 0.024 for 35 mm film", "CoCMap"),
    "BokehMaxCoC": Parameter(0.1, "fraction of the image height, 0 .. 1", "CoCMap, ConstantCoC, Debug, layered"),
    "BokehConstantCoC": Parameter(0.0, "fraction of the image height", "ConstantCoC"),
    "BokehAspectRatio": Parameter(1.0, "width / height of the image", "filters but layered"),
    "BokehAngle": Parameter(0.0, "radians: the pass's line; in exact, layered the polygon", "filters but NaiveGather"),
    "BokehAngleB": Parameter(0.0, "radians, the grid's other side", "NaiveGrid"),
    "BokehBleedingBias": Parameter(0.02, "CoC difference let pass, 0.02; 2: no leakage test", "filters but layered"),
    "BokehBleedingMult": Parameter(30.0, "weight for each unit of CoC, 30", "filters but layered"),
    "BokehBlurCoC": Parameter(1.0, "1: average the CoC with the colour", "filters but exact and layered"),
    "BokehUseMax": Parameter(0.0, "0: min, 1: max", "DepthOfFieldFinal, AdaptiveFinal"),
    "BokehDebugMode": Parameter(0.0, "0 colour, 1 depth, 2 CoC, 3 near and far", "Debug"),
    "BokehLineLength": Parameter(1.0, "length of the line in units of the CoC, 1", "Adaptive"),
    "BokehLineCenterX": Parameter(0.0, "middle of the line, to the right, units of the CoC, 0", "Adaptive"),
    "BokehLineCenterY": Parameter(0.0, "the same, towards the last row, 0", "Adaptive"),
    "BokehSqueeze": Parameter(1.0, "width of the bokeh / its height, 1", "filters"),
    "BokehSpacing": Parameter(0.0, "pixels between samples; 0: as the preset", "Adaptive, exact"),
    "BokehImageWidth": Parameter(1.0, "pixels", "Adaptive, exact, layered; all with BOKEH_VIEWPORT 1"),
    "BokehImageHeight": Parameter(1.0, "pixels", "the same; all with BOKEH_VIEWPORT 1"),
    "BokehJitter": Parameter(0.0, "amount of noise on the samples' places, 0 .. 1", "Adaptive, exact, layered"),
    "BokehFrame": Parameter(0.0, "number of the frame ([jitter](#jitter))", "the same"),
    "BokehSides": Parameter(
        6.0, "4, 6, 8 or 10; 0 is 6", "ExactEdge, Downsample, HoleFill, LayerEdge, LayerSecondOne, Composite"
    ),
    "BokehDepthKind": Parameter(
        0.0,
        "what the depth buffer holds: 0 metres, 1 window, 2 reversed, 3 reversed infinite, 4 clip, 5 orthographic, "
        "6 orthographic reversed, 7 fraction of BokehFar, 8 logarithmic",
        "SignedCoCMap, LinearDepth",
    ),
    "BokehNear": Parameter(0.1, "m", "the same"),
    "BokehFar": Parameter(1000.0, "m", "the same"),
    "BokehViewportX": Parameter(0.0, "pixels: first column of the image in its textures", "all, with BOKEH_VIEWPORT 1"),
    "BokehViewportY": Parameter(0.0, "pixels: first row", "the same"),
    "BokehTextureWidth": Parameter(1.0, "pixels", "the same"),
    "BokehTextureHeight": Parameter(1.0, "pixels", "the same"),
    "BokehPassIndex": Parameter(0.0, "0, 1 ..: number of the pass ([jitter](#jitter))", "Adaptive"),
    "BokehAxis": Parameter(0.0, "0: along rows, 1: along columns", "TileDilate"),
    "BokehLayer": Parameter(
        0.0,
        "0: the near layer, 1: the far one",
        "passes of one layer",
    ),
    "BokehCatsEye": Parameter(0.0, "BOKEH_LENS_SHAPE 1: share cut off in corners, 0 .. 0.9", "exact, HoleFill and on"),
    "BokehRoundness": Parameter(1.0, "of octagons: 0 a square, 1 regular", "the same"),
    "BokehLateral": Parameter(0.0, "how much larger red is than green, and blue smaller, -0.1 .. 0.1", "LateralColor"),
    "BokehFrontRange": Parameter(0.0, "BOKEH_FOCUS_CONTROLS 1: m that stay sharp in front of the focus", "CoCMap"),
    "BokehBackRange": Parameter(0.0, "the same behind it", "the same"),
    "BokehNearScale": Parameter(1.0, "factor of the CoC in front of the focus, 0: none", "the same"),
    "BokehFarScale": Parameter(1.0, "the same behind it", "the same"),
    "BokehNearMaxCoC": Parameter(1.0, "limit of the CoC in front, fraction of the image height", "the same"),
    "BokehFarMaxCoC": Parameter(1.0, "the same behind it", "the same"),
    "BokehDepthX": Parameter(0.0, "where the image lies in the depth buffer, a share of its width", "SignedCoCMap"),
    "BokehDepthY": Parameter(0.0, "the same, of its height", "the same"),
    "BokehDepthWidth": Parameter(1.0, "how wide it is there, a share of its width", "the same"),
    "BokehDepthHeight": Parameter(1.0, "the same, of its height", "the same"),
    "BokehStableBlend": Parameter(0.05, "share of this frame, 0 .. 1; 1 starts anew: after a cut", "StableMap"),
}
PARAMETERS = {name: parameter.default for name, parameter in BLOCK.items()}

# A constant buffer is a whole number of four floats
BLOCK_FLOATS = -(-len(BLOCK) // 4) * 4
