"""Random parameters and images on every driver: finite, not negative, and within the interval of the reference.

750 cases are drawn for one driver of each language. The slow drivers get a few each. Numbers from the seeds
are the same everywhere; BOKEH_FUZZ_SEED=N draws others. A failure names the seed of its case.
"""

import os

import numpy as np
import pytest
from hostile import COLOR, DEPTH, sprinkled
from support import load
from support_cases import result

from bokeh_validation import drivers, metrics
from bokeh_validation.frame import apertures, methods
from bokeh_validation.frame.methods import Camera, Settings
from bokeh_validation.probes.model import Case
from bokeh_validation.reference import precision
from bokeh_validation.reference.device import Reference
from bokeh_validation.reference.images import Image
from bokeh_validation.reference.listings import MAX_COLOR

SEED = int(os.environ.get("BOKEH_FUZZ_SEED", "2012"))
# Cases of each method for each fast driver
CASES = {"paper": 90, "exact": 95, "naive": 30, "naive-grid": 35}
FAST = ("osmesa", "wgpu", "dxc")
SLOW = ("egl", "webgl2", "webgpu", "d3d9", "d3d11")
SLOW_CASES = 5
# Each number of samples is another program of each entry, so few: an even one, and odd ones
SAMPLES = {"paper": (2, 3, 7, 13), "exact": (2, 7), "naive": (2, 7), "naive-grid": (2, 3, 7)}
SLOW_SAMPLES = (3,)
APERTURES = {
    "paper": apertures.NAMES,
    "exact": tuple(methods.EXACT),
    "naive": ("square", "hexagon", "star", "pentagon"),
    "naive-grid": ("square", "diamond"),
}
MOST_SIDE = 32
SPECIAL_SHARE = 1 / 8


def draw(method: str, samples: tuple[int, ...], seed: int) -> Case:
    """Any setting of a method, float32, as the shaders get it, on random pixels."""
    random = np.random.default_rng([seed, *method.encode()])

    def number(low: float, high: float, *special: float) -> float:
        if special and random.random() < SPECIAL_SHARE:
            return float(random.choice(special))
        return float(np.float32(random.uniform(low, high)))

    def one(values):
        return values[random.integers(len(values))]

    camera = Camera(
        aperture_diameter=number(0.0, 1.0, 0.0, 1e6),
        focal_length=number(0.01, 0.25),
        # before the focal length, at its largest, at infinity
        focus_distance=number(0.25, 20.0, 0.01, 0.25, 1e9),
        sensor_height=number(0.01, 0.05, 0.0),
        max_coc=number(0.0, 1.0, 0.0, 1.0),
    )
    count, adaptive = one(samples), not method.startswith("naive")
    settings = Settings(
        method,
        one(APERTURES[method]),
        count,
        number(-360.0, 360.0),
        camera,
        coc=one([None, number(0.0, 1.0)]),
        blur_coc=one([False, True]),
        leak_fix=one([False, True]),
        bleeding_bias=number(0.0, 0.25, 0.0),
        bleeding_mult=number(0.0, 60.0),
        spacing=one([0.0, number(0.25, 4.0)]) if adaptive else 0.0,
        jitter=one([0.0, number(0.0, 1.0)]) if adaptive else 0.0,
        frame=int(random.integers(0, 1001)),
        squeeze=number(0.25, 2.0, 1.0),
        targets=one([False, True]),
    )
    shape = tuple(random.integers(1, MOST_SIDE + 1, 2))
    # 6 clips one in thirty at the largest half float
    color = random.lognormal(0.0, one([0.5, 2.0, 6.0]), (*shape, 4))
    # in focus and nearly, or nothing would be sharp enough to leak
    levels = [*random.uniform(0.2, 30.0, 3), *(camera.focus_distance * np.array([1.0, random.uniform(0.9, 1.1)]))]
    depth = random.choice(levels, shape).astype(np.float32)
    color = sprinkled(random, np.minimum(color, MAX_COLOR).astype(np.float16), COLOR, one([0.0, 0.02, 0.3]))
    return Case(f"seed {seed}", settings, color, sprinkled(random, depth, DEPTH, one([0.0, 0.02, 0.3])))


def interval(case: Case, kind: precision.Precision, rounding: str) -> dict[str, Image]:
    """Every texture of the reference with the interval of a class of devices. Kept nowhere: no case comes twice."""
    return Reference().images(case.plan.passes, case.textures(), case.size, precision=kind, rounding=rounding)


def agrees(driver: drivers.Driver, case: Case) -> dict[str, Image]:
    """Fail where a driver's result is not finite, negative or outside the interval; the interval."""
    wanted = interval(case, driver.precision, driver.rounding)
    output = result(driver, case)
    # the CoC of exact is signed
    numbers = output[..., :3] if case.settings.method == "exact" else output
    assert np.isfinite(output).all() and (numbers >= 0).all(), (case.label, case.settings)
    comparison = metrics.compare(output, wanted["result"], driver.software)
    assert comparison.outside == 0, (str(comparison), case.label, case.settings)
    return wanted


@pytest.mark.parametrize("name", FAST)
@pytest.mark.parametrize("method", CASES)
def test_fast_drivers(method, name):
    """750 cases over all methods and drivers."""
    blurred, narrow = [], []
    for index in range(CASES[method]):
        wanted = agrees(load(name), draw(method, SAMPLES[method], SEED + 10_000 * FAST.index(name) + index))
        image = wanted["result"]
        blurred.append((np.abs(wanted["coc"].value[..., 3]) * image.size[1] > 2.0).any())
        narrow.append((image.error[..., :3] <= image.value[..., :3].max() / 16).mean())
    # or they might all be in focus, or allow anything
    assert np.mean(blurred) > 0.5 and np.mean(narrow) > 0.8


@pytest.mark.parametrize("name", SLOW)
def test_slow_drivers(name):
    """A few cases of every method on browsers and Direct3D."""
    for method in CASES:
        for index in range(SLOW_CASES):
            agrees(load(name), draw(method, SLOW_SAMPLES, SEED + 100_000 + index))
