"""Test the rasterised truth against the thin lens's formula and a ray-traced light, and the input of a filter."""

from dataclasses import astuple

import numpy as np
import pytest
from support import load

from bokeh_validation.frame import aperture_shapes, geometry
from bokeh_validation.frame.methods import Camera
from bokeh_validation.probes.model import overlap
from bokeh_validation.reference import listings
from bokeh_validation.truth import ray_traced
from lab.rasterised.rasteriser import Rasteriser, Scene, Thing

CAMERA = Camera(0.15, 0.05, 3.0, 0.024, 1.0)
SIZE = (160, 120)


@pytest.fixture(scope="module")
def rasteriser() -> Rasteriser:
    """Return a rasteriser."""
    return Rasteriser(SIZE, 512, load("egl"))


def light(distance: float, pixels: float, x: float = 0.0) -> Thing:
    """Return a disc with a radius in pixels, `x` metres off the middle."""
    radius = pixels * distance / (Scene((), CAMERA).zoom * SIZE[1])
    return Thing((x, 0.0, distance), (radius, radius), (1.0, 1.0, 1.0), shape="disc")


def black(*things: Thing, **changes) -> Scene:
    """Return a scene in front of black."""
    return Scene(things, CAMERA, sky=(0.0, 0.0, 0.0), **changes)


@pytest.mark.parametrize("sides", [4, 6, 8])
@pytest.mark.parametrize("distance", [1.2, 1.8, 8.0, 100.0])
def test_thin_lens(rasteriser, distance, sides):
    """Check that a disc becomes a polygon of the formula's CoC at its pinhole position, and keeps its light."""
    image = rasteriser.lens(black(light(distance, 2.0), sides=sides)).color[..., 0]
    coc = listings.circle_of_confusion(distance, *astuple(CAMERA)) * SIZE[1]
    corners, scale = aperture_shapes.even_polygon(sides), 4
    wider = geometry.coverage(corners * (coc + 4.0), SIZE, (SIZE[0] / 2, SIZE[1] / 2))
    assert image[wider == 0.0].sum() < 0.005 * image.sum()
    polygon = geometry.coverage(corners * coc * scale, (100, 100), (50, 50))
    for axis, middle in enumerate((SIZE[1] / 2, SIZE[0] / 2)):
        place, fine = np.indices(image.shape)[axis] + 0.5, np.indices(polygon.shape)[axis] - 49.5
        mean = (image * place).sum() / image.sum()
        assert mean == pytest.approx(middle, abs=0.1)
        # variances of the polygon, of a disc of radius 2, of a pixel
        variance = (polygon * fine**2).sum() / polygon.sum() / scale**2 + 1.0 + 1 / 12
        assert (image * (place - mean) ** 2).sum() / image.sum() == pytest.approx(variance, rel=0.04)
    assert image.sum() == pytest.approx(4.0 * np.pi, rel=0.03)


def test_pinhole(rasteriser):
    """Check depth and position of cards, floors and spheres, their motion in pixels, and antialiased edges."""
    zoom, height = black().zoom, SIZE[1]
    card = Thing((0.2, 0.1, 4.0), (0.3, 0.2), (0.5, 0.0, 0.0))
    ball = Thing((-0.3, 0.0, 3.0), (0.2, 0.2), (0.0, 0.5, 0.0), shape="sphere")
    floor = Thing((0.0, 0.5, 50.0), (50.0, 49.0), (0.0, 0.0, 0.5), shape="floor")
    scene = black(card, ball, floor)
    before = scene._replace(eye=(-0.01, 0.004, 0.0))
    color, depth, moved = rasteriser.pinhole(scene, before)
    where = [color[..., channel].astype(float) > 0.25 for channel in range(3)]
    per_metre = zoom * height
    assert where[0].sum() == pytest.approx(4 * 0.3 * 0.2 * (per_metre / 4.0) ** 2, rel=0.05)
    assert where[1].sum() == pytest.approx(np.pi * (0.2 * per_metre / 3.0) ** 2, rel=0.05)
    rows, columns = np.nonzero(where[0])
    assert [columns.mean() - 79.5, rows.mean() - 59.5] == pytest.approx([0.05 * per_metre, 0.025 * per_metre], abs=0.6)
    assert np.all(depth[where[0]] == pytest.approx(4.0)) and depth[where[1]].min() == pytest.approx(2.8, abs=0.01)
    row, column = np.argwhere(where[2])[-1]
    assert depth[row, column] == pytest.approx(0.5 * per_metre / (row + 0.5 - height / 2), rel=1e-3)
    assert moved[where[0]] == pytest.approx(np.tile([-0.01, 0.004], (where[0].sum(), 1)) * per_metre / 4.0, rel=1e-3)
    assert not moved[depth == 200.0].any()
    smooth = rasteriser.pinhole(scene, antialiased=True)
    assert np.array_equal(smooth.depth, depth) and len(np.unique(smooth.color[..., 0])) > 5


def test_hidden(rasteriser):
    """Check that the lens sees behind a near card as far as its CoC reaches, and that nothing is hidden without one."""
    wall = Thing((0.0, 0.0, 6.0), (50.0, 50.0), (1.0, 1.0, 1.0))
    card = Thing((0.0, 0.0, 1.5), (0.1, 0.1), (0.0, 0.0, 0.0))
    inner = np.s_[20:-20, 20:-20]
    assert not rasteriser.lens(black(wall)).hidden[inner].any()
    lens, given = rasteriser.lens(black(wall, card)), rasteriser.pinhole(black(wall, card))
    near = given.depth < 2.0
    assert lens.hidden[near].mean() > 0.02 and not lens.hidden[inner][~near[inner]].max() > 0.3
    assert np.allclose(lens.hidden_color[..., 0], lens.hidden, atol=1e-5)


def test_ray_traced_light():
    """Check that a light of market_7 blurs to the shape and brightness that ray tracing gives it."""
    file, (left, top), extent = ray_traced.MARKET, (626, 254), 60
    part = np.s_[top : top + extent, left : left + extent]
    given, truth = ray_traced.picture(file), ray_traced.truth(file, "hexagon")[part][..., 0].astype(float)
    red, (height, width) = given.color[part][..., 0].astype(float), given.depth.shape
    rows, columns = np.nonzero(red > 3.0)
    distance = float(np.median(given.depth[part][rows, columns]))
    metres = distance / (Scene((), file.camera).zoom * height)
    x, y = (columns.mean() + left + 0.5 - width / 2) * metres, (rows.mean() + top + 0.5 - height / 2) * metres
    radius = np.sqrt(rows.size / np.pi) * metres
    disc = Thing((x, y, distance), (radius, radius), [red[rows, columns].mean()] * 3, shape="disc")
    drawn = (
        Rasteriser((width, height), 192)
        .lens(Scene((disc,), file.camera, sky=[np.median(truth)] * 3))
        .color[part][..., 0]
    )
    assert overlap(drawn, truth) > 0.93
    assert drawn.sum() == pytest.approx(truth.sum(), rel=0.02)
