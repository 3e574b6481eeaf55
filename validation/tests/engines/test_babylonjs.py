"""integration/babylonjs: what its guide says of depth, focus and debug views is so."""

import numpy as np
import pytest
from support import needed
from support_pages import assert_debug_views, assert_pulled

from bokeh_validation.engines import pages


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
    assert_pulled(said)
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
    assert_debug_views(sample.call("views", kind))
