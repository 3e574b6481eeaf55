"""Test what must not change the blur: resolution, aspect ratio, preset, rotation, mirroring, exposure, position.

The size of a highlight's bokeh is measured by second moments (tests/moments.py), on float32 targets and on black,
since half floats would truncate a faint edge and so change the size. test_layers.py tests layered, test_continuity.py
small steps.
"""

from dataclasses import replace
from functools import partial

import moments
import numpy as np
import pytest
from support import LANGUAGES, in_each_language
from support_cases import CAMERA, float_result, noise_case, result

from bokeh_validation import metrics
from bokeh_validation.drivers.base import Driver
from bokeh_validation.frame import methods
from bokeh_validation.frame.methods import Settings
from bokeh_validation.numerics import precision
from bokeh_validation.numerics.images import Image
from bokeh_validation.probes.judges import expected
from bokeh_validation.probes.model import Case, depth_of, flat

PEAK = 4096.0
COC = 0.26  # of the height; the widest bokeh fits into the narrowest image

# three aspect ratios at about one size, and one ratio at 1x, 1.5x and 2x
SIZES = ((80, 160), (96, 96), (154, 66), (64, 48), (96, 72), (128, 96))
COUNTS = (7, 13, 33, 65)


def blur(method: str, aperture: str, **changes) -> Settings:
    """Return settings with the constant CoC."""
    return replace(Settings(method, aperture, camera=methods.Camera(max_coc=1.0), coc=COC, spacing=0.0), **changes)


# every way of taking samples that is linear in the light
LINEAR = (
    blur("paper", "square"),
    blur("paper", "diamond", spacing=1.0, rotation=20.0),
    blur("exact", "hexagon"),
    blur("exact", "decagon", spacing=1.0),
    blur("exact", "hexagon", spacing=1.0, rotation=25.0, squeeze=0.5),
    blur("naive", "hexagon", samples=7),
)


def named(settings: Settings) -> str:
    """Return a name of settings for messages and tests."""
    count = f"spacing {settings.spacing:g}" if settings.spacing else f"{settings.count} samples"
    return f"{settings.method} {settings.aperture} {count}"


def highlight(settings: Settings, size: tuple[int, int], pixels: int = 1) -> tuple[Case, tuple[float, float]]:
    """Return a bright square of `pixels` x `pixels` in the middle of black, and the position of its centre."""
    color = flat(size)
    left, top = (size[0] - pixels) // 2, (size[1] - pixels) // 2
    color[top : top + pixels, left : left + pixels, :3] = PEAK / pixels**2
    return Case("", settings, color, depth_of(size, 5.0)), (left + pixels / 2, top + pixels / 2)


def check_spread(driver: Driver, settings: Settings, size: tuple[int, int]) -> moments.Spread:
    """Compare mean, second moments and reach with the closed form, within moments.tolerance().

    Reach: a sample's light falls on the pixels on both sides of it, so a pass reaches less than one pixel beyond its
    farthest sample, and at least to one pixel before it.
    """
    case, center = highlight(settings, size)
    actual, reference = moments.measured(float_result(driver, case)[..., 1], center), moments.predicted(settings, size)
    passes = len(methods.plan(settings, size).passes) - 1
    slack = passes * (1.0 + driver.precision.place(max(size)) + precision.SINE * settings.coc * size[1])
    excess_reach = actual.reach - reference.reach
    assert (excess_reach > -1.0).all() and (excess_reach <= slack).all(), (named(settings), size, excess_reach)
    bound = moments.tolerance(settings, size, driver.precision)
    error = np.abs(actual.second - reference.second).max()
    assert error <= bound, (named(settings), size, error, bound)
    # the mean moves by at most the error of the samples' positions, and the blend's error times their distance
    assert np.abs(actual.mean - reference.mean).max() <= bound, (named(settings), size)
    return actual


@pytest.mark.parametrize("size", SIZES, ids=str)
@in_each_language
def test_resolution_and_aspect_ratio(size, driver):
    """Check that the CoC is a fraction of the height, and that highlights are not stretched, from 1:2 to 21:9.

    Size and shape in pixels must match the closed form at that CoC in pixels, which knows no aspect ratio.
    """
    for settings in LINEAR:
        check_spread(driver, settings, size)


