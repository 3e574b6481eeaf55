"""BOKEH_VIEWPORT: an image that is a part of its textures, with NaN around it in every one of them."""

import re
from dataclasses import replace

import numpy as np
import pytest

from bokeh_validation import methods, metrics, paths, variants
from bokeh_validation.passes import Pass
from bokeh_validation.reference import images, listings, precision
from bokeh_validation.reference.device import Reference

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


def inside(pixels: np.ndarray, viewport: tuple[int, int, int, int]) -> np.ndarray:
    """The part of (H, W, ...) pixels that a viewport is."""
    x, y, width, height = viewport
    return pixels[y : y + height, x : x + width]


def framed(part: np.ndarray, size: tuple[int, int], viewport: tuple[int, int, int, int]) -> np.ndarray:
    """An image in a texture of NaN."""
    whole = np.full((size[1], size[0], *part.shape[2:]), np.nan, part.dtype)
    inside(whole, viewport)[:] = part
    return whole


def picture(size: tuple[int, int], seed: int = 2) -> tuple[np.ndarray, np.ndarray]:
    """Random colour (H, W, 4) float16 and depth (H, W) float32: everything differs from its neighbour."""
    random = np.random.default_rng(seed)
    color = random.lognormal(0.0, 1.0, (size[1], size[0], 4)).astype(np.float16)
    return color, random.uniform(1.0, 30.0, (size[1], size[0])).astype(np.float32)


def poisoned(plan: methods.Plan) -> list[Pass]:
    """Its passes, after others that fill every target with NaN: `BokehDebug` copies what it reads."""
    names = dict.fromkeys(name for item in plan.passes for name in item.outputs)
    fill = [Pass("BokehDebug", {"ColorSamp": "nan", "DepthSamp": "depth"}, name) for name in names]
    return [*fill, *plan.passes]


def rendered(driver, settings, size, viewport, storage="half"):
    """A driver's result (H, W, 4), and the reference's with its interval in the viewport."""
    color, depth = picture(viewport[2:])
    plan = methods.in_viewport(methods.plan(settings, viewport[2:]), viewport, size)
    passes = poisoned(plan)
    nothing = np.full((size[1], size[0], 4), np.nan, np.float16)
    textures = {"color": framed(color, size, viewport), "depth": framed(depth, size, viewport), "nan": nothing}
    output = driver.run(passes, textures | plan.tables, size, storage)["result"]
    kind = precision.SOFTWARE if driver.software else precision.GPU
    everywhere = Reference().images(plan.passes, textures | plan.tables, size, storage, kind, driver.rounding)
    return output, everywhere["result"].part(
        slice(viewport[1], viewport[1] + viewport[3]), slice(viewport[0], viewport[0] + viewport[2])
    )


@pytest.mark.parametrize("settings", SETTINGS.values(), ids=SETTINGS)
def test_nothing_leaks_in(settings, driver):
    """Within the interval, so finite, inside; what was around it is as it was.

    The interval is that of the formulas on the image alone, wider by the slope times 1/128 texel, by which fetches keep
    away from the surroundings.
    """
    output, wanted = rendered(driver, settings, SIZE, VIEWPORT)
    part = inside(output, VIEWPORT)
    comparison = metrics.compare(part, wanted, driver.software)
    assert np.isfinite(part).all() and comparison.outside == 0, comparison
    around = output.copy()
    inside(around, VIEWPORT)[:] = np.nan
    np.testing.assert_array_equal(around, np.full_like(output, np.nan))
    assert np.isnan(output).any(axis=-1).sum() == SIZE[0] * SIZE[1] - VIEWPORT[2] * VIEWPORT[3]


@pytest.mark.parametrize(
    ("size", "viewport"),
    [
        ((9, 7), (3, 2, 2, 2)),
        ((9, 7), (0, 0, 9, 7)),
        ((9, 7), (8 - 3, 7 - 5, 3, 5)),
        ((4096, 5), (4096 - 40, 1, 33, 3)),
        ((5, 4096), (1, 4096 - 40, 3, 33)),
        ((8192, 4), (8192 - 33, 0, 33, 3)),
    ],
    ids=str,
)
def test_places_and_sizes(size, viewport, driver):
    """The smallest image, the whole texture, its last corner, and far from uv 0, where float32 is coarsest."""
    settings = methods.Settings("exact", "hexagon", camera=replace(CAMERA, max_coc=1.0))
    output, wanted = rendered(driver, settings, size, viewport)
    part = inside(output, viewport)
    assert np.isfinite(part).all() and (part[..., :3] >= 0).all() and (np.abs(part[..., 3]) <= 1.0).all()
    # the interval knows the places within the part, and at uv near 1 of a wide texture float32 has fewer of them
    if max(size) < 1000:
        assert metrics.compare(part, wanted, driver.software).outside == 0


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


