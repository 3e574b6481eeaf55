"""Section [1]: the constants and presets are those that the harness and the documents have."""

import re

import numpy as np
from support_cases import evaluated

from bokeh_validation import paths, shaders
from bokeh_validation.frame import methods
from bokeh_validation.reference import listings
from bokeh_validation.shaders import passes


def test_defaults():
    """Section [1] has the values that the harness takes where nobody says, and the limits of the reference."""
    camera, settings = methods.Camera(), methods.Settings()
    wanted = {
        "BOKEH_NUM_SAMPLES": methods.PAPER_SAMPLES,
        "BOKEH_SPACING": 1.0,
        "BOKEH_ADAPTIVE_SAMPLES": 1,
        "BOKEH_VIEWPORT": 0,
        "BOKEH_CHARACTER": 0,
        "BOKEH_SENSOR_HEIGHT": camera.sensor_height,
        "BOKEH_MAX_COC": camera.max_coc,
        "BOKEH_BLEEDING_BIAS": settings.bleeding_bias,
        "BOKEH_BLEEDING_MULT": settings.bleeding_mult,
        "BOKEH_MAX_COLOR": listings.MAX_COLOR,
        "BOKEH_MIN_DEPTH": listings.MIN_DEPTH,
        "BOKEH_MAX_DEPTH": listings.MAX_DEPTH,
    }
    for language in paths.LANGUAGES:
        text = paths.library(language).read_text(encoding="ascii")
        found = {name: np.float32(value) for name, value in shaders.settings(language, text).items()}
        assert found == {name: np.float32(value) for name, value in wanted.items()}, language
        table = dict(re.findall(r"^//   (BOKEH_(?!PRESET)\w+) +(-?[\d.]+) ", text, re.MULTILINE))
        assert {name: np.float32(value) for name, value in table.items()} == found, language
    assert passes.PARAMETERS["BokehSensorHeight"] == camera.sensor_height
    assert passes.PARAMETERS["BokehMaxCoC"] == camera.max_coc
    assert passes.PARAMETERS["BokehBleedingBias"] == settings.bleeding_bias
    assert passes.PARAMETERS["BokehBleedingMult"] == settings.bleeding_mult


def test_default_filter():
    """BokehDefaultFilter: what section [1] configures, for an image of a size."""
    made = "BokehDefaultFilter(vec2(1920.0, 1080.0))"
    of_image = evaluated(f"BokehResult = vec4({made}.aspectRatio, {made}.imageHeight, {made}.spacing, {made}.jitter);")
    np.testing.assert_array_equal(of_image, np.float32([1920.0 / 1080.0, 1080.0, 1.0, 0.0]))
    leakage = evaluated(f"BokehResult = vec4({made}.bleedingBias, {made}.bleedingMult, 0.0, 0.0);")[:2]
    settings = methods.Settings()
    np.testing.assert_array_equal(leakage, np.float32([settings.bleeding_bias, settings.bleeding_mult]))


# Number of samples and spacing
PRESETS = {"LOW": (5, 2.0), "MEDIUM": (9, 1.5), "HIGH": (17, 1.0), "ULTRA": (33, 1.0)}


def test_presets():
    """Two passes of two lines each make the fetches of the table, and the pixels at their centres two more. Smooth is
    the CoC whose edge, half of it in a hexagon, the samples fill.
    """
    for language in paths.LANGUAGES:
        text = paths.library(language).read_text(encoding="ascii")
        rows = re.findall(r"^//   BOKEH_PRESET_(\w+) +(\d+) +([\d.]+) +(\d+) +(\d+)$", text, re.MULTILINE)
        assert {name: (int(samples), float(spacing)) for name, samples, spacing, _, _ in rows} == PRESETS
        for _, samples, spacing, fetches, smooth in rows:
            assert int(fetches) == 4 * int(samples) + 2
            assert int(smooth) == int(2 * int(samples) * float(spacing))
        if language != "wgsl":
            found = {name: tuple(map(float, values.values())) for name, values in shaders.presets(text).items() if name}
            assert found == PRESETS
