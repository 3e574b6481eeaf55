"""Probe the character of a lens on one light: cat's eye, and lateral colour.

Axial colour is drawn as frames with different CoC (docs/methods/character.md), which other probes cover.
"""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from bokeh_validation.frame import geometry
from bokeh_validation.probes import exact
from bokeh_validation.probes.highlight import AMBIENT, HALF_LIGHT, PEAK, ROUNDED, Bokeh, polygon_of
from bokeh_validation.probes.model import Case, Check, Outputs, Probe, overlap, pixel_center

SIZE, PLACE = (280, 208), (222, 46)  # size of the image, and pixel of the light, towards a corner
COC, ROTATION = 40, 7.0
APERTURES = ("hexagon", "octagon")


def plain_bokeh(aperture: str) -> Bokeh:
    """Return the bokeh of the light through a lens without character."""
    return Bokeh(polygon_of(aperture, ROTATION, COC), SIZE, pixel_center(*PLACE))


def lit(label: str, aperture: str = "hexagon", **changes) -> Case:
    """Return a case of one bright pixel in the exact method at one sample per pixel; `changes` are to its settings."""
    return plain_bokeh(aperture).case(label, replace(exact.settings(aperture, ROTATION, SIZE, COC), **changes))


# ------------------------------------------------------------------------------------------------------------ cat's eye

CATS_EYE = 0.7
# Largest error of the outline, pixels. The first pass uses the polygons of other pixels, up to half a CoC away and
# half of that on average. Per half diagonal of distance, a side moves by half of CATS_EYE times the width.
DRIFT = 0.5 * CATS_EYE * COC * (0.25 * COC) / (0.5 * np.hypot(*SIZE))


def rim(x: float, y: float, polygon: np.ndarray) -> np.ndarray:
    """Return the offset of each rim from the middle of the aperture at a position in the image, pixels, (2,)."""
    from_middle = (2.0 * np.array([x, y]) - SIZE) / np.hypot(*SIZE)
    apothem = np.linalg.norm(polygon + np.roll(polygon, 1, axis=0), axis=1).min() / 2
    return CATS_EYE * apothem * from_middle


def cut(aperture: str, x: float, y: float) -> Bokeh:
    """Return the bokeh as the lens barrel cuts it at a position: the intersection of the polygon shifted to both
    sides.
    """
    polygon = polygon_of(aperture, ROTATION, COC)
    moved = rim(x, y, polygon)
    return Bokeh(geometry.clip_convex(polygon + moved, polygon - moved), SIZE, (x, y))


@lru_cache
def cut_light(aperture: str) -> np.ndarray:
    """Return the fraction of the light that each pixel receives, (H, W): from its own polygon, as cut at that pixel.

    This follows the definition, without edges and lengths: a point is inside the cut polygon if it is inside the
    polygon shifted to either side.
    """
    polygon, received = polygon_of(aperture, ROTATION, COC), np.zeros(SIZE[::-1])
    light, reach, steps = np.array(pixel_center(*PLACE)), COC // 2 + 1, (np.arange(8) + 0.5) / 8
    for row in range(PLACE[1] - reach, PLACE[1] + reach + 1):
        for column in range(PLACE[0] - reach, PLACE[0] + reach + 1):
            moved = rim(column + 0.5, row + 0.5, polygon)
            x, y = np.meshgrid(light[0] - column - steps, light[1] - row - steps)
            within = geometry.inside(polygon + moved, x, y) & geometry.inside(polygon - moved, x, y)
            if within.any():
                received[row, column] = within.mean() / cut(aperture, column + 0.5, row + 0.5).area
    return received


