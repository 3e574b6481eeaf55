"""Test BOKEH_HALF_PRECISION in WGSL, the one language in which a driver here computes with half floats: the image
changes by no more than rounding explains, and the brightest colours stay finite.
"""

from dataclasses import replace

import numpy as np
import pytest
from support import load, needed
from support_cases import noise_case

from bokeh_validation.drivers import webgpu
from bokeh_validation.errors import Unavailable
from bokeh_validation.frame.methods import Settings
from bokeh_validation.probes.model import Case, depth_of, flat
from bokeh_validation.probes.near_edges import CAMERA, metres
from bokeh_validation.truth import ray_traced

# Half of the distance between neighbouring half floats, relative to them
ROUNDING = 2.0**-11
# Samples of the largest gather of a hexagon at MEDIUM: 6, 12 and 12 on three rings, and the centre
SAMPLES = 31
BRIGHTEST, LIMIT = 65504.0, 8000.0
# (width, height), and a CoC in pixels that is too small for the far layer
SIZE, GATHERED = (48, 40), 5.0


@pytest.fixture(scope="module")
def wgpu():
    """Return the driver, on a device with half floats."""
    driver = load("wgpu")
    with needed("half floats"):
        if webgpu.HALF not in driver.device.features:
            raise Unavailable(f"{driver.adapter} has none")
    return driver


def drawn(driver, case, half: bool) -> np.ndarray:
    """Return the colour of a case, (H, W, 3), with its last pass in half precision or not."""
    passes = case.plan.passes
    assert passes[-1].entry == "BokehComposite"
    if half:
        passes = [*passes[:-1], replace(passes[-1], defines={**passes[-1].constants, "BOKEH_HALF_PRECISION": 1})]
    return driver.run(passes, case.textures(), case.size)["result"][..., :3].astype(float)


@pytest.mark.parametrize("scene", ray_traced.DRIVER_SCENES, ids=lambda scene: scene.name)
def test_rounding(wgpu, scene):
    """Check that the colour changes by the rounding of sums and weights at most, in 99.9 % of the values.

    Each sample's weight and product is rounded once and each sum once a sample, so a sum of positive terms is off by
    SAMPLES + 2 times ROUNDING, and the result, a ratio of two sums, by twice that. In the remaining values almost
    everything that was found is in front of the pixel: there a difference of two sums is off by more. The result is a
    half float in either case.
    """
    case = ray_traced.scene_case(scene, "layered", "hexagon")
    full, half = (drawn(wgpu, case, precision) for precision in (False, True))
    # darker values than the smallest normal half float have fewer digits
    change = np.abs(half - full) / np.maximum(full, 2.0**-14)
    assert np.percentile(change, 99.9) <= 2.0 * (SAMPLES + 2) * ROUNDING
    assert (change > 0.0).mean() > 0.01, "nothing was computed with half floats"


def test_brightest(wgpu):
    """Check that sums of the brightest colours are finite, beside dark ones too."""
    case = noise_case((64, 48), Settings("layered", "hexagon"))
    color = case.color.copy()
    color[np.random.default_rng(2).random(color.shape[:2]) < 0.6, :3] = BRIGHTEST
    half = drawn(wgpu, replace(case, color=color), True)
    assert np.isfinite(half).all() and half.max() > 1000.0


def test_limit(wgpu):
    """Check that a plane of the brightest colour becomes one of 8000, in each channel, where it is only gathered."""
    color = flat(SIZE)
    color[..., :3] = BRIGHTEST
    settings = Settings("layered", "hexagon", camera=CAMERA)
    case = Case("plane", settings, color, depth_of(SIZE, metres(GATHERED, SIZE[1])))
    assert drawn(wgpu, case, True) == pytest.approx(LIMIT, rel=2.0 * (SAMPLES + 2) * ROUNDING)
