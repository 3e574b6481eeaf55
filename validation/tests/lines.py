"""Compute the lines along which a filter pass averages: sections [2], [5] and [8] of the libraries, in float64.

An exact polygon of n sides is tiled by the parallelograms of its edges i < k <= n / 2: one pass filters along one edge
of each, the second along the other. If the lens barrel cuts the polygon (cat's eye), its edges have different lengths
in each pixel. Lengths and positions are in units of the CoC, x right, y down.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np

from bokeh_validation.frame import aperture_shapes
from bokeh_validation.shaders.entries import ADAPTIVE, COLORS, EDGE, FIRST, GRID, LINE, SECOND
from bokeh_validation.shaders.passes import Pass

# minimum length of an edge, and maximum amount of the cat's eye
LEAST, MOST = 0.001, 0.9


@dataclass(frozen=True)
class Segment:
    """Hold a line by its middle and half of it, each (2,), or (2, H, W) if they differ by pixel."""

    middle: np.ndarray
    half: np.ndarray

    @property
    def half_length(self) -> float | np.ndarray:
        """Return half of its length."""
        return np.hypot(*self.half)


@dataclass(frozen=True)
class Line:
    """Hold a line of a pass.

    slot    of the texture that is averaged along it
    shares  its weight in each of the pass's targets, before normalisation
    edge    number of the polygon's edge, from 1; 0 for other lines
    """

    slot: str
    segment: Segment
    shares: tuple[float | np.ndarray, ...] = (1.0,)
    edge: int = 0


def lines(render_pass: Pass, size: tuple[int, int] | None = None) -> tuple[Line, ...]:
    """Return all lines of a filter pass; none for other passes, for samples from a table, and for layers.

    A grid of n x n samples is n lines of n. `size` is (width, height) of the target; with it, lines are returned per
    pixel if the lens cuts the polygon, otherwise for the middle of the image.
    """
    values, (entry, color) = render_pass.given(), (render_pass.spec, COLORS[0])
    angle, squeeze = values["BokehAngle"], values["BokehSqueeze"]
    if entry.role in (LINE, ADAPTIVE):
        middle = (values["BokehLineCenterX"], values["BokehLineCenterY"])
        return (Line(color, line_segment(angle, values["BokehLineLength"], middle, squeeze)),)
    if entry.role == GRID:
        across = line_segment(values["BokehAngleB"], 1.0, (0.0, 0.0), squeeze).half
        along = line_segment(angle, 1.0, (0.0, 0.0), squeeze).half
        return tuple(Line(color, Segment(t * across, along)) for t in np.linspace(-1.0, 1.0, render_pass.samples))
    if entry.layers or entry.role not in (FIRST, SECOND, EDGE):
        return ()
    sides = entry.sides or round(values["BokehSides"])
    half_sides = sides // 2
    cut = size and render_pass.constants["BOKEH_LENS_SHAPE"]
    lengths = lengths_in(size, sides, values) if cut else edge_lengths(sides)

    def edge(k: int, second_pass: bool) -> Segment:
        return polygon_edge(k, sides, angle, squeeze, second_pass, lengths)

    if entry.role == SECOND:
        areas = {
            k: lengths[k - 1] * sum(parallelogram(k, i, sides, lengths) for i in range(1, k))
            for k in range(2, half_sides + 1)
        }
        return tuple(Line(COLORS[k - 2], edge(k, True), (area,), k) for k, area in areas.items())
    targets = range(2, half_sides + 1) if entry.role == FIRST else (render_pass.constants["BOKEH_TARGET_INDEX"] + 2,)
    return tuple(
        Line(color, edge(i, False), tuple(parallelogram(k, i, sides, lengths) for k in targets), i)
        for i in range(1, max(targets))
    )


def line_segment(angle: float, length: float, middle: tuple[float, float], squeeze: float) -> Segment:
    """Return a line at an angle in radians."""
    shape = np.array([squeeze, 1.0])
    return Segment(np.array(middle) * shape, 0.5 * length * aperture_shapes.direction(angle) * shape)


def polygon_edge(
    k: int, sides: int, rotation: float, squeeze: float, second_pass: bool, lengths: np.ndarray
) -> Segment:
    """Return edge k of a polygon as it is filtered in one of the two passes; `lengths` are from edge_lengths().

    The outline begins at the corner V_0, minus half of all edges; edge k runs from V_(k-1) to V_k with the middle M_k.
    The first pass filters along M_k - Q, where Q is the mean of M_1 to M_(n-1), the second along Q - V_0 - M_k.
    Together they place the parallelogram of the edges i < k at M_i - M_k - V_0, where the tiling needs it.

    The parallelograms of a hexagon share the corner V_0 + e_2. Drawn from there, every line begins at the pixel: edges
    1 and 3 in one direction, edge 2 in the other. The second pass shifts the image by that corner, which is 0 in a
    regular hexagon.
    """
    step, count = 2.0 * pi / sides, sides // 2
    along = [aperture_shapes.direction(rotation + i * step + 0.5 * pi) for i in range(1, count + 1)]
    edges = [np.multiply.outer(direction, length) for direction, length in zip(along, lengths, strict=True)]
    corner = [-0.5 * sum(edges)]
    for edge in edges:
        corner.append(corner[-1] + edge)
    middles = [(corner[j] + corner[j + 1]) / 2 for j in range(count)]
    middle, half = middles[k - 1] - sum(middles[:-1]) / (count - 1), 0.5 * edges[k - 1]
    if second_pass:
        middle = -middle - corner[0]
    if sides == 6:
        half = half if k == 2 else -half
        middle = half - (corner[0] + edges[1]) if second_pass else half
    shape = np.array([squeeze, 1.0]).reshape(2, *(1 for _ in middle.shape[1:]))
    return Segment(middle * shape, half * shape)


def parallelogram(k: int, i: int, sides: int, lengths: np.ndarray) -> float | np.ndarray:
    """Return the area of the parallelogram of edges i < k, for an edge k of length 1; 0 if i is not below k."""
    return sin((k - i) * 2.0 * pi / sides) * lengths[i - 1] if i < k else 0.0


def lengths_in(size: tuple[int, int], sides: int, values: Mapping[str, float]) -> np.ndarray:
    """Return edge_lengths() in each pixel of a target, (n, H, W): the farther from the middle, the more is cut."""
    y, x = np.mgrid[0 : size[1], 0 : size[0]] + 0.5
    image = np.array([values["BokehImageWidth"], values["BokehImageHeight"]])
    position = np.stack([2.0 * x / size[0] - 1.0, 2.0 * y / size[1] - 1.0]) * (image / np.hypot(*image))[:, None, None]
    c, s = cos(values["BokehAngle"]), sin(values["BokehAngle"])
    rotated = np.tensordot(np.array([[c, s], [-s, c]]), position, 1)
    amount = min(max(values["BokehCatsEye"], 0.0), MOST)
    return edge_lengths(sides, amount * rotated, min(max(values["BokehRoundness"], 0.0), 1.0))


def edge_lengths(sides: int, along: Sequence[float] | np.ndarray = (0.0, 0.0), roundness: float = 1.0) -> np.ndarray:
    """Return the lengths of edges 1 to n of a polygon that is cut along `along` (2, ...): (n, ...).

    The polygon moved by half of d in one direction and in the opposite one have an intersection with the same edge
    directions: |x n_k| <= h_k (1 - |c n_k|), where n_k is the normal of edge k, h_k half the width along it, and c = d
    / (2 h). Each edge is the piece of its line between the nearest lines that cross it.

    roundness  of an octagon: its odd edges take this fraction of their eighth of the circle, the even ones the rest
    """
    count, step = sides // 2, 2.0 * pi / sides
    normals = [np.array([cos(k * step), sin(k * step)]) for k in range(count)]
    fractions = [roundness if k % 2 else 2.0 - roundness for k in range(count)] if sides == 8 else [1.0] * count
    shrunk = [1.0 - np.abs(np.tensordot(normal, along, 1)) for normal in normals]
    half = [0.5 * cos(fraction * step / 2) * remaining for fraction, remaining in zip(fractions, shrunk, strict=True)]

    def distance(k: int, other: int) -> np.ndarray:
        """Return the distance from the foot of the normal of line k to its intersection with line k + other."""
        angle = abs(other) * step
        return (half[(k + other) % count] - half[k % count] * cos(angle)) / sin(angle)

    others = range(1, count)
    lengths = [
        np.min([distance(k, i) for i in others], axis=0) + np.min([distance(k, -i) for i in others], axis=0)
        for k in range(1, count + 1)
    ]
    return np.maximum(np.array(lengths), LEAST)
