"""The character of a lens: cat's eye, in the exact and in the layered method."""

import re
from dataclasses import replace

import numpy as np
import pytest
from support import in_each_language, load
from support_cases import CAMERA, everything, judged, kind, noise_case, result, within
from support_targets import framed, inside

from bokeh_validation import metrics, shaders
from bokeh_validation.frame import apertures, methods, polygons
from bokeh_validation.frame.methods import Settings
from bokeh_validation.probes import cats_eye
from bokeh_validation.reference import cuts, segments
from bokeh_validation.reference.device import Reference

EXACT = Settings("exact", "hexagon", camera=CAMERA, cats_eye=0.7)
LAYERED = Settings("layered", "hexagon", 7, camera=CAMERA, cats_eye=0.7)
# far layers of 25 pixels, where the lengths of the edges show
WIDE = methods.Camera(0.4, 0.05, 4.0, max_coc=0.5)


@pytest.mark.parametrize("amount", [0.0, 0.4, 0.9])
@pytest.mark.parametrize("towards", [0.0, 20.0, 45.0, 100.0])
@pytest.mark.parametrize("sides", [4, 6, 8, 10])
def test_tiling(sides, towards, amount):
    """The parallelograms lie side by side and fill what two polygons have in common that are moved to both sides."""
    polygon = apertures.even_polygon(sides)
    moved = 0.5 * np.cos(np.pi / sides) * amount * apertures.direction(np.radians(towards))
    corners = polygons.clip_convex(polygon + moved, polygon - moved)
    found = cuts.lengths(sides, amount * apertures.direction(np.radians(towards)))
    random = np.random.default_rng(sides)
    x, y = random.uniform(-0.6, 0.6, (2, 20000))
    held, total = np.zeros(x.shape, int), 0.0
    for k in range(2, sides // 2 + 1):
        second = segments.polygon_edge(k, sides, 0.0, 1.0, True, found)
        for i in range(1, k):
            first = segments.polygon_edge(i, sides, 0.0, 1.0, False, found)
            middle, u, v = first.middle + second.middle, first.half, second.half
            shape = np.array([middle + u + v, middle + u - v, middle - u - v, middle - u + v])
            held += polygons.inside(shape, x, y)
            area = abs(polygons.signed_area(shape))
            assert area == pytest.approx(segments.parallelogram(k, i, sides, found) * found[k - 1], rel=1e-9)
            total += area
    # an edge that is gone is still LEAST long, and moves the others by so much
    off = sides / 2 * cuts.LEAST if (found <= cuts.LEAST).any() else 1e-12
    assert total == pytest.approx(abs(polygons.signed_area(corners)), abs=off)
    wrong = held != polygons.inside(corners, x, y)
    assert wrong.mean() <= 4 * off


@pytest.mark.parametrize("sides", [4, 6, 8, 10])
def test_made_for_a_cut(sides):
    """BokehMakePolygon alone, with BOKEH_CHARACTER 1: the lines of the plain polygon.

    2^-12 is far above float32's roundings, and far below sin(pi / 10) - sin(pi / 11) = 0.027, what a side more makes.
    """
    text = re.sub(r"\bvoid main\(\)", "void unused()", shaders.glsl("BokehSquareSecond", "330", {"BOKEH_CHARACTER": 1}))
    text += (
        f"void main()\n{{\n    BokehPolygon polygon = BokehMakePolygon({sides}, 0.5, 0.75);\n"
        "    BokehResult = BokehPolygonEdge(2, polygon, true);\n}\n"
    )
    case = noise_case((8, 8), replace(EXACT, aperture="square"))
    item = replace(case.plan.passes[-1], sources={"glsl": text}, inputs={})
    found = load("osmesa").run([item], {}, (8, 8), "float", keep=item.outputs)[item.outputs[0]][0, 0]
    wanted = segments.polygon_edge(2, sides, 0.5, 0.75, True)
    np.testing.assert_allclose(found, [*wanted.middle, *wanted.half], atol=2.0**-12)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"targets": False},
        {"rotation": 17.0, "squeeze": 0.6},
        {"spacing": 1.0, "max_samples": 5, "jitter": 1.0, "frame": 3},
        {"cats_eye": 0.3, "spacing": 1.0},
        {"cats_eye": 5.0},
    ],
    ids=str,
)
@pytest.mark.parametrize("aperture", methods.EXACT)
@in_each_language
def test_exact_on_noise(aperture, changes, driver):
    """Random patches of colour and depth: within the interval of the reference."""
    within(driver, noise_case((61, 48), replace(EXACT, aperture=aperture, **changes)))


