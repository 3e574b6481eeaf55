"""Share helpers between the tests of the samples in integration/."""

import base64
from collections.abc import Callable
from pathlib import Path

import numpy as np
from PIL import Image

# (H, W) of the images that a capture.js reads
SIZE = (240, 320)


def pixels(data: str, size: tuple[int, int] = SIZE) -> np.ndarray:
    """Decode base64 pixels of `size` (H, W): (H, W, 4) float16 or (H, W) float32, by their length."""
    raw = base64.b64decode(data)
    half = len(raw) == 8 * size[0] * size[1]
    return np.frombuffer(raw, np.float16).reshape(*size, 4) if half else np.frombuffer(raw, np.float32).reshape(size)


def assert_pulled(said: dict) -> None:
    """Check `interaction` of capture.js: a click on the box, which is 0.9 m wide, focuses on its front."""
    assert 4.5 < said["before"] < 5.5
    assert said["box"] - 0.7 < said["after"] < said["box"] - 0.3


def assert_debug_views(said: dict, linear: Callable = lambda shown: shown) -> None:
    """Check depth, circle of confusion, near and far field in `views` of capture.js, as BOKEH_DEBUG defines them.

    linear  decodes what is displayed
    """
    shown = {mode: linear(pixels(data)) for mode, data in said["views"].items()}
    depth, coc = pixels(said["depth"]), pixels(said["coc"])[..., 3]
    focus = said["focus"]
    assert np.allclose(shown["1"][..., 0], depth / (depth + focus), atol=2e-3)
    assert np.allclose(shown["2"][..., 0], abs(coc) / said["maxCoC"], atol=2e-3)
    blurred = abs(coc) > 0.005
    near = depth < focus
    # a pixel next to a brighter, nearer one may have that one's circle of confusion
    padded = np.pad(near, 1)
    beside = near | padded[:-2, 1:-1] | padded[2:, 1:-1] | padded[1:-1, :-2] | padded[1:-1, 2:]
    assert (coc < 0)[blurred & near].all() and beside[blurred & (coc < 0)].all()
    assert (beside & ~near & (coc < 0)).mean() < 0.02
    assert (shown["3"][..., 0] > shown["3"][..., 2])[blurred & near].all() and (blurred & near).any()
    assert (shown["3"][..., 2] > shown["3"][..., 0])[blurred & ~near].all() and (blurred & ~near).any()


def assert_picture(drawn: Path, shown: Path) -> None:
    """Check that a sample draws its guide's image, apart from rounding: half a step of 255 on average."""
    with Image.open(drawn) as a, Image.open(shown) as b:
        assert a.size == b.size
        off = np.abs(np.asarray(a.convert("RGB"), float) - np.asarray(b.convert("RGB"), float)).mean()
    assert off < 0.5, f"{off:.2f} of 255 off on average"