def _judge_cut(outputs: dict[str, Outputs]) -> list[Check]:
    """Check light and shape of the bokeh, whose outline is known to half a pixel plus DRIFT."""
    checks, outline_error = [], 0.5 + DRIFT
    why = (
        f"outline known to {outline_error:.2f} pixels: half a pixel, and the first pass has the polygons of other "
        "pixels"
    )
    for aperture, textures in outputs.items():
        expected, plain = cut_light(aperture), plain_bokeh(aperture)
        shape, value = cut(aperture, *plain.middle), (textures["result"][..., 1] - AMBIENT) / PEAK
        edge, overlap_bound = shape.edge(outline_error) / shape.area / 4, shape.min_overlap(outline_error)
        uncut = overlap(expected, plain.coverage / plain.area)
        light_kept = value.sum() / expected.sum()
        checks += [
            Check(f"light, in units of the lens's, {aperture}", light_kept, 1 - edge, 1 + edge, why),
            Check(f"overlap with the cut polygon, {aperture}", overlap(value, expected), overlap_bound, 1.0, why),
            Check(f"the whole polygon overlaps less, {aperture}", uncut, 0.0, overlap_bound, "it shows"),
        ]
    return checks


CUT = Probe(
    "cats-eye-exact",
    "A light towards a corner of the image is cut by the lens barrel",
    "The narrow side points to the middle of the image; edges are straight, and the brightness is even.",
    tuple(lit(aperture, aperture, cats_eye=CATS_EYE) for aperture in APERTURES),
    _judge_cut,
    brief=False,
)

# --------------------------------------------------------------------------------------------------------------- colour

LATERAL = {"red larger": 0.05, "blue larger": -0.05}
CHANNELS = ("red", "green", "blue")


def _color_checks(label: str, shown: np.ndarray, bokeh: Bokeh, off: float) -> list[Check]:
    """Check light, position and outline in one channel.

    shown  (H, W): fraction of the light at each pixel
    bokeh  what it must be
    off    how far the outline may be off, pixels
    """
    y, x = np.mgrid[: bokeh.size[1], : bokeh.size[0]] + 0.5
    # the surroundings may be stored a step off; summed over so many pixels far from the light, that would shift its
    # centroid
    light = shown - np.median(shown)
    moved = np.linalg.norm(np.array([(light * x).sum(), (light * y).sum()]) / light.sum() - bokeh.middle)
    slip = HALF_LIGHT * np.linalg.norm(bokeh.corners, axis=1).max()
    overlap_with_polygon, outline = overlap(shown * bokeh.area, bokeh.coverage), f"known to {off} pixels"
    return [
        Check(f"light, {label}", shown.sum(), 1 - HALF_LIGHT, 1 + HALF_LIGHT, ROUNDED),
        Check(f"middle off by, {label} (pixels)", moved, 0.0, slip, "HALF_LIGHT of the light, at a corner"),
        Check(f"overlap with its polygon, {label}", overlap_with_polygon, bokeh.min_overlap(off), 1.0, outline),
    ]


def _judge_lateral(outputs: dict[str, Outputs]) -> list[Check]:
    """Check each channel: an image scaled by s has s^2 times the light. The outline may be off by half a pixel, and by
    another half for resampling.
    """
    checks, plain, image_middle = [], plain_bokeh("hexagon"), np.array(SIZE) / 2
    for label, amount in LATERAL.items():
        for channel, scale in enumerate((1.0 + amount, 1.0, 1.0 - amount)):
            name = f"{label}, {CHANNELS[channel]}"
            shown = (outputs[label]["result"][..., channel] - AMBIENT) / (PEAK * scale**2)
            middle = image_middle + (np.array(plain.middle) - image_middle) * scale
            bokeh = Bokeh(polygon_of("hexagon", ROTATION, COC * scale), SIZE, tuple(middle))
            checks += _color_checks(name, shown, bokeh, 0.5 + 0.5 * (scale != 1.0))
            if scale != 1.0:
                unmoved, overlap_bound = overlap(shown * plain.area, plain.coverage), checks[-1].low
                checks.append(Check(f"green's place overlaps less, {name}", unmoved, 0.0, overlap_bound, "it shows"))
    return checks


LATERAL_COLOR = Probe(
    "lateral-color",
    "Red and blue of a picture at other scales",
    "A red rim on one side of the bokeh and a blue one on the other, both on the line to the image's middle.",
    tuple(lit(label, lateral=amount) for label, amount in LATERAL.items()),
    _judge_lateral,
    brief=False,
)
PROBES = (CUT, LATERAL_COLOR)
