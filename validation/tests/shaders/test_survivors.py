"""What a mutant of the shaders was needed for to be noticed: no other test looked at it (validation/run mutants)."""

import re
from dataclasses import replace

import numpy as np
import pytest
from hostile import COLOR
from support import in_each_language, load
from support_cases import noise_case, within

from bokeh_validation import metrics, paths, shaders
from bokeh_validation.frame import methods
from bokeh_validation.probes.model import depth_of, flat
from bokeh_validation.reference import listings
from bokeh_validation.shaders import passes
from bokeh_validation.shaders.passes import Pass


def changed(plain: np.ndarray, output: np.ndarray) -> bool:
    """Whether a switch matters, or testing it would mean nothing."""
    return (metrics.steps(plain, output) > metrics.FAR_STEPS).mean() > 0.02


def evaluated(expression: str) -> np.ndarray:
    """The value (4,) of an expression of GLSL, a vec4, beside the functions of the library."""
    library = re.sub(r"\bvoid main\(\)", "void unused()", shaders.glsl("BokehConstantCoC", "330", {}))
    text = f"{library}void main()\n{{\n    BokehResult = {expression};\n}}\n"
    item = Pass("BokehConstantCoC", {"ColorSamp": "color"}, "value", sources={"glsl": text})
    return load("osmesa").run([item], {"color": flat((1, 1))}, (1, 1), "float", keep=("value",))["value"][0, 0]


def test_a_sensor_of_no_height(driver):
    """It becomes BOKEH_MIN_DEPTH, as in the reference: 0 in focus and not 0 / 0, and elsewhere not infinite.

    So small an aperture that the CoC stays below MaxCoC even so. As COC_ROUNDINGS of the reference: 16 roundings of
    2^-24, the focus distance is exact in float32 and its difference from the depths loses nothing.
    """
    camera = methods.Camera(2.0**-20, 0.0625, 4.0, sensor_height=0.0, max_coc=1.0)
    depth = np.array([[2.0, 4.0, 8.0, 1024.0]], np.float32)
    item = Pass("BokehCoCMap", {"ColorSamp": "color", "DepthSamp": "depth"}, "coc", camera.parameters())
    textures = {"color": flat((4, 1)), "depth": depth}
    coc = driver.run([item], textures, (4, 1), "float", keep=("coc",))["coc"][0, :, 3]
    values = (camera.aperture_diameter, camera.focal_length, camera.focus_distance, 0.0, camera.max_coc)
    wanted = listings.circle_of_confusion(depth[0].astype(np.float64), *values)
    assert wanted[1] == 0.0 and 0.0 < wanted[[0, 2, 3]].min() and wanted.max() < camera.max_coc
    np.testing.assert_allclose(coc, wanted, rtol=listings.COC_ROUNDINGS * 2.0**-24)


def test_every_channel_is_made_safe(driver):
    """Red, green and blue alike: NaN and negative become 0, infinite the largest half float."""
    hostile = np.array(COLOR, np.float16)[:, 0]
    color = np.ones((3, len(hostile), 4), np.float16)
    for channel in range(3):
        color[channel, :, channel] = hostile
    item = Pass("BokehConstantCoC", {"ColorSamp": "color"}, "result")
    output = driver.run([item], {"color": color}, (len(hostile), 3))["result"]
    wanted = np.ones((3, len(hostile), 3))
    for channel in range(3):
        wanted[channel, :, channel] = listings.safe_color(hostile.astype(np.float64))
    np.testing.assert_array_equal(output[..., :3], wanted)


def test_a_line_of_one_sample():
    """BokehMakeOffsets of one sample is one end of the line, where the distance between samples would be 0 / 0.

    WGSL cannot refuse BOKEH_NUM_SAMPLES = 1 as the others do: it is an override constant.
    """
    line = [0.25, 0.5]
    for sample, count, sign in ((0, 1, -1.0), (0, 2, -1.0), (1, 2, 1.0)):
        offset = evaluated(f"vec4(BokehMakeOffsets(vec2(0.25, 0.5), {sample}, {count}), 0.0, 0.0)")[:2]
        np.testing.assert_array_equal(offset, sign * np.array(line))


def test_default_settings():
    """BokehDefaultFilter: what section [1] configures, for an image of a size."""
    made = "BokehDefaultFilter(vec2(1920.0, 1080.0))"
    of_image = evaluated(f"vec4({made}.aspectRatio, {made}.imageHeight, {made}.spacing, {made}.jitter)")
    np.testing.assert_array_equal(of_image, np.float32([1920.0 / 1080.0, 1080.0, 1.0, 0.0]))
    given = methods.Settings()
    leakage = evaluated(f"vec4({made}.bleedingBias, {made}.bleedingMult, 0.0, 0.0)")
    np.testing.assert_array_equal(leakage[:2], np.float32([given.bleeding_bias, given.bleeding_mult]))


