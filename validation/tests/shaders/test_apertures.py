"""Test the decomposition of polygons: parallelograms, passes, light, orientation; its command and its document."""

import json
from dataclasses import replace
from functools import reduce

import numpy as np
import pytest
from support import called, in_each_language

from bokeh_validation import paths
from bokeh_validation.frame import aperture_shapes, geometry, methods
from bokeh_validation.frame.decomposition import TOLERANCE, Decomposition, decompose, parsed, strips_around
from bokeh_validation.probes import highlight, impulse
from bokeh_validation.probes.model import overlap, pixel_center

DOCUMENT = (paths.ROOT / "docs/methods/polygons.md").read_text(encoding="utf-8")
REGULAR = range(3, 13)
# Corners of shapes with and without parallel sides -> the fewest passes, and the most light of all sets of pairs of
# directions
SHAPES = {
    "-0.35,-0.3 0.1,-0.45 0.45,-0.1 0.3,0.4 -0.3,0.35": (5, 0.6472),
    "-0.2,-0.3 0.25,-0.3 0.4,0.3 -0.4,0.3": (3, 0.7812),
    "0,-0.5 0.3,-0.1 0,0.45 -0.3,-0.1": (4, 0.8636),
    "-0.4,-0.4 0.4,-0.4 0.4,0.2 0.2,0.4 -0.4,0.4": (3, 0.5536),
    "-0.4,-0.4 0.4,-0.4 0.4,0.1 0.2,0.4 -0.4,0.4": (4, 0.6728),
    "-0.45,-0.1 -0.2,-0.4 0.3,-0.4 0.45,0.1 0.2,0.4 -0.3,0.4": (4, 0.7210),
    "-0.5,0 0.1,-0.02 0.5,0.01 0.2,0.03": (4, 0.7656),
    "0.1,0.1 0.5,0.15 0.3,0.5": (3, 0.5),
}
PENTAGON = next(iter(SHAPES))


POLYGONS = {text: parsed(text) for text in SHAPES}
POLYGONS |= {f"{sides} sides": aperture_shapes.regular_polygon(sides) for sides in (*REGULAR, 16)}


def drawn_by(shape: Decomposition) -> list[np.ndarray]:
    """Return the corners (4, 2) of each parallelogram: the reflection of the points that its two lines sample."""
    parallelograms = []
    for second in (line for line in shape.passes if line.reads is not None):
        first = shape.passes[second.reads]
        half = [0.5 * line.length * aperture_shapes.direction(np.radians(line.angle)) for line in (first, second)]
        signs = np.array([[1, 1], [1, -1], [-1, -1], [-1, 1]])
        parallelograms.append(signs @ np.array(half) - np.array(first.center) - np.array(second.center))
    return parallelograms


def assert_in_common(shape: Decomposition, polygon: np.ndarray, tolerance: float) -> None:
    """Check that the parallelograms' intersection is the polygon, with sides off by at most `tolerance`, and that min
    combines all.
    """
    common = reduce(geometry.clip_convex, drawn_by(shape))
    for corners in (common, geometry.clip_convex(common, polygon)):
        off = abs(geometry.signed_area(corners)) - abs(geometry.signed_area(polygon))
        assert abs(off) <= tolerance * geometry.perimeter(polygon)
    finished = [index for index, line in enumerate(shape.passes) if line.reads is not None]
    assert [shape.passes[index].combines for index in finished] == [None, *finished[:-1]]
    assert all(line.center == (0.0, 0.0) for line in shape.passes if line.reads is None)


@pytest.mark.parametrize("name", POLYGONS)
def test_every_polygon(name):
    """Check every polygon exactly, or within the tolerance where sides are made equal; passes and light as the
    document proves.

    Inside the polygon min gives 1 / (largest area), so the light kept is the polygon's area over that.
    """
    polygon = POLYGONS[name]
    shape = decompose(polygon, tolerance=0.0)
    assert name not in SHAPES or (len(shape.passes), pytest.approx(shape.light, abs=5e-5)) == SHAPES[name]
    assert_in_common(shape, polygon, 1e-6)
    assert_in_common(decompose(polygon), polygon, 2 * TOLERANCE)
    count = len(strips_around(polygon, 1e-6))
    assert count <= len(shape.passes) <= count + count % 2
    assert (count + 1) // 2 <= len(drawn_by(shape)) < count
    area = abs(geometry.signed_area(polygon))
    largest = max(abs(geometry.signed_area(corners)) for corners in drawn_by(shape))
    assert shape.light == pytest.approx(area / largest) and shape.light <= shape.bound + 1e-9
    if count == len(polygon):
        assert len(shape.passes) == count and shape.light == pytest.approx(shape.bound)
    # The bound holds for any direction of the other side, not only the polygon's. The angles tried are 0.00015 apart;
    # the shadow of a corner at distance 1 moves by that over cos^2
    least = max(least_area(polygon, side) for side in np.roll(polygon, -1, axis=0) - polygon)
    assert area / least == pytest.approx(shape.bound, rel=5e-3)


