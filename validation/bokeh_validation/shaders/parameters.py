"""List the parameters of bokeh_passes.* in the order of the parameter block, with default, unit and meaning."""

from typing import NamedTuple


class Parameter(NamedTuple):
    """Hold a row of the table in docs/reference/parameters.md, which explains the abbreviations.

    default  the value unless a pass sets another
    unit     m, pixels, radians; height: of the image; CoC: its diameter; depth: a fraction of the depth buffer's size
    meaning  and range; a letter in parentheses stands for the constant that it requires
    """

    default: float
    unit: str
    meaning: str


# Parameter i is register c(i) of shader model 3 and byte offset 4 i of the block.
BLOCK = {
    "BokehApertureDiameter": Parameter(0.05, "m", "A of Listing 1: f / f-stop ([lens.md](../lens.md))"),
    "BokehFocalLength": Parameter(0.05, "m", "f"),
    "BokehFocusDistance": Parameter(5.0, "m", "S1, more than f"),
    "BokehSensorHeight": Parameter(0.024, "m", "35 mm film"),
    "BokehMaxCoC": Parameter(0.1, "height", "limit of the CoC, 0 .. 1"),
    "BokehConstantCoC": Parameter(0.0, "height", "ConstantCoC: the CoC everywhere"),
    "BokehAspectRatio": Parameter(1.0, "", "width / height of the image"),
    "BokehAngle": Parameter(0.0, "radians", "of the polygon; paper: of the line"),
    "BokehAngleB": Parameter(0.0, "radians", "NaiveGrid: the other side"),
    "BokehBleedingBias": Parameter(
        0.02, "height", "CoC difference that passes the leakage test; 2 turns it off; no effect on a hexagon of exact"
    ),
    "BokehBleedingMult": Parameter(30.0, "1/height", "weight per CoC; exact: not the hexagon"),
    "BokehBlurCoC": Parameter(1.0, "", "paper: 1 averages the CoC with the colour"),
    "BokehUseMax": Parameter(0.0, "", "paper: 0 min, 1 max"),
    "BokehDebugMode": Parameter(0.0, "", "0 colour, 1 depth, 2 CoC, 3 near and far"),
    "BokehLineLength": Parameter(1.0, "CoC", "Adaptive: of the line"),
    "BokehLineCenterX": Parameter(0.0, "CoC", "its middle, to the right"),
    "BokehLineCenterY": Parameter(0.0, "CoC", "towards the last row"),
    "BokehSqueeze": Parameter(1.0, "", "width of the bokeh / its height"),
    "BokehSpacing": Parameter(0.0, "pixels", "between samples; 0: as the preset"),
    "BokehImageWidth": Parameter(1.0, "pixels", "of the image"),
    "BokehImageHeight": Parameter(1.0, "pixels", ""),
    "BokehJitter": Parameter(0.0, "", "[amount of noise](#jitter), 0 .. 1 (J)"),
    "BokehFrame": Parameter(0.0, "", "number of the frame (J)"),
    "BokehSides": Parameter(6.0, "", "4, 6, 8 or 10; 0 counts as 6"),
    "BokehDepthKind": Parameter(
        0.0,
        "",
        "what the depth buffer holds: 0 metres, 1 window, 2 reversed, 3 reversed infinite, 4 clip, 5 orthographic, "
        "6 orthographic reversed, 7 fraction of Far, 8 logarithmic, "
        "9 metres times opacity, and opacity",
    ),
    "BokehNear": Parameter(0.1, "m", "near plane"),
    "BokehFar": Parameter(1000.0, "m", "far plane"),
    "BokehViewportX": Parameter(0.0, "pixels", "first column of the image (V)"),
    "BokehViewportY": Parameter(0.0, "pixels", "first row (V)"),
    "BokehTextureWidth": Parameter(1.0, "pixels", "of the textures (V)"),
    "BokehTextureHeight": Parameter(1.0, "pixels", "(V)"),
    "BokehPassIndex": Parameter(0.0, "", "Adaptive: number of the line pass (J)"),
    "BokehAxis": Parameter(0.0, "", "TileDilate: 0 along rows, 1 columns"),
    "BokehLayer": Parameter(0.0, "", "passes of one layer: 0 near, 1 far"),
    "BokehCatsEye": Parameter(0.0, "", "fraction cut off in the corners, 0 .. 0.9 (L)"),
    "BokehRoundness": Parameter(1.0, "", "octagon: 0 square, 1 regular (L)"),
    "BokehLateral": Parameter(0.0, "", "LateralColor: how much larger red is, -0.1 .. 0.1"),
    "BokehFrontRange": Parameter(0.0, "m", "sharp range in front of the focus distance (F)"),
    "BokehBackRange": Parameter(0.0, "m", "sharp range behind the focus distance (F)"),
    "BokehNearScale": Parameter(1.0, "", "factor of the CoC in front of the focus distance (F)"),
    "BokehFarScale": Parameter(1.0, "", "factor of the CoC behind the focus distance (F)"),
    "BokehNearMaxCoC": Parameter(1.0, "height", "limit of the CoC in front of the focus distance (F)"),
    "BokehFarMaxCoC": Parameter(1.0, "height", "limit of the CoC behind the focus distance (F)"),
    "BokehDepthX": Parameter(0.0, "depth", "left edge of the image in the depth buffer (F)"),
    "BokehDepthY": Parameter(0.0, "depth", "first row of the image in the depth buffer (F)"),
    "BokehDepthWidth": Parameter(1.0, "depth", "width of the image in the depth buffer (F)"),
    "BokehDepthHeight": Parameter(1.0, "depth", "height of the image in the depth buffer (F)"),
    "BokehStableBlend": Parameter(0.0, "", "StableMap: weight of this frame; 1 starts anew"),
}
PARAMETERS = {name: parameter.default for name, parameter in BLOCK.items()}

# The size of a constant buffer is a multiple of four floats
BLOCK_FLOATS = -(-len(BLOCK) // 4) * 4
