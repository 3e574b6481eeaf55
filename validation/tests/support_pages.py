"""What the tests of the samples for the web (integration/threejs and others) share."""

import base64
from collections.abc import Callable

import numpy as np


def pixels(data: str, size: tuple[int, int]) -> np.ndarray:
    """(H, W, 4) float16 or (H, W) float32 of `size` (H, W), whichever as long as `data` is in base64."""
    raw = base64.b64decode(data)
    half = len(raw) == 8 * size[0] * size[1]
    return np.frombuffer(raw, np.float16).reshape(*size, 4) if half else np.frombuffer(raw, np.float32).reshape(size)


def assert_debug_views(said: dict, size: tuple[int, int], linear: Callable = lambda shown: shown) -> None:
    """Depth, circle of confusion, near and far field of `views` of capture.js, as section [9] has them.

    linear   of what is shown, where that is encoded
    """
    shown = {mode: linear(pixels(data, size)) for mode, data in said["views"].items()}
    depth, coc = pixels(said["depth"], size), pixels(said["coc"], size)[..., 3]
    focus = said["focus"]
    assert np.allclose(shown["1"][..., 0], depth / (depth + focus), atol=2e-3)
    assert np.allclose(shown["2"][..., 0], abs(coc) / said["maxCoC"], atol=2e-3)
    blurred = abs(coc) > 0.005
    near = depth < focus
    assert ((coc < 0) == near)[blurred].all()
    assert (shown["3"][..., 0] > shown["3"][..., 2])[blurred & near].all() and (blurred & near).any()
    assert (shown["3"][..., 2] > shown["3"][..., 0])[blurred & ~near].all() and (blurred & ~near).any()
