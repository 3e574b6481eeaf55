"""Polygons that the lens barrel cuts (cat's eye), in float64: section [8] of the libraries beyond the regular polygon.

The polygon and the same moved along d by half of it to both sides have an intersection with the polygon's edge
directions: it lies within |x n_k| <= h_k (1 - |c n_k|), n_k the normal of edge k, h_k half the width along it,
c = d / (2 h). Each edge is a piece of its line, between the nearest lines that cross it.

How far off a device may be, in units of Precision.line, which bounds its sin and cos: to first order, with every sin
and cos of the formula off by as much and all of them the wrong way, the length of an edge is off by 4.9 at most (4, 6,
8 and 10 sides; partial derivatives by differences, at random cuts), an end of a line by 8.2. The rotation, which a
regular polygon has too, adds 1. The area beside an edge, l_k times the sum over i < k of l_i sin, is off by
sum l_i + (n - 1) l_k <= AREAS errors of a length: no edge of n is longer than that of the regular polygon.
"""

from collections.abc import Mapping
from math import cos, pi, sin

import numpy as np

LEAST, MOST = 0.001, 0.9  # of a length, in units of the CoC; of the amount
STRETCH, TURNS, AREAS = 5.0, 9.5, 4.0


def of_target(
    size: tuple[int, int], sides: int, values: Mapping[str, float], constants: Mapping[str, int]
) -> np.ndarray | None:
    """`lengths` for each pixel of a target, (n, H, W); None where the program has no BOKEH_CHARACTER."""
    if not constants["BOKEH_CHARACTER"]:
        return None
    y, x = np.mgrid[0 : size[1], 0 : size[0]] + 0.5
    uv = np.stack([x / size[0], y / size[1]])
    image = np.array([values["BokehImageWidth"], values["BokehImageHeight"]])
    place = (2.0 * uv - 1.0) * (image / np.hypot(*image))[:, None, None]
    c, s = cos(values["BokehAngle"]), sin(values["BokehAngle"])
    turned = np.tensordot(np.array([[c, s], [-s, c]]), place, 1)
    amount = min(max(values["BokehCatsEye"], 0.0), MOST)
    return lengths(sides, amount * turned, min(max(values["BokehRoundness"], 0.0), 1.0))


def lengths(sides: int, along: np.ndarray, roundness: float = 1.0) -> np.ndarray:
    """Of edges 1 .. n for a cut along `along` (2, ...): (n, ...), units of the CoC.

    roundness  of an octagon: its odd edges take so much of their eighth of the circle, the even ones the rest
    """
    count, step = sides // 2, 2.0 * pi / sides
    normals = [np.array([cos(k * step), sin(k * step)]) for k in range(count)]
    part = [roundness if k % 2 else 2.0 - roundness for k in range(count)] if sides == 8 else [1.0] * count
    shrunk = [1.0 - np.abs(np.tensordot(normal, along, 1)) for normal in normals]
    half = [0.5 * cos(one * step / 2) * left for one, left in zip(part, shrunk, strict=True)]

    def distance(k: int, other: int) -> np.ndarray:
        """From the foot of the normal of line k to where line k + other crosses it."""
        angle = abs(other) * step
        return (half[(k + other) % count] - half[k % count] * cos(angle)) / sin(angle)

    others = range(1, count)
    found = [
        np.min([distance(k, i) for i in others], axis=0) + np.min([distance(k, -i) for i in others], axis=0)
        for k in range(1, count + 1)
    ]
    return np.maximum(np.array(found), LEAST)
