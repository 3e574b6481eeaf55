"""What must not change the picture: rotation, mirror, exposure, place; and what must not change that of layered.

On half floats, as in use.
"""

import re
from dataclasses import replace
from unittest.mock import patch

import moments
import numpy as np
import pytest
import sweep
from support import in_each_language
from support_cases import CAMERA, kind, noise_case, result
from test_invariance import ASPECTS, DOCUMENT, LINEAR, PAPER_HEXAGON, PEAK, highlight, named

from bokeh_validation import metrics
from bokeh_validation.drivers.base import Driver
from bokeh_validation.frame import methods
from bokeh_validation.frame.methods import Settings
from bokeh_validation.probes import lights, near_edges
from bokeh_validation.probes.model import Case, depth_of, expected, flat
from bokeh_validation.reference import precision
from bokeh_validation.reference.device import Reference
from bokeh_validation.reference.images import Image
from bokeh_validation.shaders.passes import Pass


def transformed(case: Case, change, settings: Settings) -> Case:
    """Colour and depth through a function of arrays, with other settings."""
    return Case("", settings, np.ascontiguousarray(change(case.color)), np.ascontiguousarray(change(case.depth)))


def check_same(driver: Driver, case: Case, change, settings: Settings, border: int = 0) -> metrics.Comparison:
    """change(blur(image)) is blur'(change(image)): within both acceptance intervals, which both may use up.

    border  pixels at the image's edges that are left out
    """
    other = transformed(case, change, settings)
    outputs = [result(driver, c) for c in (case, other)]
    truth = [expected(c, driver.precision, driver.rounding)["result"] for c in (case, other)]
    wanted = Image(
        change(outputs[0]).astype(np.float64),
        change(truth[0].error) + truth[1].error,
        change(truth[0].undecided) | truth[1].undecided,
    )
    inner = (slice(border, case.size[1] - border), slice(border, case.size[0] - border))
    wanted = Image(wanted.value[inner], wanted.error[inner], wanted.undecided[inner])
    comparison = metrics.compare(outputs[1][inner], wanted, driver.software)
    assert comparison.outside == 0, (named(case.settings), comparison)
    return comparison


VARYING = (
    Settings("paper", "hexagon", camera=CAMERA),
    Settings("paper", "octagon", camera=CAMERA, spacing=1.0),
    Settings("exact", "hexagon", camera=CAMERA),
    Settings("exact", "decagon", camera=CAMERA, spacing=1.0),
    Settings("naive", "hexagon", 7, camera=CAMERA),
)
MIRRORED = (
    Settings("paper", "hexagon", camera=CAMERA, rotation=10.0),
    Settings("paper", "octagon", camera=CAMERA, rotation=10.0),
    Settings("exact", "square", camera=CAMERA, rotation=10.0),
    Settings("naive", "hexagon", 7, camera=CAMERA, rotation=10.0),
)


def rotated(image: np.ndarray) -> np.ndarray:
    """A quarter turn: what pointed to the right (+u) points up (-v)."""
    return np.rot90(image)


@pytest.mark.parametrize("settings", VARYING, ids=named)
@in_each_language
def test_quarter_turn(settings, driver):
    """Image and aperture turned by 90 degrees: the turned picture, with the CoC from depth. Nothing prefers an axis."""
    case = noise_case((60, 60), settings)
    turned = replace(settings, rotation=settings.rotation - 90.0)
    np.testing.assert_allclose(
        reference_result(transformed(case, rotated, turned)), rotated(reference_result(case)), rtol=1e-9, atol=1e-12
    )
    comparison = check_same(driver, case, rotated, turned)
    if driver.software:
        assert comparison.close >= metrics.CLOSE_SHARE, comparison


def reference_result(case: Case) -> np.ndarray:
    """The formula's picture: float32 between the passes, angles as they are. In float32 they have no quarter turn."""
    with patch.object(Pass, "given", Pass.values):
        return Reference().images(case.plan.passes, case.textures(), case.size, "float")["result"].value


