"""Test settings on random patches of colour and depth: every driver must be within the interval of the reference."""

from dataclasses import replace

import pytest
from support import LANGUAGES, NIGHTLY, load, nightly, spread
from support_cases import CAMERA, noise_case, within

from bokeh_validation.frame import methods
from bokeh_validation.frame.methods import Settings
from bokeh_validation.probes import cases, coverage_frames, judges
from bokeh_validation.probes.cases import PLAIN, SWEEPS
from bokeh_validation.shaders.entries import ENTRIES


@pytest.mark.parametrize("method", ["paper", "naive", "exact", "layered"])
def test_every_entry(method, driver):
    """Draw every program of the package on every driver, with everything away from its default."""
    for settings in cases.tagged(cases.ENTRIES).values():
        if settings.method.startswith(method):
            within(driver, noise_case((45, 29), settings))


def test_every_entry_is_there():
    """Check that these frames draw all entries but the ones of test_inputs.py, test_drivers.py and test_steady.py."""
    drawn = {
        render_pass.entry
        for settings in cases.tagged(cases.ENTRIES).values()
        for render_pass in methods.plan(settings, (61, 37)).passes
    }
    assert drawn | {"BokehLinearDepth", "BokehDebug", "BokehStableMap"} == set(ENTRIES)


@pytest.mark.parametrize("name", [pytest.param(name, marks=nightly) for name in NIGHTLY])
def test_character(name):
    """Draw the lens's character on the drivers that the tables below leave out. Shader model 3 has no room for jitter
    in the first pass of a decagon.
    """
    for settings in cases.tagged(cases.LENS).values():
        within(load(name), noise_case((61, 48), replace(settings, jitter=0.0)))


@spread("size", [(61, 37), (1, 1), (3, 2), (1, 2048), (2048, 1), (257, 33)], [(61, 37)])
def test_sizes(size, driver):
    """Draw odd, tiny and thin images; in layered, targets of half, quarter and eighth size are not filled completely.

    A CoC of 0.02 is 41 texels in the longest column.
    """
    camera = replace(CAMERA, max_coc=0.02) if max(size) > 1000 else CAMERA
    for method in PLAIN:
        within(driver, noise_case(size, Settings(method, "hexagon", camera=camera)))
    within(driver, noise_case(size, Settings("exact", "hexagon", 5, camera=camera, spacing=1.0, jitter=1.0)))
    within(driver, noise_case(size, Settings("layered", "hexagon", 7, camera=camera, use_mrt=min(size) > 2)))


@pytest.mark.parametrize("group", SWEEPS)
@pytest.mark.parametrize("driver", LANGUAGES, indirect=True)
def test_settings(group, driver, request):
    """Draw every parameter away from its default: each setting in one language, with --all in all of them."""
    languages = 1 if request.config.getoption("--all") else len(LANGUAGES)
    first = (list(SWEEPS).index(group) + LANGUAGES.index(driver.name)) % languages
    for settings in SWEEPS[group][first::languages]:
        _, comparison = within(driver, noise_case((75, 50) if settings.method == "layered" else (61, 48), settings))
        if driver.software and group in PLAIN:
            assert comparison.close >= 0.98, (settings, comparison)


# Frames that settings do not give: planes partly in a layer, near over far, black next to bright, many tiles, one
# pixel
IMAGES = ("plane", "near over far", "cones", "ragged", "black", "large", "layered, one pixel", "layered, not blurred")


@pytest.mark.parametrize("driver", LANGUAGES, indirect=True)
def test_images_of_layered(driver):
    """Draw the images of `check` and of the mutants, which reach special branches.

    The last one has 1 / (1 / 122), which exceeds 122 in float32: carelessly rounded up, half of it would be 62 texels.
    """
    frames = coverage_frames.all_frames()
    for label in (label for label in frames if label.startswith(IMAGES)):
        for judge in judges.judges(label, frames[label], driver.precision, driver.rounding):
            assert not judge.objection(driver)
    within(driver, noise_case((122, 24), Settings("layered", "hexagon", 7, camera=CAMERA)))
