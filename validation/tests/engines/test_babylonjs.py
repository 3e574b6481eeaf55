"""integration/babylonjs: what its guide says of depth, focus and debug views is so."""

import base64

import numpy as np
import pytest
from support import needed

from bokeh_validation.engines import pages

SIZE = (240, 320)


@pytest.fixture(scope="module", params=["webgl", "webgpu"])
def kind(request) -> str:
    return request.param


@pytest.fixture(scope="module")
def sample(kind):
    with needed("Babylon.js"), pages.opened(f"babylonjs-{kind}") as opened:
        yield opened


def test_click_and_key(sample, kind):
    """The first call, while the page is as the sample made it: a click focuses, a key shows the circle of confusion."""
    said = sample.call("interaction", kind)
    assert 4.5 < said["before"] < 5.5
    # the box is 0.9 m wide, and its front was hit
    assert said["box"] - 0.7 < said["after"] < said["box"] - 0.3
    assert len(said["passes"]) == 2 and "BokehDebugCoC" in said["passes"][1]


def test_depth_of_every_camera(sample, kind):
    """Perspective, orthographic, right-handed: what the passes read is what a ray meets, or maxZ where none does."""
    cases = sample.call("depths", kind)
    assert len(cases) == 3
    for case in cases:
        drawn, met = np.array(case["drawn"]), np.array(case["met"])
        empty = met == case["maxZ"]
        assert empty.sum() > 50 and (~empty).sum() > 100, case["name"]
        # the rest is at outlines, where the ray may pass by
        assert (abs(drawn - met) < 1e-3 * met).mean() > 0.97, case["name"]


def test_debug_views(sample, kind):
    """Depth, circle of confusion, near and far field, as section [9] has them; alpha is the signed CoC."""
    said = sample.call("views", kind)
    shown = {view: _pixels(data, np.float16) for view, data in said["views"].items()}
    depth = _pixels(said["depth"], np.float32)
    coc = _pixels(said["coc"], np.float16)[..., 3]
    focus = said["focus"]
    assert np.allclose(shown["depth"][..., 0], depth / (depth + focus), atol=2e-3)
    assert np.allclose(shown["coc"][..., 0], abs(coc) / said["maxCoC"], atol=2e-3)
    blurred = abs(coc) > 0.005
    near = depth < focus
    assert ((coc < 0) == near)[blurred].all()
    assert (shown["focus"][..., 0] > shown["focus"][..., 2])[blurred & near].all() and (blurred & near).any()
    assert (shown["focus"][..., 2] > shown["focus"][..., 0])[blurred & ~near].all() and (blurred & ~near).any()


def _pixels(data: str, dtype: type) -> np.ndarray:
    values = np.frombuffer(base64.b64decode(data), dtype)
    return values.reshape(*SIZE, 4) if dtype is np.float16 else values.reshape(SIZE)