@pytest.mark.parametrize("settings", MIRRORED, ids=named)
@in_each_language
def test_mirror(settings, driver):
    """Left and right swapped, the rotation negated: the mirrored picture. Fixed counts and tables.

    At one CoC for the whole image, but within a CoC of the image's edges: the mirrored lines come in another order, and
    passes commute only where none is clamped. With the CoC from depth it holds for the paper's hexagon and for tables,
    whose lines mirror into each other in order.

    The exact hexagon is not here: its two passes share out a sample's offset otherwise when it is mirrored, so that the
    linear filter softens other samples. Its size is that of the polygon at each rotation: test_aspect_ratio.
    """
    size, border = (84, 60), 14
    constant, turned = replace(settings, coc=0.2), replace(settings, coc=0.2, rotation=-settings.rotation)
    comparison = check_same(driver, noise_case(size, constant), np.fliplr, turned, border)
    assert comparison.close >= metrics.CLOSE_SHARE, comparison
    if settings.aperture == "hexagon":
        turned = replace(settings, rotation=-settings.rotation)
        check_same(driver, noise_case(size, settings), np.fliplr, turned)


@pytest.mark.parametrize("settings", VARYING, ids=named)
@in_each_language
def test_exposure(settings, driver):
    """Colour times 2^k: the same bits with another exponent. Colour times 1.5: each store rounds once more.

    Every operation on colour is a sum, a product with a number that does not depend on it, a quotient, min or max. A
    power of two commutes with rounding. The image is kept where no half float is denormal or too large.
    """
    case = noise_case((60, 48), settings)
    # 8 bits, so that a factor of 2 bits is exact
    few_bits = np.round(np.clip(case.color.astype(np.float64), 0.25, 32.0) * 8.0) / 8.0
    few_bits[..., 3] = 1.0
    case = replace(case, color=few_bits.astype(np.float16))
    plain = result(driver, case).astype(np.float64)
    passes = len(case.plan.passes)
    for factor in (2.0**-6, 2.0**5, 1.5):
        color = case.color.copy()
        color[..., :3] *= np.float16(factor)
        np.testing.assert_array_equal(color[..., :3].astype(np.float64), factor * few_bits[..., :3])
        found = result(driver, replace(case, color=color)).astype(np.float64)
        np.testing.assert_array_equal(found[..., 3], plain[..., 3])
        if factor == 1.5:
            # a store: half a step of 2^-10 up or down, or a whole one down; the sums: N + 8 roundings
            stores = passes * 2.0**-10
            sums = 2 * passes * (settings.count + 8) * precision.FLOAT_STEP
            blends = 2 * passes * kind(driver).filter
            np.testing.assert_allclose(found[..., :3], factor * plain[..., :3], rtol=stores + sums + blends)
        else:
            np.testing.assert_array_equal(found[..., :3], factor * plain[..., :3])


@pytest.mark.parametrize("settings", [*LINEAR, PAPER_HEXAGON], ids=named)
@in_each_language
def test_translation(settings, driver):
    """A highlight moved by whole pixels: its bokeh moved by as many, within the rounding of uv. Not bit for bit.

    uv is a float32: a place is known to 8 2^-24 of the width, elsewhere another 8 2^-24 (reference/precision.py).
    """
    settings = replace(settings, coc=0.3)
    size, shift = (96, 60), (17, -5)
    case, _ = highlight(settings, size, 3)

    def moved(image: np.ndarray) -> np.ndarray:
        return np.roll(image, shift[::-1], axis=(0, 1))

    check_same(driver, case, moved, settings)


# ----------------------------------------------------------------------------------------------------------------------
# the layered method
# ----------------------------------------------------------------------------------------------------------------------

BLUR = 24  # pixels
LAYERED = near_edges.settings()
MOVES = np.arange(17) / 8


def layered(driver: Driver, case: Case) -> np.ndarray:
    """Its picture, (H, W, 3) float64."""
    return result(driver, case)[..., :3].astype(np.float64)


def told(pattern: str) -> list[float]:
    """Numbers that docs/invariances.md states."""
    (found,) = re.findall(pattern, DOCUMENT)
    return [float(value) for value in ([found] if isinstance(found, str) else found)]


