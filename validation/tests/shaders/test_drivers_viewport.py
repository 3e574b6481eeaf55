"""Targets of other sizes, and passes into a part of them, on every driver, with NaN around the image."""

from dataclasses import replace

import numpy as np
import pytest
from support import load
from support_cases import CAMERA, noise_case
from support_targets import NAN, Area, framed, inside, nan

from bokeh_validation import metrics
from bokeh_validation.drivers import base
from bokeh_validation.errors import Unavailable
from bokeh_validation.frame import methods
from bokeh_validation.probes.model import expected
from bokeh_validation.reference.device import Reference
from bokeh_validation.shaders.passes import Pass, target_size

SIZE = (13, 9)
# 5 texels to the left, 2 to the right, 1 above, 4 below: whatever is turned or mirrored lies elsewhere
AREA: Area = (5, 1, 6, 4)
COC = 0.25
TIMED = ("osmesa", "egl", "wgpu", "dxc")


def picture(width: int, height: int) -> np.ndarray:
    """(H, W, 4) float16, no two texels alike; COC in alpha, as `copy` writes it."""
    y, x = np.mgrid[:height, :width]
    return np.stack([x + 1, y + 1, 10 * x + y, np.full_like(x, COC, float)], axis=-1).astype(np.float16)


def copy(source: str, output: str, scale: int = 1, viewport: Area | None = None) -> Pass:
    """A texture fetched with the nearest filter at each texel of the target; alpha becomes COC."""
    parameters = {"BokehConstantCoC": COC, "BokehMaxCoC": 1.0}
    return Pass("BokehConstantCoC", {"ColorSamp": source}, output, parameters, viewport=viewport, scale=scale)


def fetched(source: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """What `copy` makes of a source in a target of that size: texel floor(uv * size of the source)."""
    y, x = ((2 * np.arange(count) + 1) * source.shape[axis] // (2 * count) for axis, count in enumerate(size[::-1]))
    result = source[y[:, None], x[None, :]].copy()
    result[..., 3] = COC
    return result


# ----------------------------------------------------------------------------------------------------------------------
# sizes
# ----------------------------------------------------------------------------------------------------------------------


def test_more_bytes_a_pixel_than_the_device_writes():
    """Four half-float targets are what every device of WebGPU has; four of 32 bits are not."""
    passes = methods.plan(methods.Settings("exact", "decagon"), (8, 8)).passes
    base.require_targets(Reference(), passes, "half", 32)
    with pytest.raises(Unavailable, match="writes 32 bytes a pixel at once; BokehDecagonFirst needs 64"):
        base.require_targets(Reference(), passes, "float", 32)


@pytest.mark.parametrize("storage", ["half", "float"])
def test_targets_of_other_sizes(storage, driver):
    """Each pass reads a target of another size than its own, down to an eighth and back, and upwards from there.

    These sizes are odd at every scale, so that no fetch is on the border of two texels.
    """
    scales = (1, 2, 4, 8, 1)
    names = [f"{index} at {scale}" for index, scale in enumerate(scales)]
    sources = ["picture", *names]
    passes = [copy(*names, scale) for *names, scale in zip(sources, names, scales, strict=False)]
    for size in ((65, 49), (17, 1)):
        output = driver.run(passes, {"picture": picture(*size)}, size, storage, names)
        wanted = picture(*size)
        for name, scale in zip(names, scales, strict=True):
            wanted = fetched(wanted, target_size(scale, size))
            np.testing.assert_array_equal(output[name], wanted, name)
            assert output[name].dtype == base.storage_type(storage)


def test_targets_beside_each_other(driver):
    """One texture copied at every scale, kept in another order than drawn; names are used again at other scales."""
    size, source = (61, 37), picture(61, 37)
    passes = [copy("picture", f"{scale}", scale) for scale in (8, 1, 4, 2)]
    again = [copy("picture", "t", 2), copy("t", "t", 1), copy("t", "t", 8)]
    output = driver.run([*passes, *again], {"picture": source}, size, keep=("1", "2", "4", "8", "t"))
    for scale in (1, 2, 4, 8):
        np.testing.assert_array_equal(output[f"{scale}"], fetched(source, target_size(scale, size)))
    np.testing.assert_array_equal(output["t"], fetched(fetched(fetched(source, (31, 19)), size), (8, 5)))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"scale": 3}, "BokehConstantCoC: scale is one of 1, 2, 4, 8, not 3"),
        ({"scale": 0}, "BokehConstantCoC: scale is one of 1, 2, 4, 8, not 0"),
        ({"entry": "BokehHexagonFirst"}, "BokehHexagonFirst writes 2 targets"),
        ({"entry": "BokehHexagonFirst", "output": ("one", "two", "three")}, "BokehHexagonFirst writes 2 targets"),
    ],
)
def test_no_such_targets(changes, words):
    """Said when the pass is made."""
    with pytest.raises(ValueError, match=words):
        replace(copy("picture", "t"), **changes)


