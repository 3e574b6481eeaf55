"""Find pixels that have no counterpart nearby in the truth; FLIP, a mean, hardly notices a few wrong pixels."""

from collections.abc import Callable

import numpy as np

from bokeh_validation import pictures
from lab.rasterised.rasteriser import Lens, Pinhole

# Exposure with which random scenes are displayed; truth.EXPOSURE is for the ray-traced ones
RANDOM_EXPOSURE = 0.8
# Difference in display values from which a pixel is a fault
LIMITS = {"bright": 0.08, "dark": 0.08, "rough": 0.10}
# Pixels by which a method's result may be displaced
REACH = 3
# Below this CoC in pixels, an input with one sample per pixel has staircases, which are no fault of a result this
# close to it
SHARP, UNCHANGED = 1.5, 0.03


def maps(image: np.ndarray, pinhole: Pinhole, lens: Lens, coc: np.ndarray | None) -> dict[str, np.ndarray]:
    """Return the faults of an image (H, W, >= 3), each a map (H, W) in display values, 0 to 1.

    bright  how far above the truth's maximum within REACH pixels: specks, cores, lit cracks
    dark    how far below its minimum: holes, dark cracks, missing light
    rough   the error without its mean over 7 x 7 pixels, where the truth is smooth: texture that is not in the scene

    coc     (H, W), pixels, of an input with one sample per pixel; None: the input is antialiased

    The maps fade out where the lens sees what the input does not contain.
    """
    displayed, truth = display(image), display(lens.color)
    # the truth, if hidden parts looked like the visible ones
    visible_truth = display((lens.color - lens.hidden_color) / np.maximum(1.0 - lens.hidden[..., None], 0.02))
    hidden, unseen = around(lens.hidden, 1, np.max), around(np.abs(truth - visible_truth).max(axis=-1), 2, np.max)
    counts = np.ones(hidden.shape, bool)
    if coc is not None:
        counts = (coc >= SHARP) | (np.abs(displayed - display(pinhole.color)).max(axis=-1) >= UNCHANGED)

    def fading(hidden_weight: float, unseen_weight: float) -> np.ndarray:
        return counts * np.clip(1.0 - hidden_weight * hidden, 0, 1) * np.clip(1.0 - unseen_weight * unseen, 0, 1)

    bright = np.maximum(displayed - around(truth, REACH, np.max), 0.0).max(axis=-1)
    dark = np.maximum(around(truth, REACH, np.min) - displayed, 0.0).max(axis=-1)
    error, contrast = displayed - truth, (around(truth, 2, np.max) - around(truth, 2, np.min)).max(axis=-1)
    rough = np.abs(error - around(error, 3, np.mean)).max(axis=-1) * np.clip(1.0 - contrast / 0.25, 0, 1)
    return {"bright": bright * fading(4.0, 15.0), "dark": dark * fading(4.0, 15.0), "rough": rough * fading(1.5, 6.0)}


def display(color: np.ndarray) -> np.ndarray:
    """Return the display values of linear rgb (H, W, >= 3), 0 to 1, float32."""
    return pictures.filmic_curve(color, RANDOM_EXPOSURE).astype(np.float32)


def around(values: np.ndarray, radius: int, of: Callable) -> np.ndarray:
    """Apply np.max, np.min or np.mean to the square of 2 radius + 1 pixels around each pixel of (H, W, ..)."""
    for axis in (0, 1):
        border = [(radius, radius) if dimension == axis else (0, 0) for dimension in range(values.ndim)]
        windows = np.lib.stride_tricks.sliding_window_view(np.pad(values, border, "edge"), 2 * radius + 1, axis)
        values = of(windows, axis=-1)
    return values