@pytest.mark.parametrize("preset", methods.PRESETS)
@pytest.mark.parametrize("size", ASPECTS, ids=str)
@in_each_language
def test_layered_aspect_and_presets(size, preset, driver):
    """A far light, at each aspect ratio and preset: the polygon's second moments, but for what half size adds.

    Square pixels on each axis. Off by: 2 x 2 pixels in a texel, 1/4; each of two passes adds up to 1/4 square texel of
    four square pixels, as does a linear enlargement: 3 in all. For all that CoC^2 is made smaller by 32 square pixels,
    R^2 = CoC^2 / 4 by 8, of which the polygon has (2 + cos(2 pi / n)) / 12. Samples in the middle of cells of l pixels
    leave out l^2 / 12 on each pass; an edge of 12 pixels, 6 texels, has as many cells: l is 2.
    """
    color = flat(size)
    middle = [length // 2 for length in size]
    color[middle[1] - 1 : middle[1] + 2, middle[0] - 1 : middle[0] + 2, :3] = PEAK / 9
    case = Case("", replace(LAYERED, preset=preset), color, depth_of(size, near_edges.metres(BLUR, size[1])))
    found = moments.measured(layered(driver, case)[..., 1], (middle[0] + 0.5, middle[1] + 0.5))
    share = (2.0 + np.cos(2.0 * np.pi / 6)) / 12.0
    off = np.diag(found.second) - (9 - 1) / 12 - share * BLUR**2 / 4
    assert (off >= -8 * share - 2 * 2**2 / 12).all() and (off <= 3.25 - 8 * share).all(), off
    # the shape is known to half a pixel on each axis, the mean to less
    assert np.abs(found.mean).max() <= 0.5


@pytest.mark.parametrize("scale", [0.5, 1.0, 2.0])
@in_each_language
def test_layered_resolution(scale, driver):
    """A near edge at half, the whole and twice the size: the spread of the same lens, known to half a pixel in each."""
    height = round(64 * scale)
    coc, width = BLUR * scale, round(80 * scale)
    held = np.broadcast_to(np.arange(width) < width // 2, (height, width))
    alpha = layered(driver, near_edges.near_case("", coc, held, LAYERED))[..., 0]
    polygon = near_edges.polygon_of("hexagon", 0.0, coc)
    wanted = near_edges.edge_spread(polygon, width // 2 - np.arange(width) - 0.5)
    allowed = 0.5 * near_edges.steepest(polygon) + near_edges.WHOLE + near_edges.STEP
    assert np.abs(alpha - wanted).max() <= allowed


@pytest.mark.parametrize("factor", [0.1, 10.0])
@pytest.mark.parametrize("case", [lights.light_case(-BLUR, 3), lights.silhouette_case()], ids=lambda c: c.label)
@in_each_language
def test_layered_exposure(case, factor, driver):
    """Colour times any factor: the picture times that, where no half float is denormal or too large.

    Brightness is compared with a level that grows with it. A layer's CoC is a quotient of sums that are stored three
    times: half floats cut off up to 6 steps of it, half of that moves an edge. Beside the weights, a channel is stored
    four times.
    """
    plain = layered(driver, case)
    color = case.color.copy()
    color[..., :3] = color[..., :3].astype(np.float64) * factor
    off = np.abs(layered(driver, replace(case, color=color)) / factor - plain)
    for channel in range(3):
        image = plain[..., channel]
        slope = max(np.abs(np.diff(image, axis=axis)).max() for axis in (0, 1))
        allowed = 3 * near_edges.STEP * BLUR * slope + 4 * near_edges.STEP * image.max()
        assert off[..., channel].max() <= allowed, (channel, off[..., channel].max(), allowed)


@in_each_language
def test_layered_quarter_turn(driver):
    """Image and aperture turned by 90 degrees: the turned picture, where the sizes are multiples of 8.

    Tiles are taken along rows first, so sums are rounded in another order: as close as two drivers are.
    """
    case = noise_case((64, 64), Settings("layered", "hexagon", camera=CAMERA))
    turned = transformed(case, rotated, replace(case.settings, rotation=-90.0))
    found, wanted = (result(driver, item) for item in (turned, case))
    distance = metrics.steps(found, rotated(wanted))
    assert (distance <= metrics.CLOSE_STEPS).mean() >= metrics.CLOSE_SHARE


def edge_at(place: float) -> Case:
    """A near edge with its pixels drawn by area, and depth by their middles, as a renderer does."""
    size = near_edges.SIZE
    cover = np.clip(size[0] // 2 + place - np.arange(size[0]), 0.0, 1.0)
    case = near_edges.near_case("", BLUR, np.broadcast_to(cover >= 0.5, size[::-1]), LAYERED)
    case.color[..., 0] = cover
    case.color[..., 1] = (1.0 - cover) * near_edges.checker(size)
    return case


@in_each_language
def test_layered_moving_edge(driver):
    """A near edge moved by 1/8 pixel a frame: its alpha follows the lens's, and no frame is off from it by more.

    The layer's edge is where depth has it, half a pixel from the true one at most, and known to half a pixel: a pixel
    of the spread. Beside that, a pixel that is covered by less than a half keeps the colour of the edge in focus: where
    alpha is a half, half of a half. From frame to frame that comes and goes.
    """
    polygon = near_edges.polygon_of("hexagon", 0.0, BLUR)
    from_edge = near_edges.SIZE[0] // 2 - np.arange(near_edges.SIZE[0]) - 0.5
    off = [layered(driver, edge_at(p))[..., 0] - near_edges.edge_spread(polygon, from_edge + p) for p in MOVES]
    allowed = near_edges.steepest(polygon) + 0.25 + near_edges.WHOLE + near_edges.STEP
    assert np.abs(off).max() <= allowed
    assert np.abs(np.diff(off, axis=0)).max() <= allowed
    if driver.name == "egl":
        changed, bound = told(r"moving near edge \| up to ([\d.]+) of its alpha.*?bound ([\d.]+)")
        assert np.abs(np.diff(off, axis=0)).max() <= changed + 0.0005
        assert bound == pytest.approx(allowed, abs=0.0005)


def light_at(place: float, near: bool) -> tuple[Case, np.ndarray]:
    """A disc of 3 pixels drawn by area: near, over what is in focus, or far, beside a silhouette; and its coverage."""
    size = near_edges.SIZE
    cover = sweep.disc(size, (size[0] / 2 + 4 + place, size[1] / 2 + 0.3), 3.0)
    if not near:
        case = lights.silhouette_case()
        case.color[:, lights.EDGE :, 2] = lights.LIGHT * cover[:, lights.EDGE :]
        return case, cover
    case = near_edges.near_case("", BLUR, cover >= 0.5, LAYERED)
    case.color[..., 0] = 0.0
    case.color[..., 1] = (1.0 - cover) * near_edges.checker(size)
    case.color[..., 2] = lights.LIGHT * cover
    return case, cover


@pytest.mark.parametrize("near", [True, False], ids=["near light", "far light beside an edge"])
@in_each_language
def test_layered_moving_light(near, driver):
    """A light moved by 1/8 pixel a frame: how far its own light flickers.

    Near, it is kept as an isolated one is, 0.99 to 1.01, so a frame differs by no more than 0.02. Far, the silhouette
    hides a part: what is seen is what the polygon has there, times up to 2 (see the probe), and by 1/8 pixel that
    changes by the width of the polygon over its area, once more times 2, beside the 0.02.
    """
    found = []
    for place in MOVES:
        case, cover = light_at(place, near)
        found.append(layered(driver, case)[..., 2].sum() / (lights.LIGHT * cover.sum()))
    changed = np.abs(np.diff(found)).max()
    allowed = 0.02 + (0.0 if near else 2 * near_edges.steepest(near_edges.polygon_of("hexagon", 0.0, BLUR)) / 8)
    assert changed <= allowed
    if near:
        assert 0.99 <= min(found) and max(found) <= 1.01, found
    if driver.name == "egl":
        name = "moving near light" if near else "moving far light beside an edge"
        measured, bound = told(rf"{name} \| up to ([\d.]+) of its light.*?bound ([\d.]+)")
        assert changed <= measured + 0.0005
        assert bound == pytest.approx(allowed, abs=0.0005)