def least_area(polygon: np.ndarray, side: np.ndarray) -> float:
    """Return the smallest parallelogram around a polygon with one side along `side`, trying 20000 directions of the
    other.
    """
    along = side / np.linalg.norm(side)
    across = np.array([-along[1], along[0]])
    slopes = np.tan(np.linspace(-1.5, 1.5, 20001))
    shadows = (polygon @ along)[:, None] - (polygon @ across)[:, None] * slopes
    return np.ptp(polygon @ across) * np.ptp(shadows, axis=0).min()


@pytest.mark.parametrize("n", REGULAR)
def test_regular(n):
    """Check the closed forms of the light, and that every rotation has the same passes."""
    polygon = aperture_shapes.regular_polygon(n)
    shape = decompose(polygon)
    odd = n * np.sin(2 * np.pi / n) / (8 * np.cos(np.pi / 2 / n) ** 3)
    assert shape.light == pytest.approx(odd if n % 2 else n / 4 * (np.sin if n % 4 else np.tan)(np.pi / n))
    assert shape.light == pytest.approx(shape.bound)
    for rotation in (17.3, 90.0, 181.0, -45.0):
        assert_in_common(decompose(polygon, rotation), aperture_shapes.rotated(polygon, rotation), 1e-9)
    # rounded sides are still parallel, and neither winding order nor extra corners matter
    rounded = (aperture_shapes.rotated(polygon, 11.0) + [0.0123, 0.0087]).round(3)
    halved = np.stack([0.5 * (polygon + np.roll(polygon, 1, axis=0)), polygon], axis=1).reshape(-1, 2)
    for corners in (rounded, halved, halved[::-1]):
        assert len(decompose(corners).passes) == len(shape.passes)
        assert_in_common(decompose(corners), corners, 2 * TOLERANCE)


DRAWN = {name: aperture_shapes.regular_polygon(sides) for name, sides in aperture_shapes.POLYGONS.items()}
DRAWN["any pentagon"] = parsed(PENTAGON)


@pytest.mark.parametrize("squeeze", [1.0, 0.6])
@pytest.mark.parametrize("rotation", [0.0, 10.0])
@pytest.mark.parametrize("name", DRAWN)
@in_each_language
def test_highlight_on_a_driver(name, rotation, squeeze, driver):
    """Check that a bright pixel becomes the polygon, not its reflection, to half a pixel and with the predicted
    brightness.

    Upright, rotated and squeezed.
    """
    shape = decompose(DRAWN[name], rotation)
    corners = impulse.COC * aperture_shapes.rotated(DRAWN[name], rotation) * [squeeze, 1.0]
    middle = pixel_center(*impulse.CENTER)
    bokeh, reflected = (highlight.Bokeh(sign * corners, impulse.SIZE, middle) for sign in (1, -1))
    settings = replace(impulse.constant_coc("hexagon", rotation), squeeze=squeeze)
    plan = methods.paper_polygon(DRAWN[name], settings, impulse.SIZE)
    output = driver.run(plan.passes, bokeh.case("", settings).textures() | plan.tables, impulse.SIZE)["result"]
    light = (output[..., 1].astype(np.float64) - highlight.AMBIENT) / highlight.PEAK
    seen = np.clip(light * bokeh.area / shape.light, 0.0, 1.0)
    own, other = (overlap(seen, outline.coverage) for outline in (bokeh, reflected))
    assert own >= bokeh.min_overlap(0.5)
    assert len(corners) % 2 == 0 or own > other + 0.02
    assert light.sum() == pytest.approx(shape.light, abs=bokeh.edge(0.5) * shape.light / bokeh.area)


def test_light_of_the_document():
    """Compare the document's table of regular polygons: passes, and the light that min keeps."""
    table = DOCUMENT.split("### How much light it keeps")[1].split("\n## ")[0]
    cells = [row.strip("| ").split(" | ")[1:] for row in table.splitlines() if row.startswith("| ")]
    shapes = {sides: decompose(aperture_shapes.regular_polygon(int(sides))) for sides in cells[0]}
    assert list(map(int, shapes)) == list(REGULAR)
    assert cells[1:] == [[f"{len(s.passes)}" for s in shapes.values()], [f"{s.light:.3f}" for s in shapes.values()]]


def test_command():
    """Compare the command with the document's triangle, and with the passes of another polygon."""
    shape, data = decompose(parsed(PENTAGON)), json.loads(called("aperture", "--vertices", PENTAGON).stdout)
    assert [item["parameters"] for item in data["passes"]] == [line.parameters() for line in shape.passes]
    assert data["light"] == shape.light
    for item in json.loads(called("aperture", "--sides", 3).stdout)["passes"]:
        numbers = " | ".join(f"{value:.6f}" for value in item["parameters"].values())
        read, other = (f"pass {item[key]}" if item[key] else "" for key in ("reads", "combines"))
        row = f"| {item['pass']} | {item['entry']} | {numbers} | {read or 'CoC map'} | {other}"
        assert f"{row.rstrip()} |\n" in DOCUMENT
