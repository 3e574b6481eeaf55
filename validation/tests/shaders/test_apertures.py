"""The rule of decomposition.py: parallelograms, passes, light, orientation; the command and the document about it."""

import json
import re
import shlex
from itertools import combinations

import numpy as np
import pytest
from PIL import Image
from support import called, in_each_language

from bokeh_validation import paths
from bokeh_validation.errors import UserError
from bokeh_validation.frame import apertures, convex, decomposition, methods, polygons, sheet
from bokeh_validation.frame.decomposition import Decomposition, decompose
from bokeh_validation.probes import impulse
from bokeh_validation.probes.model import depth_of, pixel_center
from bokeh_validation.reference.device import Reference

DOCUMENT = (paths.ROOT / "docs/apertures.md").read_text(encoding="utf-8")
REGULAR = range(3, 13)
# No two sides parallel, and parallel sides of several kinds
PENTAGON = "-0.35,-0.3 0.1,-0.45 0.45,-0.1 0.3,0.4 -0.3,0.35"
SHAPES = {
    "pentagon": PENTAGON,
    "trapezoid": "-0.2,-0.3 0.25,-0.3 0.4,0.3 -0.4,0.3",
    "kite": "0,-0.5 0.3,-0.1 0,0.45 -0.3,-0.1",
    "cut square": "-0.4,-0.4 0.4,-0.4 0.4,0.2 0.2,0.4 -0.4,0.4",
    "unevenly cut square": "-0.4,-0.4 0.4,-0.4 0.4,0.1 0.2,0.4 -0.4,0.4",
    "uneven hexagon in pairs": "-0.45,-0.1 -0.2,-0.4 0.3,-0.4 0.45,0.1 0.2,0.4 -0.3,0.4",
    "needle": "-0.5,0 0.1,-0.02 0.5,0.01 0.2,0.03",
    "off the pixel": "0.1,0.1 0.5,0.15 0.3,0.5",
}


def closed_form(n: int) -> float:
    """Light kept by a regular polygon, docs/apertures.md."""
    if n % 2:
        return n * np.sin(2 * np.pi / n) / (8 * np.cos(np.pi / 2 / n) ** 3)
    return n / 4 * (np.sin if n % 4 else np.tan)(np.pi / n)


def random_polygon(seed: int) -> np.ndarray:
    """Convex, up to 12 corners, squeezed and off the pixel; with `seed` % 3 == 0 cut to pairs of parallel sides."""
    random = np.random.default_rng(seed)
    angles = np.sort(random.uniform(0.0, 2 * np.pi, random.integers(3, 13)))
    # equal places on a circle would be one corner, and gaps of half a turn would leave the rest of it thin
    angles = np.sort((angles + 0.5 * np.linspace(0.0, 2 * np.pi, len(angles), endpoint=False)) / 1.5)
    polygon = 0.5 * np.stack([np.cos(angles), np.sin(angles)], axis=1) * [1.0, random.uniform(0.4, 1.0)]
    polygon = apertures.rotated(polygon, random.uniform(0.0, 360.0))
    if seed % 3 == 0:
        for turn in random.uniform(0.0, 180.0, 2):
            strip = np.array([[-2.0, -1.0], [2.0, -1.0], [2.0, 1.0], [-2.0, 1.0]]) * [1.0, random.uniform(0.2, 0.4)]
            polygon = polygons.clip_convex(polygon, apertures.rotated(strip, turn))
    return polygon + random.uniform(-0.1, 0.1, 2)


def shapes() -> dict[str, np.ndarray]:
    """Every polygon of these tests by name."""
    named = {name: sheet.parsed(text) for name, text in SHAPES.items()}
    named |= {f"{n} sides": apertures.regular_polygon(n) for n in (*REGULAR, 16, 22)}
    return named | {f"random {seed}": random_polygon(seed) for seed in range(20)}


def normals(polygon: np.ndarray) -> np.ndarray:
    """Outward, of length 1, for each side of a polygon in the order of `polygons.signed_area` above 0, (N, 2)."""
    sides = np.roll(polygon, -1, axis=0) - polygon
    return np.stack([sides[:, 1], -sides[:, 0]], axis=1) / np.linalg.norm(sides, axis=1)[:, None]


