"""A bright light, and the polygon that its bokeh must be."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bokeh_validation.frame import aperture_shapes, geometry, methods
from bokeh_validation.probes.model import Case, Check, depth_of, flat, overlap

# Not black: where a highlight's bilinear weight is 0 in float64 and 0.00003 in float32, a half float near zero would
# count thousands of steps.
AMBIENT = 0.5
PEAK = 4096.0
# Two stores in half floats lose up to one step of 2^-10 each, where a device cuts off, and a step near AMBIENT, where
# most of a thinly spread highlight is, is up to 2^-11 / plateau of it. Asked for: 0.01.
HALF_LIGHT = 0.01
ROUNDED = "bilinear samples share their light out completely; the rest is rounding of the stores"


def polygon_of(aperture: str, rotation: float, coc: float) -> np.ndarray:
    """Corners of a polygon of the methods exact and layered, (N, 2) in pixels around the light."""
    return abs(coc) * aperture_shapes.even_polygon(methods.EXACT[aperture], rotation)


def block(middle: tuple[int, int], side: int) -> tuple[slice, slice]:
    """Rows and columns of a square of `side` pixels, an odd number, around a pixel (column, row)."""
    rows, columns = (slice(place - side // 2, place + side // 2 + 1) for place in middle[::-1])
    return rows, columns


def impulse_image(points: Iterable[tuple[int, int]], size: tuple[int, int]) -> np.ndarray:
    """Nearly black, with a bright pixel at each (column, row)."""
    image = flat(size, AMBIENT)
    for column, row in points:
        image[row, column, :3] = PEAK + AMBIENT
    return image


@dataclass(frozen=True)
class Bokeh:
    """What one bright pixel must become: a convex polygon of the same light.

    corners  pixels around the light, (N, 2)
    size     of the image, (width, height)
    middle   place of the light, pixels from the image's corner
    """

    corners: np.ndarray
    size: tuple[int, int]
    middle: tuple[float, float]

    @cached_property
    def area(self) -> float:
        """Of the polygon, square pixels."""
        return abs(geometry.signed_area(self.corners))

    @cached_property
    def coverage(self) -> np.ndarray:
        """Share of each pixel that is in the polygon, (H, W)."""
        return geometry.coverage(self.corners, self.size, self.middle)

    def edge(self, off: float) -> float:
        """Area that an outline which is off by so many pixels gains or loses."""
        return off * geometry.perimeter(self.corners)

    def least_overlap(self, off: float) -> float:
        """With a shape whose outline is off by so many pixels."""
        return (self.area - self.edge(off)) / (self.area + self.edge(off))

    def case(self, label: str, settings: methods.Settings, depth: float = 10.0) -> Case:
        """The bright pixel on a plane."""
        image = impulse_image([(int(self.middle[0]), int(self.middle[1]))], self.size)
        return Case(label, settings, image, depth_of(self.size, depth))

    def checks(self, label: str, share: np.ndarray, light_off: float, overlap_least: float) -> list[Check]:
        """Light and overlap; share (H, W): what each pixel has of the light."""
        seen = overlap(share * self.area, self.coverage)
        return [
            Check(f"light kept, {label}", share.sum(), 1 - light_off, 1 + light_off, ROUNDED),
            Check(f"overlap with the polygon, {label}", seen, overlap_least, 1.0, "asked for at a sample a pixel"),
        ]
