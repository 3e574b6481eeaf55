"""docs/lens.md: its code, run."""

import re
from math import atan, exp, inf, tan

import pytest

from bokeh_validation import paths

PAGE = (paths.ROOT / "docs/lens.md").read_text(encoding="utf-8")
SENSOR = 0.024


def run(code: str, **names: float) -> dict[str, float]:
    """The names after a block of the page, which is C and, without types and semicolons, Python."""
    names |= {"tan": tan, "exp": exp, "max": max}
    exec(code.replace("float ", "").replace(";", ""), names)
    return names


LENS, PULL = re.findall(r"^```c\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)


def test_formulas():
    """f gives the field of view back, A / f is 1 / N, and the matrix's element gives the same f."""
    lens = run(LENS, fovy=1.0, fStop=2.8, sensorHeight=SENSOR)
    assert 2.0 * atan(0.5 * SENSOR / lens["focalLength"]) == pytest.approx(1.0)
    assert lens["apertureDiameter"] * 2.8 == pytest.approx(lens["focalLength"])
    assert "0.5 * sensorHeight * abs(P[1][1])" in PAGE
    assert 0.5 * SENSOR / tan(0.5) == pytest.approx(lens["focalLength"])


@pytest.mark.parametrize("rate", [24, 60, 144])
def test_pull(rate):
    """The way left is exp(-t / tau) at any frame rate, the nearest wins, and the sky is no trouble."""
    pulled, tau = 1 / 10.0, 0.25
    for _ in range(rate):
        pulled = run(PULL, dt=1 / rate, tau=tau, d0=inf, d1=2.0, d2=5.0, pulled=pulled)["pulled"]
    assert 1 / 2.0 - pulled == pytest.approx((1 / 2.0 - 1 / 10.0) * exp(-1 / tau))
    assert f"After 3 tau {100 * exp(-3):.0f} % is left" in PAGE
