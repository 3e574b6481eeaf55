"""Test the tolerances: images slightly beyond each bound of the comparison must be refused, and the value of every
tolerance is here with its derivation, so that loosening one in the code alone fails.

The decisive bound is the interval, derived in numerics/precision.py. The bounds in steps are chosen, not derived:
Mesa's software drivers stay well within them.
"""

import ast
import json
from contextlib import suppress

import numpy as np
import pytest

from bokeh_validation import metrics, paths
from bokeh_validation.numerics import images

SHAPE = (50, 40, 4)
PIXELS = SHAPE[0] * SHAPE[1]
STEP = 2.0**-10  # of a half float from 1 to 2


def off(pixels: int, steps: float) -> metrics.Comparison:
    """Compare an image of 1.5 with some pixels off by so many steps, while the interval allows everything."""
    picture = np.full(SHAPE, 1.5)
    picture.reshape(-1, 4)[:pixels] += steps * STEP
    expected = np.full(SHAPE, 1.5)
    reference = images.Image(expected, np.ones(SHAPE), np.zeros(SHAPE[:2], bool))
    return metrics.compare(picture.astype(np.float16), reference, True)


@pytest.mark.parametrize(
    ("pixels", "steps", "ok"),
    [
        (PIXELS, 4, True),
        (PIXELS // 200, 5, True),
        (PIXELS // 200 + 1, 5, False),
        (1, 32, True),
        (1, 33, False),
    ],
)
def test_steps(pixels, steps, ok):
    """Check that all pixels may be 4 steps off, 0.005 of them more, and none more than 32."""
    assert off(pixels, steps).ok == ok


PRECISION = "bokeh_validation/numerics/precision.py"
TRUTH = "tests/shaders/test_truth.py"
# File, name and value of each tolerance, with what the value follows from; "chosen" if nothing derives it
TOLERANCES = [
    (PRECISION, "FLOAT_STEP", 2.0**-24, "rounding to nearest of float32's 24 bits"),
    (PRECISION, "COORDINATE_ULPS", 8, "chosen: interpolating, moving and scaling uv are at most 8 roundings"),
    (PRECISION, "GPU.subtexel", 1 / 256, "Direct3D and Vulkan require 8 bits below the texel"),
    (PRECISION, "GPU.filter", 2.0**-11, "rounding to nearest of half floats' 11 bits"),
    (PRECISION, "SINE", 0.000001, "three roundings of 1.25 turns, times 2 pi"),
    (PRECISION, "SOFTWARE.subtexel", 0.0, "positions stay float32"),
    (PRECISION, "SOFTWARE.filter", 4 * 2.0**-24, "chosen: a blend along x and one along y, of two roundings each"),
    ("bokeh_validation/probes/judges.py", "STEP", 2.0**-10, "a store into half floats truncates 11 bits"),
    ("bokeh_validation/probes/judges.py", "SMALLEST", 2.0**-24, "the smallest half float"),
    ("bokeh_validation/metrics.py", "CLOSE_STEPS", 4, "chosen: two passes of one or two roundings"),
    ("bokeh_validation/metrics.py", "CLOSE_SHARE", 0.995, "chosen: other pixels are at edges of the CoC"),
    ("bokeh_validation/metrics.py", "FAR_STEPS", 32, "chosen: 3 % of a value"),
    ("bokeh_validation/metrics.py", "UNDECIDED_SHARE", 0.001, "chosen: pixels whose comparisons are open"),
    (TRUTH, "SAME", 0.0005, "chosen: 0 on one Mesa; a changed sigma of the CoC gives 0.0104"),
    ("tests/shaders/test_inputs.py", "ROUNDINGS", 12 * 2.0**-24, "seven operations, of which two divisions of 2.5"),
    ("lab/tests/test_pictures.py", "MAX_DIFFERENCE", 0.5, "chosen: half a step of 8 bits, on average"),
    ("lab/tests/test_isa.py", "TOLERANCE", 0.05, "chosen: another order of instructions, and a few copies"),
    ("engines/tests/test_engines.py", "CLOSE", 0.998, "chosen: other pixels are beside lights"),
]


def constants(file: str) -> dict[str, object]:
    """Return a file's constants that are made of numbers only; those of a Precision as 'name.field'."""
    found = {"__builtins__": {}, "Precision": lambda **fields: fields}
    for node in ast.parse((paths.VALIDATION / file).read_text(encoding="utf-8")).body:
        with suppress(NameError):
            if isinstance(node, ast.Assign):
                exec(compile(ast.Module([node], []), file, "exec"), found)
    fields = {f"{name}.{key}": one for name, d in found.items() if isinstance(d, dict) for key, one in d.items()}
    return found | fields


@pytest.mark.parametrize(("file", "name", "value", "why"), TOLERANCES)
def test_tolerance(file, name, value, why):
    """Check that the code has the tolerance that the table derives."""
    assert constants(file)[name] == value, why


def test_bounds_of_truth():
    """Check that the bounds for MEDIUM are no more than 0.005 above its recorded FLIP, and that none is missing."""
    rows = json.loads((paths.ROOT / "docs/data/truth.json").read_text(encoding="utf-8"))["rows"]
    recorded = {row["scene"]: row["flip"] for row in rows if row["label"] == "layered medium"}
    bounds = constants(TRUTH)["BOUNDS"]
    assert set(bounds) == set(recorded)
    assert all(recorded[scene] <= bound <= recorded[scene] + 0.005 for scene, bound in bounds.items())
