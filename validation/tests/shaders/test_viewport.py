"""BOKEH_VIEWPORT: an image that is a part of its textures, with NaN around it in every one of them."""

from dataclasses import replace

import numpy as np
import pytest
from support import in_each_language, spread
from support_cases import kind
from support_targets import framed, inside, poisoned

from bokeh_validation import metrics
from bokeh_validation.frame import methods
from bokeh_validation.reference import images, listings
from bokeh_validation.reference.device import Reference
from bokeh_validation.shaders.passes import Pass

SIZE = (90, 70)
# not in the middle, of another aspect ratio than the textures: a wrong corner, size or order of the rows shows
VIEWPORT = (29, 8, 48, 37)
CAMERA = methods.Camera(0.12, 0.05, 4.0, max_coc=0.3)
SETTINGS = {
    "paper": methods.Settings("paper", "octagon", camera=CAMERA),
    "paper, a sample a pixel": methods.Settings("paper", "hexagon", spacing=1.0, jitter=1.0, camera=CAMERA),
    "exact": methods.Settings("exact", "decagon", rotation=11.0, camera=CAMERA),
    "exact, a sample a pixel": methods.Settings("exact", "hexagon", spacing=1.5, jitter=1.0, frame=3, camera=CAMERA),
    "exact, three targets": methods.Settings("exact", "octagon", rotation=5.0, camera=CAMERA),
    "exact, one target": methods.Settings("exact", "octagon", targets=False, squeeze=0.6, camera=CAMERA),
    "naive": methods.Settings("naive", "hexagon", 7, camera=CAMERA),
    "naive grid": methods.Settings("naive-grid", "square", 5, camera=CAMERA),
    "constant CoC": methods.Settings("exact", "square", coc=0.4, camera=replace(CAMERA, max_coc=0.5)),
}


def picture(size: tuple[int, int], seed: int = 2) -> tuple[np.ndarray, np.ndarray]:
    """Random colour (H, W, 4) float16 and depth (H, W) float32: everything differs from its neighbour."""
    random = np.random.default_rng(seed)
    color = random.lognormal(0.0, 1.0, (size[1], size[0], 4)).astype(np.float16)
    return color, random.uniform(1.0, 30.0, (size[1], size[0])).astype(np.float32)


def rendered(driver, settings, size, viewport, storage="half"):
    """A driver's result (H, W, 4), and the reference's with its interval in the viewport."""
    color, depth = picture(viewport[2:])
    plan = methods.in_viewport(methods.plan(settings, viewport[2:]), viewport, size)
    passes = poisoned(plan)
    nothing = np.full((size[1], size[0], 4), np.nan, np.float16)
    textures = {"color": framed(color, size, viewport), "depth": framed(depth, size, viewport), "nan": nothing}
    output = driver.run(passes, textures | plan.tables, size, storage)["result"]
    everywhere = Reference().images(plan.passes, textures | plan.tables, size, storage, kind(driver), driver.rounding)
    return output, everywhere["result"].part(
        slice(viewport[1], viewport[1] + viewport[3]), slice(viewport[0], viewport[0] + viewport[2])
    )


@spread("name", SETTINGS, ("paper", "exact", "naive", "constant CoC"))
def test_nothing_leaks_in(name, driver):
    """Within the interval, so finite, inside; what was around it is as it was.

    The interval is that of the formulas on the image alone, wider by the slope times 1/128 texel, by which fetches keep
    away from the surroundings.
    """
    output, wanted = rendered(driver, SETTINGS[name], SIZE, VIEWPORT)
    part = inside(output, VIEWPORT)
    comparison = metrics.compare(part, wanted, driver.software)
    assert np.isfinite(part).all() and comparison.outside == 0, comparison
    around = output.copy()
    inside(around, VIEWPORT)[:] = np.nan
    np.testing.assert_array_equal(around, np.full_like(output, np.nan))
    assert np.isnan(output).any(axis=-1).sum() == SIZE[0] * SIZE[1] - VIEWPORT[2] * VIEWPORT[3]


# Size of the textures, and where the image is in them
PLACES = [
    ((9, 7), (3, 2, 2, 2)),
    ((9, 7), (0, 0, 9, 7)),
    ((9, 7), (8 - 3, 7 - 5, 3, 5)),
    ((4096, 5), (4096 - 40, 1, 33, 3)),
    ((5, 4096), (1, 4096 - 40, 3, 33)),
    ((8192, 4), (8192 - 33, 0, 33, 3)),
]


@spread("place", PLACES, PLACES[:1])
def test_places_and_sizes(place, driver):
    """The smallest image, the whole texture, its last corner, and far from uv 0, where float32 is coarsest."""
    settings = methods.Settings("exact", "hexagon", camera=replace(CAMERA, max_coc=1.0))
    size, viewport = place
    output, wanted = rendered(driver, settings, size, viewport)
    part = inside(output, viewport)
    assert np.isfinite(part).all() and (part[..., :3] >= 0).all() and (np.abs(part[..., 3]) <= 1.0).all()
    # the interval knows the places within the part, and at uv near 1 of a wide texture float32 has fewer of them
    if max(size) < 1000:
        assert metrics.compare(part, wanted, driver.software).outside == 0


