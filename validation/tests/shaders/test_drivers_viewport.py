"""A pass into a part of its targets, on every driver: dynamic resolution, with NaN around the image."""

from dataclasses import replace

import numpy as np
import pytest
from support import load

from bokeh_validation import drivers, methods, metrics
from bokeh_validation.drivers.base import drawn_over
from bokeh_validation.passes import Pass
from bokeh_validation.patterns.model import Case, expected

Area = tuple[int, int, int, int]

SIZE = (13, 9)
# 5 texels to the left, 2 to the right, 1 above, 4 below: whatever is turned or mirrored lies elsewhere
AREA: Area = (5, 1, 6, 4)
COC = 0.25
TIMED = ("osmesa", "egl", "wgpu", "dxc")


def picture(width: int, height: int) -> np.ndarray:
    """(H, W, 4) float16, no two texels alike; COC in alpha, as `part` writes it."""
    y, x = np.mgrid[:height, :width]
    return np.stack([x + 1, y + 1, 10 * x + y, np.full_like(x, COC, float)], axis=-1).astype(np.float16)


# One texel of NaN is read everywhere. Depth is read by BokehDebug, and not used in its mode 0.
TEXTURES = {
    "picture": picture(*AREA[2:]),
    "nan": np.full((1, 1, 4), np.nan, np.float16),
    "depth": np.ones((1, 1), np.float32),
}


def fill(output: str) -> Pass:
    """NaN everywhere in a new target: the debug view of colour copies what it reads."""
    return Pass("BokehDebug", {"ColorSamp": "nan", "DepthSamp": "depth"}, output)


def part(output: str, source: str = "picture", viewport: Area | None = AREA) -> Pass:
    """A texture over the viewport, by the pass that copies with the nearest filter; its alpha becomes COC."""
    parameters = {"BokehConstantCoC": COC, "BokehMaxCoC": 1.0}
    return Pass("BokehConstantCoC", {"ColorSamp": source}, output, parameters, viewport=viewport)


def inside(image: np.ndarray, area: Area = AREA) -> np.ndarray:
    """The texels of a rectangle, a view."""
    x, y, width, height = area
    return image[y : y + height, x : x + width]


def placed(around: float) -> np.ndarray:
    """(H, W, 4) float16: the picture at its place, the same value everywhere else."""
    whole = np.full((SIZE[1], SIZE[0], 4), around, np.float16)
    inside(whole)[:] = TEXTURES["picture"]
    return whole


@pytest.mark.parametrize("storage", ["half", "float"])
class TestOneTarget:
    """Copies of whole numbers and of COC: exact in both formats, and on every driver."""

    def test_nan_arrives(self, storage, driver):
        """Else NaN around an image would prove nothing."""
        output = driver.run([fill("t")], TEXTURES, SIZE, storage, ("t",))["t"]
        assert output.shape == (SIZE[1], SIZE[0], 4) and np.isnan(output).all()

    def test_a_part_is_drawn_and_the_rest_stays(self, storage, driver):
        """The picture, upright, at its place counted from the first row in memory; NaN in every texel around it."""
        output = driver.run([fill("t"), part("t")], TEXTURES, SIZE, storage, ("t",))["t"]
        np.testing.assert_array_equal(output, placed(np.nan))

    def test_a_new_target_is_zero_around_it(self, storage, driver):
        """Also where a texture of that name was handed in: that one is no target."""
        output = driver.run([part("nan")], TEXTURES, SIZE, storage, ("nan",))["nan"]
        np.testing.assert_array_equal(output, placed(0.0))


def test_two_parts_of_a_target(driver):
    """The second is drawn over a corner of the first, which stays elsewhere."""
    second = (2, 3, 6, 4)
    output = driver.run([fill("t"), part("t"), part("t", viewport=second)], TEXTURES, SIZE, keep=("t",))["t"]
    wanted = placed(np.nan)
    inside(wanted, second)[:] = TEXTURES["picture"]
    np.testing.assert_array_equal(output, wanted)


def test_without_a_viewport_the_target_is_new_again(driver):
    """It may read the old one of its name, and a later part is drawn over the new one."""
    corner = (12, 8, 1, 1)
    passes = [fill("t"), part("t"), part("t", "t", None), replace(fill("t"), viewport=corner)]
    output = driver.run(passes, TEXTURES, SIZE, keep=("t",))["t"]
    wanted = placed(0.0)
    wanted[..., 3] = COC  # NaN became 0 by the copy
    inside(wanted, corner)[:] = np.nan
    np.testing.assert_array_equal(output, wanted)


