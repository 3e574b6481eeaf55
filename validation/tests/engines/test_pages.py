"""three.js, Babylon.js and PlayCanvas: what their guides say of depth, focus, debug views, effects is so."""

import numpy as np
import pytest
from support import needed
from support_pages import SIZE, assert_debug_views, assert_pulled, pixels

from bokeh_validation.engines import pages

# Cameras of `depths` in capture.js, and the share of the rays that must agree: the rest is at outlines, where a ray may
# pass by. WebGPURenderer's logarithmic buffer is refused for perspective cameras: test_logarithmic_depth
CAMERAS = {
    "threejs-webgl": (6, 0.98),
    "threejs-webgpu": (5, 0.98),
    "babylonjs-webgl": (3, 0.97),
    "babylonjs-webgpu": (3, 0.97),
    "playcanvas-webgl": (2, 1.0),
    "playcanvas-webgpu": (2, 1.0),
}


@pytest.fixture(scope="module", params=CAMERAS)
def sample(request):
    """(name, its opened page)"""
    with needed(request.param), pages.opened(request.param) as opened:
        yield request.param, opened


def test_what_the_guide_says(sample):
    """The first call, while the page is as the sample made it: a click focuses, a key shows the circle of confusion.

    Then depth: what the passes read is what a ray meets, or the far plane where none does, with every camera and
    buffer. Debug views as section [9] has them; alpha is the signed CoC.
    """
    (name, page), kind = sample, sample[0].partition("-")[2]
    answer = page.call("interaction", kind)
    assert_pulled(answer)
    assert "BokehDebugCoC" in answer["passes"][1] if "babylonjs" in name else answer["mode"] == 2
    cases = page.call("depths", kind)
    assert len(cases) == CAMERAS[name][0]
    for case in cases:
        drawn, met = np.array(case["drawn"]), np.array(case["met"])
        hit = met != case.get("maxZ")
        assert hit.sum() > 100 and ("maxZ" not in case or (~hit).sum() > 50), case["name"]
        assert np.mean(np.abs(drawn - met) <= 1e-3 * met) >= CAMERAS[name][1], case["name"]
    assert_debug_views(page.call("views", kind))


def test_logarithmic_depth(sample):
    """WebGL: the same depth, and with it the same CoC, as from the usual buffer. WebGPU: refused, and told why.

    Colours are the same to the bit: where things are drawn does not depend on what is stored as depth. No later pass
    reads the buffer, so the CoC stands for all of them. In units of 2^-24, relative, depth z may be off by

      * usual: 8 z / near. dz / dd = z^2 / near, and d is near 1: six roundings up to its store, two in the formula
      * logarithmic: (9 + 16 x)(1 + z) / z with x = log2(1 + z). Of 1 + z: 3 of interpolation, 6 + 4 x of exp2 (3 + 2 x
        ULP), ln(2) times two log2 of 3 ULP (12 x) and four roundings (4 x)

    and the CoC by what Listing 1 makes of that, A f S1 / (z (S1 - f)), and by a step of a half float.
    """
    name, page = sample
    if "threejs" not in name:
        pytest.skip("three.js alone has such a buffer")
    said = page.call("logarithmic", name.partition("-")[2])
    if name.endswith("webgpu"):
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


def test_other_effects(sample):
    """With bloom, occlusion, TAA and several samples a pixel it is the same picture, but for what those change."""
    name, page = sample
    if "playcanvas" not in name:
        pytest.skip("the guide of PlayCanvas alone says so")
    said = page.call("effects", None)
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
