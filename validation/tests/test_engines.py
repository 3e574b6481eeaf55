"""Every engine sample: run with its own colour and depth, and within the interval of the reference."""

import os

import pytest

from bokeh_validation import engines
from bokeh_validation.errors import Unavailable

QUICK = [name for name, engine in engines.ENGINES.items() if not engine.slow]
WANTED = {("paper", "hexagon"), ("paper", "octagon"), ("exact", "hexagon"), ("exact", "octagon")}


@pytest.mark.parametrize("name", QUICK)
def test_sample(name):
    """Hexagon and octagon, paper and exact, on what the engine drew."""
    try:
        capture = engines.run(name)
    except Unavailable as error:
        if os.environ.get("CI"):
            pytest.fail(f"{name} is missing: {error}")
        pytest.skip(f"{name}: {error}")
    assert {(s.case.settings.method, s.case.settings.aperture) for s in capture.shots} >= WANTED
    for shot in capture.shots:
        assert shot.comparison.outside == 0, f"{shot.name}: {shot.comparison}"
        # something is in focus, something is not, and something is brighter than white
        depth, color = shot.case.depth, shot.case.color
        assert depth.max() > 2 * depth.min() and color[..., :3].max() > 4.0
        assert abs(shot.result.astype(float) - color.astype(float))[..., :3].max() > 0.1
