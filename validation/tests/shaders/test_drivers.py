"""Every driver against the float64 reference: methods, apertures, scenes, odd sizes, switches, hostile pixels."""

from dataclasses import replace

import numpy as np
import pytest
from support import load

from bokeh_validation import apertures, drivers, methods, metrics, suite
from bokeh_validation.drivers import base
from bokeh_validation.errors import Unavailable
from bokeh_validation.passes import Pass, target_area, target_size
from bokeh_validation.patterns import model
from bokeh_validation.patterns.model import Case, expected
from bokeh_validation.reference import images, listings, precision
from bokeh_validation.reference.device import Reference

METHODS = [*apertures.METHODS, "naive-grid"]


def compared(driver: drivers.Driver, case: Case) -> tuple[np.ndarray, metrics.Comparison]:
    """A driver's result and how far it is from the reference; pixels outside the interval in every target compared."""
    outputs, _, comparisons = model.compared(case, driver)
    outside = sum(comparison.outside for comparison in comparisons.values())
    return outputs["result"], replace(comparisons["result"], outside=outside)


def noise_case(size: tuple[int, int], settings: methods.Settings, seed: int = 1) -> Case:
    """Random HDR colour in patches over random depth in patches: every comparison of Listing 3 goes both ways."""
    random = np.random.default_rng(seed)
    width, height = size
    coarse = (height // 6 + 1, width // 6 + 1)

    def patches(values: np.ndarray) -> np.ndarray:
        return np.kron(values, np.ones((6, 6)))[:height, :width]

    color = np.ones((height, width, 4), np.float16)
    for channel in range(3):
        color[..., channel] = patches(random.lognormal(0.0, 1.0, coarse)) + 0.1 * random.random((height, width))
    depth = patches(random.uniform(1.0, 30.0, coarse)).astype(np.float32)
    return Case(f"noise {size}", settings, color, depth)


SHAPES = [
    *((method, aperture) for method in ("paper", "naive") for aperture in apertures.APERTURES),
    *(("exact", aperture) for aperture in methods.EXACT),
]


@pytest.mark.parametrize(("method", "aperture"), SHAPES)
@pytest.mark.parametrize("scene", suite.DRIVER_SCENES, ids=lambda s: s.name)
def test_scenes(scene, method, aperture, all_drivers):
    """Both ray-traced scenes, each method and aperture: within the interval, and languages close to each other."""
    case = suite.scene_case(scene, method, aperture)
    outputs = {}
    for driver in all_drivers:
        outputs[driver.name], comparison = compared(driver, case)
        assert comparison.ok, f"{driver.name}: {comparison}"
    first: dict[str, np.ndarray] = {}
    for driver in all_drivers:
        # where the stored CoC is rounded another way, every sample of the next pass is somewhere else
        distance = metrics.steps(first.setdefault(driver.rounding, outputs[driver.name]), outputs[driver.name])
        assert (distance <= metrics.CLOSE_STEPS).mean() >= metrics.CLOSE_SHARE, driver.name
        # two results that are both within the bounds of the reference may be twice as far from each other
        undecided = expected(case, driver.software, driver.rounding)["result"].undecided
        assert distance[~undecided].max() <= 2 * metrics.FAR_STEPS, driver.name


@pytest.mark.parametrize("size", [(64, 48), (61, 37), (1, 1), (1, 64), (96, 2), (257, 33)], ids=str)
@pytest.mark.parametrize("method", METHODS)
def test_sizes(method, size, driver):
    """Odd, tiny and thin images."""
    camera = methods.Camera(0.1, 0.05, 4.0, max_coc=0.3)
    _, comparison = compared(driver, noise_case(size, methods.Settings(method, "hexagon", camera=camera)))
    assert comparison.outside == 0, comparison


@pytest.mark.parametrize(
    "changes",
    [
        {"samples": 2},
        {"samples": 3},
        {"samples": 8},
        {"samples": 40},
        {"rotation": 17.0},
        {"blur_coc": False},
        {"leak_fix": False},
        {"bleeding_bias": 0.0},
        {"bleeding_bias": 0.1},
        {"bleeding_mult": 2.0},
        {"coc": 0.2},
        {"coc": 0.9},
        {"coc": 0.0},
        {"aperture": "star", "rotation": -30.0},
        {"aperture": "octagon", "blur_coc": False},
        {"aperture": "square", "samples": 4, "leak_fix": False},
    ],
    ids=str,
)
@pytest.mark.parametrize("method", METHODS)
def test_settings(method, changes, driver):
    """Every parameter of the shaders away from its default, on random patches."""
    camera = methods.Camera(0.12, 0.05, 4.0, sensor_height=0.02, max_coc=0.25)
    if method in ("exact", "layered"):
        # no star among the polygons with an even number of sides
        changes = {**changes, "aperture": changes.get("aperture", "hexagon").replace("star", "decagon")}
    settings = replace(methods.Settings(method, "hexagon", camera=camera), **changes)
    _, comparison = compared(driver, noise_case((75, 50), settings))
    assert comparison.outside == 0, comparison
    if driver.software:
        assert comparison.close >= 0.98, comparison


def test_settings_matter():
    """Each of the switches above changes the picture, or testing it would mean nothing."""
    camera = methods.Camera(0.12, 0.05, 4.0, sensor_height=0.02, max_coc=0.25)
    base = methods.Settings("paper", "hexagon", camera=camera)
    case = noise_case((75, 50), base)
    plain = _reference_result(case)
    for changes in (
        {"samples": 8},
        {"rotation": 17.0},
        {"blur_coc": False},
        {"leak_fix": False},
        {"bleeding_bias": 0.1},
        {"bleeding_mult": 2.0},
        {"camera": replace(camera, sensor_height=0.03)},
        {"camera": replace(camera, max_coc=0.1)},
    ):
        other = _reference_result(replace(case, settings=replace(base, **changes)))
        changed = metrics.steps(plain, other) > metrics.FAR_STEPS
        assert changed.mean() > 0.02, changes


def _reference_result(case: Case) -> np.ndarray:
    return Reference().run(case.plan.passes, case.textures(), case.size)["result"]


def test_float_targets(driver):
    """32-bit targets: within the interval, and a thousand times closer than half floats could be."""
    camera = methods.Camera(0.12, 0.05, 4.0, max_coc=0.25)
    case = noise_case((64, 48), methods.Settings("paper", "hexagon", camera=camera))
    output = driver.run(case.plan.passes, case.textures(), case.size, "float")["result"]
    assert output.dtype == np.float32
    kind = precision.SOFTWARE if driver.software else precision.GPU
    wanted = Reference().images(case.plan.passes, case.textures(), case.size, "float", kind)["result"]
    off = np.abs(output - wanted.value)
    assert (off <= wanted.error).all()
    if driver.software:
        assert np.median(off / np.maximum(wanted.value, 1e-3)) < 1e-6


def exact_case(aperture: str) -> Case:
    """Exact polygons: the second pass of the plan writes two to four targets, the third reads them all."""
    camera = methods.Camera(0.12, 0.05, 4.0, max_coc=0.25)
    # powers of two: uv is exact in float32, and so is the CoC, which these passes copy
    return noise_case((64, 32), methods.Settings("exact", aperture, rotation=17.0, camera=camera))


@pytest.mark.parametrize("storage", ["half", "float"])
@pytest.mark.parametrize("aperture", ["hexagon", "octagon", "decagon"])
def test_several_targets(aperture, storage, driver):
    """Two, three and four targets of one pass: each is what the reference has in its place."""
    case = exact_case(aperture)
    passes, names = case.plan.passes, case.plan.passes[1].outputs
    output = driver.run(passes, case.textures(), case.size, storage, keep=(*reversed(names), "result"))
    kind = precision.SOFTWARE if driver.software else precision.GPU
    wanted = Reference().images(passes, case.textures(), case.size, storage, kind, driver.rounding)
    for name in (*names, "result"):
        comparison = metrics.compare(output[name], wanted[name], driver.software)
        assert comparison.outside == 0, (name, comparison)
    # or the order would not matter
    assert metrics.compare(output[names[0]], wanted[names[1]], driver.software).outside > 0


def test_targets_are_textures_like_any_other(driver):
    """Later passes read each of them, one takes the name of an earlier texture, and all can be kept."""
    case = exact_case("octagon")
    coc, first = case.plan.passes[:2]
    names = ("one", "coc", "color")
    copies = [Pass("BokehConstantCoC", {"ColorSamp": name}, f"copy of {name}") for name in names]
    keep = [item.output for item in copies] + list(names)
    output = driver.run([coc, replace(first, output=names), *copies], case.textures(), case.size, keep=keep)
    plain = driver.run([coc, first], case.textures(), case.size, keep=first.outputs)
    for name, original in zip(names, first.outputs, strict=True):
        np.testing.assert_array_equal(output[name], plain[original])
        np.testing.assert_array_equal(output[f"copy of {name}"][..., :3], output[name][..., :3])


def test_number_of_targets():
    """A pass names as many as its entry writes."""
    for output in ("one", ("one",), ("one", "two", "three")):
        with pytest.raises(ValueError, match="BokehHexagonFirst writes 2 targets"):
            Pass("BokehHexagonFirst", {}, output)


def test_more_bytes_a_pixel_than_the_device_writes():
    """Four half-float targets are what every device of WebGPU has; four of 32 bits are not."""
    passes = exact_case("decagon").plan.passes
    base.require_targets(Reference(), passes, "half", 32)
    with pytest.raises(Unavailable, match="writes 32 bytes a pixel at once; BokehDecagonFirst needs 64"):
        base.require_targets(Reference(), passes, "float", 32)
    narrow = [replace(item, channels=2) for item in passes]
    base.require_targets(Reference(), narrow, "float", 32)
    with pytest.raises(Unavailable, match="writes 15 bytes a pixel at once; BokehDecagonFirst needs 16"):
        base.require_targets(Reference(), narrow, "half", 15)


def picture(width: int, height: int) -> np.ndarray:
    """(H, W, 4) float16: no two texels alike in red and green."""
    y, x = np.mgrid[:height, :width]
    return np.stack([x + 1, y + 1, 10 * x + y, np.ones_like(x)], axis=-1).astype(np.float16)


def copy(source: str, output: str, scale: int = 1, channels: int = 4, viewport=None) -> Pass:
    """A texture fetched with the nearest filter at each texel of the target; alpha becomes 0.25."""
    parameters = {"BokehConstantCoC": 0.25, "BokehMaxCoC": 1.0}
    inputs = {"ColorSamp": source}
    return Pass("BokehConstantCoC", inputs, output, parameters, viewport=viewport, scale=scale, channels=channels)


def nan(output: str, scale: int = 1, channels: int = 4) -> Pass:
    """NaN everywhere in a new target: the debug view of colour copies what it reads."""
    inputs = {"ColorSamp": "nan", "DepthSamp": "depth"}
    return Pass("BokehDebug", inputs, output, scale=scale, channels=channels)


NAN = {"nan": np.full((1, 1, 4), np.nan, np.float16), "depth": np.ones((1, 1), np.float32)}


def fetched(source: np.ndarray, size: tuple[int, int], channels: int = 4) -> np.ndarray:
    """What `copy` makes of a source in a target of that size: texel floor(uv * size of the source)."""
    y, x = ((2 * np.arange(count) + 1) * source.shape[axis] // (2 * count) for axis, count in enumerate(size[::-1]))
    result = source[y[:, None], x[None, :]].copy()
    result[..., 3] = 0.25
    if channels == 2:
        result[..., 2:] = 0.0, 1.0
    return result


def test_sizes_of_targets():
    """Divided and rounded up; a viewport covers every texel that it touches."""
    assert [target_size(scale, (61, 37)) for scale in (1, 2, 4, 8)] == [(61, 37), (31, 19), (16, 10), (8, 5)]
    assert target_size(8, (1, 16)) == (1, 2)
    assert target_area(1, (5, 3, 7, 2)) == (5, 3, 7, 2)
    assert target_area(4, (8, 4, 7, 8)) == (2, 1, 2, 2)


@pytest.mark.parametrize("channels", [4, 2])
@pytest.mark.parametrize("storage", ["half", "float"])
@pytest.mark.parametrize("size", [(65, 49), (17, 1)], ids=str)
def test_targets_of_other_sizes(size, storage, channels, driver):
    """Each pass reads a target of another size than its own, down to an eighth and back, and upwards from there.

    These sizes are odd at every scale, so that no fetch is on the border of two texels.
    """
    scales = (1, 2, 4, 8, 1)
    names = [f"{index} at {scale}" for index, scale in enumerate(scales)]
    sources = ["picture", *names]
    passes = [copy(*names, scale, channels) for *names, scale in zip(sources, names, scales, strict=False)]
    output = driver.run(passes, {"picture": picture(*size)}, size, storage, names)
    wanted = picture(*size)
    for name, scale in zip(names, scales, strict=True):
        wanted = fetched(wanted, target_size(scale, size), channels)
        np.testing.assert_array_equal(output[name], wanted, name)
        assert output[name].dtype == base.storage_type(storage)


@pytest.mark.parametrize("channels", [4, 2])
def test_targets_beside_each_other(channels, driver):
    """One texture copied at every scale, kept in another order than drawn; names are used again at other scales."""
    size, source = (61, 37), picture(61, 37)
    passes = [copy("picture", f"{scale}", scale, channels) for scale in (8, 1, 4, 2)]
    again = [copy("picture", "t", 2, 4), copy("t", "t", 1, channels), copy("t", "t", 8, channels)]
    output = driver.run([*passes, *again], {"picture": source}, size, keep=("1", "2", "4", "8", "t"))
    for scale in (1, 2, 4, 8):
        np.testing.assert_array_equal(output[f"{scale}"], fetched(source, target_size(scale, size), channels))
    half = fetched(fetched(source, (31, 19)), (61, 37))
    np.testing.assert_array_equal(output["t"], fetched(half, (8, 5), channels))


def test_what_two_channels_read(driver):
    """Red and green; alpha 1, and blue 0 but for Direct3D 9."""
    view = Pass("BokehDebug", {"ColorSamp": "two", "DepthSamp": "depth"}, "result")
    # a power of two: the linear filter is on the texels' centres, exactly
    passes = [copy("picture", "two", channels=2), view]
    output = driver.run(passes, {"picture": picture(8, 4), **NAN}, (8, 4))["result"]
    wanted = picture(8, 4)
    wanted[..., 2:] = 1.0 if driver.name == "d3d9" else 0.0, 1.0
    np.testing.assert_array_equal(output, wanted)


@pytest.mark.parametrize("channels", [4, 2])
@pytest.mark.parametrize("new", [False, True], ids=["old", "new"])
def test_a_part_of_a_small_target(new, channels, all_drivers):
    """A viewport in texels of the full size; what an earlier pass left around it stays, a new target is 0 there."""
    size, scale, part = (29, 21), 4, (8, 4, 13, 9)
    source = {"picture": picture(4, 3), "whole": np.full((6, 8, 4), 7.0, np.float16), **NAN}
    wanted = np.full((6, 8, 4), 0.0 if new else np.nan, np.float16)
    wanted[1:4, 2:6] = fetched(picture(4, 3), (4, 3))
    if channels == 2:
        wanted[..., 2:] = 0.0, 1.0
    drawn = copy("picture", "t", scale, channels, part)
    for driver in all_drivers:
        before = [] if new else [nan("t", scale, channels)]
        output = driver.run([*before, drawn], source, size, keep=("t",))["t"]
        np.testing.assert_array_equal(output, wanted, driver.name)
    # the reference copies texel by texel, and not NaN
    before = [] if new else [copy("whole", "t", scale, channels)]
    output = Reference().run([*before, drawn], source, size, keep=("t",))["t"]
    left = fetched(source["whole"], (8, 6), channels)
    np.testing.assert_array_equal(output, np.where(np.isnan(wanted), left, wanted))


@pytest.mark.parametrize("name", ["osmesa", "egl", "wgpu", "dxc"])
def test_shared_targets(name):
    """A job takes those of another that have its size and channels, and makes those that have not."""
    driver, size, source = load(name), (61, 37), {"picture": picture(61, 37)}
    names = ("same", "small", "two")
    other = driver.prepared([copy("picture", name) for name in names], source, size)
    passes = [copy("picture", "same"), copy("picture", "small", 2), copy("picture", "two", channels=2)]
    job = driver.prepared(passes, source, size, share=other)
    assert [job.live[name] is other.live[name] for name in names] == [True, False, False]
    for _ in range(2):
        other.draw()
        job.draw()
        np.testing.assert_array_equal(job.read("small"), fetched(source["picture"], (31, 19)))
        np.testing.assert_array_equal(job.read("two"), fetched(source["picture"], size, 2))
        np.testing.assert_array_equal(other.read("small"), fetched(source["picture"], size))
    job.release()
    other.release()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"scale": 3}, "BokehConstantCoC: scale is one of 1, 2, 4, 8, not 3"),
        ({"scale": 0}, "BokehConstantCoC: scale is one of 1, 2, 4, 8, not 0"),
        ({"channels": 1}, "BokehConstantCoC: channels is one of 2, 4, not 1"),
    ],
)
def test_no_such_targets(changes, words):
    """Said when the pass is made."""
    with pytest.raises(ValueError, match=words):
        copy("picture", "t", **changes)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"viewport": (2, 4, 4, 4)}, r"viewport \(2, 4, 4, 4\) begins within a texel of targets of scale 4"),
        ({"viewport": (4, 6, 4, 4)}, r"viewport \(4, 6, 4, 4\) begins within a texel of targets of scale 4"),
        ({"viewport": (4, 4, 26, 4)}, r"viewport \(4, 4, 26, 4\) is not within 29 x 21"),
        ({"viewport": (4, 4, 4, 4), "scale": 2}, "has scale 2 and 4 channels, and draws over 't', which has scale 4"),
        ({"viewport": (4, 4, 4, 4), "channels": 2}, "4 and 2 channels, and draws over 't', which has scale 4 and 4 ch"),
    ],
)
def test_no_such_part(changes, words, driver):
    """A part of a target begins at a texel; a target keeps its size and format."""
    first = copy("picture", "t", 4)
    for candidate in (driver, Reference()):
        with pytest.raises(ValueError, match=words):
            candidate.run([first, replace(first, **changes)], {"picture": picture(8, 6)}, (29, 21), keep=("t",))


