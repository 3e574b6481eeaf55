"""Test layered: presets, what its probes notice, what must not change its image.

test_within.py tests it on noise, pass by pass; test_probes.py runs the probes of what its images must show.
"""

from dataclasses import replace

import moments
import numpy as np
import pytest
import sweep
from support import LANGUAGES, in_each_language, load
from support_cases import CAMERA, noise_case, result

from bokeh_validation import metrics, shaders
from bokeh_validation.drivers.base import Driver
from bokeh_validation.frame import methods
from bokeh_validation.plan import fetches
from bokeh_validation.probes import highlight, lights, near_edges
from bokeh_validation.probes.model import Case, depth_of, flat
from bokeh_validation.shaders.entries import COPYING_ENTRIES
from bokeh_validation.shaders.passes import Pass

BLUR = 24  # pixels
LAYERED = near_edges.settings()
MOVES = np.arange(17) / 8


def plane(case: Case, coc: float) -> Case:
    """Return the case with one CoC everywhere, in pixels."""
    return replace(case, depth=depth_of(case.size, near_edges.metres(coc, case.size[1])))


def layered(driver: Driver, case: Case) -> np.ndarray:
    """Draw a case; returns (H, W, 3) float64."""
    return result(driver, case)[..., :3].astype(np.float64)


@pytest.mark.parametrize(
    ("preset", "driver"),
    [
        *(("medium", name) for name in LANGUAGES),
        *zip(("low", "high", "ultra"), LANGUAGES, strict=True),
        ("mobile", "egl"),
    ],
    indirect=["driver"],
)
def test_every_preset(preset, driver):
    """Check every preset: an image in focus or with a CoC of up to a pixel is copied bit for bit, and one colour stays
    unchanged.

    An isolated light of one pixel, the hardest case, keeps 0.99 to 1.01 of its light. See the probes.
    """
    settings = near_edges.settings(preset=preset)
    # powers of two, so that a fetch at a texel's centre is a copy
    case = noise_case((64, 32), settings)
    case.color[4::9, 5::11, :3] = lights.LIGHT
    for coc in (0.0, 0.9, -0.9):
        copied = result(driver, plane(case, coc))
        np.testing.assert_array_equal(copied[..., :3], case.color[..., :3])
    case = noise_case((61, 43), settings)
    case.color[..., :3] = 0.7, 0.3, 40.0
    noise = np.random.default_rng(5).uniform(0.8, 30.0, case.depth.shape).astype(np.float32)
    # gathered, entering the near and the far layer, in a layer
    planes = [plane(case, coc) for coc in (-24.0, -9.0, -4.0, 4.0, 13.0, 24.0)]
    for one_color_case in (case, replace(case, depth=noise), *planes):
        error = layered(driver, one_color_case) / case.color[..., :3].astype(np.float64) - 1.0
        # a mean of one colour: a layer and its weight are truncated three times each, the image once
        assert np.abs(error).max() <= 4 * near_edges.STEP, one_color_case.depth[0]
    for coc in lights.LIGHT_COCS:
        case = lights.light_case(coc, 1, preset)
        surroundings = lights.AMBIENT * (1.0 - (lights.light_spread(coc, 1, case.size) if coc < 0 else 0.0))
        light_kept = (result(driver, case)[..., 2].astype(np.float64) - surroundings).sum() / lights.LIGHT
        assert light_kept == pytest.approx(1.0, abs=0.01), coc


