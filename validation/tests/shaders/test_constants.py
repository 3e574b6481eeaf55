"""Check constants and presets against the harness and the documents, and the tuned ones against a list."""

import os
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
    """Check that section [1] has the harness's default values, and the limits of the reference."""
    camera, settings = methods.Camera(), methods.Settings()
    samples, spacing = methods.EXACT_PRESETS[settings.preset]
    expected = {
        "BOKEH_NUM_SAMPLES": samples,
        "BOKEH_SPACING": spacing,
        "BOKEH_VIEWPORT": 0,
        "BOKEH_SIDES": 0,
        "BOKEH_DEPTH_MULTISAMPLED": 0,
        "BOKEH_HALF_PRECISION": 0,
        "BOKEH_MAX_COLOR": listings.MAX_COLOR,
        "BOKEH_MIN_DEPTH": listings.MIN_DEPTH,
        "BOKEH_MAX_DEPTH": listings.MAX_DEPTH,
    }
    for language in paths.LANGUAGES:
        text = shaders.file_text(language)
        found = shaders.settings(language, text).items()
        actual = {name: np.float32(value) for name, value in found if not name.startswith("BOKEH_TUNED_")}
        # in WGSL the type of the depth buffer is an alias that users replace
        known = {name: value for name, value in expected.items() if language != "wgsl" or "MULTISAMPLED" not in name}
        assert actual == {name: np.float32(value) for name, value in known.items()}, language
        table = dict(re.findall(r"^//   (BOKEH_(?!PRESET)\w+) +(-?[\d.]+) ", text, re.MULTILINE))
        in_table = {name: np.float32(value) for name, value in expected.items() if name in table}
        assert {name: np.float32(value) for name, value in table.items()} == in_table, language
        assert set(expected) - set(table) == {"BOKEH_MIN_DEPTH", "BOKEH_MAX_DEPTH"}, language
    assert passes.PARAMETERS["BokehSensorHeight"] == camera.sensor_height
    assert passes.PARAMETERS["BokehMaxCoC"] == camera.max_coc
    assert passes.PARAMETERS["BokehBleedingBias"] == settings.bleeding_bias
    assert passes.PARAMETERS["BokehBleedingMult"] == settings.bleeding_mult


def test_values():
    """Check values exactly or nearly: what section [1] configures, functions that no entry calls, and arguments that
    no device can be given.
    """
    driver, frames = load("egl"), coverage_frames.all_frames()
    for label in ("values", "values in a part"):
        (judge,) = judges.judges(label, frames[label], driver.precision, driver.rounding)
        assert not judge.objection(driver)


PRESETS = {name.upper(): values for name, values in methods.EXACT_PRESETS.items()}


def test_presets():
    """Check that the table has a frame's fetches; "smooth" is the CoC whose edge the samples fill, half of it in a
    hexagon.
    """
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
# Numbers that are not tuned: a half, a factor, or an end of a ramp
PLAIN = {"0.0", "0.5", "1.0", "2.0"}


def tuned() -> dict[str, list[str]]:
    """Return function of bokeh_layers.glsl -> its numbers in order, without PLAIN; and each BOKEH_TUNED_ constant."""
    text = re.sub(r"//.*", "", paths.shader("glsl", "bokeh_layers").read_text(encoding="utf-8"))
    named = {name: [value] for name, value in re.findall(r"^#define (BOKEH_TUNED_\w+) (\S+)$", text, re.MULTILINE)}
    bodies = re.findall(r"^\w+ (\w+)\([^)]*\)\n\{\n(.*?)^\}", text, re.MULTILINE | re.DOTALL)
    found = {name: re.findall(r"(?<![\w.])\d+\.\d+", body) for name, body in bodies}
    kept = {name: [one for one in numbers if one not in PLAIN] for name, numbers in found.items()}
    return named | {name: numbers for name, numbers in kept.items() if numbers}


def test_tuned_constants():
    """Compare the constants of layered, which has no independent reference, with constants.txt, function by function.

    BOKEH_WRITE_CONSTANTS=1 writes the list, after a new pass for example, and the commit shows what changed. Newly
    written expected images have a variable of their own, so that they do not hide a changed constant. Functions of the
    other files are compared with formulas.py, and the three languages with each other by parity.
    """
    lines = TUNED.read_text(encoding="utf-8").splitlines()
    if os.environ.get("BOKEH_WRITE_CONSTANTS"):
        lines = [line for line in lines if line.startswith("#")]
        lines += [" ".join((name, *numbers)) for name, numbers in tuned().items()]
        TUNED.write_text("\n".join(lines) + "\n", encoding="utf-8")
    listed = (line.split() for line in lines if not line.startswith("#"))
    assert tuned() == {name: numbers for name, *numbers in listed}