def test_same_picture_as_alone(driver):
    """Away from its edges, the part is the picture that it would be alone: fetches move by float32 roundings only.

    The image is black but for one highlight in the middle whose blur ends before the edges: the insets are between
    black texels.
    """
    settings = methods.Settings("exact", "hexagon", coc=0.3, camera=replace(CAMERA, max_coc=0.3))
    color = np.zeros((VIEWPORT[3], VIEWPORT[2], 4), np.float16)
    color[15:18, 22:26] = 40.0
    depth = np.ones(color.shape[:2], np.float32)
    plan = methods.plan(settings, VIEWPORT[2:])
    alone = driver.run(plan.passes, {"color": color, "depth": depth}, VIEWPORT[2:])["result"]
    part_of = methods.in_viewport(plan, VIEWPORT, SIZE)
    textures = {"color": framed(color, SIZE, VIEWPORT), "depth": framed(depth, SIZE, VIEWPORT)}
    output = inside(driver.run(part_of.passes, textures, SIZE)["result"], VIEWPORT)
    assert alone[..., 0].max() > 0.5
    # a place is off by at most 8 roundings of 2^-24 of the texture's width or, on a GPU, by its sub-texel step, in each
    # of two passes; the steepest slope between texels is the first pass's, 40 over an edge of 5 samples
    off = 2 * (SIZE[0] * 8 * 2.0**-24 + (0.0 if driver.software else 2.0**-8)) * 40.0
    # half floats: two stores, each one step of the largest value of its pass
    off += 2 * 2.0**-10 * 40.0 / 5
    assert np.abs(output[..., :3].astype(float) - alone[..., :3].astype(float)).max() <= off


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


@pytest.mark.parametrize("mode", range(4))
def test_debug_views(mode, driver):
    """Of the part alone, as those of an image that is the whole texture."""
    color, depth = picture(VIEWPORT[2:])
    textures = {"color": color, "depth": depth}
    parameters = {**CAMERA.parameters(), "BokehDebugMode": float(mode)}
    passes = (
        Pass("BokehCoCMap", {"ColorSamp": "color", "DepthSamp": "depth"}, "coc", parameters),
        Pass("BokehDebug", {"ColorSamp": "coc", "DepthSamp": "depth"}, "result", parameters),
    )
    alone = driver.run(passes, textures, VIEWPORT[2:])["result"]
    part_of = methods.in_viewport(methods.Plan(passes, {}), VIEWPORT, SIZE)
    output = driver.run(part_of.passes, {name: framed(part, SIZE, VIEWPORT) for name, part in textures.items()}, SIZE)
    # all but depth is read by a linear filter, off by the inset at most: 1/128 of the step to the next texel in x and
    # y; and both are stored
    step = 0.0 if mode == 1 else 2 * alone[..., :3].max() / 128
    off = np.abs(inside(output["result"], VIEWPORT)[..., :3].astype(float) - alone[..., :3])
    assert (off <= step + 2 * images.step(np.abs(alone[..., :3].astype(float)), np.float16)).all()


# What an entry may begin with, before it reads anything: BokehUseViewport, or a helper that calls it first
BEGINNINGS = "BokehUseViewport|BokehBegin|BokehAdaptiveLine|BokehFirst|BokehSecond"
# Those of the layers may be an argument of what they call: it is there before that begins
LAYERS_BEGIN = "BokehBeginLayers|BokehBeginTiles|BokehLayerPolygon"


def test_every_pass_uses_the_viewport():
    """Each entry but the vertex shader, and each helper of theirs, says first where its image is, in every language."""
    for language in paths.LANGUAGES:
        text = paths.passes(language).read_text(encoding="ascii")
        text = text[text.index("void BokehUseViewport()" if language != "wgsl" else "fn BokehUseViewport()") :]
        function = r"^[^\n/]*\b(main|\w+_PS|Bokeh[A-Z][a-z]\w+)\([^{;]*\)[^{;]*\n\{\n(.*?)^\}"
        bodies = re.findall(function, text, re.MULTILINE | re.DOTALL)
        names = [name for name, _ in bodies if name != "BokehUseViewport"]
        assert len(names) == len(variants.ENTRIES) - 1 + 7, (language, names)
        for name, body in bodies:
            if "Layer" in name or "Layer" in body or name == "BokehBeginTiles":
                assert re.search(rf"\b(?:{LAYERS_BEGIN}|BokehUseViewport)\(", body), (language, name)
                continue
            first = re.search(r"\bBokeh(?!Targets|Filter|Polygon|Result)[A-Z]\w*(?=\()", body)
            assert name == "BokehUseViewport" or re.fullmatch(BEGINNINGS, first[0]), (language, name, first[0])


# Parameter -> what it may be by mistake or before a frame has set it
MISTAKES = {
    "BokehViewportX": (-500.0, 1e30),
    "BokehViewportY": (-500.0, 1e30),
    "BokehTextureWidth": (0.0, -70.0, 1e30),
    "BokehTextureHeight": (0.0, -70.0, 1e30),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_parameters_out_of_range(name, driver):
    """Finite and not negative where all that there is to read is, from colour that is not."""
    color, depth = picture(SIZE)
    color[::3, ::5] = np.nan
    plan = methods.in_viewport(methods.plan(SETTINGS["exact"], VIEWPORT[2:]), VIEWPORT, SIZE)
    for value in MISTAKES[name]:
        passes = [replace(item, parameters={**item.parameters, name: value}) for item in plan.passes]
        output = driver.run(passes, {"color": color, "depth": depth}, SIZE)["result"]
        assert np.isfinite(output).all() and (output[..., :3] >= 0).all(), value
