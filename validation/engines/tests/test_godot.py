"""Check what integration/godot's guide says of shaders, colour, depth, focus, debug views and frames."""

from math import exp, radians, tan

import numpy as np
import pytest
from support import needed
from support_inputs import of_sample
from support_pages import SIZE, assert_debug_views, pixels

from bokeh_validation import browser
from engines import godot

pytestmark = of_sample("godot", of_code=True)


@pytest.fixture(scope="module")
def sample():
    """Open the sample, or skip the tests if it cannot run here."""
    with needed("Godot"), godot.opened() as opened:
        yield opened


def test_click_and_key(sample):
    """Check that a click focuses on the front of the box, a drag does not, and a key shows the CoC; without the node
    the scene is unchanged.
    """
    said = sample.call("interaction", None)
    assert said["points"] == [0, 1]
    assert 5.8 < said["focus"] < 6.5
    assert said["view"] == 2
    assert said["hidden"] and said["drawn"]
    # the rectangle that writes depth, and the node
    assert said["left"] == said["had"] - 2


def test_stretched_window(sample):
    """Check that the passes have the size of the image in a window that Godot stretches to three times its base."""
    assert sample.call("stretched", None) is True


@pytest.fixture(scope="module")
def scenes(sample):
    """Return colour, depth and CoC of the scene with each projection."""
    return sample.call("scenes", None)


@pytest.mark.parametrize("projection", ["perspective", "orthogonal"])
def test_color_and_depth(scenes, projection):
    """Check that the first pass reads what Godot drew: linear colour without the sRGB curve, and depth along a ray.

    Colour: the inverse of Godot's formula, by pow, which is exp2(2.4 log2(x)). log2 is off by 3 ULP, which is 3 *
    2^-21 for 16 > x > 1/32; times 2.4 it is 7.2 * 2^-21 = 3.4e-6, and with exp2's 3 + 2 * 10 ULP (2.8e-6) less than
    2^-17. The store as a half float adds 2^-11 (2^-10 on a device that truncates).
    Depth: 1 + unit / metres as a half float is off by 2^-11 of itself, or 2^-10 if truncated, so unit / metres is off
    by 2^-10 (1 + metres / unit). The depth buffer's 24 bits add 2^-24 * 160 for a near plane of 0.1 and 16 m.
    """
    actual = scenes[projection]
    scene, coc = (pixels(actual[name]).astype(np.float64) for name in ("scene", "coc"))
    expected = ((scene[..., :3] + 0.055) / 1.055) ** 2.4
    assert coc[..., :3].max() > 4.0
    assert (abs(coc[..., :3] / expected - 1.0) < 2.0**-10 + 2.0**-17).all()
    drawn = pixels(actual["depth"])[:, : SIZE[1] // 10].astype(np.float64)
    met = np.array(actual["met"]).reshape(drawn.shape)
    assert met.max() > 2 * met.min()
    assert (abs(drawn / met - 1.0) < 2.0**-10 * (1.0 + met / actual["unit"]) + 2.0**-16).all()


def test_debug_views(sample):
    """Check depth, circle of confusion, and near and far field against the definitions of section [9], in sRGB."""

    def linear(shown):
        value = shown.astype(np.float64)
        return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)

    assert_debug_views(sample.call("views", None), linear)


def test_off(sample):
    """Check that with a bokeh scale of 0 no pass draws, and that the scene's own colour is tone-mapped.

    The tone mapping is that of show.gdshader, with a white of 16. The shader's pow and the stores in half floats are
    off by less than 2^-9.
    """
    said = sample.call("unblurred", None)
    assert (said["drawing"], said["passes"], said["acts"]) == (0, 4, True)
    color, shown = (pixels(said[name])[..., :3].astype(float) for name in ("coc", "shown"))
    mapped = np.clip(color * (1.0 + color / 16.0**2) / (1.0 + color), 0.0, 1.0)
    expected = np.where(mapped < 0.0031308, 12.92 * mapped, 1.055 * mapped ** (1.0 / 2.4) - 0.055)
    assert abs(shown - expected).max() < 2.0**-9 and shown.max() > 0.9


def test_pull(sample):
    """Check that autofocus takes the nearest of its points and approaches it as in docs/lens.md.

    A step is one of float32; the reciprocal and the distance are each stored as a sum of two half floats, 2^-22.
    """
    said = sample.call("pull", None)
    metres = pixels(said["depth"])
    depths = [metres[int(v * SIZE[0]), int(u * SIZE[1])] for u, v in said["places"]]
    assert max(depths) > 1.5 * min(depths) > 3.0
    share = 1.0 - exp(-said["frame"] / said["seconds"])
    nearness, expected = 1.0 / said["before"], []
    for _ in said["distances"]:
        nearness += share * (1.0 / float(min(depths)) - nearness)
        expected.append(1.0 / nearness)
    assert len(expected) == 12 and expected[-1] > 1.5 * expected[0]
    assert said["distances"] == pytest.approx(expected, rel=12 * 2.0**-21)


def test_no_frame_late(sample):
    """Check that passes are drawn in order: the first frame after a change equals any later one."""
    said = sample.call("latency", None)
    before, first, later = (pixels(said[name]) for name in ("before", "first", "later"))
    assert abs(before.astype(float) - first).max() > 0.1
    np.testing.assert_array_equal(first, later)


def test_warnings(sample):
    """Check the editor's warnings for a node that is not a child of a camera, and for sides that paper lacks."""
    said = sample.call("warnings", None)
    assert said["right"] == []
    assert [any(word in text for text in said["wrong"]) for word in ("Camera3D", "6 or 8")] == [True, True]
    assert len(said["wrong"]) == 2


def test_compositor_script(sample):
    """Check that the effect for Forward+ and Mobile is a valid script; its passes are not drawn here."""
    with pytest.raises(browser.Refused, match=r"^WARNING: PolygonBokehEffect needs the Forward\+ or Mobile renderer\."):
        sample.call("compositor", None)
    said = sample.call("compositor", None)
    assert (said["read"], said["base"], said["class_title"]) == (True, "CompositorEffect", "PolygonBokehEffect")
    # after transparent surfaces, before glow and tone mapping
    assert (said["stage"], said["color"], said["depth"]) == (4, True, True)
    focal = 0.024 / 2.0 / tan(radians(25.0))
    assert said["parameters"][:4] == pytest.approx([focal / 2.8 * 10.0, focal, 5.0, 0.024], rel=1e-6)
    assert said["parameters"][6:] == pytest.approx(
        [-1.0, 0.0, 64.0, 48.0, 0.1, 6.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0], rel=1e-6
    )
