"""The layered method on every driver: each pass within the reference's interval, and what must be alike or unchanged.

What its pictures must show is in bokeh_validation/patterns/layers.py, which test_patterns.py runs on every driver.
"""

from dataclasses import replace

import numpy as np
import pytest
from support import load
from test_drivers import noise_case
from test_patterns import judged
from test_viewport import framed, inside, poisoned

from bokeh_validation import drivers, methods, metrics
from bokeh_validation.patterns import layers, model
from bokeh_validation.patterns.model import Case
from bokeh_validation.reference import precision
from bokeh_validation.reference.device import Reference

CAMERA = methods.Camera(0.1, 0.05, 4.0, max_coc=0.3)
SETTINGS = methods.Settings("layered", "hexagon", camera=CAMERA)
WIDE = methods.Camera(0.4, 0.05, 4.0, max_coc=0.5)


def within(driver: drivers.Driver, case: Case) -> np.ndarray:
    """A driver's result; every target of every pass is within the interval of what the pass had to read."""
    outputs, _, comparisons = model.compared(case, driver)
    bad = {name: str(comparison) for name, comparison in comparisons.items() if comparison.outside}
    assert not bad, bad
    assert np.isfinite(outputs["result"]).all()
    return outputs["result"]


@pytest.mark.parametrize("size", [(64, 48), (61, 37), (1, 1), (1, 64), (96, 2), (257, 33)], ids=str)
@pytest.mark.parametrize("targets", [True, False], ids=["several targets", "one target"])
def test_sizes(targets, size, driver):
    """Odd, tiny and thin images: targets of half, a quarter and an eighth that are not filled."""
    within(driver, noise_case(size, replace(SETTINGS, targets=targets)))


@pytest.mark.parametrize(
    "changes",
    [
        {"rotation": 17.0},
        {"squeeze": 0.5},
        {"squeeze": 1.5, "rotation": -30.0},
        {"jitter": 1.0, "frame": 3},
        *({"aperture": aperture, "rotation": 5.0} for aperture in ("square", "octagon", "decagon")),
        *({"aperture": aperture, "targets": False} for aperture in ("square", "octagon", "decagon")),
        *({"quality": quality} for quality in methods.QUALITIES if quality != "medium"),
        {"camera": WIDE},
        {"camera": WIDE, "aperture": "decagon", "jitter": 0.5, "quality": "low"},
        {"coc": 0.0},
        {"coc": 0.05},
        {"coc": 0.25},
    ],
    ids=str,
)
def test_settings(changes, driver):
    """Every setting away from its default, on random patches."""
    within(driver, noise_case((75, 50), replace(SETTINGS, **changes)))


def test_settings_matter():
    """Each of the settings above changes the picture, or testing it would mean nothing."""
    base = replace(SETTINGS, camera=WIDE)
    plain = _result(Reference(), noise_case((75, 50), base))
    for changes in (
        {"rotation": 17.0},
        {"squeeze": 0.5},
        {"jitter": 1.0, "frame": 3},
        {"aperture": "octagon"},
        {"quality": "low"},
        {"quality": "ultra"},
        {"camera": CAMERA},
    ):
        other = _result(Reference(), noise_case((75, 50), replace(base, **changes)))
        assert (metrics.steps(plain, other) > metrics.FAR_STEPS).mean() > 0.02, changes


def _result(driver: drivers.Driver, case: Case) -> np.ndarray:
    return driver.run(case.plan.passes, case.textures(), case.size)["result"]


@pytest.mark.parametrize("aperture", ["hexagon", "octagon", "decagon"])
def test_one_target_at_a_time(aperture, driver):
    """The same functions, called once for each target: the same picture.

    The sums of an edge run in another order there, so float32 rounds them in other ways: now and then a target is a
    half float's step off. Two such pictures are as close as two drivers are.
    """
    case = noise_case((75, 50), replace(SETTINGS, aperture=aperture))
    alone = replace(case, settings=replace(case.settings, targets=False))
    distance = metrics.steps(_result(driver, case), _result(driver, alone))
    assert (distance <= metrics.CLOSE_STEPS).mean() >= metrics.CLOSE_SHARE
    assert distance.max() <= metrics.FAR_STEPS


# ----------------------------------------------------------------------------------------------------------------------
# a part of the textures
# ----------------------------------------------------------------------------------------------------------------------

TEXTURES = (90, 74)
VIEWPORTS = ((24, 8, 48, 37), (0, 0, 90, 74), (40, 16, 50, 58), (72, 56, 11, 9))


