"""The layered method on every driver: each pass within the reference's interval, and what must be alike or unchanged.

What its pictures must show: the layered probes of bokeh_validation/probes, which test_patterns.py runs in every
language.
"""

from dataclasses import replace

import numpy as np
import pytest
from support import LANGUAGES, load, spread
from support_cases import CAMERA, judged, kind, noise_case, result, within
from support_targets import framed, inside, poisoned

from bokeh_validation import metrics
from bokeh_validation.frame import methods
from bokeh_validation.probes import PROBES, lights, model, near_edges, unchanged
from bokeh_validation.reference.device import Reference

# No program of layers takes the number of samples: one number for all apertures, or each would be compiled again
SETTINGS = methods.Settings("layered", "hexagon", 7, camera=CAMERA)
WIDE = methods.Camera(0.4, 0.05, 4.0, max_coc=0.5)


@spread("size", [(64, 48), (61, 37), (1, 1), (1, 64), (96, 2), (257, 33)], [(1, 1), (61, 37)])
def test_sizes(size, driver):
    """Odd, tiny and thin images: targets of half, a quarter and an eighth that are not filled. Thin ones one by one."""
    within(driver, noise_case(size, replace(SETTINGS, targets=min(size) > 2)))


@pytest.mark.parametrize(
    "changes",
    [
        {"rotation": 17.0},
        {"squeeze": 0.5},
        {"squeeze": 1.5, "rotation": -30.0},
        {"jitter": 1.0, "frame": 3},
        *({"aperture": aperture, "rotation": 5.0} for aperture in ("square", "octagon", "decagon")),
        *({"aperture": aperture, "targets": False} for aperture in ("square", "octagon", "decagon")),
        *({"preset": preset} for preset in methods.PRESETS if preset != "medium"),
        {"camera": WIDE},
        {"camera": WIDE, "aperture": "decagon", "jitter": 0.5, "preset": "low"},
        {"coc": 0.0},
        {"coc": 0.05},
        {"coc": 0.25},
    ],
    ids=str,
)
@pytest.mark.parametrize("driver", ["osmesa"], indirect=True)
def test_settings(changes, driver):
    """Every setting away from its default, on random patches; on every driver: test_drivers.py::test_every_entry."""
    within(driver, noise_case((75, 50), replace(SETTINGS, **changes)))


# ----------------------------------------------------------------------------------------------------------------------
# a part of the textures
# ----------------------------------------------------------------------------------------------------------------------

TEXTURES = (90, 74)
# Where the image is -> the aperture, so that every entry draws into one
VIEWPORTS = {
    (24, 8, 48, 37): "hexagon",
    (0, 0, 90, 74): "hexagon",
    (8, 24, 40, 30): "square",
    (40, 16, 50, 58): "octagon",
    (72, 56, 11, 9): "decagon",
}