@pytest.mark.parametrize("size", [SIZES[0], SIZES[2]], ids=str)
@in_each_language
def test_presets_never_change_the_size(size, driver):
    """Check that spacing 1, 2 and 4, fixed counts and limits give the true polygon's size, within spacing and pixel
    grid.

    The aperture's second moments on the two axes are R^2 (2 + cos(2 pi / n)) / 12. Each of the two passes removes at
    most l^2 / 12 along its line, where l is the length of a cell, and adds at most 1 / 4 square pixel on each axis
    (moments.py). The paper's lines have a sample at both ends: each count must give the size of its closed form.
    """
    edge = 0.5 * COC * size[1]
    presets = [{"spacing": spacing} for spacing in (1.0, 2.0, 4.0)] + [{"samples": samples} for samples in COUNTS]
    for changes in (*presets, {"spacing": 1.0, "squeeze": 0.5}, {"spacing": 1.0, "samples": 7}):
        settings = blur("exact", "hexagon", **{"samples": 33, **changes})
        second_moments = np.diag(check_spread(driver, settings, size).second)
        excess = second_moments - edge**2 * (2.0 + np.cos(np.pi / 3)) / 12.0 * np.array([settings.squeeze**2, 1.0])
        cell = max(settings.spacing, edge / settings.count)
        bound = moments.tolerance(settings, size, driver.precision)
        assert (excess >= -2 * cell**2 / 12 - bound).all(), (named(settings), excess)
        assert (excess <= 2 / 4 + bound).all(), (named(settings), excess)
    for samples in COUNTS:
        check_spread(driver, blur("paper", "square", samples=samples), size)


@pytest.mark.parametrize("driver", LANGUAGES[:2], indirect=True)
def test_jitter_never_changes_the_size(driver):
    """Check that random offsets keep samples within their cells: no light beyond the line's ends, and no change of the
    mean size.

    With a sample anywhere in each cell of l pixels, the variance is the line's own 1/12, which is l^2 / 12 more than
    with samples in the middle. The offset is limited to (l - 1) pixels. A frame's moments are random; their mean must
    be within 4 standard errors of that.
    """
    size, frames = (96, 96), 24
    settings = blur("paper", "square", spacing=1.0, samples=7, jitter=1.0)
    pixels, sums = COC * size[1], []
    assert pixels / 7 > 2
    for frame in range(frames):
        case, center = highlight(replace(settings, frame=frame), size, 5)
        actual = moments.measured(float_result(driver, case)[..., 1], center)
        # half of the highlight, half of the line, and one pixel per pass beyond a sample
        assert (actual.reach <= 2.5 + pixels / 2 + 2).all(), (frame, actual.reach)
        sums.append(np.diag(actual.second))
    reference = pixels**2 / 12 + (5**2 - 1) / 12
    mean, error = np.mean(sums, axis=0), np.std(sums, axis=0, ddof=1) / np.sqrt(frames)
    assert (mean >= reference - 4 * error).all() and (mean <= reference + 0.5 + 4 * error).all(), (
        mean,
        reference,
        error,
    )


def check_same(driver: Driver, case: Case, change, settings: Settings, border: int = 0) -> metrics.Comparison:
    """Check that change(blur(image)) equals blur'(change(image)) on half floats, within the sum of both intervals.

    change    a function of arrays, applied to colour and depth
    settings  of blur'
    border    pixels at the image's edges that are ignored
    """
    changed = Case("", settings, *(np.ascontiguousarray(change(image)) for image in (case.color, case.depth)))
    found, plain = result(driver, changed), result(driver, case).astype(np.float64)
    own, other = (expected(c, driver.precision, driver.rounding)["result"] for c in (case, changed))
    allowed = Image(change(plain), change(own.error) + other.error, change(own.undecided) | other.undecided)
    inner = (slice(border, case.size[1] - border), slice(border, case.size[0] - border))
    comparison = metrics.compare(found[inner], allowed.part(*inner), driver.software)
    assert comparison.outside == 0, (named(case.settings), comparison)
    return comparison


VARYING = (
    Settings("paper", "hexagon", camera=CAMERA, spacing=0.0),
    Settings("paper", "octagon", camera=CAMERA, spacing=1.0),
    Settings("exact", "hexagon", camera=CAMERA, spacing=0.0),
    # with its preset's samples
    Settings("exact", "octagon", camera=CAMERA),
    Settings("exact", "decagon", camera=CAMERA, spacing=1.0),
    Settings("naive", "hexagon", 7, camera=CAMERA, spacing=0.0),
)
MIRRORED = [
    Settings(method, aperture, 7 if method == "naive" else None, 10.0, CAMERA, spacing=0.0)
    for method, aperture in (("paper", "hexagon"), ("paper", "octagon"), ("exact", "square"), ("naive", "hexagon"))
]


