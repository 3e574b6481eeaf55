"""integration/godot: what its guide says of shaders, colour, depth, focus, debug views and frames is so."""

from math import exp, radians, tan

import numpy as np
import pytest
from support import needed
from support_inputs import of_sample
from support_pages import SIZE, assert_debug_views, pixels

from bokeh_validation import browser
from bokeh_validation.engines import godot

pytestmark = of_sample("godot")


@pytest.fixture(scope="module")
def sample():
    with needed("Godot"), godot.opened() as opened:
        yield opened


def test_click_and_key(sample):
    """A click focuses on the front of the box, a key shows the CoC; without the node all is as it was."""
    said = sample.call("interaction", None)
    assert 5.8 < said["focus"] < 6.5
    assert said["view"] == 2
    assert said["hidden"] and said["drawn"]
    # the rectangle that writes depth, and the node
    assert said["left"] == said["had"] - 2


@pytest.fixture(scope="module")
def scenes(sample):
    return sample.call("scenes", None)


@pytest.mark.parametrize("projection", ["perspective", "orthogonal"])
def test_color_and_depth(scenes, projection):
    """What the first pass reads is what Godot drew: colour without its sRGB, and what a ray meets.

    Colour: Godot's own formula the other way round, by pow, which is exp2(2.4 log2(x)): log2 is off by 3 ULP, which for
    16 > x > 1/32 is 3 * 2^-21, times 2.4 is 7.2 * 2^-21 = 3.4e-6, with exp2's 3 + 2 * 10 ULP (2.8e-6) less than 2^-17;
    and the store as a half float, 2^-11 (2^-10 where a device cuts off).
    Depth: 1 + unit / metres as a half float, off by 2^-11 of itself, 2^-10 where it is cut off, so unit / metres by
    2^-10 (1 + metres / unit); and the depth buffer's 24 bits, with a near plane of 0.1 and 16 m 2^-24 * 160.
    """
    found = scenes[projection]
    scene, coc = (pixels(found[name]).astype(np.float64) for name in ("scene", "coc"))
    wanted = ((scene[..., :3] + 0.055) / 1.055) ** 2.4
    assert coc[..., :3].max() > 4.0
    assert (abs(coc[..., :3] / wanted - 1.0) < 2.0**-10 + 2.0**-17).all()
    drawn = pixels(found["depth"])[:, : SIZE[1] // 10].astype(np.float64)
    met = np.array(found["met"]).reshape(drawn.shape)
    assert met.max() > 2 * met.min()
    assert (abs(drawn / met - 1.0) < 2.0**-10 * (1.0 + met / found["unit"]) + 2.0**-16).all()


def test_debug_views(sample):
    """Depth, circle of confusion, near and far field, as section [9] has them, in sRGB."""

    def linear(shown):
        value = shown.astype(np.float64)
        return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)

    assert_debug_views(sample.call("views", None), linear)


def test_pull(sample):
    """Autofocus takes the nearest of its points, and goes there by docs/lens.md.

    A step is that of float32; the reciprocal and the distance are each kept as a sum of two half floats, 2^-22.
    """
    said = sample.call("pull", None)
    metres = pixels(said["depth"])
    depths = [metres[int(v * SIZE[0]), int(u * SIZE[1])] for u, v in said["places"]]
    assert max(depths) > 1.5 * min(depths) > 3.0
    share = 1.0 - exp(-said["frame"] / said["seconds"])
    nearness, wanted = 1.0 / said["before"], []
    for _ in said["distances"]:
        nearness += share * (1.0 / float(min(depths)) - nearness)
        wanted.append(1.0 / nearness)
    assert len(wanted) == 12 and wanted[-1] > 1.5 * wanted[0]
    assert said["distances"] == pytest.approx(wanted, rel=12 * 2.0**-21)


def test_no_frame_late(sample):
    """All passes are drawn in their order: the first frame after a change is as any later one."""
    said = sample.call("latency", None)
    before, first, later = (pixels(said[name]) for name in ("before", "first", "later"))
    assert abs(before.astype(float) - first).max() > 0.1
    np.testing.assert_array_equal(first, later)


def test_warnings(sample):
    """A node that is no camera's child, or has sides that paper lacks, says so in the editor."""
    said = sample.call("warnings", None)
    assert said["right"] == []
    assert [any(word in text for text in said["wrong"]) for word in ("Camera3D", "6 or 8")] == [True, True]
    assert len(said["wrong"]) == 2


def test_compositor_script(sample):
    """The effect for Forward+ and Mobile is a script without an error; its passes are drawn nowhere here."""
    with pytest.raises(browser.Refused, match=r"^WARNING: PolygonBokehEffect needs the Forward\+ or Mobile renderer;"):
        sample.call("compositor", None)
    said = sample.call("compositor", None)
    assert (said["read"], said["base"], said["class_title"]) == (True, "CompositorEffect", "PolygonBokehEffect")
    # after transparent surfaces, before glow and tone mapping
    assert (said["stage"], said["color"], said["depth"]) == (4, True, True)
    focal = 0.024 / 2.0 / tan(radians(25.0))
    assert said["parameters"][:4] == pytest.approx([focal / 2.8 * 10.0, focal, 5.0, 0.024], rel=1e-6)
    assert said["parameters"][6:] == pytest.approx([-1.0, 0.0, 64.0, 48.0, 0.1, 6.0, 0.0, 1.0, 0.0, 0.0], rel=1e-6)