@spread("viewport", VIEWPORTS, [(24, 8, 48, 37)])
def test_viewport(viewport, driver):
    """NaN around the image in every texture: each pass is within its interval, and leaves what is around as it is.

    The smallest is more than 8 pixels wide and high: a target of an eighth that is one texel wide has no room for the
    inset, as an image one pixel wide in test_viewport.py.
    """
    aperture = VIEWPORTS[viewport]
    settings = replace(SETTINGS, aperture=aperture, rotation=11.0, targets=aperture != "octagon")
    image = noise_case(viewport[2:], settings)
    plan = methods.in_viewport(image.plan, viewport, TEXTURES)
    nothing = np.full((TEXTURES[1], TEXTURES[0], 4), np.nan, np.float16)
    textures = {"color": framed(image.color, TEXTURES, viewport), "depth": framed(image.depth, TEXTURES, viewport)}
    names = [name for item in plan.passes for name in item.outputs]
    outputs = driver.run(poisoned(plan), textures | {"nan": nothing}, TEXTURES, keep=names)
    parts = {}
    for item in plan.passes:
        x, y, width, height = (-(-length // item.scale) for length in viewport)
        parts |= dict.fromkeys(item.outputs, (slice(y, y + height), slice(x, x + width)))
    leaked = [name for name, part in parts.items() if not np.isfinite(outputs[name][part]).all()]
    assert not leaked, f"what is around the image leaks into {leaked}"
    wanted = Reference().images(plan.passes, textures, TEXTURES, "half", kind(driver), driver.rounding, given=outputs)
    for name, part in parts.items():
        comparison = metrics.compare(outputs[name][part], wanted[name].part(*part), False)
        assert comparison.outside == 0, (name, comparison)
    around = outputs["result"].copy()
    inside(around, viewport)[:] = np.nan
    assert np.isnan(around).all()


# ----------------------------------------------------------------------------------------------------------------------
# the light, and nothing at all
# ----------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("preset", "driver"),
    [*(("medium", name) for name in LANGUAGES), *zip(("low", "high", "ultra"), LANGUAGES, strict=True)],
    indirect=["driver"],
)
def test_every_preset(preset, driver):
    """A picture in focus, or with a CoC of up to a pixel, which spreads nothing, is copied to the bit; one colour stays
    as it is; and 0.99 to 1.01 of an isolated light of one pixel, the hardest, is kept. See the probes.
    """
    case = unchanged.focus_case()
    for coc in (0.0, 0.9, -0.9):
        depth = model.depth_of(case.size, near_edges.metres(coc, case.size[1]))
        found = result(driver, replace(case, settings=near_edges.settings(preset=preset), depth=depth))
        np.testing.assert_array_equal(found[..., :3], case.color[..., :3])
    for case in unchanged.constant_cases():
        output = result(driver, replace(case, settings=replace(case.settings, preset=preset)))[..., :3]
        off = np.abs(output.astype(np.float64) / case.color[..., :3].astype(np.float64) - 1.0)
        assert off.max() <= 4 * near_edges.STEP, case.label
    for coc in lights.LIGHT_COCS:
        case = lights.light_case(coc, 1, preset)
        around = lights.AMBIENT * (1.0 - (lights.light_spread(coc, 1, case.size) if coc < 0 else 0.0))
        kept = (result(driver, case)[..., 2].astype(np.float64) - around).sum() / lights.LIGHT
        assert kept == pytest.approx(1.0, abs=0.01), coc


# ----------------------------------------------------------------------------------------------------------------------
# the probes notice what they are there for
# ----------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("probe", "changes"),
    [
        ("near-edge-hexagon", {"camera": replace(near_edges.CAMERA, aperture_diameter=1.2)}),
        ("near-edge-hexagon", {"squeeze": 0.8}),
        ("near-edge-octagon", {"aperture": "square"}),
        ("near-branch", {"camera": replace(near_edges.CAMERA, aperture_diameter=1.4)}),
        ("layered-light-9", {"rotation": 30.0}),
        ("layered-light-9", {"camera": replace(near_edges.CAMERA, aperture_diameter=1.2)}),
        ("silhouette-light", {"coc": 0.3}),
        ("covered-light", {"camera": replace(near_edges.CAMERA, aperture_diameter=2.0)}),
        ("layered-focus", {"coc": 0.2}),
    ],
    ids=str,
)
def test_probes_notice(probe, changes):
    """Other settings than its own, and it fails."""
    found = next(item for item in PROBES if item.name == probe)
    assert not all(check.ok for check in judged(found, **changes))


def test_sweep_notices_a_pop():
    """A picture of the near layer where the gather's should still be: all the change of a sweep in one step."""
    outputs = {
        case.label: {"result": result(load("osmesa"), case).astype(np.float64)} for case in unchanged.SWEEP.cases
    }
    outputs["CoC -9.25"] = outputs["CoC -9.75"]
    outputs["CoC -9"] = outputs["CoC -8.25"]
    assert not all(check.ok for check in unchanged.SWEEP.judge(outputs))