def filtered(driver: drivers.Driver, before: list[Pass], size: tuple[int, int], area: Area) -> dict[str, np.ndarray]:
    """Draw the two targets of BokehHexagonFirst, "a" and "b", into a part; compare them with the reference.

    The interval is that of every comparison, see metrics.compare. The reference has targets as large as the part, so uv
    that ran over anything else, or a little off, would show: there is noise in every texel, read between the texels.
    """
    random = np.random.default_rng(7)
    color = np.ones((area[3], area[2], 4), np.float16)
    color[..., :3] = random.lognormal(0.0, 1.0, (area[3], area[2], 3))
    settings = methods.Settings("exact", "hexagon", coc=0.15)
    depth = np.full((area[3], area[2]), 4.0, np.float32)
    case = Case("viewport", settings, color, depth)
    first, second = case.plan.passes[:2]
    case = replace(case, keep=second.outputs)
    wanted = expected(case, driver.software, driver.rounding)
    stored = driver.run([first], case.textures(), case.size, keep=first.outputs)
    textures = {**TEXTURES, **case.textures(), **stored}
    drawn = [*before, replace(second, output=("a", "b"), viewport=area)]
    output = driver.run(drawn, textures, size, keep=("a", "b"))
    for name, plain in zip(("a", "b"), second.outputs, strict=True):
        comparison = metrics.compare(inside(output[name], area), wanted[plain], driver.software)
        assert comparison.ok, f"{driver.name} {name}: {comparison}"
    return output


def around(image: np.ndarray, area: Area) -> np.ndarray:
    """(N, 4): the texels outside of a rectangle."""
    outside = np.ones(image.shape[:2], bool)
    inside(outside, area)[:] = False
    return image[outside]


@pytest.mark.parametrize("new", [(), ("a",), ("b",)], ids=["both old", "a new", "b new"])
def test_several_targets(new, driver):
    """Each target keeps what is around the part if an earlier pass drew it, and is 0 there if none did."""
    size, area = (41, 27), (11, 3, 24, 16)
    before = [fill(name) for name in ("a", "b") if name not in new]
    for name, image in filtered(driver, before, size, area).items():
        rest = around(image, area)
        assert len(rest) == 41 * 27 - 24 * 16
        assert (rest == 0).all() if name in new else np.isnan(rest).all()


@pytest.mark.parametrize(
    ("viewport", "source", "words"),
    [
        (AREA, "t", "BokehConstantCoC reads 't' and draws over it"),
        ((8, 1, 6, 4), "picture", r"viewport \(8, 1, 6, 4\) is not within 13 x 9"),
        ((5, 6, 6, 4), "picture", r"viewport \(5, 6, 6, 4\) is not within 13 x 9"),
        ((-1, 1, 6, 4), "picture", "is not within"),
        ((5, -1, 6, 4), "picture", "is not within"),
        ((5, 1, 0, 4), "picture", "is not within"),
        ((5, 1, 6, 0), "picture", "is not within"),
    ],
)
def test_refused(viewport, source, words, driver):
    """Reading what is drawn over is undefined on every device; a rectangle must lie in the targets."""
    with pytest.raises(ValueError, match=words):
        driver.run([fill("t"), part("t", source, viewport)], TEXTURES, SIZE, keep=("t",))


def test_what_is_drawn_over():
    """Only outputs of earlier passes, and only by a pass with a viewport."""
    passes = [part("nan"), part("t", viewport=None), part("t"), part("t", viewport=None), part("nan")]
    assert drawn_over(passes, SIZE) == [set(), set(), {"t"}, set(), {"nan"}]
    # a texture that was handed in is not the target of its name
    assert drawn_over([part("picture")], SIZE) == [set()]


@pytest.mark.parametrize("name", TIMED)
def test_jobs(name):
    """Drawn many times, and on the targets of another job: NaN left in those does not come back."""
    driver = load(name)
    other = driver.prepared([fill("t")], TEXTURES, SIZE)
    jobs = [
        (driver.prepared([fill("t"), part("t")], TEXTURES, SIZE), np.nan),
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
