"""Test the lens's character: cat's eye and curved blades. test_within.py draws them on noise; probes test colour."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from lines import LEAST, edge_lengths, parallelogram, polygon_edge
from support import spread
from support_cases import CAMERA, evaluated, everything, noise_case, result

from bokeh_validation import metrics
from bokeh_validation.frame import aperture_shapes, geometry
from bokeh_validation.frame.methods import Settings


@pytest.mark.parametrize("rotation, squeeze", [*product((0.0, 0.3), (1.0, 0.5))])
@pytest.mark.parametrize("amount, towards", [(0.0, 0.0), *product((0.4, 0.9), (0.0, 20.0, 45.0, 100.0))])
@pytest.mark.parametrize("sides", [4, 6, 8, 10])
def test_tiling(sides, amount, towards, rotation, squeeze):
    """Check that the parallelograms do not overlap, and fill the intersection of the polygon shifted to both sides.

    towards   degrees from the polygon's own axis: the aperture is cut, then rotated and squeezed
    rotation  radians
    """
    cut = amount * aperture_shapes.direction(np.radians(towards))
    polygon, moved, found = (
        aperture_shapes.even_polygon(sides),
        0.5 * np.cos(np.pi / sides) * cut,
        edge_lengths(sides, cut),
    )
    whole = geometry.clip_convex(polygon + moved, polygon - moved)
    corners = aperture_shapes.rotated(whole, np.degrees(rotation)) * [squeeze, 1.0]
    x, y = np.random.default_rng(sides).uniform(-0.6, 0.6, (2, 20000))
    held, total = np.zeros(x.shape, int), 0.0
    for k in range(2, sides // 2 + 1):
        second = polygon_edge(k, sides, rotation, squeeze, True, found)
        for i in range(1, k):
            first = polygon_edge(i, sides, rotation, squeeze, False, found)
            middle, u, v = first.middle + second.middle, first.half, second.half
            shape = np.array([middle + u + v, middle + u - v, middle - u - v, middle - u + v])
            held += geometry.inside(shape, x, y)
            area = abs(geometry.signed_area(shape))
            assert area == pytest.approx(squeeze * parallelogram(k, i, sides, found) * found[k - 1], rel=1e-9)
            total += area
    # an edge that has vanished still has the length LEAST, and shifts the others by that much
    off = sides / 2 * LEAST if (found <= LEAST).any() else 1e-12
    assert total == pytest.approx(abs(geometry.signed_area(corners)), abs=off)
    assert (held != geometry.inside(corners, x, y)).mean() <= 4 * off


@pytest.mark.parametrize("roundness", [0.1, 0.5, 1.0])
def test_rounded_outline(roundness):
    """Check the chords of a square with cut corners on the circle: a corner takes a fraction of an eighth, a side the
    rest of its quarter.
    """
    chords = np.sin(np.radians([22.5 * roundness, 45.0 - 22.5 * roundness]))
    np.testing.assert_allclose(edge_lengths(8, np.zeros(2), roundness), [*chords, *chords], rtol=1e-12)


@pytest.mark.parametrize(
    "uncut", ["{}", "BokehWithRoundness({}, 1.0)", "BokehWithCatsEye({}, uv, vec2(3.0, 2.0), 0.0)"]
)
@pytest.mark.parametrize("sides", [4, 6, 8, 10])
def test_made_for_a_cut(sides, uncut):
    """Check BokehMakePolygon alone, and with a lens that cuts nothing: lines (rays in a hexagon) and area of the plain
    polygon.

    2^-12 is far above float32's roundings, and far below sin(pi / 10) - sin(pi / 11) = 0.027, the effect of one more
    side.
    """
    made = f"vec2 uv = vec2(0.25, 1.0); BokehPolygon p = {uncut.format(f'BokehMakePolygon({sides}, 0.5, 0.75)')};"
    expected = polygon_edge(2, sides, 0.5, 0.75, True, edge_lengths(sides))
    line = "BokehRay" if sides == 6 else "BokehEdgeLine"
    actual = evaluated(f"{made} BokehResult = {line}(2, p, true);")
    np.testing.assert_allclose(actual, [*expected.middle, *expected.half], atol=2.0**-12)
    area = evaluated(f"{made} BokehResult = vec4(p.area, 0.0, 0.0, 0.0);")[0]
    assert area == pytest.approx(abs(geometry.signed_area(aperture_shapes.even_polygon(sides))), abs=2.0**-12)


@spread("method", ["exact", "layered"])
def test_nothing_to_cut(method, driver):
    """Check that an amount of 0 gives the plain polygon, up to the rounding between two ways of computing it."""
    case = noise_case((61, 48), Settings(method, "hexagon", 7, camera=CAMERA, cats_eye=0.7))
    plain = result(driver, replace(case, settings=replace(case.settings, cats_eye=0.0)))
    cut, none = (everything(driver, case, BokehCatsEye=amount)["result"] for amount in (0.7, 0.0))
    assert np.mean(metrics.steps(none, plain.astype(np.float64)) > metrics.CLOSE_STEPS) < 0.01
    assert np.mean(metrics.steps(cut, plain.astype(np.float64)) > metrics.FAR_STEPS) > 0.02
