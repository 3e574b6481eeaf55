"""What the passes of the layered method have in common, in float64 and ball arithmetic (balls.py).

Names are the shaders'.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, cos, floor, pi, sin

import numpy as np

from bokeh_validation.reference import balls, cuts, gather
from bokeh_validation.reference.balls import Ball, Texture
from bokeh_validation.reference.images import Image
from bokeh_validation.reference.precision import FLOAT_STEP, Precision


@dataclass(frozen=True)
class Constants:
    """`BokehLayers`, and what the library's constants say.

    height    of the image, pixels
    largest   possible CoC, pixels
    noise     (value, error, wraps) of segments.noise for the target, times the amount; None: no jitter
    lengths   of the polygon's edges in each pixel of the target, from cuts.lengths; None: it is regular
    """

    width: int
    height: int
    sides: int
    rotation: float
    squeeze: float
    largest: float
    jitter: np.ndarray | None
    open_jitter: np.ndarray | None
    rings: int
    cells: int
    cubic: bool
    lengths: np.ndarray | None = None


class Run:
    """One pass over some rows of its target, `size` texels in all."""

    def __init__(
        self, textures: Sequence[Image], size: tuple[int, int], layers: Constants, precision: Precision | None
    ):
        self.textures = [Texture(image, precision) for image in textures]
        self.size, self.layers, self.precision = size, layers, precision

    def banded(self, function: Callable[[np.ndarray, np.ndarray, slice], Sequence[Ball]]) -> list[Image]:
        """`function(x, y, rows)` for all rows, in bands that stay in the cache; x, y texel centres (rows, W)."""
        width, height = self.size
        step = max(1, gather.BAND_ROWS * 512 // max(width, 1))

        def band(start: int) -> Sequence[Ball]:
            rows = slice(start, min(start + step, height))
            y, x = np.mgrid[rows, 0:width] + 0.5
            return function(x, y, rows)

        with ThreadPoolExecutor(gather.THREADS) as pool:
            parts = list(pool.map(band, range(0, height, step)))
        return [_image([part[i] for part in parts]) for i in range(len(parts[0]))]

    def exact(self, value) -> Ball:
        """Numbers that every device has alike."""
        value = np.asarray(value, np.float64)
        return Ball(value, np.zeros_like(value) if self.precision else None)

    def fetch(self, index: int, x, y) -> Ball:
        """A filtered fetch of a texture at places in its texels."""
        place = [value if isinstance(value, Ball) else self.exact(value) for value in (x, y)]
        return self.textures[index].fetch(*place)

    def moved(self, x, y, sample: "Sample", scale: Ball, rows: slice) -> tuple[Ball, Ball]:
        """A place on the outline, times a scale.

        The shader turns one corner into the next, so each edge adds the error of sin and cos once more, and three
        roundings. Of a cut polygon the corners are sums of edges, off by cuts.TURNS each, and twice as far away.
        """
        once = self.precision.line if self.precision else 0.0
        if self.layers.lengths is not None:
            once *= 2.0 * cuts.TURNS

        def along(offset) -> Ball:
            ball = self.exact(part(offset, rows) + np.zeros_like(x))
            if ball.radius is None:
                return ball
            turned = (sample.edge + 2) * (once + 3 * FLOAT_STEP)
            return Ball(ball.value, ball.radius + turned * max(1.0, self.layers.squeeze))

        return self.exact(x) + along(sample.x) * scale, self.exact(y) + along(sample.y) * scale


def part(field: np.ndarray | float, rows: slice) -> np.ndarray | float:
    """Some rows of a field (H, W), or a number."""
    return field[rows] if np.ndim(field) else field


def _image(parts: Sequence[Ball]) -> Image:
    """Bands to an image; undecided nowhere, since open comparisons are in the radius."""
    value = np.concatenate([part.value for part in parts])
    if parts[0].radius is None:
        return Image(value)
    radius = np.concatenate([np.broadcast_to(part.radius, part.value.shape) for part in parts])
    return Image(value, radius, np.zeros(value.shape[:2], bool))


def brightest(pixel: Ball) -> Ball:
    """`BokehBrightest`."""
    return balls.maximum(balls.maximum(pixel[..., 0], pixel[..., 1]), pixel[..., 2])


def with_one(pixel: Ball) -> Ball:
    """rgb, 1."""
    one = np.ones(pixel.value.shape[:-1])
    radius = None if pixel.radius is None else np.zeros_like(one)
    return balls.stack(pixel[..., 0], pixel[..., 1], pixel[..., 2], Ball(one, radius))


def slope_of(largest: Ball, none: float, whole: float) -> Ball:
    """`BokehLayerSlope`."""
    gate = balls.clamp((largest - none) / (whole - none), 0.001, 1.0)
    return 5.0 / balls.maximum(largest / gate, 2.0)


def near_slope_of(largest: Ball) -> Ball:
    """`BokehNearSlope`."""
    return slope_of(largest, 6.0, 12.0)


def far_slope_of(largest: Ball) -> Ball:
    """`BokehFarSlope`."""
    return slope_of(largest, 10.0, 16.0)


def share(coc: Ball, slope: Ball) -> Ball:
    """`BokehLayerShare`."""
    return balls.clamp(coc * slope - 2.0, 0.0, 1.0)


def reaching(coc: Ball, tiles: int) -> Ball:
    """`BokehReaching`."""
    return coc * balls.clamp(coc / 16.0 + (1.0 - max(tiles - 2.0, 0.0)), 0.0, 1.0)


def reach_tiles(layers: Constants) -> int:
    """`BokehReachTiles`."""
    return min(ceil(layers.largest / 16.0) + 2, 127)


def blur_weight(brightness: Ball) -> Ball:
    """`BokehBlurWeight`."""
    return balls.minimum(0.01 + brightness, 10000.0)


def spread_radius(s: Ball) -> Ball:
    """`BokehSpreadRadius`."""
    return balls.maximum(0.5 * balls.absolute(s) - 0.5, 0.0)


@dataclass(frozen=True)
class Sample:
    """A sample on the outline of a polygon with corners at a distance of 1; (H, W) where pixels differ.

    edge            it is on, 0 ..
    x, y            place
    next_x, next_y  from it to the next one on the edge
    share           area of the triangle from the middle to the edge, in units of their mean
    """

    edge: int
    x: float | np.ndarray
    y: float | np.ndarray
    next_x: float | np.ndarray
    next_y: float | np.ndarray
    share: float | np.ndarray = 1.0


def outline(ring: int, layers: Constants) -> list[Sample]:
    """The samples of a ring, `BokehOnEdge` on each edge."""
    sides = layers.sides
    points = _corners(layers)
    areas = [a[0] * b[1] - a[1] * b[0] for a, b in pairwise(points)]
    shares = [area / (sum(areas) / sides) for area in areas] if layers.lengths is not None else [1.0] * sides
    on_edge = max(floor(6.0 * ring / sides + 0.5), 1)
    found = []
    for edge, (corner, following) in enumerate(pairwise(points)):
        along = (following - corner) / on_edge
        for i in range(on_edge):
            (x, next_x), (y, next_y) = zip(corner + along * i, along, strict=True)
            found.append(Sample(edge, x * layers.squeeze, y, next_x * layers.squeeze, next_y, shares[edge]))
    return found


def _corners(layers: Constants) -> list[np.ndarray]:
    """The corners before edge 0 and after each edge, not squeezed, (2,) or (2, H, W)."""
    sides, count = layers.sides, layers.sides // 2
    if layers.lengths is None:
        angles = [layers.rotation + (2 * j - 1) * pi / sides for j in range(sides + 1)]
        return [np.array([cos(angle), sin(angle)]) for angle in angles]
    along = [layers.rotation + 2 * pi * i / sides for i in range(1, count + 1)]
    edges = [
        np.multiply.outer([-sin(angle), cos(angle)], long) for angle, long in zip(along, layers.lengths, strict=True)
    ]
    corners = [edges[-1] - sum(edges[:-1])]
    for j in range(sides):
        # edge 0 is opposite to the last one
        edge = edges[j % count - 1] * (1.0 if 0 < j <= count else -1.0)
        corners.append(corners[-1] + 2.0 * edge)
    return corners