@pytest.mark.parametrize("viewport", VIEWPORTS, ids=str)
def test_viewport(viewport, driver):
    """NaN around the image in every texture: each pass is within its interval, and leaves what is around as it is.

    The smallest is more than 8 pixels wide and high: a target of an eighth that is one texel wide has no room for the
    inset, as an image one pixel wide in test_viewport.py.
    """
    image = noise_case(viewport[2:], replace(SETTINGS, rotation=11.0))
    plan = methods.in_viewport(image.plan, viewport, TEXTURES)
    nothing = np.full((TEXTURES[1], TEXTURES[0], 4), np.nan, np.float16)
    textures = {"color": framed(image.color, TEXTURES, viewport), "depth": framed(image.depth, TEXTURES, viewport)}
    names = [name for item in plan.passes for name in item.outputs]
    outputs = driver.run(fill(plan), textures | {"nan": nothing}, TEXTURES, keep=names)
    kind = precision.SOFTWARE if driver.software else precision.GPU
    wanted = Reference().images(plan.passes, textures, TEXTURES, "half", kind, driver.rounding, given=outputs)
    for item in plan.passes:
        x, y, width, height = (-(-length // item.scale) for length in viewport)
        part = slice(y, y + height), slice(x, x + width)
        for name in item.outputs:
            comparison = metrics.compare(outputs[name][part], wanted[name].part(*part), False)
            assert comparison.outside == 0, (name, comparison)
    around = outputs["result"].copy()
    inside(around, viewport)[:] = np.nan
    assert np.isnan(around).all()


def fill(plan: methods.Plan) -> list:
    """Its passes, after others that fill every target with NaN, each at its scale."""
    scales = {name: item.scale for item in plan.passes for name in item.outputs}
    return [
        replace(item, scale=scales.get(item.output, 1)) if item.viewport is None else item for item in poisoned(plan)
    ]


def test_viewport_is_the_picture_alone(driver):
    """In the middle of a large texture, the image is what it would be alone.

    Black but for a light whose blur ends before the edges, so that the insets lie between black texels. Places are off
    by float32 roundings, 8 of 2^-24 of the width, and a GPU's step of 2^-8 texel; the steepest slopes that are fetched
    between texels are the light's own.
    """
    viewport = (24, 16, 48, 40)
    color, depth = model.flat(viewport[2:]), model.depth_of(viewport[2:], 30.0)
    color[18:22, 22:26, :3] = 40.0
    case = Case("", SETTINGS, color, depth)
    alone = _result(driver, case)
    plan = methods.in_viewport(case.plan, viewport, TEXTURES)
    textures = {"color": framed(color, TEXTURES, viewport), "depth": framed(depth, TEXTURES, viewport)}
    output = inside(driver.run(plan.passes, textures, TEXTURES)["result"], viewport)
    place = TEXTURES[0] * 8 * 2.0**-24 + (0.0 if driver.software else 2.0**-8)
    # a pass reads the layer at half its share, and the next ones what it wrote; each stores with a step
    allowed = 4 * (place + 2.0**-10) * alone[..., :3].astype(float).max()
    assert np.abs(output[..., :3].astype(float) - alone[..., :3].astype(float)).max() <= allowed


# ----------------------------------------------------------------------------------------------------------------------
# the light, and nothing at all
# ----------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("quality", methods.QUALITIES)
def test_in_focus_to_the_bit(quality, driver):
    """Every preset copies a picture in focus; and one whose CoC is up to a pixel, since nothing spreads by that."""
    case = layers.focus_case()
    for coc in (0.0, 0.9, -0.9):
        depth = model.depth_of(case.size, layers.metres(coc, case.size[1]))
        found = _result(driver, replace(case, settings=layers.settings(quality=quality), depth=depth))
        np.testing.assert_array_equal(found[..., :3], case.color[..., :3])


@pytest.mark.parametrize("quality", methods.QUALITIES)
@pytest.mark.parametrize("case", layers.constant_cases(), ids=lambda c: c.label)
def test_one_colour(case, quality, driver):
    """Every preset leaves one colour as it is, see the probe."""
    chosen = replace(case.settings, quality=quality)
    output = _result(driver, replace(case, settings=chosen))[..., :3].astype(np.float64)
    wanted = case.color[..., :3].astype(np.float64)
    assert np.abs(output / wanted - 1.0).max() <= 4 * layers.STEP


@pytest.mark.parametrize("quality", methods.QUALITIES)
@pytest.mark.parametrize("coc", layers.LIGHT_COCS)
def test_light_is_kept(coc, quality, driver):
    """Every preset: 0.99 to 1.01 of an isolated light of one pixel, the hardest."""
    case = layers.light_case(coc, 1, quality)
    result = _result(driver, case).astype(np.float64)
    spread = layers.light_spread(coc, 1, case.size)
    around = layers.AMBIENT * (1.0 - (spread if coc < 0 else 0.0))
    assert (result[..., 2] - around).sum() / layers.LIGHT == pytest.approx(1.0, abs=0.01)


# ----------------------------------------------------------------------------------------------------------------------
# the probes notice what they are there for
# ----------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("probe", "changes"),
    [
        ("near-edge-hexagon", {"camera": replace(layers.CAMERA, aperture_diameter=1.2)}),
        ("near-edge-hexagon", {"squeeze": 0.8}),
        ("near-edge-octagon", {"aperture": "square"}),
        ("near-branch", {"camera": replace(layers.CAMERA, aperture_diameter=1.4)}),
        ("layered-light-9", {"rotation": 30.0}),
        ("layered-light-9", {"camera": replace(layers.CAMERA, aperture_diameter=1.2)}),
        ("silhouette-light", {"coc": 0.3}),
        ("covered-light", {"camera": replace(layers.CAMERA, aperture_diameter=2.0)}),
        ("layered-focus", {"coc": 0.2}),
    ],
    ids=str,
)
def test_probes_notice(probe, changes):
    """Other settings than its own, and it fails."""
    found = next(item for item in layers.PROBES if item.name == probe)
    assert not all(check.ok for check in judged(found, **changes))


def test_sweep_notices_a_pop():
    """A picture of the near layer where the gather's should still be: all the change of a sweep in one step."""
    cases = {case.label: case for case in layers.SWEEP.cases}
    outputs = {label: {"result": _result(load("osmesa"), case).astype(np.float64)} for label, case in cases.items()}
    outputs["CoC -9.25"] = outputs["CoC -9.75"]
    outputs["CoC -9"] = outputs["CoC -8.25"]
    assert not all(check.ok for check in layers.SWEEP.judge(outputs))
