"""Whether BokehNoise still is noise: how many values it takes, and whether they are those it should take."""

from dataclasses import dataclass

import numpy as np

from bokeh_validation.half.evaluate import ALL_FLOAT, ALL_HALF, Evaluator
from bokeh_validation.half.frames import FRAME
from bokeh_validation.half.numbers import Rounded

BLOCK = 128


@dataclass(frozen=True)
class Noise:
    """BokehNoise on a block of BLOCK x BLOCK pixels.

    values       how many different ones, of BLOCK * BLOCK
    correlation  with float64
    """

    where: str
    precision: str
    values: int
    correlation: float


def measured() -> list[Noise]:
    """In the first and in the last corner of a 4K frame, float32 and half."""
    found = []
    for where, corner in (("first", (0, 0)), ("last", (FRAME[0] - BLOCK, FRAME[1] - BLOCK))):
        exact = _values(Rounded(np.float64), ALL_FLOAT, corner)
        for precision, choice in (("float32", ALL_FLOAT), ("half", ALL_HALF)):
            values = _values(Rounded(), choice, corner)
            correlation = float(np.corrcoef(values, exact)[0, 1])
            found.append(Noise(where, precision, len(np.unique(values)), correlation))
    return found


def _values(numbers: Rounded, choice, corner: tuple[int, int]) -> np.ndarray:
    y, x = np.mgrid[0:BLOCK, 0:BLOCK]
    uv = (np.stack([x.ravel(), y.ravel()], axis=1) + 0.5 + np.array(corner)) / np.array(FRAME)
    given = Evaluator(numbers, choice)
    return given.call("BokehNoise", uv, float(FRAME[0]), float(FRAME[1]), 1.0).ravel().astype(np.float64)
