"""Compute what the application supplies to the paper's method: the lines of each aperture, the offsets of Listing 2,
and the tables of the naive gather.

Angles are in radians: 0 points along +u (right), 90 degrees along +v (towards the last row in memory).
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from math import cos, radians, sin

import numpy as np

from bokeh_validation.frame import geometry

APERTURES = ("square", "diamond", "hexagon", "octagon", "star")
# Regular polygons made from lines by decomposition.py: name -> number of sides. They are inscribed in the CoC, with
# the first corner straight up.
POLYGONS = {"triangle": 3, "pentagon": 5, "heptagon": 7, "decagon": 10}
NAMES = (*APERTURES, *POLYGONS)
METHODS = ("paper", "naive", "exact", "layered")


@dataclass(frozen=True)
class Parallelogram:
    """Describe a parallelogram by the angles of two lines of length CoC, in degrees.

    The image is blurred along the first line, then along the second.
    """

    first: float
    second: float

    def corners(self, rotation: float = 0.0) -> np.ndarray:
        """Return the corners in order, (4, 2), x right and y down, for a CoC of 1. `rotation` is in degrees."""
        e1, e2 = (0.5 * direction(radians(a + rotation)) for a in (self.first, self.second))
        return np.array([e1 + e2, e1 - e2, -e1 - e2, -e1 + e2])


# Section 4.5 and Figure 10 of the paper. Both parallelograms of the hexagon begin with the same line.
PARALLELOGRAMS: dict[str, tuple[Parallelogram, ...]] = {
    "square": (Parallelogram(0, 90),),
    "diamond": (Parallelogram(0, 45),),
    "hexagon": (Parallelogram(90, 30), Parallelogram(90, 150)),
    "octagon": (Parallelogram(0, 90), Parallelogram(45, 135)),
    "star": (Parallelogram(0, 90), Parallelogram(45, 135)),
}
USES_MAX = {"star"}


def direction(angle: float) -> np.ndarray:
    """Return the unit vector at an angle in radians, (2,)."""
    return np.array([cos(angle), sin(angle)])


def make_offsets(angle: float, aspect_ratio: float, num_samples: int) -> np.ndarray:
    """Return the offsets of the samples along a line (Listing 2), in uv for a CoC of 1, (num_samples, 2). `angle` is
    in radians.
    """
    last = max(num_samples, 2) - 1
    t = (2.0 * np.arange(num_samples) - last) / last
    return t[:, None] * (0.5 * direction(angle) / np.array([aspect_ratio, 1.0]))


def rotated(table: np.ndarray, rotation: float) -> np.ndarray:
    """Rotate offsets (N, 2) by `rotation` degrees, from +x towards +y."""
    c, s = cos(radians(rotation)), sin(radians(rotation))
    return table @ np.array([[c, s], [-s, c]])


def lattice_kernel(cells: int, inside: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> np.ndarray:
    """Return the points (N, 2) of a square lattice with `cells` points across a CoC of 1 where
    `inside(x, y)` is true.
    """
    # the lattice is twice as wide as the CoC, for shapes that extend beyond it
    axis = (np.arange(-cells, cells) + 0.5) / cells if cells % 2 == 0 else np.arange(-cells, cells + 1) / cells
    y, x = np.meshgrid(axis, axis, indexing="ij")
    keep = inside(x, y)
    return np.stack([x[keep], y[keep]], axis=1)


def regular_polygon(sides: int) -> np.ndarray:
    """Return the corners (sides, 2) of a regular polygon inscribed in a CoC of 1, first corner straight up, then from
    +x towards +y.
    """
    return np.array([0.5 * direction(radians(360.0 * k / sides - 90.0)) for k in range(sides)])


def even_polygon(sides: int, rotation: float = 0.0) -> np.ndarray:
    """Return the corners (sides, 2) of a polygon of the exact method, inscribed in a CoC of 1, with a vertical edge at
    the right.

    rotation  degrees
    """
    return np.array([0.5 * direction(radians(360.0 * (k + 0.5) / sides + rotation)) for k in range(sides)])


def kernel(aperture: str, samples: int, rotation: float = 0.0) -> np.ndarray:
    """Return the offset table of the naive gather, (N, 2), x right and y down, for a CoC of 1.

    aperture  one of NAMES
    samples   samples on a line; the table has about their density: 13 gives the hexagon of 127 samples and the octagon
              of 120 samples in Figure 4
    rotation  degrees
    """
    cells = max(2, samples - 1)
    if aperture in POLYGONS:
        # slightly enlarged, so that rounding excludes no point that lies on a side
        corners = regular_polygon(POLYGONS[aperture]) * (1.0 + 1e-12)
        table = lattice_kernel(cells, partial(geometry.inside, corners))
        # mirrored, because a pixel finds a highlight on the opposite side of itself; centred, so that the image does
        # not shift
        return rotated(table.mean(axis=0) - table, rotation)
    shapes = PARALLELOGRAMS[aperture]
    if len(shapes) == 1:
        u, v = (make_offsets(radians(angle), 1.0, samples) for angle in (shapes[0].first, shapes[0].second))
        table = (v[:, None, :] + u[None, :, :]).reshape(-1, 2)
    elif aperture == "hexagon":
        # a triangular lattice of n rings around the centre, 3 n (n + 1) + 1 points; the outermost corners lie on the
        # circle
        n = max(1, (samples - 1) // 2)
        a, b = direction(radians(90)) * 0.5 / n, direction(radians(30)) * 0.5 / n
        steps = range(-n, n + 1)
        table = np.array([i * a + j * b for j in steps for i in steps if abs(i + j) <= n])
    else:
        # two squares of side CoC, one upright and one rotated by 45 degrees: the octagon is their intersection, the
        # star their union
        both = np.logical_or if aperture in USES_MAX else np.logical_and
        table = lattice_kernel(cells, lambda x, y: both(*(geometry.inside(s.corners(), x, y) for s in shapes)))
    return rotated(table, rotation)
