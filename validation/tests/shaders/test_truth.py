"""Layered against ray-traced truth, the scatter that it is compared with, and the numbers of docs/likeness.md."""

import json
import os
import re
import tempfile
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from support import called, load

from bokeh_validation import paths, truth
from bokeh_validation.frame import methods, polygons
from bokeh_validation.probes import shapes
from bokeh_validation.probes.model import Case
from bokeh_validation.truth import ray_traced
from bokeh_validation.truth.scatter import GROWTH, scatter, signed_pixels

PAGE = paths.ROOT / "docs" / "likeness.md"
SCENES = {scene.name: scene for scene in ray_traced.SCENES}
# What layered is to reach: FLIP of MEDIUM; LOW may be so much more
BOUNDS = {"street_11": 0.042, "canopy_12": 0.138, "street_11x3": 0.108, "canopy_12x3": 0.265, "market_7": 0.187}
LOW_MORE = 0.012
# The octagon against its truth: so near to what the hexagon has
OCTAGON_OFF = 0.006
LAYERED = "layered medium"
# Where the scatter, at hundreds of times the cost, has the lower FLIP
BEHIND = ("market_7",)


@cache
def measured(name: str, label: str, aperture: str = "hexagon", rotation: float | None = None) -> truth.Row:
    """On OSMesa; made once for all tests, by the command what it makes."""
    if (name, aperture) == ("street_11", "hexagon"):
        return commanded()[1][label]
    changes = {} if rotation is None else {"rotation": rotation}
    image = truth.picture(load("osmesa"), SCENES[name], label, aperture, **changes)
    return truth.row(SCENES[name], label, image, ray_traced.truth(SCENES[name], aperture))


