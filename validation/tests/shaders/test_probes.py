"""Run every probe in one language, with --all in each, and check that probes notice what they are meant to notice."""

from dataclasses import replace

import numpy as np
import pytest
from support import LANGUAGES, load, needed, nightly
from support_cases import judged, result

from bokeh_validation import probes
from bokeh_validation.errors import Unavailable
from bokeh_validation.frame import geometry
from bokeh_validation.probes import impulse, near_edges, outcomes, rims, sweep
from bokeh_validation.probes.highlight import polygon_of

PROBES = {probe.name: probe for probe in probes.PROBES}


def on_drivers():
    """Yield each probe with each driver: one language by default, the others with --all, all drivers for
    validation/run.
    """
    for index, name in enumerate(PROBES):
        for driver in probes.REAL:
            others = nightly if driver in LANGUAGES else pytest.mark.report
            by_default = driver == LANGUAGES[index % len(LANGUAGES)]
            yield pytest.param(name, driver, marks=() if by_default else others, id=f"{name}-{driver}")


@pytest.mark.parametrize(("name", "driver_name"), list(on_drivers()))
def test_probe(name, driver_name, request, hand_over):
    """Check that a probe is within the interval of the reference and shows what it must."""
    outcome = outcomes.of_probe(PROBES[name], driver_name, request.config.getoption("--adapter"))
    hand_over(outcome)
    with needed(f"driver {driver_name}"):
        for reason in outcome.missing.values():
            raise Unavailable(reason)
    (run,) = outcome.runs
    assert not list(run.lines(False))


# For one highlight: another aperture, a rotation of 5 degrees, and a CoC that is 10 % too large
OTHERS = {"square": "octagon", "diamond": "square", "hexagon": "octagon", "octagon": "hexagon", "star": "square"}
WRONG = ({"rotation": 5.0}, {"coc": 1.1 * impulse.COC / impulse.SIZE[1]})
# Probe -> changes of its settings, each of which it must notice
NOTICED = {
    **{impulse.probe(own).name: [{"aperture": other}, *WRONG] for own, other in OTHERS.items()},
    # a switch without effect, and a CoC that does not follow depth
    "leakage": [{"leak_fix": False}, {"leak_fix": True}],
    "silhouette": [{"coc": 0.1}],
    "coc-blur": [{"blur_coc": True}, {"blur_coc": False}],
    "near-edge-hexagon": [{"camera": replace(near_edges.CAMERA, aperture_diameter=1.2)}, {"squeeze": 0.8}],
    "near-edge-octagon": [{"aperture": "square"}],
    "layered-light-9": [{"rotation": 30.0}, {"camera": replace(near_edges.CAMERA, aperture_diameter=1.2)}],
    # as wide as the background's, by the camera; and another polygon
    "lights-apart-exact": [{"camera": replace(near_edges.CAMERA, aperture_diameter=1.1)}, {"aperture": "octagon"}],
    "silhouette-light": [{"coc": 0.3}],
    "covered-light": [{"camera": replace(near_edges.CAMERA, aperture_diameter=2.0)}],
    # no cut, half of one, and a CoC that is too small; no lateral colour, or too little
    "cats-eye-exact": [{"cats_eye": 0.0}, {"cats_eye": 0.4}, {"coc": 0.15}],
    "lateral-color": [{"lateral": 0.0}, {"lateral": 0.03}],
}


@pytest.mark.parametrize("name", NOTICED)
def test_probes_notice(name):
    """Check that a probe fails with other settings than its own."""
    for changes in NOTICED[name]:
        assert not all(check.ok for check in judged(PROBES[name], **changes)), changes


def test_sweep_notices_a_pop():
    """Check that the sweep notices an image of the near layer where the gather's should be: its whole change in one
    step.
    """
    outputs = {case.label: {"result": result(load("egl"), case).astype(np.float64)} for case in sweep.SWEEP.cases}
    outputs["CoC -9.25"] = outputs["CoC -9.75"]
    outputs["CoC -9"] = outputs["CoC -8.25"]
    assert not all(check.ok for check in sweep.SWEEP.judge(outputs))


@pytest.mark.parametrize("second", [12, 20, 40])
def test_rims_notice_a_second_polygon(second):
    """Check that the outline is above its bound if a twentieth of the light is in a polygon of another CoC, as it is if
    the rim of a light keeps the CoC of the plane.
    """
    rim, image = rims.Rim(-60, second), np.full((*rims.SIZE[::-1], 3), rims.AMBIENT)
    for coc, part in ((rim.coc, 0.95), (second, 0.05)):
        coverage = geometry.coverage(polygon_of("hexagon", 0.0, coc), rims.SIZE, rims.MIDDLE)
        image[..., 2] += part * rims.LIGHT * coverage / coverage.sum()
    assert rim.measured(image)[1] > rims.OUTLINE