HOSTILE_COLOR = [np.nan, np.inf, -np.inf, -1.0, 0.0, -0.0, 65504.0, 6e-8, 1.0]
HOSTILE_DEPTH = [np.nan, np.inf, -np.inf, -1.0, 0.0, 1e-30, 0.05, 4.0, 1e30]


def test_first_pass_makes_hostile_pixels_safe(driver):
    """NaN, infinite, negative and denormal colour and depth: finite and >= 0 after the first pass, as documented."""
    color = np.ones((9, 9, 4), np.float16)
    color[..., 0] = np.array(HOSTILE_COLOR, np.float16)
    color[..., 1] = np.array(HOSTILE_COLOR, np.float16)[:, None]
    color[..., 3] = np.nan
    depth = np.repeat(np.array(HOSTILE_DEPTH, np.float32)[:, None], 9, axis=1)
    camera = methods.Camera(0.1, 0.05, 4.0, max_coc=0.25)
    case = Case("hostile", methods.Settings(camera=camera), color, depth)
    plan = case.plan
    output = driver.run(plan.passes, case.textures(), case.size, keep=("coc", "result"))
    coc = output["coc"].astype(np.float64)
    assert np.isfinite(coc).all() and (coc >= 0).all()
    np.testing.assert_array_equal(coc[0, :, 0], [0, 65504, 0, 0, 0, 0, 65504, np.float16(6e-8), 1])
    np.testing.assert_array_equal(coc[:, 0, 1], [0, 65504, 0, 0, 0, 0, 65504, np.float16(6e-8), 1])
    limit = 0.1 * 0.05 / 3.95 / 0.024
    nearest = listings.circle_of_confusion(0.05, 0.1, 0.05, 4.0, 0.024, 0.25)
    wanted = [0.25, limit, 0.25, 0.25, 0.25, 0.25, nearest, 0.0, limit]
    np.testing.assert_allclose(coc[:, 0, 3], wanted, rtol=2.0**-10)
    assert np.isfinite(output["result"]).all() and (output["result"] >= 0).all()


