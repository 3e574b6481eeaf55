"""Probe layered: round near lights as renderers draw them, with an antialiased rim.

Colour is averaged over a pixel, and depth is taken in the pixel's middle. A rim pixel of which the light covers less
than half thus has some of the light's colour, but the depth of the plane. Such pixels must not show inside the blurred
light, either as dots or as the outline of a second polygon. Nor must a light of which a leaf leaves only a sliver
break into the samples of the blur, which shows as combs.
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from bokeh_validation.frame import geometry
from bokeh_validation.frame.aperture_shapes import regular_polygon
from bokeh_validation.probes.highlight import polygon_of
from bokeh_validation.probes.lights_apart import settings
from bokeh_validation.probes.model import Case, Check, Outputs, Probe, depth_of, flat
from bokeh_validation.probes.near_edges import STEP, metres

LIGHT, AMBIENT = 200.0, 0.125
SIZE = (128, 128)
# Off the middle of its pixel, so that the rim is different on each side
MIDDLE = (64.3, 64.1)
# CoC of the light in pixels -> its radius in pixels
RADII = {-24: 2.0, -40: 3.5, -60: 4.5, -66: 4.5, -80: 5.0}
LEAF = 20  # half of the side of the leaf, a dark square at the depth of the light, in pixels
# Ripple and outline are measured in the light's polygon shrunk to this: the light's own edge is soft
INSIDE = 0.75
RING = 2  # pixels
# Asked for. A second polygon that covers a part p of the inside, and is brighter by d, has a ripple of
# d * sqrt(p * (1 - p)), at most d / 2; an outline of the same size is thus at least twice as easy to see.
RIPPLE = OUTLINE = 0.05
# Each pixel is stored three times in a layer and once in the result, and every store may lose a STEP of its light.
# What was recorded is rounded to a hundredth.
LIGHT_OFF = 4 * STEP + 0.005


class Rim(NamedTuple):
    """Name a case.

    coc     of the light, in pixels; near CoC are negative
    plane   CoC of the plane behind it
    sliver  if a leaf covers the left half of the light, the width of the part right of it that is seen, in pixels
    """

    coc: int
    plane: int
    preset: str = "medium"
    sliver: int = 0

    @property
    def label(self) -> str:
        """Return the name for reports and tables."""
        plane = f"a plane of {self.plane}" if self.plane else "a plane in focus"
        sliver = f", {self.sliver} pixels seen beside a leaf" if self.sliver else ""
        return f"CoC {self.coc} on {plane}{sliver}, {self.preset.upper()}"

    def seen(self) -> np.ndarray:
        """Return which pixels show the light rather than the leaf, (H, W) bool."""
        x = np.arange(SIZE[0]) + 0.5 - MIDDLE[0]
        return np.broadcast_to((x > 0.0) & (x < self.sliver) | (self.sliver == 0), SIZE[::-1])

    def coverage(self) -> np.ndarray:
        """Return the fraction of each pixel that the light covers, (H, W)."""
        return geometry.coverage(2.0 * RADII[self.coc] * regular_polygon(48), SIZE, MIDDLE) * self.seen()

    def case(self) -> Case:
        """Return a blue light on a plane with a little red, green and blue."""
        color, depth = flat(SIZE), depth_of(SIZE, metres(self.plane, SIZE[1]))
        color[..., :3] = 0.01, 0.01, AMBIENT
        color[..., 2] += LIGHT * self.coverage()
        y, x = np.mgrid[: SIZE[1], : SIZE[0]] + 0.5 - np.reshape(MIDDLE[::-1], (2, 1, 1))
        leaf = ~self.seen() & (np.maximum(abs(x), abs(y)) < LEAF)
        depth[(np.hypot(x, y) < RADII[self.coc]) | leaf] = metres(self.coc, SIZE[1])
        return Case(self.label, settings("layered", preset=self.preset), color, depth)

    def measured(self, result: np.ndarray) -> tuple[float, float, float]:
        """Return ripple, outline and the fraction of the light kept in a result (H, W, >= 3).

        The outline is the largest difference in brightness between two rings of the polygon, RING pixels wide, over the
        mean. The brightness of a ring is its median, which ignores dots; the ripple does not.
        """
        blue = result[..., 2] - AMBIENT
        polygon = polygon_of("hexagon", 0.0, self.coc)
        y, x = np.mgrid[: SIZE[1], : SIZE[0]] + 0.5
        y, x = (axis - np.average(axis, weights=self.coverage()) for axis in (y, x))
        steps = np.arange(RING, INSIDE * abs(self.coc) / 2 + 0.001, RING) / (abs(self.coc) / 2)
        within = [np.zeros(blue.shape, bool), *(geometry.inside(step * polygon, x, y) for step in steps)]
        inside = blue[geometry.inside(INSIDE * polygon, x, y)]
        rings = [np.median(blue[outer & ~inner]) for inner, outer in pairwise(within)]
        outline = np.ptp(rings) / inside.mean()
        light = blue.sum() / (LIGHT * self.coverage().sum())
        return float(inside.std() / inside.mean()), float(outline), float(light)


# Ripple, outline and light kept, measured on llvmpipe; docs/results-data.md shows them too
RECORDED = {
    Rim(-24, 0): (0.04, 0.03, 1.00),
    Rim(-40, 0): (0.01, 0.02, 1.00),
    Rim(-60, 0): (0.01, 0.04, 1.00),
    Rim(-80, 0): (0.01, 0.02, 1.00),
    Rim(-24, 12): (0.04, 0.03, 1.00),
    Rim(-40, 12): (0.01, 0.02, 1.00),
    Rim(-60, 12): (0.01, 0.04, 1.00),
    Rim(-80, 12): (0.01, 0.02, 1.00),
    Rim(-24, 40): (0.04, 0.03, 1.00),
    Rim(-40, 40): (0.01, 0.02, 1.00),
    Rim(-60, 40): (0.01, 0.04, 1.00),
    Rim(-80, 40): (0.01, 0.02, 1.00),
    Rim(-24, 12, "high"): (0.04, 0.03, 1.00),
    Rim(-40, 12, "high"): (0.01, 0.02, 1.00),
    Rim(-60, 12, "high"): (0.01, 0.02, 1.00),
    Rim(-80, 12, "high"): (0.01, 0.02, 1.00),
    Rim(-60, 0, sliver=2): (0.03, 0.05, 1.00),
    Rim(-66, 0, sliver=2): (0.04, 0.06, 1.00),
}


def _judge(outputs: dict[str, Outputs]) -> list[Check]:
    checks = []
    for rim, (_, _, known_light) in RECORDED.items():
        ripple, outline, light = rim.measured(outputs[rim.label]["result"])
        checks += [
            Check(f"ripple, {rim.label}", ripple, 0.0, RIPPLE, "asked for"),
            # the rim of a sliver's polygon is softer, so that it reaches into the ring inside it
            Check(f"second outline, {rim.label}", outline, 0.0, np.inf if rim.sliver else OUTLINE, "asked for"),
            Check(f"light kept, {rim.label}", light, known_light - LIGHT_OFF, known_light + LIGHT_OFF, "recorded"),
        ]
    return checks


PROBES = (
    Probe(
        "near-light-rim",
        "A round near light with an antialiased rim",
        "A flat hexagon, without dots or a smaller polygon inside.",
        tuple(rim.case() for rim in RECORDED),
        _judge,
    ),
)