@pytest.mark.parametrize(
    "changes",
    [
        {"rotation": 17.0},
        {"aperture": "square", "squeeze": 0.5},
        {"aperture": "octagon", "targets": False, "rotation": 5.0},
        {"aperture": "decagon", "jitter": 1.0, "frame": 3},
        {"camera": WIDE, "rotation": 17.0, "cats_eye": 0.9},
        {"camera": WIDE, "aperture": "decagon", "targets": False, "cats_eye": 0.9},
    ],
    ids=str,
)
@in_each_language
def test_layered_on_noise(changes, driver):
    """Every pass within the interval of the reference."""
    within(driver, noise_case((75, 50), replace(LAYERED, **changes)))


@pytest.mark.parametrize("roundness", [0.1, 0.5, 1.0])
def test_rounded_outline(roundness):
    """A square whose corners are cut off, on the circle: the sides of the polygon, one by one."""
    corners = cats_eye.rounded(roundness)
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1)
    # the outline begins with a corner that is cut off, edge 1 of the octagon is such a one
    np.testing.assert_allclose(cuts.lengths(8, np.zeros(2), roundness), np.roll(sides, -2)[:4], rtol=1e-12)


@pytest.mark.parametrize("roundness", [0.5, 0.0, -1.0])
@in_each_language
def test_curved_blades(roundness, driver):
    """An octagon between a square and a regular one, cut by the barrel or not."""
    for settings in (replace(EXACT, cats_eye=0.0), EXACT, LAYERED):
        within(driver, noise_case((61, 48), replace(settings, aperture="octagon", roundness=roundness, rotation=10.0)))


@pytest.mark.parametrize("name", ["d3d9", "webgl2", "webgpu"])
def test_exact_elsewhere(name):
    """The same in shader model 3 and in a browser."""
    for aperture in methods.EXACT:
        within(load(name), noise_case((61, 48), replace(EXACT, aperture=aperture, rotation=17.0, roundness=0.5)))


@pytest.mark.parametrize("settings", [EXACT, LAYERED], ids=["exact", "layered"])
@in_each_language
def test_nothing_to_cut(settings, driver):
    """An amount of 0 is the plain polygon, to the steps that two ways to compute it differ by."""
    case = noise_case((61, 48), settings)
    plain = result(driver, replace(case, settings=replace(settings, cats_eye=0.0)))
    cut, none = (everything(driver, case, BokehCatsEye=amount)["result"] for amount in (0.7, 0.0))
    assert np.mean(metrics.steps(none, plain.astype(np.float64)) > metrics.CLOSE_STEPS) < 0.01
    assert np.mean(metrics.steps(cut, plain.astype(np.float64)) > metrics.FAR_STEPS) > 0.02


@pytest.mark.parametrize("method", [EXACT, LAYERED], ids=["exact", "layered"])
@in_each_language
def test_viewport(method, driver):
    """The image that is a part of its textures has its own middle and corners."""
    viewport, textures = (24, 8, 48, 37), (90, 74)
    image = noise_case(viewport[2:], method)
    plan = methods.in_viewport(image.plan, viewport, textures)
    given = {"color": framed(image.color, textures, viewport), "depth": framed(image.depth, textures, viewport)}
    names = [name for item in plan.passes for name in item.outputs]
    outputs = driver.run(plan.passes, given, textures, keep=names)
    wanted = Reference().images(plan.passes, given, textures, "half", kind(driver), driver.rounding, given=outputs)
    x, y, width, height = viewport
    part = slice(y, y + height), slice(x, x + width)
    comparison = metrics.compare(inside(outputs["result"], viewport), wanted["result"].part(*part), False)
    assert comparison.outside == 0, comparison


@pytest.mark.parametrize("changes", [{"cats_eye": 0.0}, {"cats_eye": 0.4}, {"coc": 0.15}], ids=str)
def test_probe_notices(changes):
    """No cut, half of one, and a CoC that is too small."""
    probe = cats_eye.PROBES[0]
    assert not all(check.ok for check in judged(probe, **changes))
