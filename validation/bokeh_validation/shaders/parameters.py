"""The parameters of bokeh_passes.*: their order, which is the layout of the block, defaults, units and readers."""

from typing import NamedTuple


class Parameter(NamedTuple):
    """A row of the table in docs/reference/parameters.md, which says what its short words stand for.

    default  where a pass does not say otherwise
    unit     m, pixels, radians; height: of the image; CoC: its diameter; share: of a buffer's size
    meaning  and range
    readers  entries that read it
    """

    default: float
    unit: str
    meaning: str
    readers: str


# Parameter i is register c(i) of shader model 3 and byte offset 4 i of the block.
BLOCK = {
    "BokehApertureDiameter": Parameter(0.05, "m", "A of Listing 1: f / f-stop ([lens.md](../lens.md))", "map"),
    "BokehFocalLength": Parameter(0.05, "m", "f", "map"),
    "BokehFocusDistance": Parameter(5.0, "m", "S1, more than f", "map, Debug"),
    "BokehSensorHeight": Parameter(0.024, "m", "35 mm film", "map"),
    "BokehMaxCoC": Parameter(0.1, "height", "limit of the CoC, 0 .. 1", "map, ConstantCoC, Debug, layered"),
    "BokehConstantCoC": Parameter(0.0, "height", "the CoC everywhere", "ConstantCoC"),
    "BokehAspectRatio": Parameter(1.0, "", "width / height of the image", "paper, exact"),
    "BokehAngle": Parameter(0.0, "radians", "the pass's line; exact, layered: the polygon", "filters"),
    "BokehAngleB": Parameter(0.0, "radians", "the grid's other side", "NaiveGrid"),
    "BokehBleedingBias": Parameter(0.02, "height", "CoC difference let pass; 2: no leakage test", "paper, exact"),
    "BokehBleedingMult": Parameter(30.0, "1 / height", "weight per CoC", "paper, exact"),
    "BokehBlurCoC": Parameter(1.0, "", "1: average the CoC with the colour", "paper"),
    "BokehUseMax": Parameter(0.0, "", "0: min, 1: max", "..Final"),
    "BokehDebugMode": Parameter(0.0, "", "0 colour, 1 depth, 2 CoC, 3 near and far", "Debug"),
    "BokehLineLength": Parameter(1.0, "CoC", "of the line", "Adaptive"),
    "BokehLineCenterX": Parameter(0.0, "CoC", "middle of the line, to the right", "Adaptive"),
    "BokehLineCenterY": Parameter(0.0, "CoC", "towards the last row", "Adaptive"),
    "BokehSqueeze": Parameter(1.0, "", "width of the bokeh / its height", "filters"),
    "BokehSpacing": Parameter(0.0, "pixels", "between samples; 0: as the preset", "Adaptive, exact"),
    "BokehImageWidth": Parameter(1.0, "pixels", "of the image", "viewport, filters"),
    "BokehImageHeight": Parameter(1.0, "pixels", "of the image", "viewport, filters"),
    "BokehJitter": Parameter(0.0, "", "amount of noise, 0 .. 1", "jitter"),
    "BokehFrame": Parameter(0.0, "", "number of the frame", "jitter"),
    "BokehSides": Parameter(6.0, "", "4, 6, 8 or 10; 0 counts as 6", "ExactEdge, layered"),
    "BokehDepthKind": Parameter(
        0.0,
        "",
        "what the depth buffer holds: 0 metres, 1 window, 2 reversed, 3 reversed infinite, 4 clip, 5 orthographic, "
        "6 orthographic reversed, 7 fraction of Far, 8 logarithmic",
        "SignedCoCMap, LinearDepth",
    ),
    "BokehNear": Parameter(0.1, "m", "near plane", "SignedCoCMap, LinearDepth"),
    "BokehFar": Parameter(1000.0, "m", "far plane", "SignedCoCMap, LinearDepth"),
    "BokehViewportX": Parameter(0.0, "pixels", "first column of the image", "viewport"),
    "BokehViewportY": Parameter(0.0, "pixels", "first row", "viewport"),
    "BokehTextureWidth": Parameter(1.0, "pixels", "of the textures", "viewport"),
    "BokehTextureHeight": Parameter(1.0, "pixels", "of the textures", "viewport"),
    "BokehPassIndex": Parameter(0.0, "", "number of the line pass, 0 ..", "Adaptive"),
    "BokehAxis": Parameter(0.0, "", "0: along rows, 1: columns", "TileDilate"),
    "BokehLayer": Parameter(0.0, "", "0: near, 1: far", "one layer"),
    "BokehCatsEye": Parameter(0.0, "", "share cut off in the corners, 0 .. 0.9", "lens shape"),
    "BokehRoundness": Parameter(1.0, "", "octagon: 0 square, 1 regular", "lens shape"),
    "BokehLateral": Parameter(0.0, "", "how much larger red is, -0.1 .. 0.1", "LateralColor"),
    "BokehFrontRange": Parameter(0.0, "m", "sharp range before the focus", "focus"),
    "BokehBackRange": Parameter(0.0, "m", "behind it", "focus"),
    "BokehNearScale": Parameter(1.0, "", "factor of the CoC before the focus", "focus"),
    "BokehFarScale": Parameter(1.0, "", "behind it", "focus"),
    "BokehNearMaxCoC": Parameter(1.0, "height", "limit of the CoC before the focus", "focus"),
    "BokehFarMaxCoC": Parameter(1.0, "height", "behind it", "focus"),
    "BokehDepthX": Parameter(0.0, "share", "left edge of the image in the depth buffer", "focus"),
    "BokehDepthY": Parameter(0.0, "share", "first row", "focus"),
    "BokehDepthWidth": Parameter(1.0, "share", "width", "focus"),
    "BokehDepthHeight": Parameter(1.0, "share", "height", "focus"),
    "BokehStableBlend": Parameter(0.05, "", "share of this frame; 1 starts anew", "StableMap"),
}
PARAMETERS = {name: parameter.default for name, parameter in BLOCK.items()}

# A constant buffer is a whole number of four floats
BLOCK_FLOATS = -(-len(BLOCK) // 4) * 4
