"""Chromatic aberration: lateral and axial colour."""

from dataclasses import replace

import numpy as np
import pytest
from support import in_each_language, load
from support_cases import CAMERA, judged, noise_case, result, within
from support_targets import framed, inside

from bokeh_validation import metrics
from bokeh_validation import probes as patterns
from bokeh_validation.frame import methods
from bokeh_validation.frame.methods import Settings
from bokeh_validation.probes import chromatic
from bokeh_validation.reference.device import Reference

EXACT = Settings("exact", "hexagon", camera=CAMERA)
LATERAL = replace(EXACT, lateral=0.02)
AXIAL = replace(EXACT, axial=(0.05, -0.03))


@pytest.mark.parametrize("amount", [0.02, -0.1, 5.0])
@in_each_language
def test_lateral_on_noise(amount, driver):
    """Within the interval of the reference; too large amounts are 0.1."""
    within(driver, noise_case((61, 48), replace(EXACT, lateral=amount)))


@pytest.mark.parametrize("name", ["d3d9", "webgl2", "webgpu"])
def test_lateral_elsewhere(name):
    """The same in shader model 3 and in a browser."""
    within(load(name), noise_case((61, 48), LATERAL))


@pytest.mark.parametrize("name", ["d3d9", "d3d11"])
def test_lateral_probe_on_direct3d(name):
    """What it must show, where a last pass that resamples leaves all that is dark a step darker."""
    assert all(check.ok for check in patterns.run(chromatic.PROBES[0], load(name)).checks)


@in_each_language
def test_lateral_after_layered(driver):
    """It is a pass of its own."""
    within(driver, noise_case((75, 50), Settings("layered", "hexagon", 7, camera=CAMERA, lateral=0.03)))


@in_each_language
def test_green_stays(driver):
    """Green and the CoC are those of the picture without; red and blue are not."""
    plain, found = (result(driver, noise_case((61, 48), one)) for one in (EXACT, LATERAL))
    moved = []
    for channel in range(4):
        other = plain.copy()
        other[..., channel] = found[..., channel]
        moved.append(metrics.steps(other, plain.astype(np.float64)))
    assert max(moved[1].max(), moved[3].max()) <= metrics.CLOSE_STEPS
    assert min(np.mean(moved[channel] > metrics.FAR_STEPS) for channel in (0, 2)) > 0.1


@in_each_language
def test_lateral_in_a_viewport(driver):
    """The middle is that of the image, and nothing around it is read: framed() puts NaN there."""
    viewport, textures = (24, 8, 48, 37), (90, 74)
    image = noise_case(viewport[2:], LATERAL)
    plan = methods.in_viewport(image.plan, viewport, textures)
    given = {"color": framed(image.color, textures, viewport), "depth": framed(image.depth, textures, viewport)}
    found = inside(driver.run(plan.passes, given, textures)["result"], viewport)
    wanted = Reference().run(image.plan.passes, image.textures(), image.size)["result"]
    assert np.isfinite(found).all()
    assert np.mean(metrics.steps(found, wanted.astype(np.float64)) > metrics.FAR_STEPS) < 0.02


@pytest.mark.parametrize("changes", [{"lateral": 0.0}, {"lateral": 0.03}], ids=str)
def test_lateral_probe_notices(changes):
    """None, and too little."""
    assert not all(check.ok for check in judged(chromatic.PROBES[0], **changes))


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"targets": False, "axial": (-0.05, 0.02)},
        {"rotation": 17.0, "squeeze": 0.6, "cats_eye": 0.5},
        {"spacing": 1.0, "max_samples": 5, "jitter": 1.0, "frame": 3},
    ],
    ids=str,
)
@pytest.mark.parametrize("aperture", methods.EXACT)
@in_each_language
def test_axial_on_noise(aperture, changes, driver):
    """Within the interval of the reference."""
    within(driver, noise_case((61, 48), replace(AXIAL, aperture=aperture, **changes)))


@pytest.mark.parametrize("name", ["webgl2", "webgpu"])
def test_axial_elsewhere(name):
    """The same in a browser."""
    within(load(name), noise_case((61, 48), AXIAL))


@pytest.mark.parametrize("changes", [{"axial": (0.0, 0.0)}, {"axial": (0.01, -0.01)}], ids=str)
def test_axial_probe_notices(changes):
    """None, and red for blue."""
    assert not all(check.ok for check in judged(chromatic.PROBES[1], **changes))
