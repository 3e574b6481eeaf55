"""Test validation/run peers: each effect on a small image, the search for parameters, and times."""

import hashlib
import json
from dataclasses import replace

import numpy as np
import pytest
from support import called, needed, refused

from bokeh_validation import paths
from bokeh_validation.truth import ray_traced
from lab import other_effects
from lab.other_effects import effects, timing
from lab.other_effects.effects import EFFECTS, FOUND, ONE_LIGHT, Page
from lab.rasterised import motion


@pytest.fixture(scope="module")
def page():
    """Open all effects in a browser."""
    with needed("Chromium, npm and cargo"):
        opened = Page(list(EFFECTS))
    with opened:
        yield opened


def sharpest(image: np.ndarray) -> float:
    """Return the largest step between neighbours in the blurred half."""
    return abs(np.diff(image[:, 208:], axis=1)).max()


@pytest.mark.parametrize("name", EFFECTS)
def test_effect(page, name):
    """Check that the focused half stays sharp, the rest is blurred, and a change of parameters leaves no trace."""
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
    # so far from the edge that no blur reaches it, and near the axis, since pmndrs focuses on a sphere
    assert abs(first[:, 96:160] - color[:, 96:160]).max() < 0.01 * color.max()


def test_parameters_that_were_found():
    """Check that every scene and the light have parameters of every effect."""
    assert set(FOUND) == {scene.name for scene in ray_traced.SCENES} | {ONE_LIGHT}
    assert all(set(of_effects) == set(EFFECTS) for of_effects in FOUND.values())


def test_motion(monkeypatch):
    """Draw an effect in two frames of a small sequence, and check its row of the table."""
    monkeypatch.setattr(motion, "SIZE", (192, 108))
    monkeypatch.setattr(motion, "FRAMES", 2)
    monkeypatch.setattr(other_effects, "search", lambda page, key, start, lens: start)
    with needed("Chromium, npm and cargo"):
        (row,) = other_effects.in_motion(["BokehPass"], "focus")
    assert row["label"].startswith("three.js BokehPass") and 0.0 < row["change"][0] < 20.0
    assert motion.table([row])[2].startswith("| three.js BokehPass")


class Planted:
    """Replace a page: its image equals the truth at planted parameters, and gets worse with their distance."""

    planted = {"focusRange": 5.0, "bokehScale": 1.6, "resolutionScale": 1.0}

    def draw(self, effect: str, parameters: dict) -> np.ndarray:
        """Return an image that shows the distance from the planted parameters."""
        assert effect == "DepthOfFieldEffect" and parameters["focusDistance"] == 5.0
        distance = sum(abs(np.log(parameters[name] / value)) for name, value in self.planted.items())
        return np.tile(np.linspace(0.1, 0.9, 32)[:, None], (32, 1, 4)) + 0.1 * distance


def test_search():
    """Check that the search finds the lowest FLIP by halves and doubles, then by steps of 0.8, and by an option."""
    lens = other_effects.reduced(Planted().draw("DepthOfFieldEffect", Planted.planted | {"focusDistance": 5.0}))
    start = {"focusDistance": 5.0, "focusRange": 1.0, "bokehScale": 2.0, "resolutionScale": 0.5}
    found = other_effects.search(Planted(), "DepthOfFieldEffect", start, lens)
    assert found == pytest.approx(Planted.planted | {"focusDistance": 5.0})
    for scene in ray_traced.SCENES:
        documented = effects.documented(scene.camera, (270, 480))
        assert {name: set(of_effect) for name, of_effect in documented.items()} == {
            name: set(of_effect) for name, of_effect in FOUND[scene.name].items()
        }


def test_times(monkeypatch, tmp_path):
    """Time every effect and method once on a small image, and check the table and the JSON.

    No ratio of times is judged: on so small an image, other work on the machine decides it.
    """
    scene = ray_traced.picture(ray_traced.MARKET)
    small = replace(scene, color=scene.color[::15, ::15], depth=scene.depth[::15, ::15])
    monkeypatch.setattr(ray_traced, "picture", lambda _: small)
    monkeypatch.setattr(timing, "ROUNDS", 1)
    with needed("Chromium and npm"):
        Page([]).close()
    done = called("peers", "--time", "--json", tmp_path / "times.json")
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "times.json").read_text(encoding="utf-8"))
    assert (found["scene"], found["size"], found["rounds"]) == ("market_7", [64, 36], 1)
    assert found["device"] in done.stdout and "market_7 at 64 x 36" in done.stdout
    others = [effects.title(name) for name in EFFECTS if not name.startswith("Bevy")]
    assert [row["label"] for row in found["rows"]] == [*others, *timing.OURS]
    for row in found["rows"]:
        low, high = row["quartiles"]
        assert min(row["ms"], row["without"]) > 0.0 and low <= row["ratio"] <= high
        assert f"| {row['label']} |" in done.stdout


def test_summary_of_times():
    """Check that the frame without the effect is taken off, that each round has its own ratio, and the least time."""
    times = np.array([[[1, 11], [2, 7]], [[1, 21], [2, 42]], [[1, 11], [2, 1]]], float)
    base, other = timing.summary([timing.BASE, "layered low"], times)
    assert (base["ms"], base["without"], base["ratio"], base["quartiles"]) == (10.0, 1.0, 1.0, [1.0, 1.0])
    assert (other["label"], other["ms"], other["without"]) == ("layered low", 5.0, 2.0)
    # 5 / 10, 40 / 20, and what the clock can tell over 10
    assert other["ratio"] == 0.5 and other["quartiles"] == [0.255, 1.25]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ("--time --effect BevyBokeh", ["--effect BevyBokeh", "BokehPass"]),
        ("--time --motion pan", ["--time", "--motion"]),
        ("--time --scene market_7 --scene street_11", ["--time", "one scene"]),
        ("--json times.json", ["--json", "--time"]),
    ],
)
def test_refused(options, words):
    """Check that --time refuses what it cannot time, and that --json needs it."""
    refused(called("peers", *options.split()), words)


def digests() -> dict[str, str]:
    """Return 'scene, effect' -> hash of the parameters with which the effect was measured."""
    hashes = {}
    for scene, found in FOUND.items():
        for effect, parameters in found.items():
            text = json.dumps(parameters, sort_keys=True)
            hashes[f"{scene}, {effect}"] = hashlib.sha256(text.encode()).hexdigest()[:16]
    return hashes


def test_effects_have_the_parameters_that_were_measured():
    """Check that found.json is unchanged: a changed parameter requires a new measurement, and then a new digest."""
    assert json.loads((paths.ROOT / "docs/data/peers.json").read_bytes())["parameters"] == digests()