# ----------------------------------------------------------------------------------------------------------------------
# a part of a target
# ----------------------------------------------------------------------------------------------------------------------

TEXTURES = {"picture": picture(*AREA[2:]), **NAN}


def part(output: str, source: str = "picture", viewport: Area | None = AREA) -> Pass:
    """A texture over the viewport."""
    return copy(source, output, viewport=viewport)


def placed(around: float) -> np.ndarray:
    """(H, W, 4) float16: the picture at its place, the same value everywhere else."""
    return framed(TEXTURES["picture"], SIZE, AREA, around)


@pytest.mark.parametrize("storage", ["half", "float"])
def test_a_part_is_drawn_and_the_rest_stays(storage, driver):
    """The picture, upright, at its place counted from the first row in memory; NaN in every texel around it.

    A second part is drawn over a corner of the first. Where no earlier pass has drawn, the rest is 0, also where a
    texture of that name was handed in: that one is no target.
    """
    second = (2, 3, 6, 4)
    passes = [nan("empty"), nan("one"), part("one"), nan("two"), part("two"), part("two", viewport=second), part("nan")]
    output = driver.run(passes, TEXTURES, SIZE, storage, ("empty", "one", "two", "nan"))
    # else NaN around an image would prove nothing
    assert output["empty"].shape == (SIZE[1], SIZE[0], 4) and np.isnan(output["empty"]).all()
    np.testing.assert_array_equal(output["one"], placed(np.nan))
    np.testing.assert_array_equal(output["nan"], placed(0.0))
    wanted = placed(np.nan)
    inside(wanted, second)[:] = TEXTURES["picture"]
    np.testing.assert_array_equal(output["two"], wanted)


def test_without_a_viewport_the_target_is_new_again(driver):
    """It may read the old one of its name, and a later part is drawn over the new one."""
    corner = (12, 8, 1, 1)
    passes = [nan("t"), part("t"), part("t", "t", None), replace(nan("t"), viewport=corner)]
    output = driver.run(passes, TEXTURES, SIZE, keep=("t",))["t"]
    wanted = placed(0.0)
    wanted[..., 3] = COC  # NaN became 0 by the copy
    inside(wanted, corner)[:] = np.nan
    np.testing.assert_array_equal(output, wanted)


@pytest.mark.parametrize("new", [(), ("a",), ("b",)], ids=["both old", "a new", "b new"])
def test_several_targets(new, driver):
    """Each target keeps what is around the part if an earlier pass drew it, and is 0 there if none did.

    What is drawn is compared with the reference, whose targets are as large as the part: so uv that ran over anything
    else, or a little off, would show.
    """
    size, area = (41, 27), (11, 3, 24, 16)
    case = noise_case(area[2:], methods.Settings("exact", "hexagon", coc=0.15, camera=CAMERA))
    first, second = case.plan.passes[:2]
    case = replace(case, keep=second.outputs)
    wanted = expected(case, driver.precision, driver.rounding)
    stored = driver.run([first], case.textures(), case.size, keep=first.outputs)
    before = [nan(name) for name in ("a", "b") if name not in new]
    drawn = [*before, replace(second, output=("a", "b"), viewport=area)]
    output = driver.run(drawn, {**TEXTURES, **stored}, size, keep=("a", "b"))
    for name, plain in zip(("a", "b"), second.outputs, strict=True):
        comparison = metrics.compare(inside(output[name], area), wanted[plain], driver.software)
        assert comparison.ok, f"{name}: {comparison}"
        around = np.ones(size[::-1], bool)
        inside(around, area)[:] = False
        rest = output[name][around]
        assert (rest == 0).all() if name in new else np.isnan(rest).all()