def assert_same_shape(shape: Decomposition, polygon: np.ndarray, tolerance: float) -> None:
    """The parallelograms have exactly the polygon in common: all hold its corners, and each side bounds one of them."""
    polygon = polygon if polygons.signed_area(polygon) > 0 else polygon[::-1]
    outward = normals(polygon)
    reach = (polygon * outward).sum(axis=1)
    assert (polygon @ outward.T <= reach + 1e-9).all(), "the test's own normals"
    parts = np.array([(part.corners @ outward.T).max(axis=0) for part in shape.parts])
    np.testing.assert_allclose(parts.min(axis=0), reach, atol=tolerance)
    for part in shape.parts:
        corners = part.corners if polygons.signed_area(part.corners) > 0 else part.corners[::-1]
        assert (polygon @ normals(corners).T <= (corners * normals(corners)).sum(axis=1) + 1e-9).all()


@pytest.mark.parametrize("name", shapes())
def test_every_polygon(name):
    """The parallelograms have the polygon in common: exactly, or within the tolerance where sides are made equal.

    Their lines make them; passes, parallelograms and light are within what decomposition.py proves. Up to four
    directions, the search finds the best of all sets of pairs.
    """
    polygon = shapes()[name]
    shape, tolerant = decompose(polygon, 0.0), decompose(polygon)
    assert_same_shape(shape, polygon, 1e-5)
    assert_same_shape(tolerant, polygon, 2 * decomposition.TOLERANCE)
    assert_lines_make_parts(tolerant)
    assert tolerant.shared == len(tolerant.parts) - len({part.first for part in tolerant.parts})
    assert all(tolerant.lines[part.first].center == (0.0, 0.0) for part in tolerant.parts)
    p, sides = len(shape.directions), len(shape.polygon)
    assert p <= len(shape.lines) <= p + p % 2
    assert (p + 1) // 2 <= len(shape.parts) < p
    # on the polygon min is 1 / (largest area), so its sum is the area over that
    area = abs(polygons.signed_area(polygon))
    assert shape.light == pytest.approx(area / max(part.area for part in shape.parts))
    assert shape.light <= shape.bound + 1e-9
    if p == sides:
        assert len(shape.lines) == p and shape.light == pytest.approx(shape.bound)
    # The bound holds for any direction of the other side, not only those of the polygon. The angles tried are 0.00015
    # apart; the shadow of a corner 1 away moves by that over cos^2
    largest = max(least_area(polygon, side) for side in np.roll(polygon, -1, axis=0) - polygon)
    assert area / largest == pytest.approx(shape.bound, rel=5e-3)
    if p <= 4:
        passes, largest = brute_force(decomposition.strips(shape.polygon, 0.0))
        assert len(shape.lines) == passes
        assert max(part.area for part in shape.parts) == pytest.approx(largest)


def least_area(polygon: np.ndarray, side: np.ndarray) -> float:
    """Smallest parallelogram around a polygon with one side along `side`, by trying 20000 directions of the other."""
    along = side / np.linalg.norm(side)
    across = np.array([-along[1], along[0]])
    slopes = np.tan(np.linspace(-1.5, 1.5, 20001))
    shadows = (polygon @ along)[:, None] - (polygon @ across)[:, None] * slopes
    return np.ptp(polygon @ across) * np.ptp(shadows, axis=0).min()


@pytest.mark.parametrize("rotation", [0.0, 17.3, 90.0, 181.0, -45.0])
def test_rotation(rotation):
    """Turned passes make the turned polygon; the first corner is straight up at 0, and turns to the right."""
    for n in REGULAR:
        turned = decompose(apertures.regular_polygon(n), 0.0).rotated(rotation)
        angles = np.radians(rotation - 90.0 + 360.0 * np.arange(n) / n)
        wanted = 0.5 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        np.testing.assert_allclose(turned.polygon, wanted, atol=1e-12)
        assert_same_shape(turned, wanted, 1e-9)
        assert_lines_make_parts(turned)


def assert_lines_make_parts(shape: Decomposition) -> None:
    """Each parallelogram is the reflection of what its two lines sample, and min has all of them in the end."""
    for part in shape.parts:
        first, second = shape.lines[part.first], shape.lines[part.second]
        assert first.reads is None and first.combines is None and second.reads == part.first < part.second
        half = [0.5 * line.length * apertures.direction(np.radians(line.angle)) for line in (first, second)]
        middle = -np.array(first.center) - np.array(second.center)
        lines = middle + np.array([[1, 1], [1, -1], [-1, -1], [-1, 1]]) @ np.array(half)
        gaps = np.linalg.norm(lines[:, None] - part.corners[None], axis=2)
        assert gaps.min(axis=1).max() < 1e-9 and gaps.min(axis=0).max() < 1e-9
        assert part.area == pytest.approx(abs(polygons.signed_area(lines)))
    finished = [part.second for part in shape.parts]
    assert [shape.lines[index].combines for index in finished] == [None, *finished[:-1]]
    assert sorted(finished + list({part.first for part in shape.parts})) == list(range(len(shape.lines)))
    assert finished[-1] == len(shape.lines) - 1


