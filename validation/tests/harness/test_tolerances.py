"""Test the tolerances of the comparison: images slightly beyond each bound must be refused.

The decisive bound is the interval, derived in numerics/precision.py. The bounds in steps are chosen, not derived:
Mesa's software drivers stay well within them.
"""

import numpy as np
import pytest

from bokeh_validation import metrics
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


def test_undecided():
    """Check that 0.001 of the pixels may be far off if a comparison is open."""
    assert metrics.UNDECIDED_SHARE == 0.001
