"""Test BOKEH_VIEWPORT: an image inside larger textures, each with NaN around it."""

from dataclasses import replace

import numpy as np
from support import NIGHTLY, spread
from support_cases import noise_case

from bokeh_validation.frame import methods
from bokeh_validation.frame.methods import Settings
from bokeh_validation.numerics import images
from bokeh_validation.probes import judges
from bokeh_validation.probes.cases import IN_RECTANGLE, IN_VIEWPORT, RECTANGLE, SIZE, VIEWPORTS
from bokeh_validation.shaders.passes import Pass, target_area

EVERYWHERE = ("paper hexagon", "exact, preset", "naive", "constant CoC", "layered hexagon", "smallest")


def inside(pixels: np.ndarray, area: tuple[int, int, int, int]) -> np.ndarray:
    """Return the part of pixels (H, W, ...) in a rectangle (x, y, width, height), as a view."""
    x, y, width, height = area
    return pixels[y : y + height, x : x + width]


def framed(part: np.ndarray, size: tuple[int, int], area: tuple[int, int, int, int]) -> np.ndarray:
    """Return a texture of NaN with an image in the rectangle `area`."""
    whole = np.full((size[1], size[0], *part.shape[2:]), np.nan, part.dtype)
    inside(whole, area)[:] = part
    return whole


@spread("name", VIEWPORTS, EVERYWHERE)
def test_nothing_leaks_in(name, driver):
    """Check that targets are within the reference's interval inside the viewport and unchanged outside it.

    Around the image every texture is NaN. The interval is computed for the image alone, then widened by the slope times
    1/128 texel, the distance that fetches keep from the surroundings.
    """
    settings, size, viewport = VIEWPORTS[name]
    image = noise_case(viewport[2:], settings)
    plan = methods.in_viewport(image.plan, viewport, size)
    textures = {"color": framed(image.color, size, viewport), "depth": framed(image.depth, size, viewport)}
    textures |= plan.tables
    # in shader model 3 the last pass of layered does not fit with a viewport: variants.NO_ROOM
    passes = [
        render_pass for render_pass in plan.passes if (driver.name, render_pass.entry) != ("d3d9", "BokehComposite")
    ]
    # the interval covers positions within the part; at uv near 1 of a wide texture float32 resolves fewer of them
    if max(size) < 1000:
        frame = judges.Frame(tuple(passes), textures, size, area=viewport)
        for judge in judges.judges(name, frame, driver.precision, driver.rounding):
            assert not judge.objection(driver)
    scales = {name: render_pass.scale for render_pass in passes for name in render_pass.outputs}
    # fill every target with NaN first, by debug views at the target's scale
    textures["nan"] = np.full((size[1], size[0], 4), np.nan, np.float16)
    inputs = {"ColorSamp": "nan", "DepthSamp": "depth"}
    poison = [Pass("BokehDebug", inputs, name, scale=scale) for name, scale in scales.items()]
    outputs = driver.run([*poison, *passes], textures, size, keep=scales)
    for name, scale in scales.items():
        target = outputs[name].copy()
        image_part = inside(target, target_area(scale, viewport))
        assert np.isfinite(image_part).all(), f"what is around the image leaks into {name}"
        if name == plan.result:
            assert (image_part[..., :3] >= 0).all() and (np.abs(image_part[..., 3]) <= 1.0).all()
        image_part[:] = np.nan
        assert np.isnan(target).all(), f"{name} is drawn outside the viewport"


@spread("", [()], nightly_drivers=NIGHTLY)
def test_debug_views_and_linear_depth(driver):
    """Compare debug views and linear depth of a part with the same image in a texture of its own size."""
    image = noise_case(RECTANGLE[2:], Settings())
    textures = {"color": image.color, "depth": image.depth}
    whole = {name: framed(pixels, SIZE, RECTANGLE) for name, pixels in textures.items()}
    parameters = {**IN_VIEWPORT.parameters(), "BokehDepthKind": 7.0, "BokehFar": 20.0}
    coc = Pass("BokehCoCMap", {"ColorSamp": "color", "DepthSamp": "depth"}, "coc", parameters)
    view = Pass("BokehDebug", {"ColorSamp": "coc", "DepthSamp": "depth"}, "result", parameters)
    views = [(coc, replace(view, parameters={**parameters, "BokehDebugMode": float(mode)})) for mode in range(4)]
    linear = (Pass("BokehLinearDepth", {"DepthSamp": "depth"}, "result", parameters),)
    for passes in (linear, *views):
        alone = driver.run(passes, textures, RECTANGLE[2:])["result"][..., :3].astype(float)
        plan = methods.in_viewport(methods.Plan(passes, {}), RECTANGLE, SIZE)
        output = driver.run(plan.passes, whole, SIZE)["result"]
        assert not output[: RECTANGLE[1]].any(), "a new target holds 0 around the viewport"
        # colour is read with a linear filter, off by at most the inset: 1/128 of the step to the next texel in x and
        # y; and both results are stored
        step = 0.0 if passes in (linear, views[1]) else 2 * alone.max() / 128
        off = np.abs(inside(output, RECTANGLE)[..., :3].astype(float) - alone)
        assert (off <= step + 2 * images.step(np.abs(alone), np.float16)).all()


@spread("", [()], nightly_drivers=NIGHTLY)
def test_a_column(driver):
    """Check an image one pixel wide, which has no room for the inset: it equals the image alone if its surroundings
    are finite.

    Black surroundings would darken it by 1/128 if the fetch were moved by the inset. The rounding of uv moves it by 8
    steps of 2^-24 of the width, a GPU by its sub-texel step; the store adds a step of half floats.
    """
    size, viewport = (8, 8), (3, 1, 1, 5)
    color = np.zeros((8, 8, 4), np.float16)
    inside(color, viewport)[:] = 1.0
    plan = methods.in_viewport(methods.plan(Settings("exact", "square", coc=0.5), (1, 5)), viewport, size)
    output = driver.run(plan.passes, {"color": color, "depth": np.ones((8, 8), np.float32)}, size)["result"]
    off = np.abs(inside(output, viewport)[..., :3].astype(float) - 1.0)
    assert off.max() <= 2 * (8 * 8 * 2.0**-24 + (0.0 if driver.software else 2.0**-8) + 2.0**-11)


@spread("name", ["ViewportX", "ViewportY", "TextureWidth", "TextureHeight"])
def test_parameters_out_of_range(name, driver):
    """Check that results are finite and not negative for invalid viewports, also from bad colour."""
    image = noise_case(SIZE, Settings())
    image.color[::3, ::5] = np.nan
    plan = methods.in_viewport(methods.plan(IN_RECTANGLE["exact, preset"], RECTANGLE[2:]), RECTANGLE, SIZE)
    for value in (-500.0, 0.0, 1e30):
        passes = [
            replace(render_pass, parameters={**render_pass.parameters, f"Bokeh{name}": value})
            for render_pass in plan.passes
        ]
        output = driver.run(passes, image.textures(), SIZE)["result"]
        assert np.isfinite(output).all() and (output[..., :3] >= 0).all(), value
