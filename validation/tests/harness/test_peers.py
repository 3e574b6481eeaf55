"""validation/run peers: each effect on a small picture, and its measures on known pictures."""

import numpy as np
import pytest
from support import needed

from bokeh_validation.frame.methods import Camera
from bokeh_validation.truth import ray_traced
from bokeh_validation.truth.peers import counted, crate, effects
from bokeh_validation.truth.peers.effects import EFFECTS

CAMERA = Camera(0.1, 0.05, 2.0, 0.024, 0.15)


@pytest.fixture(scope="module")
def page():
    """All effects in a browser."""
    with needed("Chromium, npm and cargo"):
        crate.source()
        opened = effects.Page()
    with opened:
        yield opened


def sharpest(image: np.ndarray) -> float:
    """The largest step between neighbours in the blurred half."""
    return abs(np.diff(image[:, 60:].astype(float), axis=1)).max()


@pytest.mark.parametrize("name", EFFECTS)
def test_effect(page, name):
    """The scene arrives to the bit. Focus stays, the rest is blurred; a change of parameters leaves nothing behind."""
    # the lights of market_7, in focus on the left, far away on the right
    color = ray_traced.picture(ray_traced.MARKET).color[200:264, 560:656]
    depth = np.full(color.shape[:2], CAMERA.focus_distance, np.float32)
    depth[:, 48:] = 1000.0
    page.load(color, depth, CAMERA)
    np.testing.assert_array_equal(page.draw("input", {})[..., :3], color[..., :3])
    documented = page.documented(name)
    other = documented | {number: documented[number] * 0.5 for number in EFFECTS[name].numbers}
    other |= {option: values[-1] for option, values in EFFECTS[name].options.items()}
    first, changed, again = (page.draw(name, used)[..., :3] for used in (documented, other, documented))
    np.testing.assert_array_equal(first, again)
    assert abs(first.astype(float) - changed).max() > 0.1
    assert sharpest(first) < 0.5 * sharpest(color[..., :3])
    # as far from the edge as no blur reaches
    assert abs(first[:, :24].astype(float) - color[:, :24, :3]).max() < 0.01 * color.max()
    if name == "BokehPass":
        assert counted.fetches(page.draws(name, documented)) == 42  # 41 of colour, 1 of depth


@pytest.mark.parametrize("name", ["BokehPass", "BevyBokeh"])
def test_light_of_the_lens(page, name):
    """One light far away keeps what it has, within the circle of confusion: its lens is the scene's."""
    color = np.zeros((65, 65, 4), np.float16)
    color[32, 32] = 1000.0
    page.load(color, np.full((65, 65), 1e5, np.float32), CAMERA)
    drawn = page.draw(name, page.documented(name))[..., 0].astype(float)
    radius = 0.5 * 65 * 0.1 * 0.05 / (1.95 * 0.024)
    y, x = np.nonzero(drawn)
    # a tap is at most at the rim, its bilinear footprint reaches a pixel further
    assert radius - 2.0 < np.hypot(y - 32, x - 32).max() < radius + 2.0
    assert drawn.sum() == pytest.approx(1000.0, rel=0.01)


def test_parameters_that_were_found():
    """Every scene and the light have all of every effect's."""
    chosen = effects.parameters()
    assert set(chosen) == {scene.name for scene in ray_traced.SCENES} | {effects.ONE_LIGHT}
    for place, of_effects in chosen.items():
        for name, effect in EFFECTS.items():
            assert {*effect.numbers, *effect.options} <= set(of_effects[name]), (place, name)
