"""Mistakes in the ready-made passes, alike in all three languages: the parity check compares their bodies too."""

from functools import partial

from bokeh_validation.mutants.killers import AXIAL, CUT, JITTER, LAYERED_TARGET, ROUND
from bokeh_validation.mutants.mutant import Mutant
from bokeh_validation.mutants.mutant import row as any_row

row = partial(any_row, "passes")
# fmt: off
IN_PASSES: tuple[Mutant, ...] = (
    row("begin-no-viewport", "dropped sample", "Begin", "BokehUseViewport();", ""),
    row("begin-index", "dropped sample", "Begin", "BokehFrame, passIndex", "BokehFrame, 0.0"),
    row("begin-frame", "dropped sample", "Begin", "BokehFrame, passIndex", "0.0, passIndex"),
    row("begin-size", "axis", "Begin", "BokehImageWidth, BokehImageHeight", "BokehImageHeight, BokehImageWidth"),
    row("begin-aspect", "aspect", "Begin", "= BokehAspectRatio", "= 1.0"),
    row("begin-height", "axis", "Begin", "settings.imageHeight = BokehImageHeight",
        "settings.imageHeight = BokehImageWidth"),
    row("begin-spacing", "axis", "Begin", "= BokehSpacing", "= BokehJitter"),
    row("begin-jitter", "dropped sample", "Begin", "BokehJitter * noise", "noise"),
    row("begin-noise", "dropped sample", "Begin", "BokehJitter * noise", "BokehJitter"),
    row("begin-bias", "axis", "Begin", "= BokehBleedingBias", "= BokehBleedingMult"),
    row("begin-mult", "axis", "Begin", "= BokehBleedingMult", "= BokehBleedingBias"),
    row("viewport-place", "axis", "UseViewport", "BokehViewportX, BokehViewportY", "BokehViewportY, BokehViewportX"),
    row("viewport-textures", "axis", "UseViewport", "BokehTextureWidth, BokehTextureHeight",
        "BokehTextureHeight, BokehTextureWidth"),
    row("first-index", "constant", "First", "BokehBegin(uv, 0.0)", "BokehBegin(uv, 1.0)"),
    row("second-index", "constant", "Second", "BokehBegin(uv, 1.0)", "BokehBegin(uv, 0.0)"),
    row("edge-index", "constant", "ExactEdge", ", 0.0)", ", 1.0)", JITTER),
    row("line-index", "constant", "AdaptiveLine", "BokehPassIndex", "0.0"),
    row("aperture-squeeze", "aspect", "Aperture", "BokehSqueeze", "1.0"),
    row("aperture-angle", "angle", "Aperture", "BokehAngle", "BokehAngleB"),
    row("aperture-image", "axis", "Aperture", "BokehImageWidth, BokehImageHeight", "BokehImageHeight, BokehImageWidth",
        *CUT),
    row("aperture-round", "dropped sample", "Aperture", "polygon.roundness = BokehRoundness;", "", *ROUND),
    row("aperture-fifth", "dropped sample", "Aperture", "polygon.fifth = cut.fifth;", "", *CUT),
    row("aperture-axial", "axis", "Aperture", "BokehAxialRed, ", "BokehAxialBlue, ", *AXIAL),
    row("lateral-no-viewport", "dropped sample", "LateralColor", "BokehUseViewport();", ""),
    row("line-center", "axis", "AdaptiveLine", "BokehLineCenterX, BokehLineCenterY",
        "BokehLineCenterY, BokehLineCenterX"),
    row("line-squeeze", "aspect", "AdaptiveLine", "BokehSqueeze", "1.0"),
    row("signed-entry", "pass", "SignedCoCMap", "BokehSignedCoCMap(", "BokehCoCMap("),
    row("decagon-last-target", "axis", "DecagonFirst", "targets.T5", "targets.T4"),
    row("octagon-sides", "off-by-one", "OctagonFirst", ", 8)", ", 10)"),
    row("linear-kind", "off-by-one", "LinearDepth", "BokehDepthKind + 0.5", "BokehDepthKind - 0.5"),
    # of the layers
    row("layers-pass-noise", "pass", "BeginLayers", "ceil(imageSize / scale)", "imageSize"),
    row("layers-pass-first-layer", "pass", "LayerPolygon", "BokehLayer > 0.5", "BokehLayer < 0.5"),
    row("layers-pass-second-layer", "pass", "HexagonLayerSecond", "BokehLayer > 0.5", "BokehLayer < 0.5"),
    row("layers-pass-reach", "pass", "LayerReach", "vec2(1.0 - BokehAxis, BokehAxis)",
        "vec2(BokehAxis, 1.0 - BokehAxis)"),
    row("layers-pass-sides", "pass", "DecagonLayerSecond", "10, 2.0", "8, 2.0"),
    row("layers-pass-pick", "pass", "LayerHolesOne", "BokehEdge + 0.5", "BokehEdge - 0.5", LAYERED_TARGET),
    row("layers-pass-edge", "pass", "LayerEdge", "int(BokehEdge + 0.5)", "int(BokehEdge - 0.5)"),
)