def test_a_line_of_no_length(driver):
    """An adaptive line of length 0 beside the pixel is one sample there: the image moved by its middle.

    Everything is a power of two: uv, and with it the place of the sample, is exact.
    """
    width, height, coc = 64, 32, 0.25
    color = noise_case((width, height), methods.Settings()).color
    first = Pass("BokehConstantCoC", {"ColorSamp": "color"}, "coc", {"BokehConstantCoC": coc, "BokehMaxCoC": 1.0})
    parameters = {
        "BokehAspectRatio": width / height,
        "BokehImageWidth": float(width),
        "BokehImageHeight": float(height),
        "BokehSpacing": 1.0,
        "BokehBleedingBias": 1.0,
        "BokehLineLength": 0.0,
        "BokehLineCenterX": 0.5,
        "BokehLineCenterY": -0.25,
    }
    line = Pass("BokehAdaptive", {"ColorSamp": "coc", "DepthSamp": "depth"}, "result", parameters)
    textures = {"color": color, "depth": depth_of((width, height), 5.0)}
    output = driver.run([first, line], textures, (width, height))["result"]
    # the CoC is 8 pixels: 4 to the right and 2 up
    np.testing.assert_array_equal(output[2:, :-4, :3], color[:-2, 4:, :3])


@pytest.mark.parametrize("targets", [True, False], ids=["at once", "one by one"])
@pytest.mark.parametrize("aperture", methods.EXACT)
@in_each_language
def test_jitter_of_the_exact_passes(aperture, targets, driver):
    """Few samples on a wide blur, so that the noise acts in every pass: as the reference says, and not as without."""
    settings = methods.Settings(
        "exact", aperture, coc=0.5, camera=methods.Camera(max_coc=1.0), max_samples=3, spacing=1.0, jitter=1.0, frame=5
    )
    case = noise_case((61, 48), replace(settings, targets=targets))
    output, _ = within(driver, case)
    plain, _ = within(driver, replace(case, settings=replace(case.settings, jitter=0.0)))
    assert changed(plain, output)


@in_each_language
def test_noise_comes_again(driver):
    """After 64 frames, and after 2^22 as well, where the number of the frame times 33/64 has no room for a fraction."""
    camera = methods.Camera(max_coc=1.0)
    settings = methods.Settings("exact", coc=0.5, camera=camera, max_samples=3, spacing=1.0, jitter=1.0)
    results = []
    for frame in (5, 64 + 5, 2**22 + 5, 6):
        case = noise_case((61, 48), replace(settings, frame=frame))
        results.append(driver.run(case.plan.passes, case.textures(), case.size)["result"])
    np.testing.assert_array_equal(results[1], results[0])
    np.testing.assert_array_equal(results[2], results[0])
    assert changed(results[0], results[3])


@pytest.mark.parametrize("mode", [2, 3])
def test_debug_views_of_the_near_field(mode, driver):
    """A signed CoC below 0 is as bright as the same above 0."""
    coc = flat((2, 1))
    coc[0, :, 3] = -0.0625, 0.0625
    parameters = {"BokehDebugMode": float(mode), "BokehMaxCoC": 0.125, "BokehFocusDistance": 4.0}
    view = Pass("BokehDebug", {"ColorSamp": "coc", "DepthSamp": "depth"}, "result", parameters)
    output = driver.run([view], {"coc": coc, "depth": depth_of((2, 1), 2.0)}, (2, 1), "float")["result"][0]
    tints = {2: [0.5, 0.5, 0.5, 1.0], 3: [0.5, 0.25, 0.0, 1.0]}[mode]
    np.testing.assert_array_equal(output, [tints, tints])


@pytest.mark.parametrize("mode", [2, 3])
def test_debug_views_of_a_pinhole(mode, driver):
    """MaxCoC 0 is taken for BOKEH_MIN_DEPTH: in focus black and not 0 / 0, and elsewhere not infinite."""
    small = 2.0**-21  # half of BOKEH_MIN_DEPTH, and a half float
    coc = flat((2, 1))
    coc[0, :, 3] = 0.0, small
    parameters = {"BokehDebugMode": float(mode), "BokehMaxCoC": 0.0, "BokehFocusDistance": 4.0}
    view = Pass("BokehDebug", {"ColorSamp": "coc", "DepthSamp": "depth"}, "result", parameters)
    output = driver.run([view], {"coc": coc, "depth": depth_of((2, 1), 8.0)}, (2, 1), "float")["result"][0]
    # the alpha is read through the linear filter at a place that is exact: at two pixels uv is 1/4 and 3/4
    grey = small / listings.MIN_DEPTH
    tints = {2: [1.0, 1.0, 1.0], 3: [0.1, 0.4, 1.0]}[mode]
    wanted = [[0.0, 0.0, 0.0, 1.0], [*(grey * tint for tint in tints), 1.0]]
    # a division counts for 2.5 roundings, as Vulkan allows, beside the rounding of BOKEH_MIN_DEPTH and two products
    np.testing.assert_allclose(output, wanted, rtol=6 * 2.0**-24)


