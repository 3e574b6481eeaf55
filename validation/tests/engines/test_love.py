"""integration/love: what its guide says of depth and focus is so."""

import json
import math

import numpy as np
import pytest
from support import needed

from bokeh_validation.engines import love


@pytest.fixture(scope="module")
def focus(tmp_path_factory):
    folder = tmp_path_factory.mktemp("love")
    with needed("LÖVE"):
        love.run("love", folder)
    return json.loads((folder / "capture.json").read_text(encoding="utf-8"))["focus"]


def test_depth_under_a_place(focus):
    """Where the projection puts the collar of the pawn, upright, its surface is met first: radii are 0.1 to 0.28 m."""
    assert focus["subject"] - 0.28 < focus["read"] < focus["subject"] - 0.09


def test_pull(focus):
    """To the nearest of 7 m, 2 m and infinity: n frames of dt leave exp(-n dt / tau) of the way in 1 / distance."""
    left = (1 / np.array(focus["pulled"]) - 1 / 2) / (1 / focus["subject"] - 1 / 2)
    frames = np.arange(1, len(left) + 1)
    # distances went through float32; their differences from the end keep 1e-5
    np.testing.assert_allclose(left, [math.exp(-n * 0.02 / 0.2) for n in frames], rtol=1e-4)