@pytest.mark.parametrize("new", [False, True], ids=["old", "new"])
def test_a_part_of_a_small_target(new, all_drivers):
    """A viewport in texels of the full size; what an earlier pass left around it stays, a new target is 0 there."""
    size, scale, area = (29, 21), 4, (8, 4, 13, 9)
    source = {"picture": picture(4, 3), "whole": np.full((6, 8, 4), 7.0, np.float16), **NAN}
    drawn = copy("picture", "t", scale, viewport=area)
    # the reference copies texel by texel, and not NaN
    for driver, before, rest in [
        *((driver, nan("t", scale), np.nan) for driver in all_drivers),
        (Reference(), copy("whole", "t", scale), [7.0, 7.0, 7.0, COC]),
    ]:
        wanted = np.full((6, 8, 4), 0.0 if new else rest, np.float16)
        inside(wanted, (2, 1, 4, 3))[:] = fetched(picture(4, 3), (4, 3))
        output = driver.run([drawn] if new else [before, drawn], source, size, keep=("t",))["t"]
        np.testing.assert_array_equal(output, wanted, driver.name)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"inputs": {"ColorSamp": "t"}}, "BokehConstantCoC reads 't' and draws over it"),
        ({"viewport": (2, 4, 4, 4)}, r"viewport \(2, 4, 4, 4\) begins within a texel of targets of scale 4"),
        ({"viewport": (4, 6, 4, 4)}, r"viewport \(4, 6, 4, 4\) begins within a texel of targets of scale 4"),
        ({"viewport": (4, 4, 26, 4)}, r"viewport \(4, 4, 26, 4\) is not within 29 x 21"),
        ({"viewport": (4, 4, 4, 18)}, "is not within"),
        ({"viewport": (-4, 4, 4, 4)}, "is not within"),
        ({"viewport": (4, -4, 4, 4)}, "is not within"),
        ({"viewport": (4, 4, 0, 4)}, "is not within"),
        ({"viewport": (4, 4, 4, 0)}, "is not within"),
        ({"scale": 2}, "has scale 2 .*draws over 't', which has scale 4"),
    ],
)
def test_refused(changes, words, all_drivers):
    """Reading what is drawn over is undefined on every device; a part begins at a texel and lies in its target, which
    keeps its size and format.
    """
    first = copy("picture", "t", 4)
    second = replace(first, **{"viewport": (4, 4, 4, 4), **changes})
    for driver in (*all_drivers, Reference()):
        with pytest.raises(ValueError, match=words):
            driver.run([first, second], {"picture": picture(8, 6)}, (29, 21), keep=("t",))


# ----------------------------------------------------------------------------------------------------------------------
# jobs that are drawn many times
# ----------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", TIMED)
def test_jobs(name):
    """Drawn many times, and on the targets of another job: NaN left in those does not come back."""
    driver = load(name)
    other = driver.prepared([nan("t")], TEXTURES, SIZE)
    jobs = [
        (driver.prepared([nan("t"), part("t")], TEXTURES, SIZE), np.nan),
        (driver.prepared([part("t")], TEXTURES, SIZE, share=other), 0.0),
    ]
    for job, rest in jobs:
        for _ in range(2):
            other.draw()
            job.draw()
            np.testing.assert_array_equal(job.read("t"), placed(rest))
        job.timed(3)
        np.testing.assert_array_equal(job.read("t"), placed(rest))
        job.release()
    other.release()
