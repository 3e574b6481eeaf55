"""Convex polygons as users give them: refused by the corner that is wrong, without idle corners."""

import numpy as np

from bokeh_validation.errors import UserError
from bokeh_validation.frame import polygons

MAX_COORDINATE = 2.0
# Corners that are nearer to each other, or to the line between their neighbours, are one corner, or none.
MERGED = 1e-6


def checked(vertices: np.ndarray) -> np.ndarray:
    """A convex polygon, (n, 2), any winding, as `decomposition.Decomposition.polygon` has it.

    Repeated corners and corners on a straight side are left out. Raises UserError, naming the corner from 1 on, where
    it is not convex, crosses itself, is flat, has numbers that are not finite, or is too large for units of the CoC.
    """
    polygon = np.asarray(vertices, float)
    if polygon.ndim != 2 or polygon.shape[1] != 2 or len(polygon) < 3:
        raise UserError(f"polygon: {len(polygon)} corners. Give three or more, x and y each.")
    if not np.isfinite(polygon).all():
        raise UserError(f"polygon: corner {_first(~np.isfinite(polygon).all(axis=1))} is not a finite number. Mend it.")
    far = (np.abs(polygon) > MAX_COORDINATE).any(axis=1)
    if far.any():
        raise UserError(
            f"polygon: corner {_first(far)} is farther out than {MAX_COORDINATE:g}. The unit is the CoC, 1 = its "
            "diameter: scale the polygon."
        )
    numbers, polygon = _without_idle_corners(polygon)
    if len(polygon) < 3:
        raise UserError("polygon: all corners are on one line. Give one with an area.")
    if polygons.signed_area(polygon) < 0.0:
        # the first corner stays the first
        numbers, polygon = np.roll(numbers[::-1], 1), np.roll(polygon[::-1], 1, axis=0)
    before, after = polygon - np.roll(polygon, 1, axis=0), np.roll(polygon, -1, axis=0) - polygon
    turns = np.degrees(np.arctan2(cross(before, after), (before * after).sum(axis=1)))
    if (turns <= 0.0).any():
        raise UserError(f"polygon: not convex at corner {numbers[np.argmin(turns)] + 1}. Give a convex polygon.")
    if turns.sum() > 540.0:
        raise UserError("polygon: its sides cross. Give the corners of a convex polygon in order.")
    return polygon


def _first(bad: np.ndarray) -> int:
    return int(np.argmax(bad)) + 1


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Of vectors (.., 2)."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _without_idle_corners(polygon: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Numbers and places of the corners that bend the outline."""
    numbers = np.arange(len(polygon))
    index = 0
    while index < len(numbers) and len(numbers) > 2:
        a, b, c = polygon[numbers[[index - 1, index, (index + 1) % len(numbers)]]]
        along = c - a
        span = np.linalg.norm(along)
        off = abs(cross(along, b - a)) / span if span > MERGED else 0.0
        repeated = min(np.linalg.norm(b - a), np.linalg.norm(c - b)) <= MERGED
        between = off <= MERGED and 0.0 <= (b - a) @ along <= along @ along
        if repeated or between:
            # its neighbour may be idle now
            numbers, index = np.delete(numbers, index), max(index - 1, 0)
        else:
            index += 1
    return numbers, polygon[numbers]
