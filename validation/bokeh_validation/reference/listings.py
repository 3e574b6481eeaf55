"""Compute Listings 1 and 3 and depth conventions in float64; depth in metres, CoC as a fraction of the image height."""

import numpy as np

MAX_COLOR = 65504.0
MIN_DEPTH = float(np.float32(1e-6))
MAX_DEPTH = 1e9


def circle_of_confusion(depth, aperture_diameter, focal_length, focus_distance, sensor_height, max_coc):
    """Return the CoC diameter of a thin lens (section 4.1), fraction of the image height, 0 to max_coc.

    All lengths are in metres. A focus distance up to the focal length, where no lens can focus, is treated as
    MIN_DEPTH beyond it; an infinite one as MAX_DEPTH.
    """
    focus_distance = min(focus_distance, MAX_DEPTH)
    magnification = focal_length / max(focus_distance - focal_length, MIN_DEPTH)
    c = aperture_diameter * magnification * np.abs(depth - focus_distance) / depth
    return np.clip(c / max(sensor_height, MIN_DEPTH), 0.0, max_coc)


def safe_color(color: np.ndarray) -> np.ndarray:
    """Replace NaN and negative colour by 0, and infinite colour by the largest half float; any shape."""
    return np.where(color > 0.0, np.minimum(color, MAX_COLOR), 0.0)


def safe_depth(depth: np.ndarray) -> np.ndarray:
    """Replace NaN, zero and negative depth by the smallest depth, and infinite depth by the largest; any shape."""
    return np.where(depth > MIN_DEPTH, np.minimum(depth, MAX_DEPTH), MIN_DEPTH)


# Name of the kind of depth that a buffer of one channel holds -> BokehDepthKind
DEPTH_KINDS = {
    "metres": 0,
    "window": 1,
    "reversed": 2,
    "infinite": 3,
    "clip": 4,
    "orthographic": 5,
    "orthographic reversed": 6,
    "fraction": 7,
    "logarithmic": 8,
}
# The kind of a buffer of two channels, metres times opacity and opacity
WEIGHTED = 9


def linear_depth(depth: np.ndarray, kind: int, near: float, far: float) -> np.ndarray:
    """Convert stored depth to metres along the view axis, made safe by safe_depth().

    kind       a value of DEPTH_KINDS
    near, far  distances of the planes, metres
    """
    with np.errstate(all="ignore"):
        metres = {
            0: lambda: depth,
            1: lambda: near * far / (far - depth * (far - near)),
            2: lambda: near * far / (near + depth * (far - near)),
            3: lambda: near / np.where(depth >= near / MAX_DEPTH, depth, near / MAX_DEPTH),
            4: lambda: 2.0 * near * far / (far + near - depth * (far - near)),
            5: lambda: near + depth * (far - near),
            6: lambda: near + (1.0 - depth) * (far - near),
            7: lambda: depth * far,
            8: lambda: (1.0 + far) ** np.where(depth >= 0.0, depth, 0.0) - 1.0,
        }[kind]()
    return safe_depth(metres)


def stored_depth(metres: np.ndarray, kind: int, near: float, far: float) -> np.ndarray:
    """Return the value that a depth buffer stores for a depth in metres, float64: the inverse of linear_depth()."""
    return {
        0: lambda: metres,
        1: lambda: far * (metres - near) / (metres * (far - near)),
        2: lambda: near * (far - metres) / (metres * (far - near)),
        3: lambda: near / metres,
        4: lambda: (far + near - 2.0 * near * far / metres) / (far - near),
        5: lambda: (metres - near) / (far - near),
        6: lambda: 1.0 - (metres - near) / (far - near),
        7: lambda: metres / far,
        8: lambda: np.log1p(metres) / np.log1p(far),
    }[kind]()


def leakage_weight(sample_depth, sample_coc, center_depth, center_coc, bias, mult):
    """Return the weight of Listing 3: a nearer and clearly sharper sample is weighted by its own CoC,
    all others by 1.
    """
    leaks = (sample_depth < center_depth) & (center_coc > sample_coc + bias)
    return np.where(leaks, np.clip(sample_coc * mult, 0.0, 1.0), 1.0)
