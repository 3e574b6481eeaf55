"""integration/playcanvas: what its guide says of depth, focus, debug views and other effects is so."""

import numpy as np
import pytest
from support import needed
from support_pages import SIZE, assert_debug_views, assert_pulled, pixels

from bokeh_validation.engines import pages


@pytest.fixture(scope="module", params=["webgl", "webgpu"])
def sample(request):
    with needed("PlayCanvas"), pages.opened(f"playcanvas-{request.param}") as opened:
        yield opened


def test_click_and_key(sample):
    """The first call, while the page is as the sample made it: a click focuses, a key shows the circle of confusion."""
    said = sample.call("interaction", None)
    assert_pulled(said)
    assert said["mode"] == 2


def test_depth_of_every_camera(sample):
    """Perspective and orthographic: what the passes read is what a ray meets."""
    cases = sample.call("depths", None)
    assert len(cases) == 2
    for case in cases:
        drawn, met = np.array(case["drawn"]), np.array(case["met"])
        assert len(drawn) == 240 * 32 and met.max() > 2 * met.min()
        np.testing.assert_allclose(drawn, met, rtol=1e-3, err_msg=case["name"])


def test_debug_views(sample):
    """Depth, circle of confusion, near and far field, as section [9] has them; alpha is the signed CoC."""
    assert_debug_views(sample.call("views", None))


def test_other_effects(sample):
    """With bloom, occlusion, TAA and several samples a pixel it is the same picture, but for what those change."""
    said = sample.call("effects", None)
    found = {name: pixels(one["result"], one["size"]).astype(float) for name, one in said.items()}
    assert all((result[..., 3] == 1).all() for result in found.values())
    plain = found.pop("none")
    assert plain.shape[:2] == SIZE
    assert found.pop("scale").shape[:2] == (SIZE[0] // 2, SIZE[1] // 2)
    np.testing.assert_array_equal(found.pop("bloom"), plain)
    assert [name for name, one in said.items() if one["blooms"]] == ["bloom"]
    # of the picture's light; the most by TAA, which dims lamps of a pixel or two before they are blurred
    off = {name: (np.abs(result - plain).mean() / plain[..., :3].mean()) for name, result in found.items()}
    assert set(off) == {"ssao", "taa", "samples"}
    assert all(0 < by < 0.3 for by in off.values()), off
