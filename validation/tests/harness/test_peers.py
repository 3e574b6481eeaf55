"""validation/run peers: each effect on a small picture."""

import numpy as np
import pytest
from support import needed

from bokeh_validation.truth import ray_traced
from bokeh_validation.truth.peers.effects import EFFECTS, FOUND, ONE_LIGHT, Page


@pytest.fixture(scope="module")
def page():
    """All effects in a browser."""
    with needed("Chromium, npm and cargo"):
        opened = Page(list(EFFECTS))
    with opened:
        yield opened


def sharpest(image: np.ndarray) -> float:
    """The largest step between neighbours in the blurred half."""
    return abs(np.diff(image[:, 208:], axis=1)).max()


@pytest.mark.parametrize("name", EFFECTS)
def test_effect(page, name):
    """Focus stays, the rest is blurred; a change of parameters leaves nothing behind."""
    # the lights of market_7, in focus on the left, far away on the right
    scene = ray_traced.MARKET
    color = ray_traced.picture(scene).color[100:356, 384:768, :3].astype(np.float32)
    depth = np.full(color.shape[:2], scene.camera.focus_distance, np.float32)
    depth[:, 192:] = 1000.0
    page.load(color, depth, scene.camera)
    used = [FOUND[place][name] for place in (scene.name, ONE_LIGHT, scene.name)]
    first, changed, again = (page.draw(name, parameters)[..., :3] for parameters in used)
    np.testing.assert_array_equal(first, again)
    assert abs(first - changed).max() > 0.1
    assert sharpest(first) < 0.5 * sharpest(color)
    # as far from the edge as no blur reaches, and near the axis: pmndrs focuses on a sphere
    assert abs(first[:, 96:160] - color[:, 96:160]).max() < 0.01 * color.max()


def test_parameters_that_were_found():
    """Every scene and the light have every effect's."""
    assert set(FOUND) == {scene.name for scene in ray_traced.SCENES} | {ONE_LIGHT}
    assert all(set(of_effects) == set(EFFECTS) for of_effects in FOUND.values())
