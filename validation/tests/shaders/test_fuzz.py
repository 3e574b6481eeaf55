"""Test random parameters and images: results are finite, not negative, and within the interval of the reference.

There are 750 cases over all methods, on one driver per language; by default a third of them are drawn, with --all
every one. Seeds give the same numbers everywhere;
BOKEH_FUZZ_SEED=N draws others. A failure names the seed of its case.
"""

import os

import numpy as np
import pytest
from invalid_input import COLOR, DEPTH, sprinkled
from support import LANGUAGES, load

from bokeh_validation.frame import aperture_shapes, methods
from bokeh_validation.frame.methods import Camera, Settings
from bokeh_validation.probes.judges import compared
from bokeh_validation.probes.model import Case
from bokeh_validation.reference.listings import MAX_COLOR

SEED = int(os.environ.get("BOKEH_FUZZ_SEED", "2012"))
# Number of cases of each method for each driver
CASES = {"paper": 90, "exact": 95, "naive": 30, "naive-grid": 35}
# Each sample count needs another program for each entry, so there are few: one even, the others odd
SAMPLES = {"paper": (2, 3, 7, 13), "exact": (2, 7), "naive": (2, 7), "naive-grid": (2, 3, 7)}
APERTURES = {
    "paper": aperture_shapes.NAMES,
    "exact": tuple(methods.EXACT),
    "naive": ("square", "hexagon", "star", "pentagon"),
    "naive-grid": ("square", "diamond"),
}
MOST_SIDE = 32
SPECIAL_SHARE = 1 / 8


def draw(method: str, seed: int) -> Case:
    """Draw random settings of a method, as float32, which is what shaders receive, and random pixels."""
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
        # closer than the focal length, at its largest value, at infinity
        focus_distance=number(0.25, 20.0, 0.01, 0.25, 1e9),
        sensor_height=number(0.01, 0.05, 0.0),
        max_coc=number(0.0, 1.0, 0.0, 1.0),
    )
    count, adaptive = one(SAMPLES[method]), not method.startswith("naive")
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
        use_mrt=one([False, True]),
    )
    shape = tuple(random.integers(1, MOST_SIDE + 1, 2))
    # 6 clips one in thirty at the largest half float
    color = random.lognormal(0.0, one([0.5, 2.0, 6.0]), (*shape, 4))
    # depths in focus and nearly so, or nothing would be sharp enough to leak
    levels = [*random.uniform(0.2, 30.0, 3), *(camera.focus_distance * np.array([1.0, random.uniform(0.9, 1.1)]))]
    depth = random.choice(levels, shape).astype(np.float32)
    color = sprinkled(random, np.minimum(color, MAX_COLOR).astype(np.float16), COLOR, one([0.0, 0.02, 0.3]))
    depth = sprinkled(random, depth, DEPTH, one([0.0, 0.02, 0.3]))
    return Case(f"seed {seed}", settings, color, depth, ("coc", "result"))


@pytest.mark.parametrize("name", LANGUAGES)
@pytest.mark.parametrize("method", CASES)
def test_random_cases(method, name, request):
    """Check random cases: the result, and the CoC map, whose colour is the input's."""
    driver, blurred, narrow = load(name), [], []
    step = 1 if request.config.getoption("--all") else 3
    for index in range(0, CASES[method], step):
        case = draw(method, SEED + 10_000 * LANGUAGES.index(name) + index)
        found = compared(case, driver)
        for target, pixels in found.outputs.items():
            # the CoC of exact is signed
            numbers = pixels[..., :3] if method == "exact" else pixels
            assert np.isfinite(pixels).all() and (numbers >= 0).all(), (target, case.label, case.settings)
            comparison = found.comparisons[target]
            assert comparison.outside == 0, (target, str(comparison), case.label, case.settings)
        result, coc = found.expected["result"], found.expected["coc"].value[..., 3]
        blurred.append((np.abs(coc) * case.size[1] > 2.0).any())
        narrow.append((result.error[..., :3] <= result.value[..., :3].max() / 16).mean())
    # otherwise all cases might be in focus, or their intervals might allow anything; for the fractions, a third of
    # the cases is too few
    if step == 1:
        assert np.mean(blurred) > 0.5 and np.mean(narrow) > 0.8
    assert any(blurred) and max(narrow) > 0.8
