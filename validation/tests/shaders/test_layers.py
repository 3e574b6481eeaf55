"""The layered method: presets, what its probes notice, what must not change its picture.

On noise, pass by pass: test_within.py. What its pictures must show: the probes, which test_patterns.py runs.
"""

import re
from dataclasses import replace

import moments
import numpy as np
import pytest
import sweep
from support import LANGUAGES, in_each_language, load
from support_cases import CAMERA, noise_case, result

from bokeh_validation import metrics, shaders
from bokeh_validation.drivers.base import Driver
from bokeh_validation.frame import fetches, methods
from bokeh_validation.probes import highlight, lights, model, near_edges, unchanged
from bokeh_validation.probes.model import Case, depth_of, flat
from bokeh_validation.shaders.passes import COPYING_ENTRIES, Pass

# No program of layers takes the number of samples: one number for all apertures, or each would be compiled again
SETTINGS = methods.Settings("layered", "hexagon", 7, camera=CAMERA)


# ----------------------------------------------------------------------------------------------------------------------
# the light, and nothing at all
# ----------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("preset", "driver"),
    [*(("medium", name) for name in LANGUAGES), *zip(("low", "high", "ultra"), LANGUAGES, strict=True)],
    indirect=["driver"],
)
def test_every_preset(preset, driver):
    """A picture in focus, or with a CoC of up to a pixel, which spreads nothing, is copied to the bit; one colour stays
    as it is; and 0.99 to 1.01 of an isolated light of one pixel, the hardest, is kept. See the probes.
    """
    case = unchanged.focus_case()
    for coc in (0.0, 0.9, -0.9):
        depth = model.depth_of(case.size, near_edges.metres(coc, case.size[1]))
        found = result(driver, replace(case, settings=near_edges.settings(preset=preset), depth=depth))
        np.testing.assert_array_equal(found[..., :3], case.color[..., :3])
    for case in unchanged.constant_cases():
        output = result(driver, replace(case, settings=replace(case.settings, preset=preset)))[..., :3]
        off = np.abs(output.astype(np.float64) / case.color[..., :3].astype(np.float64) - 1.0)
        assert off.max() <= 4 * near_edges.STEP, case.label
    for coc in lights.LIGHT_COCS:
        case = lights.light_case(coc, 1, preset)
        around = lights.AMBIENT * (1.0 - (lights.light_spread(coc, 1, case.size) if coc < 0 else 0.0))
        kept = (result(driver, case)[..., 2].astype(np.float64) - around).sum() / lights.LIGHT
        assert kept == pytest.approx(1.0, abs=0.01), coc


# ----------------------------------------------------------------------------------------------------------------------
# what must not change the picture, and what may change it only a little
# ----------------------------------------------------------------------------------------------------------------------

BLUR = 24  # pixels
LAYERED = near_edges.settings()
MOVES = np.arange(17) / 8


def layered(driver: Driver, case: Case) -> np.ndarray:
    """Its picture, (H, W, 3) float64."""
    return result(driver, case)[..., :3].astype(np.float64)


@pytest.mark.parametrize("preset", methods.PRESETS)
@pytest.mark.parametrize("size", ((80, 160), (96, 96), (160, 90), (154, 66)), ids=str)
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
    color[middle[1] - 1 : middle[1] + 2, middle[0] - 1 : middle[0] + 2, :3] = 4096.0 / 9
    case = Case("", replace(LAYERED, preset=preset), color, depth_of(size, near_edges.metres(BLUR, size[1])))
    found = moments.measured(layered(driver, case)[..., 1], (middle[0] + 0.5, middle[1] + 0.5))
    share = (2.0 + np.cos(2.0 * np.pi / 6)) / 12.0
    off = np.diag(found.second) - (9 - 1) / 12 - share * BLUR**2 / 4
    assert (off >= -8 * share - 2 * 2**2 / 12).all() and (off <= 3.25 - 8 * share).all(), off
    # the shape is known to half a pixel on each axis, the mean to less
    assert np.abs(found.mean).max() <= 0.5


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
    case = noise_case((64, 64), SETTINGS)
    turned = Case("", replace(SETTINGS, rotation=-90.0), np.rot90(case.color).copy(), np.rot90(case.depth).copy())
    found, wanted = (result(driver, item) for item in (turned, case))
    distance = metrics.steps(found, np.rot90(wanted))
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
    polygon = highlight.polygon_of("hexagon", 0.0, BLUR)
    from_edge = near_edges.SIZE[0] // 2 - np.arange(near_edges.SIZE[0]) - 0.5
    off = [layered(driver, edge_at(p))[..., 0] - near_edges.edge_spread(polygon, from_edge + p) for p in MOVES]
    allowed = near_edges.steepest(polygon) + 0.25 + near_edges.WHOLE + near_edges.STEP
    assert np.abs(off).max() <= allowed
    assert np.abs(np.diff(off, axis=0)).max() <= allowed


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
    allowed = 0.02 + (0.0 if near else 2 * near_edges.steepest(highlight.polygon_of("hexagon", 0.0, BLUR)) / 8)
    assert changed <= allowed
    if near:
        assert 0.99 <= min(found) and max(found) <= 1.01, found