@cache
def page() -> dict[str, dict[str, tuple[float, float, float]]]:
    """Method -> scene -> FLIP, PSNR, light of the table in the document."""
    lines = re.findall(r"^\| (.*) \|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    start = next(k for k, line in enumerate(lines) if "market_7" in line)
    names = lines[start].removeprefix("| ").split(" | ")
    found = {}
    for label, *cells in (line.split(" | ") for line in lines[start + 1 : start + 8]):
        numbers = [tuple(map(float, re.findall(r"[\d.]+", cell))) for cell in cells]
        found[label] = dict(zip(names, numbers, strict=True))
    return found


def assert_as_written(row: truth.Row) -> None:
    """Numbers are within what builds of a driver differ by: 1 % and the last digit."""
    for written, value, digits in zip(
        page()[row.label][row.scene], (row.flip, row.psnr, row.light), (4, 2, 3), strict=True
    ):
        assert abs(written - value) <= 1.5 * 10.0**-digits + 0.01 * value, row


@pytest.mark.parametrize("name", SCENES)
def test_layered(name):
    """MEDIUM within its bound, LOW not much farther, half-float targets, one set of parameters for all scenes.

    Nearer than every other method, than the scatter too but on market_7. Their numbers are the page's, which
    test_command holds to what the command computes.
    """
    ours, low = measured(name, LAYERED), measured(name, "layered low")
    assert ours.flip <= BOUNDS[name] and low.flip <= BOUNDS[name] + LOW_MORE
    others = {label: row[name][0] for label, row in page().items() if not label.startswith("layered")}
    assert {label for label, flip in others.items() if flip <= ours.flip} == ({"scatter"} if name in BEHIND else set())
    assert_as_written(ours)
    assert_as_written(low)


def test_octagon():
    """As near as the hexagon; and its truth is turned as TRUTH_ROTATION says: any other way it is farther off."""
    turned = measured("street_11", LAYERED, "octagon")
    assert turned.flip == pytest.approx(measured("street_11", LAYERED).flip, abs=OCTAGON_OFF)
    assert turned.flip < measured("street_11", LAYERED, "octagon", 0.0).flip


# ------------------------------------------------------------------------------------------------------------- command


@cache
def commanded() -> tuple[str, dict[str, truth.Row], list[str]]:
    """`validation/run truth` on street_11: what it prints, its rows from the JSON, its pictures."""
    with tempfile.TemporaryDirectory() as folder:
        options = "truth --scene street_11 --driver osmesa --json".split()
        done = called(*options, f"{folder}/numbers.json", "--pictures", folder)
        assert done.returncode == 0, done.stderr
        rows = json.loads(Path(folder, "numbers.json").read_text(encoding="utf-8"))["rows"]
        return done.stdout, {row["label"]: truth.Row(**row) for row in rows}, sorted(os.listdir(folder))


def test_command():
    """A table, the same numbers as JSON, the pictures of that scene; docs/likeness.md has its numbers."""
    said, rows, files = commanded()
    head, _, *lines, _ = said.splitlines()
    assert head == "| | street_11 |" and [line.split(" | ")[0] for line in lines] == [f"| {label}" for label in rows]
    assert list(rows) == truth.labels() and set(page()) == set(rows)
    assert all(set(columns) == set(SCENES) for columns in page().values())
    for row in rows.values():
        assert_as_written(row)
    assert files == ["likeness_street_11_detail.png", "numbers.json"]


# ------------------------------------------------------------------------------------------------------------- scatter

CAMERA = methods.Camera(2.0, 0.05, 5.0, max_coc=0.5)
SIZE = (96, 80)
SETTINGS = methods.Settings("exact", "hexagon", camera=CAMERA)


def depth_at(coc: float) -> float:
    """Metres where a signed CoC, diameter in pixels, is reached."""
    c = coc / SIZE[1] * CAMERA.sensor_height * (CAMERA.focus_distance - CAMERA.focal_length)
    c /= CAMERA.aperture_diameter * CAMERA.focal_length
    return CAMERA.focus_distance / (1.0 - c)


def light_case(coc: float, around: float, ambient: float, light: float = 1000.0) -> Case:
    """One bright pixel with a signed CoC on a plane with another."""
    color = np.ones((SIZE[1], SIZE[0], 4), np.float32)
    color[..., :3] = ambient
    depth = np.full(SIZE[::-1], depth_at(around), np.float32)
    color[40, 48, :3], depth[40, 48] = light, depth_at(coc)
    return Case("", SETTINGS, color, depth)


@pytest.mark.parametrize("coc", [-30.0, -12.0, 12.0, 30.0])
def test_scatter_of_one_light(coc):
    """Among pixels of its own CoC: all light is kept, in the polygon of its CoC.

    It is shared between two kernels that are GROWTH apart (half a pixel for small ones): even within the smaller one,
    nothing beyond the larger one, both less or more than half a pixel's diagonal for the pixels' corners. The rest is
    the FFT's rounding, 1e-12 of the light.
    """
    case = light_case(coc, coc, 0.0)
    assert signed_pixels(case)[40, 48] == pytest.approx(coc, rel=1e-5)
    result = scatter(case)[..., 0]
    assert result.sum() == pytest.approx(1000.0, rel=1e-6)
    step = max(GROWTH * abs(coc), 0.5)
    outline, center = shapes.outline(SETTINGS), (48.5, 40.5)
    core = polygons.coverage((abs(coc) - step - 3.0) * outline, SIZE, center) == 1.0
    beyond = polygons.coverage((abs(coc) + step + 3.0) * outline, SIZE, center) == 0.0
    assert np.ptp(result[core]) <= 1e-6 * result.max() and np.abs(result[beyond]).max() <= 1e-6 * result.max()


def test_scatter_of_a_near_light_over_focus():
    """It spreads over what is in focus, which stays: each pixel loses the share that the light covers there."""
    coc, ambient = -24.0, 0.5
    result = scatter(light_case(coc, 0.0, ambient))[..., 0]
    alone = scatter(light_case(coc, coc, 0.0))[..., 0]
    # coverage is the light's share, and the hole that it leaves is filled with what is around it
    np.testing.assert_allclose(result, ambient * (1.0 - alone / 1000.0) + alone, rtol=1e-6, atol=1e-6)


def test_scatter_of_a_plane():
    """One colour stays that colour at any depth, and what is in focus stays to the bit."""
    random = np.random.default_rng(4)
    color = np.full((SIZE[1], SIZE[0], 4), 0.3, np.float32)
    depth = random.choice([1.0, 2.0, 4.9, 5.0, 8.0, 100.0], SIZE[::-1]).astype(np.float32)
    np.testing.assert_allclose(scatter(Case("", SETTINGS, color, depth)), color[..., :3], rtol=1e-6)
    color[..., :3] = random.random((*SIZE[::-1], 3))
    sharp = Case("", SETTINGS, color, np.full(SIZE[::-1], 5.0, np.float32))
    np.testing.assert_array_equal(scatter(sharp), color[..., :3])
