"""Test BokehStableMap: outlines in jittered depth do not flicker, and disappear with their object."""

import numpy as np
import pytest

from bokeh_validation.frame import methods
from bokeh_validation.frame.methods import Settings
from bokeh_validation.probes.model import flat

SIZE, SETTINGS = (40, 12), Settings("exact")
JITTERED = (20, 21, 20, 21, 21, 20, 20, 21)


def maps(driver, ends, blend, moved=0.0, history=1.0) -> tuple[np.ndarray, np.ndarray]:
    """Return the CoC of the middle row, (frames, width), of the plain and the stabilised map.

    ends     column at which the near object ends, for each frame
    moved    its velocity, pixels per frame
    history  CoC before the first frame
    """
    velocity = np.full((SIZE[1], SIZE[0], 4), moved / SIZE[0], np.float16) * np.float16([1, 0, 0, 0])
    found, last = [], flat(SIZE, 0.0, history)
    for end in ends:
        depth = np.full(SIZE[::-1], 20.0, np.float32)
        depth[:, :end] = 2.0
        passes = methods.steadied(methods.plan(SETTINGS, SIZE), SIZE, blend).passes[:2]
        textures = {"color": flat(SIZE), "depth": depth, "velocity": velocity, "history": last}
        outputs = driver.run(passes, textures, SIZE, keep=("new coc", "coc"))
        last = outputs["coc"]
        found.append([outputs[name][SIZE[1] // 2, :, 3].astype(float) for name in ("new coc", "coc")])
    return tuple(np.swapaxes(found, 0, 1))


def test_stands_still(driver):
    """Check a pixel that is near in some frames only: each frame changes a twentieth."""
    new, steady = maps(driver, JITTERED * 4, 0.05)
    step = np.ptp(new[:, 20])
    assert step > 0.04
    assert np.abs(np.diff(steady[8:], axis=0)).max() == pytest.approx(0.05 * 1.95 * step, rel=0.1)
    assert (steady[8:, 22:] == new[8:, 22:]).all() and (steady[8:, :20] == new[8:, :20]).all()


def test_goes_along(driver):
    """Check that the map follows what moves; half a pixel per frame smears over a pixel, and without velocity it lags
    by one.
    """
    new, steady = maps(driver, range(10, 26), 0.05, moved=1.0)
    assert np.abs(steady - new)[1:, 1:].max() < 0.001
    for moved, ends in ((0.5, np.arange(20, 52) // 2), (0.0, range(25, 9, -1)), (0.0, range(25, 4, -5))):
        new, steady = maps(driver, ends, 0.05, moved)
        columns = np.arange(SIZE[0]) - np.reshape(ends, (-1, 1))
        assert ((steady == new) | (columns == -1) | (columns == 0)).all()


@pytest.mark.parametrize("history", [np.nan, np.inf, -np.inf, 1.0, -1.0])
def test_begins_anew(driver, history):
    """Check that nothing remains after a cut, whatever the previous frame held, and that values stay within the
    neighbourhood.
    """
    new, steady = maps(driver, (20, 20), 1.0, history=history)
    assert (steady == new).all()
    new, steady = maps(driver, JITTERED, 0.05, history=history)
    assert (steady <= new).all() and (steady[:, 22:] == new[:, 22:]).all() and (steady >= new.min()).all()
    # nothing comes from outside the image
    new, steady = maps(driver, (20, 20), 0.0, moved=1.0, history=history)
    assert (steady[:, 0] == new[:, 0]).all()