@pytest.mark.parametrize("method", ["naive", "naive-grid"])
@in_each_language
def test_squeeze_of_the_naive_methods(method, driver):
    """The squeeze narrows the table and the grid as it does the lines."""
    settings = methods.Settings(method, "hexagon", camera=methods.Camera(0.1, 0.05, 4.0, max_coc=0.3), rotation=20.0)
    case = noise_case((61, 48), settings)
    squeezed = replace(case, settings=replace(settings, squeeze=0.5))
    output, _ = within(driver, squeezed)
    plain, _ = within(driver, case)
    assert changed(plain, output)


@pytest.mark.parametrize("count", [2, 127, 128, 129, 200, 256, 300])
def test_many_offsets(count, driver):
    """A table of more offsets than a loop of shader model 3 has iterations: each is read once.

    The offsets are whole pixels along a row, each nearer to the pixel than the last, with a value of its own there.
    """
    width, coc = 1024, 0.5
    random = np.random.default_rng(count)
    color = np.ones((2, width, 4), np.float16)
    color[..., :3] = random.integers(0, 2, (2, width, 1))
    places = random.permutation(count) - count // 2
    # uv counts widths, offsets the CoC over the aspect ratio 512: a pixel is 1 / 1024 of uv
    kernel = np.zeros((1, count, 4), np.float32)
    kernel[0, :, 0] = places / width / coc * (width / 2)
    first = Pass("BokehConstantCoC", {"ColorSamp": "color"}, "coc", {"BokehConstantCoC": coc, "BokehMaxCoC": 1.0})
    inputs = {"ColorSamp": "coc", "DepthSamp": "depth", "KernelSamp": "kernel"}
    parameters = {"BokehAspectRatio": width / 2, "BokehBleedingBias": 1.0}
    gather = Pass("BokehNaiveGather", inputs, "result", parameters, samples=count)
    textures = {"color": color, "depth": depth_of((width, 2), 5.0), "kernel": kernel}
    output = driver.run([first, gather], textures, (width, 2), "float")["result"]
    wanted = np.mean(
        [color[:, np.clip(np.arange(width) + place, 0, width - 1), 0] for place in places], axis=0, dtype=float
    )
    # Weights are 1 and sums of 0 and 1 exact. A place is off by three roundings of 2^-24 of 1024 texels and the filter
    # with it, 1.8e-4; a sample that is left out changes the mean by 1.6e-3 or more.
    np.testing.assert_allclose(output[..., 0], wanted, atol=2.0**-11)


def test_constant_coc_is_clamped(driver):
    """A constant CoC below 0 is 0, one above MaxCoC is that."""
    for value, wanted in ((-0.5, 0.0), (0.125, 0.125), (0.5, 0.25)):
        parameters = {"BokehConstantCoC": value, "BokehMaxCoC": 0.25}
        item = Pass("BokehConstantCoC", {"ColorSamp": "color"}, "result", parameters)
        output = driver.run([item], {"color": flat((4, 2), 1.0)}, (4, 2))["result"]
        np.testing.assert_array_equal(output[..., 3], wanted)


def test_defaults():
    """Section [1] has the values that the harness takes where nobody says, and the limits of the reference."""
    camera, settings = methods.Camera(), methods.Settings()
    wanted = {
        "BOKEH_NUM_SAMPLES": methods.PAPER_SAMPLES,
        "BOKEH_SPACING": 1.0,
        "BOKEH_ADAPTIVE_SAMPLES": 1,
        "BOKEH_VIEWPORT": 0,
        "BOKEH_CHARACTER": 0,
        "BOKEH_SENSOR_HEIGHT": camera.sensor_height,
        "BOKEH_MAX_COC": camera.max_coc,
        "BOKEH_BLEEDING_BIAS": settings.bleeding_bias,
        "BOKEH_BLEEDING_MULT": settings.bleeding_mult,
        "BOKEH_MAX_COLOR": listings.MAX_COLOR,
        "BOKEH_MIN_DEPTH": listings.MIN_DEPTH,
        "BOKEH_MAX_DEPTH": listings.MAX_DEPTH,
    }
    for language in paths.LANGUAGES:
        text = paths.library(language).read_text(encoding="ascii")
        found = {name: np.float32(value) for name, value in shaders.settings(language, text).items()}
        assert found == {name: np.float32(value) for name, value in wanted.items()}, language
    assert passes.PARAMETERS["BokehSensorHeight"] == camera.sensor_height
    assert passes.PARAMETERS["BokehMaxCoC"] == camera.max_coc
    assert passes.PARAMETERS["BokehBleedingBias"] == settings.bleeding_bias
    assert passes.PARAMETERS["BokehBleedingMult"] == settings.bleeding_mult