@pytest.mark.parametrize("preset", methods.PRESETS)
@pytest.mark.parametrize("size", ((80, 160), (96, 96), (160, 90), (154, 66)), ids=str)
@in_each_language
def test_layered_aspect_and_presets(size, preset, driver):
    """Check a far light at each aspect ratio and preset: the polygon's second moments, apart from what the size of the
    layers adds.

    A texel of a layer has t x t pixels, t = 2 or 4. In square pixels on each axis, the moments may be larger because of
    a texel's size, (t^2 - 1) / 12, and because each of two passes adds up to 1/4 square texel, as does a linear
    enlargement: 3 t^2 / 4 in all. To compensate, CoC^2 is reduced by 8 square texels, so R^2 = CoC^2 / 4 by 2 t^2, of
    which the polygon has (2 + cos(2 pi / n)) / 12. Samples in the middle of cells of l pixels leave out l^2 / 12 per
    pass; an edge of 12 pixels, 12 / t texels, has as many cells: l is t.
    """
    texel = methods.PRESETS[preset][3]
    color = flat(size)
    middle = [length // 2 for length in size]
    color[middle[1] - 1 : middle[1] + 2, middle[0] - 1 : middle[0] + 2, :3] = 4096.0 / 9
    case = Case("", replace(LAYERED, preset=preset), color, depth_of(size, near_edges.metres(BLUR, size[1])))
    spread = moments.measured(layered(driver, case)[..., 1], (middle[0] + 0.5, middle[1] + 0.5))
    share = (2.0 + np.cos(2.0 * np.pi / 6)) / 12.0
    excess = np.diag(spread.second) - (9 - 1) / 12 - share * BLUR**2 / 4
    added = (texel**2 - 1) / 12 + 3 * texel**2 / 4
    sharpened = 2 * texel**2 * share
    assert (excess >= -sharpened - 2 * texel**2 / 12).all() and (excess <= added - sharpened).all(), excess
    # the shape is known to half a texel less half a pixel on each axis, the mean more exactly
    assert np.abs(spread.mean).max() <= 0.5 * (texel - 1)


@pytest.mark.parametrize("factor", [0.1, 10.0])
@pytest.mark.parametrize("case", [lights.light_case(-BLUR, 3), lights.silhouette_case()], ids=lambda c: c.label)
@in_each_language
def test_layered_exposure(case, factor, driver):
    """Check that colour times any factor gives the image times that factor, if no half float is denormal or too large.

    Brightness is compared with a level that scales with it. A layer's CoC is a quotient of sums that are stored three
    times: truncating half floats lose up to 6 steps of it, half of which moves an edge. Apart from the weights, a
    channel is stored four times.
    """
    plain = layered(driver, case)
    color = (case.color.astype(np.float64) * [factor, factor, factor, 1.0]).astype(np.float16)
    error = np.abs(layered(driver, replace(case, color=color)) / factor - plain).max(axis=(0, 1))
    slope = np.max([np.abs(np.diff(plain, axis=axis)).max(axis=(0, 1)) for axis in (0, 1)], axis=0)
    bound = 3 * near_edges.STEP * BLUR * slope + 4 * near_edges.STEP * plain.max(axis=(0, 1))
    assert (error <= bound).all(), (error, bound)


@in_each_language
def test_layered_quarter_turn(driver):
    """Check that image and aperture rotated by 90 degrees give the rotated image, if sizes are multiples of 8.

    Tiles are processed along rows first, so sums are rounded in another order: the images are as close as two
    drivers'.
    """
    case = noise_case((64, 64), methods.Settings("layered", "hexagon", 7, camera=CAMERA))
    rotated = replace(case.settings, rotation=-90.0)
    rotated = Case("", rotated, np.rot90(case.color).copy(), np.rot90(case.depth).copy())
    actual, expected = (result(driver, one_case) for one_case in (rotated, case))
    distance = metrics.steps(actual, np.rot90(expected))
    assert (distance <= metrics.CLOSE_STEPS).mean() >= metrics.CLOSE_SHARE


def drawn_by_area(cover: np.ndarray) -> Case:
    """Return a near object over the checker, its pixels drawn by area and its depth at pixel centres, as
    renderers do.
    """
    case = near_edges.near_case("", BLUR, cover >= 0.5, LAYERED)
    case.color[..., 0] = cover
    case.color[..., 1] = (1.0 - cover) * near_edges.checker(case.size)
    return case


@in_each_language
def test_layered_moving_edge(driver):
    """Check a near edge that moves by 1/8 pixel per frame: its alpha follows the lens's, with bounded error in every
    frame.

    The layer's edge is where depth has it, at most half a pixel from the true one, and known to half a pixel: together
    a pixel of the spread. In addition, a pixel covered by less than half keeps the colour of the edge in focus: where
    alpha is a half, that is half of a half. It may appear and disappear from frame to frame.
    """
    polygon, (width, height) = highlight.polygon_of("hexagon", 0.0, BLUR), near_edges.SIZE
    x, errors = np.arange(width), []
    for edge in width // 2 + MOVES:
        case = drawn_by_area(np.tile(np.clip(edge - x, 0.0, 1.0), (height, 1)))
        errors.append(layered(driver, case)[..., 0] - near_edges.edge_spread(polygon, edge - x - 0.5))
    bound = near_edges.steepest(polygon) + 0.25 + near_edges.UNCOVERED + near_edges.STEP
    assert np.abs(errors).max() <= bound
    assert np.abs(np.diff(errors, axis=0)).max() <= bound


@pytest.mark.parametrize("near", [True, False], ids=["near light", "far light beside an edge"])
@in_each_language
def test_layered_moving_light(near, driver):
    """Check how much the light of a disc of 3 pixels flickers, drawn by area and moved by 1/8 pixel per frame.

    A near light keeps 0.99 to 1.01 of its light like an isolated light, so frames differ by at most 0.02. The
    silhouette hides a part of a far light: it shows at most twice the light of the polygon's visible part (see the
    probe). In 1/8 pixel that part changes by an eighth of the polygon's width over its area; the bound is twice that,
    in addition to the 0.02.
    """
    light_kept, (width, height) = [], near_edges.SIZE
    for offset in MOVES:
        cover = sweep.disc(near_edges.SIZE, (width / 2 + 4 + offset, height / 2 + 0.3), 3.0)
        case, behind = (drawn_by_area(cover), 0) if near else (lights.silhouette_case(), lights.EDGE)
        if near:
            case.color[..., 0] = 0.0
        case.color[:, behind:, 2] = lights.LIGHT * cover[:, behind:]
        light_kept.append(layered(driver, case)[..., 2].sum() / (lights.LIGHT * cover.sum()))
    bound = 0.02 + (0.0 if near else 2 * near_edges.steepest(highlight.polygon_of("hexagon", 0.0, BLUR)) / 8)
    assert np.abs(np.diff(light_kept)).max() <= bound
    assert not near or (0.99 <= min(light_kept) and max(light_kept) <= 1.01), light_kept


def ending(render_pass: Pass, last: str, first: str = "", **changes) -> Pass:
    """Return a pass with the statement `last` after its own code, and the lines `first` before it."""
    version, text = shaders.glsl(render_pass.entry, "330", render_pass.constants).split("\n", 1)
    main = f"#undef main\nvoid main()\n{{\n    entry();\n    {last}\n}}\n"
    return replace(render_pass, sources={"glsl": f"{version}\n{first}\n#define main entry\n{text}\n{main}"}, **changes)


# The target that needs only two channels, by docs/methods/layered.md
TWO_CHANNELS = {"layer coc"}


def test_two_channels_are_enough():
    """Check that the target that docs/methods/layered.md names may be RG16F without changing the image."""
    settings = methods.Settings("layered", "hexagon", 7, camera=CAMERA, use_mrt=False)
    driver, case = load("egl"), noise_case((101, 77), settings)
    passes, drop_channels = case.plan.passes, "BokehResult = vec4(BokehResult.rg, 0.0, 1.0);"
    assert TWO_CHANNELS < {name for render_pass in passes for name in render_pass.outputs}
    fewer = [
        ending(render_pass, drop_channels) if TWO_CHANNELS.issuperset(render_pass.outputs) else render_pass
        for render_pass in passes
    ]
    from_two_channels, from_four_channels = (
        driver.run(variant, case.textures(), case.size)["result"] for variant in (fewer, passes)
    )
    np.testing.assert_array_equal(from_two_channels, from_four_channels)


# Maximum fetches of colour per pixel where passes do most, including the four neighbours in the CoC map
MOST_FETCHES = {"low": 55, "medium": 74}
# and where everything is in focus: a fraction of the paper's 3 x 13 fetches of colour and as many of depth
IN_FOCUS = 1 + 0.35 * 2 * 39
COUNTER = """float fetched = 0.0;
#define textureLod(tex, uv, level) (fetched += 1.0, textureLod(tex, uv, level))
#define texelFetch(tex, texel, level) (fetched += 1.0, texelFetch(tex, texel, level))"""


def counted(settings: methods.Settings, depth: np.ndarray) -> tuple[float, float, float]:
    """Count the fetches per full-size pixel of all passes on the device; returns the mean, the sum of each pass's
    maximum, and the maximum of the last pass, Composite.
    """
    size = depth.shape[::-1]
    passes, scales = [], {}
    for number, render_pass in enumerate(methods.plan(settings, size).passes):
        passes.append(render_pass)
        if render_pass.entry not in COPYING_ENTRIES:
            name = f"{number} {render_pass.entry}"
            scales[name] = render_pass.scale
            outputs = name, *(f"{name}, {k}" for k in range(1, len(render_pass.outputs)))
            passes.append(ending(render_pass, "BokehResult = vec4(fetched);", COUNTER, output=outputs))
    output = load("egl").run(passes, {"color": flat(size, 1.0), "depth": depth}, size, keep=list(scales))
    counts = [output[name][..., 0].astype(float) / scale**2 for name, scale in scales.items()]
    # plus the CoC map: the pixel and its four neighbours
    return 5 + sum(map(np.mean, counts)), 5 + sum(map(np.max, counts)), counts[-1].max()


# wide enough for the quarter layer with 16 samples on an edge, in layers of half size
COC = 128
# just over 24 pixels of CoC, from which a layer beside COC begins to take some (BokehLayerSlope)
LEFT = 24.1


@pytest.mark.parametrize("preset", methods.PRESETS)
def test_fetches(preset):
    """Check that a pixel for which every pass does all it can has exactly the planned fetches, and that few are made
    in focus.

    Patches of 2 pixels have the largest near and far CoC, CoC that are almost completely left to the gather, and none.
    So layers and gather have most to do everywhere.
    """
    # as many texels in layers of any size
    largest = COC * methods.PRESETS[preset][3] // 2
    size = (256, 2 * largest)
    depths = [near_edges.metres(coc, size[1]) for coc in (-largest, -LEFT, 0.0, LEFT, largest)]
    coarse = np.random.default_rng(4).choice(np.float32(depths), (size[1] // 2, size[0] // 2))
    settings = near_edges.settings(preset=preset)
    settings = replace(settings, camera=replace(near_edges.CAMERA, max_coc=largest / size[1]))
    passes = methods.plan(settings, size).passes
    mean, maximum, _ = counted(settings, coarse.repeat(2, 0).repeat(2, 1))
    assert mean <= maximum <= MOST_FETCHES.get(preset, maximum)
    assert maximum == pytest.approx(fetches.of_frame(passes)["color"])
    mean, *_ = counted(settings, depth_of(size, near_edges.CAMERA.focus_distance))
    assert mean <= IN_FOCUS


# CoC in pixels from which the gather reaches a little less far than where it has an additional ring, and from which it
# reaches just as far; and what begins to be a far layer, for a preset with bicubic layers and for one without
REACHES, STARTS = (0.5, 3.0, 5.7, 6.1, 11.6, 12.1), (10.6, 14.6, 24.0)


@pytest.mark.parametrize("preset", methods.PRESETS)
def test_fetches_at_outlines(preset):
    """Check that Composite takes no more fetches than planned where it blends outlines in focus too."""
    settings, (height, width) = near_edges.settings(preset=preset), (96, 128)
    passes = methods.plan(settings, (width, height)).passes
    planned = fetches.of_frame(passes[-1:])["color"]
    most = 0.0
    for reach in REACHES:
        for start in STARTS:
            depths = [near_edges.metres(coc, height) for coc in (0.0, -reach, start)]
            coarse = np.random.default_rng(4).choice(np.float32(depths), (height // 4, width // 4), p=(0.6, 0.1, 0.3))
            *_, composite = counted(settings, coarse.repeat(4, 0).repeat(4, 1))
            assert composite <= planned, (reach, start)
            most = max(most, composite)
    # they were blended: more than a fetch of the map, one of a tile, and the layers
    assert most > 2 + 2 * (5 if methods.PRESETS[preset][2] else 1)


# Fraction of the outline's pixels that the object covers
COVERED = 0.5


def outlined(driver: Driver, blend: bool) -> tuple[np.ndarray, Case]:
    """Draw a red wall in focus to the right of a dark background with lights, with one antialiased column between
    them; returns the image and the case.

    The background is dark beside the wall, so that the input's outline is dark too. Its lights begin 4 pixels farther.
    """
    case = noise_case((128, 64), LAYERED)
    case.color[..., :3] = 0.0
    case.color[:, :60, :3] = 8.0
    case.color[:, 64:, :3] = 2.0, 0.25, 0.5
    case.color[:, 64, :3] *= COVERED
    case.depth[:, :64], case.depth[:, 64:] = near_edges.metres(BLUR, 64), near_edges.metres(0.0, 64)
    *others, last = case.plan.passes
    last = replace(last, defines=last.defines | {"BOKEH_LAYER_OUTLINES": int(blend)})
    return driver.run((*others, last), case.textures(), case.size)["result"][..., :3].astype(np.float64), case


@pytest.mark.parametrize("driver", LANGUAGES, indirect=True)
def test_outlines(driver):
    """Check that an antialiased outline in focus is blended with the blurred background, and that nothing else changes.

    What is behind the outline lies between the background one pixel before and what the wall hides: there the blur of
    the lights has fallen by at most as much as from one pixel to the next.
    """
    (image, case), (unblended, _) = outlined(driver, True), outlined(driver, False)
    rows = slice(24, 40)
    # the unblended outline is the input
    np.testing.assert_array_equal(unblended[rows, 64], case.color[rows, 64, :3])
    changed = np.abs(image - unblended).max(axis=(0, 2)) > 0.0
    assert changed.nonzero()[0].tolist() == [64]
    wall = case.color[rows, 65, :3].astype(np.float64)
    behind = (image[rows, 64] - COVERED * wall) / (1.0 - COVERED)
    beside, slope = image[rows, 63], np.abs(image[rows, 62] - image[rows, 63])
    assert beside.min() > 1.0
    assert (np.abs(behind - beside) <= 2.0 * slope + 0.02 * beside).all()


@in_each_language
def test_in_focus_behind(driver):
    """Check that a bright surface exactly in focus does not glow onto a dark strip in front of it, also in focus.

    A near object in reach makes the gather wide. The strip's disc has a radius of 0.45 pixels, so it reaches no other
    pixel, and colours are powers of two, so the copy is exact.
    """
    size, strip = (64, 48), slice(16, 32)
    color, depth = flat(size, 1.0), depth_of(size, near_edges.metres(0.0, size[1]))
    color[strip, :, :3], depth[strip] = 2.0**-6, near_edges.metres(-0.9, size[1])
    depth[38:42], depth[42:] = near_edges.metres(-8.0, size[1]), near_edges.metres(-16.0, size[1])
    image = layered(driver, Case("in focus behind", LAYERED, color, depth))
    np.testing.assert_array_equal(image[strip], 2.0**-6)


@in_each_language
def test_a_light_while_the_near_layer_appears(driver):
    """Check that a near light over a sharp background keeps its energy while it passes from the gather to the layer.

    The light's weight in the near layer grows from 0 to 1 while its CoC grows from 8.4 to 9.6 pixels
    (BokehLayerWeight). The energy must stay between what the gather alone keeps at 8.25 pixels and the layer alone at
    10, within 0.03: the gather's samples lie elsewhere at each CoC, and from 7 to 8 pixels that changes its energy by
    0.04. Where the weights of the two do not add up to 1, the light has up to 1.6 times its energy. Before and after,
    the energy must be right within 0.05, which is the gather's own error.
    """
    size, light, energy = (96, 64), (slice(28, 32), slice(40, 44)), {}
    for coc in (8.25, 8.5, 8.75, 9.0, 9.25, 9.5, 10.0):
        color, depth = flat(size, 0.0), depth_of(size, near_edges.metres(0.0, size[1]))
        color[light][..., :3], depth[light] = 64.0, near_edges.metres(-coc, size[1])
        energy[coc] = layered(driver, Case("light", LAYERED, color, depth)).sum() / color[..., :3].sum(dtype=np.float64)
    before, *between, after = energy.values()
    assert 0.95 <= min(before, after) <= max(before, after) <= 1.05, energy
    assert min(before, after) - 0.03 <= min(between) <= max(between) <= max(before, after) + 0.03, energy
