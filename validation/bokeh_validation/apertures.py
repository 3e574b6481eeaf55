"""Host side of Listing 2 and of the workflows: which lines make which aperture, and the tables of the naive gather.

Angles are in radians, 0 along +u (to the right) and 90 degrees along +v (towards the last row in memory).
"""

from dataclasses import dataclass
from math import cos, radians, sin

import numpy as np

APERTURES = ("square", "diamond", "hexagon", "octagon", "star")
# Regular polygons that decomposition.py makes: number of sides, inscribed in the CoC, first corner straight up
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


def line_end(angle: float, aspect_ratio: float) -> np.ndarray:
    """End of a line of length 1 centred on the pixel, uv, shape (2,): `BokehLineEnd` of the shaders."""
    return 0.5 * direction(angle) / np.array([aspect_ratio, 1.0])


def make_offsets(angle: float, aspect_ratio: float, num_samples: int) -> np.ndarray:
    """Listing 2: offsets of all samples on a line, uv for a CoC of 1, shape (num_samples, 2)."""
    last = max(num_samples, 2) - 1
    t = (2.0 * np.arange(num_samples) - last) / last
    return t[:, None] * line_end(angle, aspect_ratio)


def rotated(table: np.ndarray, rotation: float) -> np.ndarray:
    """Offsets turned by `rotation` degrees, from +x towards +y."""
    c, s = cos(radians(rotation)), sin(radians(rotation))
    return table @ np.array([[c, s], [-s, c]])


def parallelogram_kernel(shape: Parallelogram, side: int) -> np.ndarray:
    """Grid of side x side offsets from edge to edge of a parallelogram, (side^2, 2), x right, y down, CoC of 1."""
    u, v = (make_offsets(radians(a), 1.0, side) for a in (shape.first, shape.second))
    return (v[:, None, :] + u[None, :, :]).reshape(-1, 2)


def hexagon_kernel(rings: int = 6) -> np.ndarray:
    """Triangular lattice of `rings` rings about the centre: 3 r (r + 1) + 1 offsets, 127 for 6 (Figure 4a).

    The outermost corners lie on the circle of confusion, one of them straight up.
    """
    a, b = direction(radians(90)) * 0.5 / rings, direction(radians(30)) * 0.5 / rings
    return np.array(
        [i * a + j * b for j in range(-rings, rings + 1) for i in range(-rings, rings + 1) if abs(i + j) <= rings]
    )


def lattice_kernel(cells: int, inside) -> np.ndarray:
    """Midpoints of a square lattice, `cells` of them across a CoC of 1, where `inside(x, y)` is true."""
    half = cells  # enough for shapes that reach beyond the CoC
    axis = (np.arange(-half, half) + 0.5) / cells if cells % 2 == 0 else np.arange(-half, half + 1) / cells
    y, x = np.meshgrid(axis, axis, indexing="ij")
    keep = inside(x, y)
    return np.stack([x[keep], y[keep]], axis=1)


def _square_distances(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """How far out in units of the upright and of the turned square of side 1: 0.5 is on the edge."""
    return np.maximum(abs(x), abs(y)), (abs(x) + abs(y)) / np.sqrt(2.0)


def octagon_kernel(cells: int = 12) -> np.ndarray:
    """Square lattice inside the regular octagon common to both squares of side CoC: 120 offsets for 12 (Figure 4b)."""
    return lattice_kernel(cells, lambda x, y: np.maximum(*_square_distances(x, y)) <= 0.5)


def star_kernel(cells: int = 12) -> np.ndarray:
    """Square lattice inside the union of the two squares of side CoC."""
    return lattice_kernel(cells, lambda x, y: np.minimum(*_square_distances(x, y)) <= 0.5)


def regular_polygon(sides: int) -> np.ndarray:
    """Corners inscribed in the circle of confusion, the first straight up, from +x towards +y, (sides, 2), CoC of 1."""
    return np.array([0.5 * direction(radians(360.0 * k / sides - 90.0)) for k in range(sides)])


def even_polygon(sides: int, rotation: float = 0.0) -> np.ndarray:
    """Corners of the exact method's polygons, inscribed in the CoC, an edge upright at the right, (sides, 2)."""
    return np.array([0.5 * direction(radians(360.0 * (k + 0.5) / sides + rotation)) for k in range(sides)])


def polygon_kernel(sides: int, cells: int = 12) -> np.ndarray:
    """Square lattice inside a regular polygon, point-reflected: 46 offsets for a triangle and 12.

    A pixel finds a highlight on the other side of itself, so that the picture of a highlight is the offsets' mirror
    image. The mean is 0, or the picture would move.
    """
    corners = regular_polygon(sides)

    def inside(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        within = np.ones(x.shape, bool)
        for (ax, ay), (bx, by) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            within &= (bx - ax) * (y - ay) - (by - ay) * (x - ax) >= -1e-12
        return within

    table = lattice_kernel(cells, inside)
    return table.mean(axis=0) - table


def kernel(aperture: str, samples: int, rotation: float = 0.0) -> np.ndarray:
    """Table of the naive gather with about the density of `samples` a line, (N, 2), x right, y down, CoC of 1.

    `samples` = 13 gives the 127-sample hexagon and the 120-sample octagon of Figure 4.
    """
    if aperture in ("square", "diamond"):
        table = parallelogram_kernel(PARALLELOGRAMS[aperture][0], samples)
    elif aperture == "hexagon":
        table = hexagon_kernel(max(1, (samples - 1) // 2))
    elif aperture == "octagon":
        table = octagon_kernel(max(2, samples - 1))
    elif aperture == "star":
        table = star_kernel(max(2, samples - 1))
    elif aperture in POLYGONS:
        table = polygon_kernel(POLYGONS[aperture], max(2, samples - 1))
    else:
        raise ValueError(f"unknown aperture {aperture!r}: one of {', '.join(NAMES)}")
    return rotated(table, rotation)
