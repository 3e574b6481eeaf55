"""Describe a bright light and the polygon that its bokeh must be."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bokeh_validation.frame import aperture_shapes, geometry, methods
from bokeh_validation.probes.model import Case, Check, depth_of, flat, overlap

# The surroundings are not black: a bilinear weight of 0 in float64 may be 0.00003 in float32, and a half float near
# zero would then be off by thousands of steps.
AMBIENT = 0.5
PEAK = 4096.0
# Allowed error of the light. Two stores in half floats lose up to one step of 2^-10 each on a device that truncates;
# near AMBIENT, where most of a widely spread highlight is, a step is up to 2^-11 / plateau of it. The bound is 0.01.
HALF_LIGHT = 0.01
ROUNDED = "bilinear samples share their light out completely; the rest is rounding of the stores"


def polygon_of(aperture: str, rotation: float, coc: float) -> np.ndarray:
    """Return the corners of a polygon of exact and layered, (N, 2) in pixels around the light.

    rotation  degrees
    coc       pixels; the sign is ignored
    """
    return abs(coc) * aperture_shapes.even_polygon(methods.EXACT[aperture], rotation)


def block(middle: tuple[int, int], side: int) -> tuple[slice, slice]:
    """Return the rows and columns of a square around a pixel (column, row); `side` is an odd number of pixels."""
    rows, columns = (slice(index - side // 2, index + side // 2 + 1) for index in middle[::-1])
    return rows, columns


def impulse_image(points: Iterable[tuple[int, int]], size: tuple[int, int]) -> np.ndarray:
    """Return an image (H, W, 4) of AMBIENT with a bright pixel at each (column, row)."""
    image = flat(size, AMBIENT)
    for column, row in points:
        image[row, column, :3] = PEAK + AMBIENT
    return image


@dataclass(frozen=True)
class Bokeh:
    """Describe what one bright pixel must become: a convex polygon with the same light.

    corners  pixels around the light, (N, 2)
    size     of the image, (width, height)
    middle   position of the light, pixels from the image's corner
    """

    corners: np.ndarray
    size: tuple[int, int]
    middle: tuple[float, float]

    @cached_property
    def area(self) -> float:
        """Return the polygon's area, square pixels."""
        return abs(geometry.signed_area(self.corners))

    @cached_property
    def coverage(self) -> np.ndarray:
        """Return the fraction of each pixel inside the polygon, (H, W)."""
        return geometry.coverage(self.corners, self.size, self.middle)

    def edge(self, off: float) -> float:
        """Return the area that changes if the outline is off by `off` pixels."""
        return off * geometry.perimeter(self.corners)

    def min_overlap(self, off: float) -> float:
        """Return the overlap with a shape whose outline is off by `off` pixels."""
        return (self.area - self.edge(off)) / (self.area + self.edge(off))

    def case(self, label: str, settings: methods.Settings, depth: float = 10.0) -> Case:
        """Return a case of the bright pixel on a plane; `depth` is in metres."""
        image = impulse_image([(int(self.middle[0]), int(self.middle[1]))], self.size)
        return Case(label, settings, image, depth_of(self.size, depth))

    def checks(self, label: str, light: np.ndarray, light_off: float, min_overlap: float) -> list[Check]:
        """Return checks of light and overlap; light (H, W) is the fraction of the light at each pixel."""
        overlap_with_polygon = overlap(light * self.area, self.coverage)
        return [
            Check(f"light kept, {label}", light.sum(), 1 - light_off, 1 + light_off, ROUNDED),
            Check(
                f"overlap with the polygon, {label}",
                overlap_with_polygon,
                min_overlap,
                1.0,
                "asked for at a sample a pixel",
            ),
        ]
