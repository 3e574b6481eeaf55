"""Check what the guides of three.js, Babylon.js and PlayCanvas say of depth, focus, debug views and effects."""

import numpy as np
import pytest
from support import needed
from support_inputs import samples
from support_pages import SIZE, assert_debug_views, assert_pulled, pixels

from bokeh_validation import browser
from engines import pages

# Sample -> number of cameras of `depths` in capture.js, and the fraction of rays that must agree; the rest may pass an
# outline. WebGPURenderer refuses a logarithmic buffer for perspective cameras: test_logarithmic_depth
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
    """Return (name, its open page) of a sample."""
    with needed(request.param), pages.opened(request.param) as opened:
        yield request.param, opened


def test_what_the_guide_says(sample):
    """Check interaction, depth and debug views.

    Interaction comes first, while the page is as the sample made it: a click focuses, a drag does not, a key shows the
    circle of confusion. Depth: the passes read the distance of the surface that a ray hits, or the far plane if it hits
    nothing, with every camera and buffer. Debug views follow BOKEH_DEBUG; alpha is the signed CoC.
    """
    (name, page), kind = sample, sample[0].partition("-")[2]
    answer = page.call("interaction", kind)
    assert_pulled(answer)
    # the pull to the distance before may still be changing the last bit; a click changes metres
    assert answer["dragged"] == pytest.approx(answer["before"], rel=1e-12)
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


@pytest.mark.parametrize(
    "sample", samples(name for name in CAMERAS if not name.startswith("threejs")), indirect=True
)  # three.js: test_web.py
def test_off(sample):
    """Check that with a bokeh scale of 0 no pass draws, that the next effect reads the scene, and that a larger scale
    turns the blur on again.
    """
    name, page = sample
    found = page.call("unblurred", name.partition("-")[2])
    task = {"task": True} if "babylonjs" in name else {}
    assert found == {"drawing": 0, "isScene": True, "comesBack": True, **task}


@pytest.mark.parametrize("sample", samples(["threejs-webgpu"]), indirect=True)
def test_logarithmic_depth(sample):
    """Check that WebGPU refuses a logarithmic buffer with a message. WebGL reads it; the other engines do not have
    one.
    """
    with pytest.raises(browser.Refused, match="PolygonBokehNode cannot read logarithmicDepthBuffer"):
        sample[1].call("logarithmic", "webgpu")


@pytest.mark.parametrize("sample", samples(["playcanvas-webgl", "playcanvas-webgpu"]), indirect=True)
def test_other_effects(sample):
    """Check that bloom, occlusion, TAA and multisampling change the image only by their own effect."""
    said = sample[1].call("effects", None)
    found = {name: pixels(one["result"], one["size"]).astype(float) for name, one in said.items()}
    assert all((result[..., 3] == 1).all() for result in found.values())
    plain = found.pop("none")
    assert plain.shape[:2] == SIZE
    assert found.pop("scale").shape[:2] == (SIZE[0] // 2, SIZE[1] // 2)
    np.testing.assert_array_equal(found.pop("bloom"), plain)
    assert [name for name, one in said.items() if one["blooms"]] == ["bloom"]
    # occlusion and multisampling need a prepass; otherwise depth comes from the scene pass
    assert {name for name, one in said.items() if one["prepass"]} == {"ssao", "samples"}
    # relative to the image's light; TAA changes most, since it dims lamps of a pixel or two before they are blurred
    off = {name: (np.abs(result - plain).mean() / plain[..., :3].mean()) for name, result in found.items()}
    assert set(off) == {"ssao", "taa", "samples"}
    assert all(0 < by < 0.3 for by in off.values()), off


@pytest.mark.parametrize("sample", samples(["playcanvas-webgl", "playcanvas-webgpu"]), indirect=True)
def test_splats(sample):
    """Check that Gaussian splats which write depth are in the depth that the blur uses."""
    said = sample[1].call("splats", None)
    wall, without, splats = said["found"]
    assert wall == without > 1.5 * said["distance"]
    assert splats == pytest.approx(said["distance"], rel=0.02)


@pytest.mark.parametrize(
    "sample", samples(name for name in CAMERAS if not name.startswith("threejs")), indirect=True
)  # three.js: test_web.py
def test_options(sample):
    """Check that extras act, that at neutral values they change nothing beyond rounding, and that invalid options give
    a message.
    """
    (name, page), kind = sample, sample[0].partition("-")[2]

    def shown(options, **uniforms):
        return page.call("shown", [kind, options, uniforms])

    assert 'preset is "high". Use one of "MEDIUM"' in shown({"preset": "high"})
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
