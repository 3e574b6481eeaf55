"""Layered against ray-traced truth, and the command that measures it."""

import json
from functools import cache

import pytest
from support import called, load, needed

from bokeh_validation import paths, truth
from bokeh_validation.errors import Unavailable
from bokeh_validation.probes import outcomes
from bokeh_validation.run.validate import market
from bokeh_validation.truth import ray_traced

SCENES = {scene.name: scene for scene in ray_traced.SCENES}
# FLIP of MEDIUM at most: below every other method of docs/results.md
BOUNDS = {"street_11": 0.042, "canopy_12": 0.139, "street_11x3": 0.105, "canopy_12x3": 0.270, "market_7": 0.181}
# What `validation/run truth --json` wrote, and how far FLIP may be from it: on one Mesa it repeats exactly, the rest is
# for another. It sees constants that act on these scenes, changed in all three languages and with expected pictures
# written anew (sigma .0375 to .06: market_7 .0104 off). It does not see the far layer's ramp (10 to 14 in place of 16:
# .0001 off), which test_expected.py and constants.txt hold.
RECORDED = {
    (row["scene"], row["label"]): row
    for row in json.loads((paths.ROOT / "docs/data/truth.json").read_text(encoding="utf-8"))["rows"]
}
SAME = 0.0005
BRANCHES = ("canopy_12x3",)
# The octagon against its truth: so near to what the hexagon has
OCTAGON_OFF = 0.006


@cache
def flip(name: str, label: str, aperture: str = "hexagon", **changes) -> float:
    """On OSMesa, half-float targets."""
    image = truth.picture(load("osmesa"), SCENES[name], label, aperture, **changes)
    return truth.measured(image, ray_traced.truth(SCENES[name], aperture))["flip"]


@pytest.mark.parametrize("name", SCENES)
def test_layered(name, request):
    """MEDIUM within its bound and as recorded, one set of parameters for all scenes.

    LOW is nearer than exact everywhere but among wide branches, where exact's lines keep each to its own blur: on
    the widest blur, on street_11 in test_command, on all with --all.
    """
    assert flip(name, "layered medium") <= BOUNDS[name]
    assert flip(name, "layered medium") == pytest.approx(RECORDED[name, "layered medium"]["flip"], abs=SAME)
    if name == "canopy_12x3" or request.config.getoption("--all"):
        assert (flip(name, "layered low") < flip(name, "exact")) == (name not in BRANCHES)


@pytest.mark.report
def test_market(request, hand_over):
    """For the report of validation/run: what each method makes of market_7, layered nearest to the truth."""
    driver = outcomes.driver_or_reason("osmesa", request.config.getoption("--adapter"))
    with needed("driver osmesa"):
        if isinstance(driver, str):
            raise Unavailable(driver)
    outcome, measured = market(driver)
    hand_over(outcome)
    assert max(measured, key=measured.__getitem__) == "layered medium"


def test_octagon():
    """As near as the hexagon; and its truth is turned as TRUTH_ROTATION says: any other way it is farther off."""
    turned = flip("street_11", "layered medium", "octagon")
    assert turned == pytest.approx(flip("street_11", "layered medium"), abs=OCTAGON_OFF)
    assert turned < flip("street_11", "layered medium", "octagon", rotation=0.0)


def test_command():
    """Every method's numbers as JSON, layered ahead of the others.

    The JSON alone on standard output, where '-' asks for it; all other text on standard error.
    """
    options = "truth --scene street_11 --driver osmesa --json -".split()
    done = called(*options)
    assert done.returncode == 0 and "| street_11 |" in done.stderr, done.stderr
    rows = {row["label"]: row for row in json.loads(done.stdout)["rows"]}
    assert list(rows) == list(truth.DEFAULT)
    assert rows["layered medium"]["flip"] == pytest.approx(flip("street_11", "layered medium"))
    ahead = sorted(rows, key=lambda label: rows[label]["flip"])
    assert ahead[:2] == ["layered medium", "layered low"]
