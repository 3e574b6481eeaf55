"""Host side of Listing 2 and of the workflows: which lines make which aperture, and the tables of the naive gather.

Angles are in radians, 0 along +u (to the right) and 90 degrees along +v (towards the last row in memory).
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from math import cos, radians, sin

import numpy as np

from bokeh_validation.frame import geometry

APERTURES = ("square", "diamond", "hexagon", "octagon", "star")
# Regular polygons that aperture.py makes: number of sides, inscribed in the CoC, first corner straight up
POLYGONS = {"triangle": 3, "pentagon": 5, "heptagon": 7, "decagon": 10}
NAMES = (*APERTURES, *POLYGONS)
METHODS = ("paper", "naive", "exact", "layered")


@dataclass(frozen=True)
class Parallelogram:
    """Two lines of length CoC, in degrees: blurred along the first, then along the second."""

    first: float
    second: float

    def corners(self, rotation: float = 0.0) -> np.ndarray:
        """Corners in order, (4, 2), x right and y down, for a CoC of 1. Rotation in degrees."""
        e1, e2 = (0.5 * direction(radians(a + rotation)) for a in (self.first, self.second))
        return np.array([e1 + e2, e1 - e2, -e1 - e2, -e1 + e2])


# Section 4.5 and Figure 10. Both parallelograms of the hexagon begin with the same line.
PARALLELOGRAMS: dict[str, tuple[Parallelogram, ...]] = {
    "square": (Parallelogram(0, 90),),
    "diamond": (Parallelogram(0, 45),),
    "hexagon": (Parallelogram(90, 30), Parallelogram(90, 150)),
    "octagon": (Parallelogram(0, 90), Parallelogram(45, 135)),
    "star": (Parallelogram(0, 90), Parallelogram(45, 135)),
}
USES_MAX = {"star"}


def direction(angle: float) -> np.ndarray:
    """Unit vector of an angle in radians."""
    return np.array([cos(angle), sin(angle)])


def make_offsets(angle: float, aspect_ratio: float, num_samples: int) -> np.ndarray:
    """Listing 2: offsets of all samples on a line, uv for a CoC of 1, shape (num_samples, 2)."""
    last = max(num_samples, 2) - 1
    t = (2.0 * np.arange(num_samples) - last) / last
    return t[:, None] * (0.5 * direction(angle) / np.array([aspect_ratio, 1.0]))


def rotated(table: np.ndarray, rotation: float) -> np.ndarray:
    """Offsets turned by `rotation` degrees, from +x towards +y."""
    c, s = cos(radians(rotation)), sin(radians(rotation))
    return table @ np.array([[c, s], [-s, c]])


def lattice_kernel(cells: int, inside: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> np.ndarray:
    """Midpoints of a square lattice, `cells` of them across a CoC of 1, where `inside(x, y)` is true."""
    # twice as wide as the CoC: enough for shapes that reach beyond it
    axis = (np.arange(-cells, cells) + 0.5) / cells if cells % 2 == 0 else np.arange(-cells, cells + 1) / cells
    y, x = np.meshgrid(axis, axis, indexing="ij")
    keep = inside(x, y)
    return np.stack([x[keep], y[keep]], axis=1)


def regular_polygon(sides: int) -> np.ndarray:
    """Corners inscribed in the circle of confusion, the first straight up, from +x towards +y, (sides, 2), CoC of 1."""
    return np.array([0.5 * direction(radians(360.0 * k / sides - 90.0)) for k in range(sides)])


def even_polygon(sides: int, rotation: float = 0.0) -> np.ndarray:
    """Corners of the exact method's polygons, inscribed in the CoC, an edge upright at the right, (sides, 2)."""
    return np.array([0.5 * direction(radians(360.0 * (k + 0.5) / sides + rotation)) for k in range(sides)])


def kernel(aperture: str, samples: int, rotation: float = 0.0) -> np.ndarray:
    """Table of the naive gather with about the density of `samples` a line, (N, 2), x right, y down, CoC of 1.

    `samples` = 13 gives the 127-sample hexagon and the 120-sample octagon of Figure 4.
    """
    cells = max(2, samples - 1)
    if aperture in POLYGONS:
        # a little larger, so that rounding leaves out no place on a side
        corners = regular_polygon(POLYGONS[aperture]) * (1.0 + 1e-12)
        table = lattice_kernel(cells, partial(geometry.inside, corners))
        # mirrored: a pixel finds a highlight on the other side of itself; the mean is 0, or the picture would move
        return rotated(table.mean(axis=0) - table, rotation)
    shapes = PARALLELOGRAMS[aperture]
    if len(shapes) == 1:
        u, v = (make_offsets(radians(angle), 1.0, samples) for angle in (shapes[0].first, shapes[0].second))
        table = (v[:, None, :] + u[None, :, :]).reshape(-1, 2)
    elif aperture == "hexagon":
        # triangles in n rings about the centre, 3 n (n + 1) + 1 places; the outermost corners are on the circle
        n = max(1, (samples - 1) // 2)
        a, b = direction(radians(90)) * 0.5 / n, direction(radians(30)) * 0.5 / n
        steps = range(-n, n + 1)
        table = np.array([i * a + j * b for j in steps for i in steps if abs(i + j) <= n])
    else:
        # what both squares of side CoC have, the upright and the turned one; what either of them has
        both = np.logical_or if aperture in USES_MAX else np.logical_and
        table = lattice_kernel(cells, lambda x, y: both(*(geometry.inside(s.corners(), x, y) for s in shapes)))
    return rotated(table, rotation)