@pytest.mark.parametrize("mode", [0, 1, 2, 3])
def test_debug_views(mode, driver):
    """Section [9]: colour, depth, CoC, near and far field."""
    camera = methods.Camera(0.1, 0.05, 4.0, max_coc=0.2)
    case = noise_case((40, 30), methods.Settings(camera=camera))
    first = case.plan.passes[0]
    parameters = {**camera.parameters(), "BokehDebugMode": float(mode)}
    view = Pass("BokehDebug", {"ColorSamp": "coc", "DepthSamp": "depth"}, "result", parameters)
    output = driver.run([first, view], case.textures(), case.size)["result"]
    wanted = Reference().images([first, view], case.textures(), case.size, rounding=driver.rounding)["result"].value
    # a colour is read at a rounded uv (mode 0) or takes half a dozen float32 roundings, and is stored once
    off = np.abs(output - wanted) / images.step(np.maximum(np.abs(wanted), 2.0**-10), np.float16)
    assert off.max() <= metrics.CLOSE_STEPS


def rejected_case(around: float) -> Case:
    """One far, blurred pixel with a CoC of 2.5 pixels whose two samples fall on nearer ones at the depth `around`."""
    color = np.full((8, 16, 4), 9.0, np.float16)
    depth = np.full((8, 16), around, np.float32)
    color[4, 8, :3], depth[4, 8] = 0.5, 50.0
    return Case("rejected", methods.Settings("naive-grid", "square", 2, camera=REJECTING), color, depth)