# What docs/layers.md says of the targets that need two channels
TWO_CHANNELS = {"leftovers", "tile leftovers", "row leftovers", "shares", "sizes"}


def test_two_channels_are_enough():
    """The targets that docs/layers.md names may be RG16F: the same picture."""
    driver, case = load("osmesa"), noise_case((101, 77), replace(SETTINGS, targets=False))
    assert TWO_CHANNELS < {name for item in case.plan.passes for name in item.outputs}
    main = "void main()\n{\n    whole();\n    BokehResult = vec4(BokehResult.rg, 0.0, 1.0);\n}\n"
    fewer = []
    for item in case.plan.passes:
        if TWO_CHANNELS.issuperset(item.outputs):
            text = shaders.glsl(item.entry, "330", item.constants)
            item = replace(item, sources={"glsl": re.sub(r"\bvoid main\(\)", "void whole()", text) + main})
        fewer.append(item)
    whole, output = (driver.run(each, case.textures(), case.size)["result"] for each in (case.plan.passes, fewer))
    np.testing.assert_array_equal(output, whole)


# ----------------------------------------------------------------------------------------------------------------------
# what it costs: texels fetched, counted on the device
# ----------------------------------------------------------------------------------------------------------------------

MOST_FETCHES = {"low": (55, 55), "medium": (90, 90)}
# The same where all is in focus, of the paper's 3 x 13 fetches of colour and as many of depth
IN_FOCUS = 0.35 * 2 * 39


def counting(item: Pass, outputs: tuple[str, ...]) -> Pass:
    """A pass that writes how often it fetched in place of its result."""
    text = shaders.glsl(item.entry, "330", item.constants)
    head = re.compile(r"^(vec4 BokehFetch(?:Grid|Around|Nearest)\([^)]*\)\n\{\n)", re.MULTILINE)
    text, found = head.subn(r"\1    fetched += 1.0;\n", text)
    assert found == 3
    text, found = re.subn(r"\bvoid main\(\)", "void counted()", text)
    assert found >= 1
    version, rest = text.split("\n", 1)
    main = "void main()\n{\n    counted();\n    BokehResult = vec4(fetched);\n}\n"
    text = f"{version}\nfloat fetched = 0.0;\n{rest}\n{main}"
    return replace(item, output=outputs, sources={"glsl": text})


def counted(settings: methods.Settings, color: np.ndarray, depth: np.ndarray) -> dict[str, tuple[float, float]]:
    """Entry and number of each pass after the CoC map -> its fetches for a pixel of the full size: mean, most."""
    size = depth.shape[::-1]
    plan, names = methods.plan(settings, size).passes, []
    passes = []
    for number, item in enumerate(plan):
        passes.append(item)
        if item.entry not in COPYING_ENTRIES:
            names.append(f"{number} {item.entry}")
            others = tuple(f"{number}, {k}" for k in range(1, len(item.outputs)))
            passes.append(counting(item, (names[-1], *others)))
    output = load("osmesa").run(passes, {"color": color, "depth": depth}, size, keep=names)
    scales = [item.scale for item in plan if item.entry not in COPYING_ENTRIES]
    found = zip(names, scales, strict=True)
    return {n: tuple(f(output[n][..., 0].astype(float)) / s**2 for f in (np.mean, np.max)) for n, s in found}


COC = 80
SIZE = (256, 2 * COC)


@pytest.mark.parametrize("preset", MOST_FETCHES)
def test_fetches_at_the_worst(preset):
    """Of the picture, and of a pixel for which every pass takes all that it can.

    Patches of 2 pixels of the largest CoC near and far, a third of them and none: layers and gather have most to do
    everywhere.
    """
    depths = [near_edges.metres(coc, SIZE[1]) for coc in (-COC, -COC / 3, 0.0, COC / 3, COC)]
    coarse = np.random.default_rng(4).choice(np.float32(depths), (SIZE[1] // 2, SIZE[0] // 2))
    camera = replace(near_edges.CAMERA, max_coc=COC / SIZE[1])
    settings = replace(near_edges.settings(preset=preset), camera=camera)
    found = counted(settings, flat(SIZE, 1.0), coarse.repeat(2, 0).repeat(2, 1))
    mean, most = (sum(counts[i] for counts in found.values()) for i in (0, 1))
    allowed = MOST_FETCHES[preset]
    assert mean <= allowed[0] and most <= allowed[1], (mean, most, found)
    # the CoC map besides
    assert most + 1 == pytest.approx(fetches.of_frame(methods.plan(settings, SIZE).passes)["color"])


@pytest.mark.parametrize("preset", methods.PRESETS)
def test_fetches_in_focus(preset):
    """What the plan says of it, to the fetch."""
    depth = depth_of(SIZE, near_edges.CAMERA.focus_distance)
    settings = near_edges.settings(preset=preset)
    found = counted(settings, flat(SIZE, 1.0), depth)
    total = sum(mean for mean, _ in found.values())
    assert total <= IN_FOCUS, found
    counts = [(fetches.of_pass(item, True)["color"], item.scale**2) for item in methods.plan(settings, SIZE).passes]
    # the CoC map besides
    assert sum(count / texel for count, texel in counts) == total + 1
