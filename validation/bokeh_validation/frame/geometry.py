"""Compute with polygons, given as corners (N, 2), x right and y down, and with their coverage of pixels."""

from collections.abc import Iterator

import numpy as np

SUBPIXELS = 8


def _sides(polygon: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Return (start, edge vector) of each side; a point is inside where the cross product of edge and point - start is
    positive.
    """
    polygon = polygon if signed_area(polygon) > 0 else polygon[::-1]
    return zip(polygon, np.roll(polygon, -1, axis=0) - polygon, strict=True)


def clip_convex(subject: np.ndarray, clip: np.ndarray) -> np.ndarray:
    """Return the intersection of two convex polygons, (N, 2), by Sutherland-Hodgman clipping."""
    corners = np.asarray(subject, float)
    for start, edge in _sides(clip):
        offs = edge[0] * (corners[:, 1] - start[1]) - edge[1] * (corners[:, 0] - start[0])
        kept = []
        for a, b, off_a, off_b in zip(corners, np.roll(corners, -1, axis=0), offs, np.roll(offs, -1), strict=True):
            if off_a >= 0:
                kept.append(a)
            if off_a * off_b < 0:
                kept.append(a + (b - a) * off_a / (off_a - off_b))
        corners = np.array(kept).reshape(-1, 2)
    gaps = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1)
    return corners[gaps > 1e-9]


def signed_area(polygon: np.ndarray) -> float:
    """Return the area; positive if the corners run from +x towards +y."""
    x, y = polygon[:, 0], polygon[:, 1]
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def perimeter(polygon: np.ndarray) -> float:
    """Return the length of the boundary."""
    return float(np.linalg.norm(polygon - np.roll(polygon, 1, axis=0), axis=1).sum())


def inside(polygon: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return whether points are inside a convex polygon or on its edge, bool in the shape of x and y."""
    within = np.ones(np.broadcast(x, y).shape, bool)
    for start, edge in _sides(polygon):
        within &= edge[0] * (y - start[1]) - edge[1] * (x - start[0]) >= 0
    return within


def coverage(polygon: np.ndarray, size: tuple[int, int], center: tuple[float, float]) -> np.ndarray:
    """Return the fraction of each pixel that a convex polygon covers, (H, W), from SUBPIXELS^2 points per pixel.

    size    (width, height) of the image, pixels
    center  position of the polygon's origin, pixels from the image's corner (pixel centres at .5)
    """
    width, height = size
    x = (np.arange(width * SUBPIXELS) + 0.5) / SUBPIXELS - center[0]
    y = ((np.arange(height * SUBPIXELS) + 0.5) / SUBPIXELS - center[1])[:, None]
    return inside(polygon, x, y).reshape(height, SUBPIXELS, width, SUBPIXELS).mean(axis=(1, 3))


def turn_between(weights: np.ndarray, others: np.ndarray, center: tuple[float, float], folds: int) -> float:
    """Return the smallest rotation between two images (H, W) of a shape with `folds`-fold symmetry, degrees, from
    their moments.

    center  of the rotation, pixels from the image's corner
    """
    height, width = weights.shape
    y, x = np.mgrid[0:height, 0:width] + 0.5
    moment = ((x - center[0]) + 1j * (y - center[1])) ** folds
    return abs(float(np.degrees(np.angle(np.sum(weights * moment) / np.sum(others * moment))))) / folds
