"""Sample textures in float64 with the samplers that the shaders use: linear or nearest filter, clamp."""

import numpy as np


def nearest_index(x: np.ndarray, y: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """Return the flat index of the texel at a position. x, y in texels from the image's corner; size is (width,
    height).
    """
    width, height = size
    column = np.clip(np.floor(x), 0, width - 1).astype(np.int64)
    row = np.clip(np.floor(y), 0, height - 1).astype(np.int64)
    return row * width + column


def bilinear(pixels: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Sample with a linear filter and clamp.

    pixels  (H, W, C) float64
    x, y    positions in texels from the image's corner (texel centres at .5), of the same shape S
    Returns (*S, C).
    """
    height, width, channels = pixels.shape
    flat = pixels.reshape(-1, channels)
    x0, y0 = np.floor(x - 0.5), np.floor(y - 0.5)
    fx, fy = (x - 0.5 - x0)[..., None], (y - 0.5 - y0)[..., None]
    left = np.clip(x0, 0, width - 1).astype(np.int64)
    right = np.clip(x0 + 1, 0, width - 1).astype(np.int64)
    top = np.clip(y0, 0, height - 1).astype(np.int64) * width
    bottom = np.clip(y0 + 1, 0, height - 1).astype(np.int64) * width
    # take() copies a whole texel at a time; flat[...] copies single numbers and is ten times slower
    upper = flat.take(top + left, axis=0) * (1 - fx) + flat.take(top + right, axis=0) * fx
    lower = flat.take(bottom + left, axis=0) * (1 - fx) + flat.take(bottom + right, axis=0) * fx
    return upper * (1 - fy) + lower * fy


def neighbourhood(pixels: np.ndarray) -> np.ndarray:
    """Return the maximum over 3 x 3 texels with clamp, per channel, (H, W, C)."""
    rows = np.concatenate([pixels[:1], pixels, pixels[-1:]])
    rows = np.maximum(np.maximum(rows[:-2], rows[1:-1]), rows[2:])
    columns = np.concatenate([rows[:, :1], rows, rows[:, -1:]], axis=1)
    return np.maximum(np.maximum(columns[:, :-2], columns[:, 1:-1]), columns[:, 2:])


def slopes(pixels: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the largest difference between horizontal and between vertical neighbours within 3 x 3 texels, each (H,
    W, C).
    """
    across = np.abs(np.diff(pixels, axis=1, append=pixels[:, -1:]))
    across = np.maximum(across, np.concatenate([across[:, :1] * 0, across[:, :-1]], axis=1))
    down = np.abs(np.diff(pixels, axis=0, append=pixels[-1:]))
    down = np.maximum(down, np.concatenate([down[:1] * 0, down[:-1]], axis=0))
    return neighbourhood(across), neighbourhood(down)