@pytest.mark.parametrize("settings", VARYING, ids=named)
@in_each_language
def test_quarter_turn(settings, driver):
    """Check that image and aperture rotated by 90 degrees give the rotated image, with the CoC from depth: no axis is
    preferred.
    """
    case = noise_case((60, 60), settings)
    # what pointed to the right (+u) then points up (-v)
    turned = replace(settings, rotation=settings.rotation - 90.0)
    comparison = check_same(driver, case, np.rot90, turned)
    if driver.software:
        assert comparison.close >= metrics.CLOSE_SHARE, comparison


@pytest.mark.parametrize("settings", MIRRORED, ids=named)
@in_each_language
def test_mirror(settings, driver):
    """Check that swapping left and right and negating the rotation gives the mirrored image. Fixed counts and tables.

    The CoC is constant, and pixels within a CoC of the image's edges are ignored: mirrored lines come in another
    order, and passes only commute where none is clamped. With the CoC from depth it holds for the paper's hexagon and
    for tables, whose lines mirror into each other in order.

    The exact hexagon is left out: when mirrored, its two passes split a sample's offset differently, so that the
    linear filter softens other samples. test_resolution_and_aspect_ratio checks its size at each rotation.
    """
    case, turned = noise_case((84, 60), settings), replace(settings, rotation=-settings.rotation)
    constant = replace(case, settings=replace(settings, coc=0.2))
    comparison = check_same(driver, constant, np.fliplr, replace(turned, coc=0.2), border=14)
    assert comparison.close >= metrics.CLOSE_SHARE, comparison
    if settings.aperture == "hexagon":
        check_same(driver, case, np.fliplr, turned)


@pytest.mark.parametrize("settings", VARYING, ids=named)
@in_each_language
def test_exposure(settings, driver):
    """Check exposure: colour times 2^k is bit-identical up to the exponent; colour times 1.5 is rounded once more per
    store.

    Every operation on colour is a sum, a product with a number that does not depend on colour, a quotient, min or max.
    A power of two commutes with rounding. Colours are chosen so that no half float is denormal or too large. CoC are
    bit-identical; only in `exact` the CoC that the first pass writes follows the ratio of two sums of colour, so at 1.5
    times the colour each store may round it the other way.
    """
    case = noise_case((60, 48), settings)
    # 8 bits, so that a factor with two bits is exact
    few_bits = np.round(np.clip(case.color.astype(np.float64), 0.25, 32.0) * 8.0) / 8.0
    passes, pictures = len(case.plan.passes), {}
    # a store: half a step of 2^-10 up or down, or a whole one down; the sums: N + 8 roundings
    rounded = passes * 2.0**-10 + 2 * passes * ((settings.count + 8) * precision.FLOAT_STEP + driver.precision.filter)
    for factor in (1.0, 2.0**-6, 2.0**5, 1.5):
        brighter = replace(case, color=(few_bits * [factor, factor, factor, 1.0]).astype(np.float16))
        actual = pictures[factor] = result(driver, brighter).astype(np.float64)
        steps = passes * 2.0**-10 if settings.method == "exact" and factor == 1.5 else 0.0
        np.testing.assert_allclose(actual[..., 3], pictures[1.0][..., 3], rtol=steps, atol=0.0)
        reference = factor * pictures[1.0][..., :3]
        np.testing.assert_allclose(actual[..., :3], reference, rtol=rounded * (factor == 1.5), atol=0.0)


@pytest.mark.parametrize("settings", [*LINEAR, blur("paper", "hexagon")], ids=named)
@in_each_language
def test_translation(settings, driver):
    """Check that a highlight moved by whole pixels has its bokeh moved by as many, within the rounding of uv.

    It is not bit-identical, since uv is a float32: a position is known to 8 2^-24 of the width, and to another 8 2^-24
    elsewhere (numerics/precision.py).
    """
    settings = replace(settings, coc=0.3)
    case, _ = highlight(settings, (96, 60), 3)
    check_same(driver, case, partial(np.roll, shift=(-5, 17), axis=(0, 1)), settings)
