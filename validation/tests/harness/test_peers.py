"""validation/run peers: one effect end to end on a small picture, and what is measured, on what is known."""

import numpy as np
import pytest
from support import needed

from bokeh_validation.frame.methods import Camera
from bokeh_validation.probes.model import overlap
from bokeh_validation.truth import ray_traced
from bokeh_validation.truth.peers import Peers, counted, crate, effects, measured, peers_command
from bokeh_validation.truth.peers.effects import EFFECTS

CAMERA = Camera(0.1, 0.05, 2.0, 0.024, 0.15)


@pytest.fixture(scope="module")
def page():
    """All effects in a browser."""
    with needed("Chromium and npm"):
        opened = Peers()
    yield opened
    opened.close()


def loaded(page) -> np.ndarray:
    """The lights of market_7, in focus on the left, far away on the right."""
    color = ray_traced.picture(ray_traced.MARKET).color[200:264, 560:656]
    depth = np.full(color.shape[:2], CAMERA.focus_distance, np.float32)
    depth[:, 48:] = 1000.0
    page.load(color, depth, CAMERA)
    return color


def test_one_effect(page):
    """BokehPass: what is in focus stays as it is, what is not is blurred, at the fetches of its text."""
    color = loaded(page)
    # the scene reaches the engine to the bit
    np.testing.assert_array_equal(page.draw("input", {})[..., :3], color[..., :3])
    documented, *others = page.grid("BokehPass")
    assert len(others) == 11
    drawn = page.draw("BokehPass", documented).astype(float)
    # 41 taps at one place but for the rounding of packed depth, summed in float32, stored as a half: two steps of it
    focused = color[..., :3].astype(float)
    assert (abs(drawn[:, :48, :3] - focused[:, :48]) <= 2.0**-9 * focused[:, :48] + 1e-6).all()
    assert abs(drawn[:, 48:, :3] - focused[:, 48:]).max() > 1.0
    assert counted.fetches(page.draws("BokehPass", documented)) == 42  # 41 of colour, 1 of depth
    assert len(page.time({"BokehPass": documented}, 2)[0]) == 2
    assert set(page.versions()) == {effect.package for effect in EFFECTS.values()}


@pytest.mark.parametrize("name", [name for name, effect in EFFECTS.items() if effect.package != crate.NAME])
def test_parameters_arrive(page, name):
    """Others change the picture, and nothing of them is left when the first come back."""
    color = loaded(page)
    first, *_, last = page.grid(name)
    drawn = [page.draw(name, parameters)[..., :3] for parameters in (first, last, first)]
    np.testing.assert_array_equal(drawn[0], drawn[2])
    assert abs(drawn[0].astype(float) - drawn[1]).max() > 0.1
    # no effect blurs what is in focus, as far from the edge as no blur reaches
    assert abs(drawn[0][:, :24].astype(float) - color[:, :24, :3]).max() < 0.01 * color.max()


def test_light_of_the_lens(page):
    """One light far away: over the places of the taps, the farthest at the radius of the circle of confusion."""
    color = np.zeros((65, 65, 4), np.float16)
    color[32, 32] = 1000.0
    page.load(color, np.full((65, 65), 1e5, np.float32), CAMERA)
    drawn = page.draw("BokehPass", page.grid("BokehPass")[0])[..., 0].astype(float)
    radius = 0.5 * 65 * 0.1 * 0.05 / (1.95 * 0.024)
    y, x = np.nonzero(drawn)
    # a tap is at most at the rim, its bilinear footprint reaches a pixel further
    assert radius - 1.5 < np.hypot(y - 32, x - 32).max() < radius + 1.5
    # each of 41 taps, where the filter has it whole
    assert drawn.sum() == pytest.approx(1000.0, rel=0.01)