REJECTING = methods.Camera(0.3, 0.05, 2.0, max_coc=1.0)


def test_every_sample_rejected(driver):
    """No centre sample, only focused nearer neighbours: the weights sum to zero, the centre pixel is the answer."""
    case = rejected_case(2.0)
    output = driver.run(case.plan.passes, case.textures(), case.size, keep=("coc", "result"))
    assert 2.0 < output["coc"][4, 8, 3] * 8 < 3.0, "the samples must miss the pixel itself"
    np.testing.assert_array_equal(output["result"][4, 8], output["coc"][4, 8])


def test_nearly_rejected_samples_still_count(driver):
    """Weights of a thousandth each: the mean is that of the samples, not of the centre."""
    case = rejected_case(1.9998)
    output = driver.run(case.plan.passes, case.textures(), case.size, keep=("coc", "result"))
    assert 0 < output["coc"][4, 7, 3] * 30.0 < 0.002
    np.testing.assert_allclose(output["result"][4, 8, :3].astype(float), 9.0, rtol=2.0**-10)


def test_depth_of_a_tenth_of_a_millimetre(driver):
    """Depth is in metres, but nothing is wrong with a scene a millimetre deep."""
    camera = methods.Camera(1e-6, 1e-5, 1e-3, sensor_height=1e-6, max_coc=1.0)
    depth = np.array([[1e-4, 5e-4, 2e-3, 1e-5]], np.float32)
    case = Case("tiny", methods.Settings(camera=camera), np.ones((1, 4, 4), np.float16), depth)
    coc = driver.run(case.plan.passes[:1], case.textures(), case.size, keep=("coc",))["coc"][0, :, 3]
    wanted = listings.circle_of_confusion(depth[0].astype(float), 1e-6, 1e-5, 1e-3, 1e-6, 1.0)
    np.testing.assert_allclose(coc.astype(float), wanted, rtol=1.1 * 2.0**-10)


def test_a_sharp_picture_stays_as_it_is(driver):
    """CoC 0 everywhere: every pass copies, but for reading at a rounded uv."""
    case = noise_case((64, 64), methods.Settings("paper", "octagon", coc=0.0))
    output = driver.run(case.plan.passes, case.textures(), case.size)["result"]
    # 64 is a power of two: uv is exact in float32 and so is the copy
    np.testing.assert_array_equal(output[..., :3], case.color[..., :3])


def test_unknown_parameter_is_refused(driver):
    """A misspelt parameter must not fall back to its default."""
    misspelt = Pass("BokehConstantCoC", {"ColorSamp": "color"}, "result", {"BokehCoC": 1.0})
    with pytest.raises(KeyError):
        driver.run([misspelt], {"color": np.ones((2, 2, 4), np.float16)}, (2, 2))
