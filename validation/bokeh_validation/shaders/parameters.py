"""List the parameters of bokeh_passes.* in the order of the parameter block, with default, unit and meaning."""

from typing import NamedTuple


class Parameter(NamedTuple):
    """Hold a row of the table in docs/reference/parameters.md, which explains the units.

    default  the value unless a pass sets another
    unit     m, pixels, radians; height: of the image; CoC: its diameter; depth: a fraction of the depth buffer's size
    meaning  and range, and the constant that it requires
    """

    default: float
    unit: str
    meaning: str


# Parameter i is register c(i) of shader model 3 and byte offset 4 i of the block.
BLOCK = {
    # f/2.8 with a bokeh scale of 10, as in every package
    "BokehApertureDiameter": Parameter(
        0.05 / 2.8 * 10.0, "m", "diameter of the aperture: bokeh scale * focal length / f-stop ([lens.md](../lens.md))"
    ),
    "BokehFocalLength": Parameter(0.05, "m", "focal length of the lens"),
    "BokehFocusDistance": Parameter(
        5.0, "m", "distance along the view axis at which objects are sharp; more than the focal length"
    ),
    "BokehSensorHeight": Parameter(0.024, "m", "height of the sensor; 0.024 is 35 mm film"),
    "BokehMaxCoC": Parameter(0.1, "height", "largest CoC that is drawn, 0 to 1; a larger CoC is reduced to it"),
    "BokehConstantCoC": Parameter(0.0, "height", "pass ConstantCoC: the CoC of all pixels"),
    "BokehAspectRatio": Parameter(1.0, "", "width of the image / its height"),
    "BokehAngle": Parameter(
        0.0, "radians", "[rotation](#rotation) of the polygon; in the line passes of paper: direction of the line"
    ),
    "BokehAngleB": Parameter(0.0, "radians", "pass NaiveGrid: direction of the second side of the grid"),
    "BokehBleedingBias": Parameter(
        0.02,
        "height",
        "[leakage test](../glossary.md#blur) of paper and naive: a sample fails if its CoC is smaller than "
        "that of the pixel by more than this value; 2 turns the test off",
    ),
    "BokehBleedingMult": Parameter(
        30.0, "1/height", "weight of a sample that fails the leakage test: the CoC of the sample * this number"
    ),
    "BokehBlurCoC": Parameter(1.0, "", "paper, naive: 1 also blurs the CoC, 0 keeps the CoC of each pixel"),
    "BokehUseMax": Parameter(
        0.0, "", "passes whose names end in Final: how two lines are combined; 0 takes the minimum, 1 the maximum"
    ),
    "BokehDebugMode": Parameter(
        0.0, "", "pass Debug: what it shows; 0 colour, 1 depth, 2 the CoC, 3 the near and the far field"
    ),
    "BokehLineLength": Parameter(1.0, "CoC", "passes Adaptive and AdaptiveFinal: length of the line"),
    "BokehLineCenterX": Parameter(
        0.0, "CoC", "passes Adaptive and AdaptiveFinal: how far the middle of the line is to the right of the pixel"
    ),
    "BokehLineCenterY": Parameter(
        0.0,
        "CoC",
        "passes Adaptive and AdaptiveFinal: how far the middle of the line is from the pixel, towards the last row",
    ),
    "BokehSqueeze": Parameter(1.0, "", "width of the bokeh / its height"),
    "BokehSpacing": Parameter(0.0, "pixels", "distance between samples; 0 takes the preset's"),
    "BokehImageWidth": Parameter(1.0, "pixels", "width of the image"),
    "BokehImageHeight": Parameter(1.0, "pixels", "height of the image"),
    "BokehJitter": Parameter(0.0, "", "[amount of noise](#jitter), 0 to 1; needs `BOKEH_JITTER`"),
    "BokehFrame": Parameter(0.0, "", "number of the frame, for the noise; needs `BOKEH_JITTER`"),
    "BokehSides": Parameter(6.0, "", "number of sides, 4, 6, 8 or 10; 0 means 6"),
    "BokehDepthKind": Parameter(0.0, "", "[kind of depth](../inputs.md#depth) in the depth buffer, 0 to 9"),
    "BokehNear": Parameter(0.1, "m", "distance of the camera's near plane"),
    "BokehFar": Parameter(1000.0, "m", "distance of the camera's far plane"),
    "BokehViewportX": Parameter(0.0, "pixels", "first column of the image in its textures; needs `BOKEH_VIEWPORT`"),
    "BokehViewportY": Parameter(0.0, "pixels", "first row of the image in its textures; needs `BOKEH_VIEWPORT`"),
    "BokehTextureWidth": Parameter(1.0, "pixels", "width of the full-size textures; needs `BOKEH_VIEWPORT`"),
    "BokehTextureHeight": Parameter(1.0, "pixels", "height of the full-size textures; needs `BOKEH_VIEWPORT`"),
    "BokehPassIndex": Parameter(
        0.0, "", "passes Adaptive and AdaptiveFinal: number of the line pass, for the noise; needs `BOKEH_JITTER`"
    ),
    "BokehCatsEye": Parameter(
        0.0, "", "fraction of the bokeh that is cut off in the corners, 0 to 0.9; needs `BOKEH_LENS_SHAPE`"
    ),
    "BokehRoundness": Parameter(
        1.0, "", "shape of an octagon: 0 a square, 1 a regular octagon; needs `BOKEH_LENS_SHAPE`"
    ),
    "BokehLateral": Parameter(
        0.0, "", "pass LateralColor: fraction by which red is larger and blue is smaller, -0.1 to 0.1"
    ),
    "BokehFrontRange": Parameter(
        0.0, "m", "how far in front of the focus distance objects stay sharp; needs `BOKEH_FOCUS_CONTROLS`"
    ),
    "BokehBackRange": Parameter(
        0.0, "m", "how far behind the focus distance objects stay sharp; needs `BOKEH_FOCUS_CONTROLS`"
    ),
    "BokehNearScale": Parameter(1.0, "", "factor of the CoC in front of the focus; needs `BOKEH_FOCUS_CONTROLS`"),
    "BokehFarScale": Parameter(1.0, "", "factor of the CoC behind the focus; needs `BOKEH_FOCUS_CONTROLS`"),
    "BokehNearMaxCoC": Parameter(1.0, "height", "largest CoC in front of the focus; needs `BOKEH_FOCUS_CONTROLS`"),
    "BokehFarMaxCoC": Parameter(1.0, "height", "largest CoC behind the focus; needs `BOKEH_FOCUS_CONTROLS`"),
    "BokehDepthX": Parameter(0.0, "depth", "left edge of the image in the depth texture; needs `BOKEH_FOCUS_CONTROLS`"),
    "BokehDepthY": Parameter(0.0, "depth", "first row of the image in the depth texture; needs `BOKEH_FOCUS_CONTROLS`"),
    "BokehDepthWidth": Parameter(1.0, "depth", "width of the image in the depth texture; needs `BOKEH_FOCUS_CONTROLS`"),
    "BokehDepthHeight": Parameter(
        1.0, "depth", "height of the image in the depth texture; needs `BOKEH_FOCUS_CONTROLS`"
    ),
    "BokehStableBlend": Parameter(
        0.0,
        "",
        "pass StableMap: 1 forgets earlier frames (set it in the first frame, after a cut, and when the viewport "
        "changes); 0 in all other frames",
    ),
}
PARAMETERS = {name: parameter.default for name, parameter in BLOCK.items()}

# The size of a constant buffer is a multiple of four floats
BLOCK_FLOATS = -(-len(BLOCK) // 4) * 4