def test_bevy(page):
    """Its shader with the imports put in: a light far away keeps what it has, inside the circle of confusion."""
    with needed("cargo"):
        crate.source()
    color = np.zeros((65, 65, 4), np.float16)
    color[32, 32] = 1000.0
    page.load(color, np.full((65, 65), 1e5, np.float32), CAMERA)
    asked = page.documented("BevyBokeh")
    drawn = page.draw("BevyBokeh", asked)[..., 0].astype(float)
    # lines of whole pixels from the light on: a half float's rounding, twice
    assert drawn.sum() == pytest.approx(1000.0, rel=0.01)
    y, x = np.nonzero(drawn)
    radius = 0.5 * 65 * 0.1 * 0.05 / (1.95 * 0.024)
    assert np.hypot(y - 32, x - 32).max() < radius + 2.0
    # two passes: depth, and two lines of 32 pixels and the one that they begin at
    assert counted.of_bevy("BevyBokeh", asked["maxDiameter"]) == 2 * (1 + 2 * 33)


def test_fetches_of_a_text():
    """Loops as often as they turn, the larger branch, functions where they are called."""
    text = """#version 300 es
precision highp float;
#define N 4
uniform sampler2D a; in vec2 uv; out vec4 found;
vec4 twice(vec2 p) { return texture(a, p) + textureLod(a, p, 0.0); }
vec4 never(vec2 p) { return texture(a, p); }
void main()
{
    found = vec4(0.0);
    for (int i = 0; i < N; i++) { for (int j = 1; j <= 3; ++j) found += twice(uv); }
    if (texture(a, uv).r > 0.5) found += twice(uv); else if (uv.x > 0.0) found += texture(a, uv);
}
"""
    assert counted.of_text(text) == 4 * 3 * 2 + 1 + 2
    draws = [{"text": text, "share": 0.25}, {"text": text + "// peerLight", "share": 1}]
    assert counted.fetches(draws) == 27 / 4
    with pytest.raises(ValueError, match="not counted"):
        counted.of_text(text.replace("i < N", "i < int(uv.x)"))


def test_measures():
    """A shape and itself, and moved by half of its width; a table of what was measured."""
    square = np.zeros((8, 8))
    square[:, 2:6] = 1.0
    assert overlap(square, square) == 1.0
    assert overlap(square, np.roll(square, 2, axis=1)) == pytest.approx(1 / 3)
    row = measured.Drawn("market_7", "Babylon", {"fStop": 1.0}, 0.4, 20.0, 1.0, 23.2)
    shape = {"Babylon": measured.Shape({"fStop": 2.0}, 0.5, 1.0)}
    lines = peers_command.markdown([row], shape, {"Babylon": 7.0}, {"@babylonjs/core": "9"})
    assert lines[2] == "| Babylon.js DepthOfFieldEffect 9 | 23 | 7 | 0.50/1.00 | 0.4000/20.00/1.000 |"
    used = peers_command.parameters([row], shape)
    assert used == {"market_7": {"Babylon": {"fStop": 1.0}}, "one light": {"Babylon": {"fStop": 2.0}}}


def test_found():
    """Every effect has parameters for every scene, and no others than those of its grid."""
    found = effects.found()
    assert set(found) == {one.name for one in ray_traced.SCENES} | {effects.ONE_LIGHT}
    for place, chosen in found.items():
        assert set(chosen) == set(EFFECTS), place
        for name, parameters in chosen.items():
            assert {*EFFECTS[name].factors, *EFFECTS[name].choices} <= set(parameters), (place, name)


def test_search():
    """From the best of a grid on, in steps, as long as it gets better; from there what is found is the best."""

    def off(parameters):
        return abs(parameters["a"] - 3.0) + abs(parameters["b"] - 0.5)

    best = measured.climbed(off, {"a": 1.0, "b": 1.0, "c": 7.0}, 2.5, ("a", "b"))
    assert best["c"] == 7.0
    for name in ("a", "b"):
        for factor in (measured.STEP, 1 / measured.STEP):
            assert off({**best, name: best[name] * factor}) >= off(best)
    # within a step of the optimum
    assert abs(np.log(best["a"] / 3.0)) < -np.log(measured.STEP)
    assert abs(np.log(best["b"] / 0.5)) < -np.log(measured.STEP)
