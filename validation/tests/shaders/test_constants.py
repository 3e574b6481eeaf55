"""The constants and presets are those that the harness and the documents have, and those that were tuned."""

import re

import numpy as np
from support import load

from bokeh_validation import paths, shaders
from bokeh_validation.frame import methods
from bokeh_validation.plan import fetches
from bokeh_validation.probes import coverage_frames, judges
from bokeh_validation.reference import listings
from bokeh_validation.shaders import passes


def test_defaults():
    """Section [1] has the values that the harness takes where nobody says, and the limits of the reference."""
    camera, settings = methods.Camera(), methods.Settings()
    samples, spacing = methods.EXACT_PRESETS[settings.preset]
    wanted = {
        "BOKEH_NUM_SAMPLES": samples,
        "BOKEH_SPACING": spacing,
        "BOKEH_VIEWPORT": 0,
        "BOKEH_SIDES": 0,
        "BOKEH_DEPTH_MULTISAMPLED": 0,
        "BOKEH_MAX_COLOR": listings.MAX_COLOR,
        "BOKEH_MIN_DEPTH": listings.MIN_DEPTH,
        "BOKEH_MAX_DEPTH": listings.MAX_DEPTH,
    }
    for language in paths.LANGUAGES:
        text = shaders.file_text(language)
        found = {name: np.float32(value) for name, value in shaders.settings(language, text).items()}
        # in WGSL the type of the depth buffer is an alias, which a user replaces
        known = {name: value for name, value in wanted.items() if language != "wgsl" or "MULTISAMPLED" not in name}
        assert found == {name: np.float32(value) for name, value in known.items()}, language
        table = dict(re.findall(r"^//   (BOKEH_(?!PRESET)\w+) +(-?[\d.]+) ", text, re.MULTILINE))
        in_table = {name: np.float32(value) for name, value in wanted.items() if name in table}
        assert {name: np.float32(value) for name, value in table.items()} == in_table, language
        assert set(wanted) - set(table) == {"BOKEH_MIN_DEPTH", "BOKEH_MAX_DEPTH"}, language
    assert passes.PARAMETERS["BokehSensorHeight"] == camera.sensor_height
    assert passes.PARAMETERS["BokehMaxCoC"] == camera.max_coc
    assert passes.PARAMETERS["BokehBleedingBias"] == settings.bleeding_bias
    assert passes.PARAMETERS["BokehBleedingMult"] == settings.bleeding_mult


def test_values():
    """To the bit or nearly: what section [1] configures, what functions return that no entry calls, or for numbers that
    no device can be given.
    """
    driver, frames = load("osmesa"), coverage_frames.all_frames()
    for label in ("values", "values in a part"):
        (judge,) = judges.judges(label, frames[label], driver.precision, driver.rounding)
        assert not judge.objection(driver)


PRESETS = {name.upper(): values for name, values in methods.EXACT_PRESETS.items()}


def test_presets():
    """Fetches of the table are a frame's. Smooth is the CoC whose edge, half of it in a hexagon, the samples fill."""
    for language in paths.LANGUAGES:
        text = shaders.file_text(language)
        rows = re.findall(
            r"^//   BOKEH_PRESET_(\w+) +(\d+) +([\d.]+) +(\d+) +(\d+)(?: +the default)?$", text, re.MULTILINE
        )
        assert {name: (int(samples), float(spacing)) for name, samples, spacing, _, _ in rows} == PRESETS
        for name, samples, spacing, fetched, smooth in rows:
            settings = methods.Settings("exact", preset=name.lower())
            assert int(fetched) == sum(fetches.of_frame(methods.plan(settings, (1920, 1080)).passes).values())
            assert int(smooth) == int(2 * int(samples) * float(spacing))
        if language != "wgsl":
            found = {name: tuple(map(float, values.values())) for name, values in shaders.presets(text).items() if name}
            assert found == PRESETS


TUNED = paths.VALIDATION / "tests/shaders/constants.txt"
# What is no choice: a half, a factor or an end of a share
PLAIN = {"0.0", "0.5", "1.0", "2.0"}


def tuned() -> dict[str, list[str]]:
    """Function of bokeh_layers.glsl -> its numbers in their order, but for PLAIN."""
    text = re.sub(r"//.*", "", paths.shader("glsl", "bokeh_layers").read_text(encoding="utf-8"))
    bodies = re.findall(r"^\w+ (\w+)\([^)]*\)\n\{\n(.*?)^\}", text, re.MULTILINE | re.DOTALL)
    found = {name: re.findall(r"(?<![\w.])\d+\.\d+", body) for name, body in bodies}
    return {name: kept for name, numbers in found.items() if (kept := [one for one in numbers if one not in PLAIN])}


def test_tuned_constants():
    """Of layered, which is its own reference: what constants.txt has, function by function.

    Written by hand, so that expected pictures written anew do not carry a changed constant with them. The other files'
    functions are held to formulas.py, and the three languages to each other by parity.
    """
    lines = [line.split() for line in TUNED.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    assert tuned() == {name: numbers for name, *numbers in lines}
