"""List invalid colour and depth, and what docs/inputs.md says that each value is treated as."""

import numpy as np

from bokeh_validation.reference.listings import MAX_COLOR, MAX_DEPTH, MIN_DEPTH

# Half-float colour value -> value that replaces it; 6e-8 is the smallest denormal half float
COLOR = (
    (np.nan, 0.0),
    (np.inf, MAX_COLOR),
    (-np.inf, 0.0),
    (-1.0, 0.0),
    (-MAX_COLOR, 0.0),
    (-6e-8, 0.0),
    (-0.0, 0.0),
    (6e-8, 6e-8),
    (MAX_COLOR, MAX_COLOR),
)
# Depth in metres -> depth that replaces it
DEPTH = (
    (np.nan, MIN_DEPTH),
    (np.inf, MAX_DEPTH),
    (-np.inf, MIN_DEPTH),
    (-1.0, MIN_DEPTH),
    (0.0, MIN_DEPTH),
    (1e-30, MIN_DEPTH),
    (1e30, MAX_DEPTH),
)


def sprinkled(random: np.random.Generator, pixels: np.ndarray, pairs, share: float) -> np.ndarray:
    """Return the pixels with about a fraction `share` of their numbers replaced by bad values from `pairs`."""
    chosen = random.choice(np.array([bad for bad, _ in pairs]), pixels.shape).astype(pixels.dtype)
    return np.where(random.random(pixels.shape) < share, chosen, pixels)