def in_part(driver, plan: methods.Plan, textures: dict[str, np.ndarray]) -> np.ndarray:
    """A plan's result where the image is the VIEWPORT of textures of NaN, float64."""
    plan = methods.in_viewport(plan, VIEWPORT, SIZE)
    whole = {name: framed(pixels, SIZE, VIEWPORT) for name, pixels in textures.items()}
    return inside(driver.run(plan.passes, whole, SIZE)["result"], VIEWPORT).astype(np.float64)


def test_a_column(driver):
    """An image one pixel wide has no room for the inset: it is the image alone, where what is around is finite.

    Black surroundings would darken it by 1/128 if the fetch were moved by the inset. The rounding of uv moves it by 8
    steps of 2^-24 of the width, a GPU by its sub-texel step; then a step of half floats.
    """
    size, viewport = (8, 8), (3, 1, 1, 5)
    color = np.zeros((8, 8, 4), np.float16)
    inside(color, viewport)[:] = 1.0
    plan = methods.in_viewport(methods.plan(methods.Settings("exact", "square", coc=0.5), (1, 5)), viewport, size)
    output = driver.run(plan.passes, {"color": color, "depth": np.ones((8, 8), np.float32)}, size)["result"]
    off = np.abs(inside(output, viewport)[..., :3].astype(float) - 1.0)
    assert off.max() <= 2 * (8 * 8 * 2.0**-24 + (0.0 if driver.software else 2.0**-8) + 2.0**-11)


def test_linear_depth(driver):
    """`BokehLinearDepth` reads the rectangle of the engine's depth buffer, texel by texel."""
    metres = np.geomspace(0.5, 90.0, VIEWPORT[2] * VIEWPORT[3]).reshape(VIEWPORT[3], VIEWPORT[2])
    stored = listings.stored_depth(metres, 5, 0.1, 100.0).astype(np.float32)
    parameters = {"BokehDepthKind": 5.0, "BokehNear": 0.1, "BokehFar": 100.0}
    plan = methods.Plan((Pass("BokehLinearDepth", {"DepthSamp": "depth"}, "result", parameters),), {})
    plan = methods.in_viewport(plan, VIEWPORT, SIZE)
    output = driver.run(plan.passes, {"depth": framed(stored, SIZE, VIEWPORT)}, SIZE, "float")["result"]
    # the nearest number of 24 bits, times far, and two operations
    np.testing.assert_allclose(inside(output, VIEWPORT)[..., 0], metres, rtol=4 * 2.0**-24, atol=2.0**-23 * 100.0)
    assert not output[: VIEWPORT[1]].any(), "a new target holds 0 around the viewport"


def test_debug_views(driver):
    """Of the part alone, as those of an image that is the whole texture."""
    color, depth = picture(VIEWPORT[2:])
    textures = {"color": color, "depth": depth}
    for mode in range(4):
        parameters = {**CAMERA.parameters(), "BokehDebugMode": float(mode)}
        passes = (
            Pass("BokehCoCMap", {"ColorSamp": "color", "DepthSamp": "depth"}, "coc", parameters),
            Pass("BokehDebug", {"ColorSamp": "coc", "DepthSamp": "depth"}, "result", parameters),
        )
        alone = driver.run(passes, textures, VIEWPORT[2:])["result"][..., :3].astype(float)
        output = in_part(driver, methods.Plan(passes, {}), textures)[..., :3]
        # all but depth is read by a linear filter, off by the inset at most: 1/128 of the step to the next texel in x
        # and y; and both are stored
        step = 0.0 if mode == 1 else 2 * alone.max() / 128
        assert (np.abs(output - alone) <= step + 2 * images.step(np.abs(alone), np.float16)).all()


# Parameter -> what it may be by mistake or before a frame has set it
MISTAKES = {
    "BokehViewportX": (-500.0, 1e30),
    "BokehViewportY": (-500.0, 1e30),
    "BokehTextureWidth": (0.0, -70.0, 1e30),
    "BokehTextureHeight": (0.0, -70.0, 1e30),
}


@pytest.mark.parametrize("name", MISTAKES)
@in_each_language
def test_parameters_out_of_range(name, driver):
    """Finite and not negative where all that there is to read is, from colour that is not."""
    color, depth = picture(SIZE)
    color[::3, ::5] = np.nan
    plan = methods.in_viewport(methods.plan(SETTINGS["exact"], VIEWPORT[2:]), VIEWPORT, SIZE)
    for value in MISTAKES[name]:
        passes = [replace(item, parameters={**item.parameters, name: value}) for item in plan.passes]
        output = driver.run(passes, {"color": color, "depth": depth}, SIZE)["result"]
        assert np.isfinite(output).all() and (output[..., :3] >= 0).all(), value
