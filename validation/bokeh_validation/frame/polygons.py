"""Analytic apertures: polygons as corner lists (N, 2), x right and y down, and their coverage of pixels."""

import numpy as np

SUBPIXELS = 8


def clip_convex(subject: np.ndarray, clip: np.ndarray) -> np.ndarray:
    """Intersection of two convex polygons (Sutherland-Hodgman)."""
    clip = clip if signed_area(clip) > 0 else clip[::-1]
    corners = [np.asarray(p, float) for p in subject]
    for start, end in zip(clip, np.roll(clip, -1, axis=0), strict=True):
        edge = end - start

        def side(p, start=start, edge=edge):
            return edge[0] * (p[1] - start[1]) - edge[1] * (p[0] - start[0])

        kept = []
        for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
            sa, sb = side(a), side(b)
            if sa >= 0:
                kept.append(a)
            if (sa > 0 > sb) or (sa < 0 < sb):
                kept.append(a + (b - a) * sa / (sa - sb))
        corners = kept
    return _without_repeats(np.array(corners))


def _without_repeats(polygon: np.ndarray) -> np.ndarray:
    gaps = np.linalg.norm(polygon - np.roll(polygon, 1, axis=0), axis=1)
    return polygon[gaps > 1e-9]


def signed_area(polygon: np.ndarray) -> float:
    """Area; positive where the corners run from +x towards +y."""
    x, y = polygon[:, 0], polygon[:, 1]
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def perimeter(polygon: np.ndarray) -> float:
    """Length of the boundary."""
    return float(np.linalg.norm(polygon - np.roll(polygon, 1, axis=0), axis=1).sum())


def corner_angles(polygon: np.ndarray) -> np.ndarray:
    """Interior angle at each corner, radians, of a convex polygon."""
    before = np.roll(polygon, 1, axis=0) - polygon
    after = np.roll(polygon, -1, axis=0) - polygon
    cosine = np.sum(before * after, axis=1) / np.linalg.norm(before, axis=1) / np.linalg.norm(after, axis=1)
    return np.arccos(np.clip(cosine, -1.0, 1.0))


def inside(polygon: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Which places are in a convex polygon or on its edge, bool in the shape of x and y."""
    polygon = polygon if signed_area(polygon) > 0 else polygon[::-1]
    found = np.ones(np.broadcast(x, y).shape, bool)
    for start, end in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        edge = end - start
        found &= edge[0] * (y - start[1]) - edge[1] * (x - start[0]) >= 0
    return found


def coverage(polygon: np.ndarray, size: tuple[int, int], center: tuple[float, float]) -> np.ndarray:
    """Share of each pixel that a convex polygon covers, (H, W), from SUBPIXELS^2 points a pixel.

    center  where the polygon's origin is, in pixels from the image's corner (pixel centres at .5)
    """
    width, height = size
    x = (np.arange(width * SUBPIXELS) + 0.5) / SUBPIXELS - center[0]
    y = ((np.arange(height * SUBPIXELS) + 0.5) / SUBPIXELS - center[1])[:, None]
    return inside(polygon, x, y).reshape(height, SUBPIXELS, width, SUBPIXELS).mean(axis=(1, 3))


def moment_phase(weights: np.ndarray, center: tuple[float, float], folds: int) -> float:
    """Orientation of a shape with `folds`-fold symmetry: phase of its moment of that order, degrees."""
    height, width = weights.shape
    y, x = np.mgrid[0:height, 0:width] + 0.5
    z = (x - center[0]) + 1j * (y - center[1])
    return float(np.degrees(np.angle(np.sum(weights * z**folds))) / folds)


def angle_between(a: float, b: float, folds: int) -> float:
    """Smallest turn between two orientations of a `folds`-fold shape, degrees."""
    fold = 360.0 / folds
    return abs((a - b + fold / 2) % fold - fold / 2)