@pytest.mark.parametrize("n", REGULAR)
def test_regular(n):
    """As few parallelograms and passes as there can be, and the closed forms of the light; as the document's table."""
    shape = decompose(apertures.regular_polygon(n))
    (row,) = re.findall(rf"^\| {n} \| (\d+) \| (\d+) \| (\d+) \| (\d+) \| (\d\.\d+) \|$", DOCUMENT, re.MULTILINE)
    numbers = (len(shape.directions), len(shape.parts), len(shape.lines), shape.shared)
    assert row == (*map(str, numbers), f"{shape.light:.3f}")
    p = n if n % 2 else n // 2
    assert len(shape.directions) == len(shape.lines) == p
    assert len(shape.parts) == (p + 1) // 2 and shape.shared == p % 2
    assert shape.light == pytest.approx(closed_form(n)) == pytest.approx(shape.bound)
    assert max(part.area for part in shape.parts) == pytest.approx(min(part.area for part in shape.parts))


def brute_force(found: list[decomposition.Strip]) -> tuple[int, float]:
    """Fewest passes and their smallest largest area, from all sets of pairs that have every direction."""
    p = len(found)
    pairs = [(i, j) for i in range(p) for j in range(p) if i != j]
    best = (2 * p, np.inf)
    for count in range((p + 1) // 2, p + 1):
        for chosen in combinations(pairs, count):
            if {i for pair in chosen for i in pair} == set(range(p)):
                best = min(best, cost(found, chosen))
    return best


def cost(found: list[decomposition.Strip], chosen: tuple[tuple[int, int], ...]) -> tuple[int, float]:
    """Passes and largest area of pairs (hub, leaf); leaves share their hub's line where they can have equal chords."""
    passes, largest = 0, 0.0
    for hub in {i for i, _ in chosen}:
        chords = {leaf: decomposition.chord(found[leaf], found[hub]) for h, leaf in chosen if h == hub}
        fixed = {round(chords[leaf], 9) for leaf in chords if not found[leaf].free}
        # one line for each chord that cannot be changed; a free leaf takes the next longer one, or one of its own
        longest = max(fixed, default=0.0)
        own = any(chord > longest + 1e-9 for leaf, chord in chords.items() if found[leaf].free)
        passes += len(chords) + len(fixed) + own
        largest = max(largest, max(chords.values()) * found[hub].width)
    return passes, largest


def test_examples():
    """What the document says of single shapes."""
    passes = {name: len(decompose(sheet.parsed(text), 0.0).lines) for name, text in SHAPES.items()}
    assert passes["cut square"] == 3 and passes["unevenly cut square"] == 4
    assert passes["uneven hexagon in pairs"] == 4
    random = np.random.default_rng(5)
    for _ in range(20):
        triangle = decompose(apertures.regular_polygon(3) + random.uniform(-0.2, 0.2, (3, 2)), 0.0)
        assert len(triangle.lines) == 3 and triangle.light == pytest.approx(0.5)


# ------------------------------------------------------------------------------------------------- the paper's shapes


# The octagon is turned by 22.5 degrees and larger, since its squares have the CoC as their side
@pytest.mark.parametrize(("sides", "turn", "light"), [(6, 0.0, 0.75), (8, 22.5, 0.8284)])
def test_polygons_of_the_paper(sides, turn, light):
    """The rule's hexagon and octagon are the paper's: the same passes in the same order, and its light."""
    aperture, scale = {6: ("hexagon", 1.0), 8: ("octagon", np.cos(np.pi / 8))}[sides]
    shape = decompose(apertures.rotated(apertures.regular_polygon(sides), turn) / scale)
    plan = methods.paper(methods.Settings("paper", aperture), (64, 64))
    own = methods.paper_polygon(shape, methods.Settings(), (64, 64))
    for line, item, mine in zip(shape.lines, plan.passes[1:], own.passes[1:], strict=True):
        assert np.radians(line.angle) == pytest.approx(item.parameters["BokehAngle"])
        assert line.length == pytest.approx(1.0) and line.center == (0.0, 0.0)
        assert dict(item.inputs) == dict(mine.inputs) and item.output == mine.output
    assert shape.light == pytest.approx(impulse.light_kept(aperture)) == pytest.approx(light, abs=5e-5)


# -------------------------------------------------------------------------------------------------------------- drivers


def settings(aperture: str, **changes) -> methods.Settings:
    """Two samples a pixel of a constant CoC."""
    camera = methods.Camera(max_coc=1.0)
    coc = impulse.COC / impulse.SIZE[1]
    return methods.Settings("paper", aperture, impulse.SAMPLES, camera=camera, coc=coc, **changes)


def assert_drawn(driver, plan: methods.Plan, shape: Decomposition, squeeze: float = 1.0) -> None:
    """One bright pixel becomes the polygon, not its reflection, known to half a pixel, as bright as the rule says."""
    polygon = impulse.COC * shape.polygon * [squeeze, 1.0]
    area, edge = abs(polygons.signed_area(polygon)), 0.5 * polygons.perimeter(polygon)
    largest = max(part.area for part in shape.parts) * squeeze * impulse.COC**2
    textures = {"color": impulse.impulse_image(), "depth": depth_of(impulse.SIZE, 10.0), **plan.tables}
    output = driver.run(plan.passes, textures, impulse.SIZE)["result"][..., 1].astype(np.float64)
    light = (output - impulse.AMBIENT) / impulse.PEAK
    seen, overlap = np.clip(light * largest, 0.0, 1.0), []
    for corners in (polygon, -polygon):
        truth = polygons.coverage(corners, impulse.SIZE, pixel_center(*impulse.CENTER))
        overlap.append(np.minimum(seen, truth).sum() / np.maximum(seen, truth).sum())
    assert overlap[0] >= (area - edge) / (area + edge)
    assert len(polygon) % 2 == 0 or overlap[0] > overlap[1] + 0.02
    assert light.sum() == pytest.approx(shape.light, abs=edge / largest)


@pytest.mark.parametrize("name", [*SHAPES, "random 3", "random 4"])
def test_any_polygon(name):
    """One bright pixel by the reference."""
    shape = decompose(shapes()[name])
    assert_drawn(Reference(), methods.paper_polygon(shape, settings("hexagon"), impulse.SIZE), shape)


@pytest.mark.parametrize("squeeze", [1.0, 0.6])
@pytest.mark.parametrize("rotation", [0.0, 10.0])
@pytest.mark.parametrize("aperture", apertures.POLYGONS)
@in_each_language
def test_highlight_on_a_driver(aperture, rotation, squeeze, driver):
    """The shaders draw the polygon as the command draws it: upright, turned, squeezed."""
    shape = decompose(apertures.regular_polygon(apertures.POLYGONS[aperture])).rotated(rotation)
    chosen = settings(aperture, rotation=rotation, squeeze=squeeze)
    assert_drawn(driver, methods.plan(chosen, impulse.SIZE), shape, squeeze)


@pytest.mark.parametrize("aperture", apertures.POLYGONS)
def test_naive_kernel(aperture):
    """A lattice in the reflected polygon, as dense as the octagon's, that does not move the picture."""
    polygon = apertures.regular_polygon(apertures.POLYGONS[aperture])
    for samples in (7, 13, 30):
        table = apertures.kernel(aperture, samples)
        np.testing.assert_allclose(table.mean(axis=0), 0.0, atol=1e-12)
        area, cell = abs(polygons.signed_area(polygon)), 1.0 / (samples - 1)
        assert len(table) * cell**2 == pytest.approx(area, abs=0.5 * cell * polygons.perimeter(polygon))
        # every offset, seen from the other side, is in the polygon but for the shift of the mean
        outward = normals(polygon)
        assert (-table @ outward.T <= (polygon * outward).sum(axis=1) + 0.5 * cell).all()
    turned = apertures.kernel(aperture, 13, 30.0)
    np.testing.assert_allclose(turned, apertures.rotated(apertures.kernel(aperture, 13), 30.0))


# ------------------------------------------------------------------------------------------------------------ bad input


def test_polygons_are_tidied():
    """Any winding; repeated corners and corners on a side are left out; rounded sides are parallel."""
    square = np.array([[-0.3, -0.3], [0.3, -0.3], [0.3, 0.3], [-0.3, 0.3]])
    untidy = [[-0.3, -0.3], [0, -0.3], [0.1, -0.3], [0.3, -0.3], [0.3, -0.3], [0.3, 0.3], [-0.3, 0.3], [-0.3, 0.0]]
    for corners in (np.array(untidy), np.array(untidy)[::-1], square[::-1]):
        tidy = convex.checked(corners)
        assert len(tidy) == 4 and polygons.signed_area(tidy) == pytest.approx(0.36)
        assert {tuple(c) for c in tidy} == {tuple(c) for c in square}
    np.testing.assert_array_equal(convex.checked(square[::-1])[0], square[3])
    rounded = (apertures.rotated(apertures.regular_polygon(8), 11.0) + [0.0123, 0.0087]).round(3)
    assert len(decompose(rounded).lines) == 4 and len(decompose(rounded, 0.0).lines) == 8
    rounded = (apertures.rotated(apertures.regular_polygon(6), 11.0) + [0.0123, 0.0087]).round(3)
    assert len(decompose(rounded).lines) == 3


BAD_POLYGONS = {
    "0,0 0.1,0 nan,0.2": "corner 3 is not a finite number",
    "0,0 0.1,0 0.2,0": "on one line",
    "0.1,0.1 0.1,0.1 0.1,0.1": "on one line",
    "0,0 0.4,0 0.1,0.1 0,0.4": "not convex at corner 3",
    "0,0.4 0.1,0.1 0.4,0 0,0": "not convex at corner 2",
    "-0.3,-0.3 0.3,0.3 0.3,-0.3 -0.3,0.3": "not convex at corner",
    "0,-0.5 0.294,0.405 -0.476,-0.155 0.476,-0.155 -0.294,0.405": "sides cross",
    "0,0 120,0 60,90": "corner 2 is farther out than 2",
    "0,0 0.4,0 0.2,0.001": "thinner than 0.01",
    "": "0 corners",
    "0,0 1,0 1": "corner 3 is '1'",
    "0,0 1,x 1,1": "corner 2 is '1,x'",
    " ".join(f"{0.5 * np.cos(a):.4f},{0.5 * np.sin(a):.4f}" for a in np.arange(13) / 13 * 2 * np.pi): "13 directions",
}


@pytest.mark.parametrize("text", BAD_POLYGONS)
def test_bad_polygon(text):
    """One line that names the corner."""
    with pytest.raises(UserError) as caught:
        decompose(sheet.parsed(text))
    assert BAD_POLYGONS[text] in str(caught.value) and "\n" not in str(caught.value)


# ------------------------------------------------------------------------------------------------- command and document


def test_command_writes_what_it_says(tmp_path, monkeypatch):
    """Table, JSON and picture of the same passes, into a folder with a space."""
    folder = tmp_path / "a folder"
    folder.mkdir()
    monkeypatch.chdir(folder)
    options = ["--vertices", PENTAGON, "--rotation", "20", "--squeeze", "0.75"]
    done = called("aperture", *options, "--output", "pic ture.png", "--json", "pass es.json")
    assert done.returncode == 0 and done.stderr == "", done.stderr
    assert sorted(path.name for path in folder.iterdir()) == ["pass es.json", "pic ture.png"]
    shape = decompose(sheet.parsed(PENTAGON)).rotated(20.0)
    page = sheet.Sheet(shape, 0.75)
    first, header, *rows, last = done.stdout.splitlines()
    assert first == sheet.summary(page) and last == "in every pass: BokehSqueeze 0.75, BokehUseMax 0"
    assert header.split()[3:7] == ["BokehAngle", "BokehLineLength", "BokehLineCenterX", "BokehLineCenterY"]
    data = json.loads((folder / "pass es.json").read_text())
    assert len(rows) == len(data["passes"]) == len(shape.lines)
    for row, item, line in zip(rows, data["passes"], shape.lines, strict=True):
        np.testing.assert_allclose([float(word) for word in row.split()[3:7]], [*line.parameters().values()], atol=1e-6)
        assert item["parameters"] == {**line.parameters(), "BokehSqueeze": 0.75}
        assert item["reads"] == (None if line.reads is None else line.reads + 1)
    np.testing.assert_allclose(data["polygon"], shape.polygon)
    assert data["light"] == shape.light
    picture = np.asarray(Image.open(folder / "pic ture.png").convert("RGB"))
    assert picture.shape[1] == 4 * sheet.PANEL and picture.std() > 10


COMMANDS = re.findall(r"validation/run (aperture .*? --output docs/images/\w+\.png)", DOCUMENT)


def test_output_of_the_document():
    """The table that the document shows is the command's."""
    done = called("aperture", "--sides", "3")
    assert done.returncode == 0 and f"```\n{done.stdout}```" in DOCUMENT


@pytest.mark.parametrize("command", COMMANDS)
def test_pictures_of_the_document(command, tmp_path):
    """Each picture is what the command beside it draws, and small."""
    words = shlex.split(command)
    picture = paths.ROOT / words[-1]
    assert picture.stat().st_size < 150_000
    done = called(*words[:-1], tmp_path / "picture.png")
    assert done.returncode == 0, done.stderr
    drawn, kept = (np.asarray(Image.open(path)).astype(int) for path in (tmp_path / "picture.png", picture))
    assert drawn.shape == kept.shape and np.abs(drawn - kept).max() <= 2
