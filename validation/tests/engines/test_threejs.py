"""integration/threejs: what its guide says of depth, focus and debug views is so."""

import numpy as np
import pytest
from support import needed
from support_pages import assert_debug_views, assert_pulled, pixels

from bokeh_validation.engines import pages


@pytest.fixture(scope="module", params=["webgl", "webgpu"])
def kind(request) -> str:
    return request.param


@pytest.fixture(scope="module")
def sample(kind):
    with needed("three.js"), pages.opened(f"threejs-{kind}") as opened:
        yield opened


def test_click_and_key(sample, kind):
    """The first call, while the page is as the sample made it: a click focuses, a key shows the circle of confusion."""
    said = sample.call("interaction", kind)
    assert_pulled(said)
    assert said["mode"] == 2


def test_depth_of_every_camera(sample, kind):
    """Perspective and orthographic, usual, reversed and logarithmic: what the passes read is what a ray meets."""
    cases = sample.call("depths", kind)
    # the logarithmic buffer of WebGPURenderer is refused for perspective cameras: see the test below
    assert len(cases) == (6 if kind == "webgl" else 5)
    for case in cases:
        drawn, met = np.array(case["drawn"]), np.array(case["met"])
        assert len(drawn) > 500
        # the rest is at outlines, where the ray may pass by
        assert (abs(drawn - met) < 1e-3 * met).mean() > 0.98, case["name"]


def test_logarithmic_depth(sample, kind):
    """WebGL: the same depth, and with it the same CoC, as from the usual buffer. WebGPU: refused, and told why.

    Colours are the same to the bit: where things are drawn does not depend on what is stored as depth. No later pass
    reads the buffer, so the CoC stands for all of them. In units of 2^-24, relative, depth z may be off by

      * usual: 8 z / near. dz / dd = z^2 / near, and d is near 1: six roundings up to its store, two in the formula
      * logarithmic: (9 + 16 x)(1 + z) / z with x = log2(1 + z). Of 1 + z: 3 of interpolation, 6 + 4 x of exp2 (3 + 2 x
        ULP), ln(2) times two log2 of 3 ULP (12 x) and four roundings (4 x)

    and the CoC by what Listing 1 makes of that, A f S1 / (z (S1 - f)), and by a step of a half float.
    """
    said = sample.call("logarithmic", kind)
    if kind == "webgpu":
        assert any("PolygonBokehNode cannot read logarithmicDepthBuffer" in words for words in said["said"]), said
        return
    assert said["said"] == []
    usual, logarithmic = (
        {
            "color": pixels(frame["color"]),
            "depth": pixels(frame["depth"]).astype(np.float64),
            "coc": pixels(frame["result"])[..., 3],
        }
        for frame in said["frames"]
    )
    np.testing.assert_array_equal(logarithmic["color"], usual["color"])
    z, lens = usual["depth"], said["camera"]
    assert z.max() > 5 * z.min()
    allowed = 2.0**-24 * (8 * z / said["near"] + (9 + 16 * np.log2(1 + z)) * (1 + z) / z)
    off = np.abs(logarithmic["depth"] / z - 1)
    assert (off <= allowed).all(), (off / allowed).max()
    focus, focal = lens["focus_distance"], lens["focal_length"]
    slope = lens["aperture_diameter"] * focal * focus / (z * (focus - focal)) / lens["sensor_height"]
    coc = usual["coc"].astype(np.float64)
    assert abs(coc).max() > 0.05
    step = np.spacing(np.maximum(abs(usual["coc"]), abs(logarithmic["coc"]))).astype(np.float64)
    assert (np.abs(logarithmic["coc"] - coc) <= slope * allowed + step).all()


def test_debug_views(sample, kind):
    """Depth, circle of confusion, near and far field, as section [9] has them; alpha is the signed CoC."""
    assert_debug_views(sample.call("views", kind))
