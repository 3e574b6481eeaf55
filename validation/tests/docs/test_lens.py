"""docs/lens.md: its numbers computed again from Listing 1's formula, its code run."""

import re
from math import atan, degrees, exp, inf, radians, tan

import numpy as np
import pytest

from bokeh_validation import paths
from bokeh_validation.reference import listings

PAGE = (paths.ROOT / "docs/lens.md").read_text(encoding="utf-8")
ROWS, SENSOR = 1080, 0.024
# The page says 'far away' where the library's depth ends
FAR = listings.MAX_DEPTH


def run(code: str, **names: float) -> dict[str, float]:
    """The names after a block of the page, which is C and, without types and semicolons, Python."""
    names |= {"tan": tan, "exp": exp, "max": max}
    exec(code.replace("float ", "").replace(";", ""), names)
    return names


LENS, PULL = re.findall(r"^```c\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)


def coc(fovy: float, stop: float, focus: float, depth: float, height: float = SENSOR, unit: float = 1.0) -> float:
    """Pixels at 1080 rows, by the page's code and the reference's formula; lengths in `unit` metres."""
    lens = run(LENS, fovy=fovy, fStop=stop, sensorHeight=height / unit)
    given = lens["apertureDiameter"], lens["focalLength"], focus / unit, height / unit, inf
    return ROWS * float(listings.circle_of_confusion(np.float64(depth / unit), *given))


def field_of_view(focal_length: float, height: float = SENSOR) -> float:
    return 2.0 * atan(0.5 * height / focal_length)


def table(head: str) -> list[list[str]]:
    """Cells of the rows below a table's head."""
    rows = PAGE.split(head, 1)[1].split("\n\n", 1)[0].splitlines()[2:]
    return [row.strip("| ").split(" | ") for row in rows]


def rounded(value: float) -> str:
    """As the page writes it: three digits that count."""
    return f"{value:.3g}"


def test_formulas():
    """f gives the field of view back, A / f is 1 / N, and the matrix's element gives the same f."""
    lens = run(LENS, fovy=1.0, fStop=2.8, sensorHeight=SENSOR)
    assert field_of_view(lens["focalLength"]) == pytest.approx(1.0)
    assert lens["apertureDiameter"] * 2.8 == pytest.approx(lens["focalLength"])
    assert "0.5 * sensorHeight * abs(P[1][1])" in PAGE
    assert 0.5 * SENSOR / tan(0.5) == pytest.approx(lens["focalLength"])


def test_table():
    """Every number of the large table."""
    stops = [float(stop) for stop in re.findall(r"f/([\d.]+)", PAGE.split("| lens, field of view |")[1].split("\n")[0])]
    rows = table("| lens, field of view |")
    assert len(rows) == 9 and len(stops) == 6 and f"ends at {0.1 * ROWS:.0f}" in PAGE
    for lens, focus, *found in rows:
        millimetres, shown = re.fullmatch(r"(\d+) mm, ([\d.]+) degrees", lens).groups()
        fovy = field_of_view(0.001 * float(millimetres))
        assert shown == f"{degrees(fovy):.1f}"
        wanted = [coc(fovy, stop, float(focus.removesuffix(" m")), FAR) for stop in stops]
        assert found == [rounded(value) for value in wanted], lens


def test_room():
    """The wall 10 m away, the approximation for the text, and the f-stop as the scale."""
    for fovy, focal_length, found in table("| field of view | focal length |"):
        millimetres = float(focal_length.removesuffix(" mm"))
        assert fovy == f"{degrees(field_of_view(0.001 * millimetres)):.3g} degrees"
        # of the focal length where that is a whole number, else of the angle
        angle = field_of_view(0.001 * millimetres) if millimetres % 1 == 0 else radians(float(fovy.split()[0]))
        assert focal_length == f"{1000 * run(LENS, fovy=angle, fStop=1, sensorHeight=SENSOR)['focalLength']:.3g} mm"
        assert found == f"{rounded(coc(angle, 2.8, 5.0, 10.0))} pixels"
        assert coc(angle, 0.14, 5.0, 10.0) == pytest.approx(20 * coc(angle, 2.8, 5.0, 10.0))
        f = 0.001 * millimetres
        assert coc(angle, 2.8, 5.0, 10.0) == pytest.approx(ROWS * f * f / (2.8 * SENSOR) * 0.1, rel=0.02)
        # a model in 1 : 20 through the same lens: all distances a twentieth; S1 - f is not S1
        assert coc(angle, 2.8, 0.25, 0.5) == pytest.approx(20 * coc(angle, 2.8, 5.0, 10.0), rel=1.1 * f / (0.25 - f))


@pytest.mark.parametrize("rate", [24, 60, 144])
def test_pull(rate):
    """The way left is exp(-t / tau) at any frame rate, the nearest wins, and the sky is no trouble."""
    pulled, tau = 1 / 10.0, 0.25
    for _ in range(rate):
        pulled = run(PULL, dt=1 / rate, tau=tau, d0=inf, d1=2.0, d2=5.0, pulled=pulled)["pulled"]
    assert 1 / 2.0 - pulled == pytest.approx((1 / 2.0 - 1 / 10.0) * exp(-1 / tau))
    assert f"After 3 tau {100 * exp(-3):.0f} % is left" in PAGE
