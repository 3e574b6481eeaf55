"""three.js, Babylon.js and PlayCanvas: what their guides say of depth, focus, debug views, effects is so."""

import numpy as np
import pytest
from support import needed
from support_inputs import samples
from support_pages import SIZE, assert_debug_views, assert_pulled, pixels

from bokeh_validation import browser
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


@pytest.fixture(scope="module", params=samples(CAMERAS))
def sample(request):
    """(name, its opened page)"""
    with needed(request.param), pages.opened(request.param) as opened:
        yield request.param, opened


def test_what_the_guide_says(sample):
    """The first call, while the page is as the sample made it: a click focuses, a drag does not (three.js), a key
    shows the circle of confusion.

    Then depth: what the passes read is what a ray meets, or the far plane where none does, with every camera and
    buffer. Debug views as BOKEH_DEBUG has them; alpha is the signed CoC.
    """
    (name, page), kind = sample, sample[0].partition("-")[2]
    answer = page.call("interaction", kind)
    assert_pulled(answer)
    assert answer.get("dragged", answer["before"]) == answer["before"]
    assert "coc" in answer["passes"][1] and len(answer["passes"]) == 2 if "babylonjs" in name else answer["mode"] == 2
    cases = page.call("depths", kind)
    assert len(cases) == CAMERAS[name][0]
    for case in cases:
        drawn, met = np.array(case["drawn"]), np.array(case["met"])
        hit = met != case.get("maxZ")
        assert hit.sum() > 100 and ("maxZ" not in case or (~hit).sum() > 50), case["name"]
        assert np.mean(np.abs(drawn - met) <= 1e-3 * met) >= CAMERAS[name][1], case["name"]
        if "nearer" in case:
            assert np.mean((met < case["focus"]) == case["nearer"]) >= CAMERAS[name][1], case["name"]
    assert_debug_views(page.call("views", kind))


@pytest.mark.parametrize("sample", samples(["threejs-webgpu"]), indirect=True)
def test_logarithmic_depth(sample):
    """WebGPU: refused, and told why. WebGL reads it; the other engines have no such buffer."""
    with pytest.raises(browser.Refused, match="PolygonBokehNode cannot read logarithmicDepthBuffer"):
        sample[1].call("logarithmic", "webgpu")


@pytest.mark.parametrize("sample", samples(["playcanvas-webgl", "playcanvas-webgpu"]), indirect=True)
def test_other_effects(sample):
    """With bloom, occlusion, TAA and several samples a pixel it is the same picture, but for what those change."""
    said = sample[1].call("effects", None)
    found = {name: pixels(one["result"], one["size"]).astype(float) for name, one in said.items()}
    assert all((result[..., 3] == 1).all() for result in found.values())
    plain = found.pop("none")
    assert plain.shape[:2] == SIZE
    assert found.pop("scale").shape[:2] == (SIZE[0] // 2, SIZE[1] // 2)
    np.testing.assert_array_equal(found.pop("bloom"), plain)
    assert [name for name, one in said.items() if one["blooms"]] == ["bloom"]
    # occlusion of the light and multisampling need a prepass; else depth comes from the scene pass
    assert {name for name, one in said.items() if one["prepass"]} == {"ssao", "samples"}
    # of the picture's light; the most by TAA, which dims lamps of a pixel or two before they are blurred
    off = {name: (np.abs(result - plain).mean() / plain[..., :3].mean()) for name, result in found.items()}
    assert set(off) == {"ssao", "taa", "samples"}
    assert all(0 < by < 0.3 for by in off.values()), off


@pytest.mark.parametrize("sample", samples(["playcanvas-webgl", "playcanvas-webgpu"]), indirect=True)
def test_splats(sample):
    """Gaussian splats that write depth are in the depth that is blurred by."""
    said = sample[1].call("splats", None)
    wall, without, splats = said["found"]
    assert wall == without > 1.5 * said["distance"]
    assert splats == pytest.approx(said["distance"], rel=0.02)


@pytest.mark.parametrize(
    "sample", samples(name for name in CAMERAS if not name.startswith("threejs")), indirect=True
)  # three.js: test_web.py
def test_options(sample):
    """Extras act, and at their neutral values change nothing but by rounding; what no option can be is said."""
    (name, page), kind = sample, sample[0].partition("-")[2]

    def shown(options, **uniforms):
        return page.call("shown", [kind, options, uniforms])

    assert 'preset is "high". Give "MEDIUM"' in shown({"preset": "high"})
    for options, extra, neutral, acting in (
        ({"method": "exact", "preset": "LOW"}, "jitter", {"jitter": 0}, {"jitter": 1}),
        ({}, "catsEye", {"catsEye": 0}, {"catsEye": 0.8}),
        ({}, "lateral", {"lateral": 0}, {"lateral": 0.02}),
        ({}, "focusRange", {}, {"backRange": 8}),
    ):
        plain, still, changed = (
            pixels(shown(given, **uniforms), (72, 96)).astype(float)
            for given, uniforms in (
                (options, {}),
                (options | {"extras": [extra]}, neutral),
                (options | {"extras": [extra]}, acting),
            )
        )
        assert np.allclose(still, plain, atol=0.02, rtol=0.01), f"{name}, {extra}"
        assert not np.allclose(changed, plain, atol=0.02, rtol=0.01), f"{name}, {extra}"
