"""Passes into targets of any size and into parts of them, with NaN in what is around."""

import numpy as np

from bokeh_validation.frame import methods
from bokeh_validation.shaders.passes import Pass

Area = tuple[int, int, int, int]


def inside(pixels: np.ndarray, area: Area) -> np.ndarray:
    """The part of (H, W, ...) pixels that a rectangle (x, y, width, height) is, a view."""
    x, y, width, height = area
    return pixels[y : y + height, x : x + width]


def framed(part: np.ndarray, size: tuple[int, int], area: Area, around: float = np.nan) -> np.ndarray:
    """An image at its place in a texture of NaN, or of another value."""
    whole = np.full((size[1], size[0], *part.shape[2:]), around, part.dtype)
    inside(whole, area)[:] = part
    return whole


# One texel of NaN is read everywhere. Depth is read by BokehDebug, and not used in its mode 0.
NAN = {"nan": np.full((1, 1, 4), np.nan, np.float16), "depth": np.ones((1, 1), np.float32)}


def nan(output: str, scale: int = 1) -> Pass:
    """NaN everywhere in a new target: the debug view of colour copies what it reads."""
    return Pass("BokehDebug", {"ColorSamp": "nan", "DepthSamp": "depth"}, output, scale=scale)


def poisoned(plan: methods.Plan) -> list[Pass]:
    """Its passes, after others that fill every target with NaN, each at its scale; reads the texture "nan"."""
    scales = {name: item.scale for item in plan.passes for name in item.outputs}
    return [*(nan(name, scale) for name, scale in scales.items()), *plan.passes]