# Number of samples and spacing
PRESETS = {"LOW": (5, 2.0), "MEDIUM": (9, 1.5), "HIGH": (17, 1.0), "ULTRA": (33, 1.0)}


def test_presets():
    """Two passes of two lines each make the fetches of the table, and the pixels at their centres two more. Smooth is
    the CoC whose edge, half of it in a hexagon, the samples fill.
    """
    for language in paths.LANGUAGES:
        text = paths.library(language).read_text(encoding="ascii")
        rows = re.findall(r"^//   BOKEH_PRESET_(\w+) +(\d+) +([\d.]+) +(\d+) +(\d+)$", text, re.MULTILINE)
        assert {name: (int(samples), float(spacing)) for name, samples, spacing, _, _ in rows} == PRESETS
        for _, samples, spacing, fetches, smooth in rows:
            assert int(fetches) == 4 * int(samples) + 2
            assert int(smooth) == int(2 * int(samples) * float(spacing))
        if language != "wgsl":
            found = {name: tuple(map(float, values.values())) for name, values in shaders.presets(text).items() if name}
            assert found == PRESETS


@pytest.mark.parametrize("f_number", [1.4, 16.0])
def test_signed_map(f_number, driver):
    """BokehSignedCoCMap against BokehCoCMap: the same CoC, below 0 where the pixel is nearer than the focus; depth that
    is none is the nearest.
    """
    camera = methods.Camera(0.05 / f_number, 0.05, 4.0, max_coc=0.25)
    depth = np.array([[np.nan, -1.0, 0.0, 0.5, 2.0, 3.9, 4.0, 4.1, 8.0, 1e5, np.inf]], np.float32)
    size = (depth.shape[1], 1)
    textures = {"color": flat(size, 0.5), "depth": depth}
    found = []
    for entry in ("BokehCoCMap", "BokehSignedCoCMap"):
        item = Pass(entry, {"ColorSamp": "color", "DepthSamp": "depth"}, "coc", camera.parameters())
        found.append(driver.run([item], textures, size, "float", keep=("coc",))["coc"][0])
    plain, signed = found
    near = np.arange(size[0]) < 6
    np.testing.assert_array_equal(signed[:, :3], plain[:, :3])
    np.testing.assert_array_equal(signed[:, 3], np.where(near, -plain[:, 3], plain[:, 3]))
    assert plain[6, 3] == 0.0 and (np.delete(plain[:, 3], 6) > 0.0).all()


@pytest.mark.parametrize("method", ["paper", "exact"])
@in_each_language
def test_half_a_pixel_is_in_focus(method, driver):
    """A CoC of up to half a pixel blurs nothing, to the bit; one of a pixel does."""
    camera = methods.Camera(max_coc=1.0)
    # so close that a line of a pixel has several samples
    settings = methods.Settings(method, "hexagon", spacing=0.1, leak_fix=False, camera=camera)
    results = {}
    for coc in (0.3, 0.5, 1.0):
        # powers of two: uv and half a pixel are exact
        case = noise_case((64, 32), replace(settings, coc=coc / 32.0))
        results[coc] = driver.run(case.plan.passes, case.textures(), case.size, keep=("coc", "result"))
    for coc in (0.3, 0.5):
        np.testing.assert_array_equal(results[coc]["result"], results[coc]["coc"])
    assert changed(results[1.0]["coc"], results[1.0]["result"])


@pytest.mark.parametrize("aperture", ["hexagon", "decagon"])
@in_each_language
def test_squeezed_lines_have_means(aperture, driver):
    """Squeezed edges have different lengths and numbers of samples: each line is worth its area all the same."""
    camera = methods.Camera(max_coc=1.0)
    settings = methods.Settings("exact", aperture, coc=0.5, camera=camera, spacing=1.0, squeeze=0.3, rotation=20.0)
    within(driver, noise_case((61, 48), settings))
