"""Every driver against the float64 reference: methods, apertures, scenes, odd sizes, switches, hostile pixels."""

from dataclasses import replace

import numpy as np
import pytest
from hostile import COLOR, DEPTH
from support import LANGUAGES, in_each_language, load, spread
from support_cases import CAMERA, kind, noise_case, result, within

from bokeh_validation import metrics
from bokeh_validation.frame import apertures, methods
from bokeh_validation.frame.methods import Settings
from bokeh_validation.probes.model import Case, expected
from bokeh_validation.reference import images, listings
from bokeh_validation.reference.device import Reference
from bokeh_validation.shaders.entries import ENTRIES
from bokeh_validation.shaders.passes import Pass
from bokeh_validation.truth import ray_traced

# test_layers.py has the same of layered
METHODS = ("paper", "exact", "naive", "naive-grid")
SHAPES = [
    *((method, aperture) for method in ("paper", "naive") for aperture in apertures.APERTURES),
    *(("exact", aperture) for aperture in methods.EXACT),
]
# a part of the ray-traced scenes with something in focus, near and far
PART = (slice(206, 270), slice(264, 344))


@pytest.mark.parametrize(("method", "aperture"), SHAPES)
@pytest.mark.parametrize("scene", ray_traced.DRIVER_SCENES, ids=lambda s: s.name)
def test_scenes(scene, method, aperture, all_drivers):
    """Both ray-traced scenes, each method and aperture: within the interval, and drivers close to each other; all of
    them on the first, one of each language on the second.
    """
    case = ray_traced.scene_case(scene, method, aperture)
    case = replace(case, color=case.color[PART].copy(), depth=case.depth[PART].copy())
    first: dict[str, np.ndarray] = {}
    for driver in all_drivers if scene is ray_traced.DRIVER_SCENES[0] else map(load, LANGUAGES):
        output, comparison = within(driver, case)
        assert comparison.ok, f"{driver.name}: {comparison}"
        # where the stored CoC is rounded another way, every sample of the next pass is somewhere else
        distance = metrics.steps(first.setdefault(driver.rounding, output), output)
        assert (distance <= metrics.CLOSE_STEPS).mean() >= metrics.CLOSE_SHARE, driver.name
        # two results that are both within the bounds of the reference may be twice as far from each other
        undecided = expected(case, driver.precision, driver.rounding)["result"].undecided
        assert distance[~undecided].max() <= 2 * metrics.FAR_STEPS, driver.name


ALL = {
    "rotation": 17.0,
    "squeeze": 0.7,
    "bleeding_bias": 0.05,
    "bleeding_mult": 12.0,
    "camera": methods.Camera(0.12, 0.05, 4.0, sensor_height=0.02, max_coc=0.25),
}
ADAPTIVE = {"spacing": 1.5, "max_samples": 5, "jitter": 1.0, "frame": 61}
WHOLE = {
    "paper": Settings("paper", "hexagon", 8, **ALL),
    "paper star": Settings("paper", "star", 4, blur_coc=False, **ALL),
    "paper adaptive": Settings("paper", "pentagon", **ADAPTIVE, **ALL),
    "naive": Settings("naive", "octagon", 6, **ALL),
    "naive-grid": Settings("naive-grid", "square", 4, **ALL),
    "constant CoC": Settings("paper", "square", coc=0.2, **ALL),
    "exact, one target": Settings("exact", "decagon", targets=False, **ALL),
    "layered, one target": Settings("layered", "octagon", 7, targets=False, jitter=1.0, **ALL),
    **{f"exact {name}": Settings("exact", name, **ADAPTIVE, **ALL) for name in methods.EXACT},
    **{f"layered {name}": Settings("layered", name, 7, jitter=0.5, frame=3, **ALL) for name in methods.EXACT},
}


@pytest.mark.parametrize("method", ["paper", "naive", "constant", "exact", "layered"])
def test_every_entry(method, driver):
    """Every program of the package on every driver, everything away from its default: within the interval."""
    for name, settings in WHOLE.items():
        if name.startswith(method):
            within(driver, noise_case((45, 29), settings))


def test_every_entry_is_there():
    """In the table above, but for those of test_inputs.py, test_chromatic.py and test_debug_views."""
    drawn = {item.entry for settings in WHOLE.values() for item in methods.plan(settings, (61, 37)).passes}
    assert drawn | {"BokehLinearDepth", "BokehLateralColor", "BokehDebug"} == set(ENTRIES)


@spread("size", [(61, 37), (1, 1), (1, 64), (96, 2), (257, 33)], [(61, 37)])
@pytest.mark.parametrize("method", METHODS)
def test_sizes(method, size, driver):
    """Odd, tiny and thin images."""
    within(driver, noise_case(size, Settings(method, "hexagon", camera=CAMERA)))


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
@in_each_language
def test_settings(method, changes, driver):
    """Every parameter of the shaders away from its default, on random patches. That each matters: test_fuzz.py."""
    if method == "exact":
        # no star among the polygons with an even number of sides
        changes = {**changes, "aperture": changes.get("aperture", "hexagon").replace("star", "decagon")}
    settings = replace(Settings(method, "hexagon", camera=ALL["camera"]), **changes)
    _, comparison = within(driver, noise_case((60, 40), settings))
    if driver.software:
        assert comparison.close >= 0.98, comparison


def test_float_targets(driver):
    """32-bit targets: within the interval, and a thousand times closer than half floats could be."""
    case = noise_case((64, 48), Settings("paper", "hexagon", camera=CAMERA))
    output = result(driver, case, "float")
    assert output.dtype == np.float32
    wanted = Reference().images(case.plan.passes, case.textures(), case.size, "float", kind(driver))["result"]
    off = np.abs(output - wanted.value)
    assert (off <= wanted.error).all()
    if driver.software:
        assert np.median(off / np.maximum(wanted.value, 1e-3)) < 1e-6


def exact_case(aperture: str) -> Case:
    """Exact polygons: the second pass of the plan writes two to four targets, the third reads them all."""
    # powers of two: uv is exact in float32, and so is the CoC, which these passes copy
    return noise_case((64, 32), Settings("exact", aperture, rotation=17.0, camera=ALL["camera"]))


@pytest.mark.parametrize("storage", ["half", "float"])
@pytest.mark.parametrize("aperture", ["hexagon", "octagon", "decagon"])
def test_several_targets(aperture, storage, driver):
    """Two, three and four targets of one pass: each is what the reference has in its place."""
    case = exact_case(aperture)
    passes, names = case.plan.passes, case.plan.passes[1].outputs
    output = driver.run(passes, case.textures(), case.size, storage, keep=(*reversed(names), "result"))
    wanted = Reference().images(passes, case.textures(), case.size, storage, kind(driver), driver.rounding)
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


def test_first_pass_makes_hostile_pixels_safe(driver):
    """NaN, infinite, negative and denormal colour and depth: finite and >= 0 after the first pass, as documented."""
    colors, depths = (np.array(pairs)[:, 0] for pairs in (COLOR, DEPTH))
    color = np.ones((len(depths), len(colors), 4), np.float16)
    color[..., 0] = colors
    color[..., 1] = colors[: len(depths), None]
    color[..., 3] = np.nan
    depth = np.repeat(depths.astype(np.float32)[:, None], len(colors), axis=1)
    camera = methods.Camera(0.1, 0.05, 4.0, max_coc=0.25)
    case = Case("hostile", Settings(camera=camera), color, depth)
    output = driver.run(case.plan.passes, case.textures(), case.size, keep=("coc", "result"))
    coc = output["coc"].astype(np.float64)
    assert np.isfinite(coc).all() and (coc >= 0).all()
    wanted = np.array([counted for _, counted in COLOR], np.float16)
    np.testing.assert_array_equal(coc[0, :, 0], wanted)
    np.testing.assert_array_equal(coc[:, 0, 1], wanted[: len(depths)])
    limit = 0.1 * 0.05 / 3.95 / 0.024
    counted = [limit if metres > 1e6 else 0.25 for _, metres in DEPTH]
    np.testing.assert_allclose(coc[:, 0, 3], counted, rtol=2.0**-10)
    assert np.isfinite(output["result"]).all() and (output["result"] >= 0).all()


@pytest.mark.parametrize("mode", [0, 1, 2, 3])
def test_debug_views(mode, driver):
    """Section [9]: colour, depth, CoC, near and far field."""
    camera = methods.Camera(0.1, 0.05, 4.0, max_coc=0.2)
    case = noise_case((40, 30), Settings(camera=camera))
    parameters = {**camera.parameters(), "BokehDebugMode": float(mode)}
    view = Pass("BokehDebug", {"ColorSamp": "coc", "DepthSamp": "depth"}, "result", parameters)
    passes = [case.plan.passes[0], view]
    output = driver.run(passes, case.textures(), case.size)["result"]
    wanted = Reference().images(passes, case.textures(), case.size, rounding=driver.rounding)["result"].value
    # a colour is read at a rounded uv (mode 0) or takes half a dozen float32 roundings, and is stored once
    off = np.abs(output - wanted) / images.step(np.maximum(np.abs(wanted), 2.0**-10), np.float16)
    assert off.max() <= metrics.CLOSE_STEPS


def rejected(driver, around: float) -> dict[str, np.ndarray]:
    """One far, blurred pixel with a CoC of 2.5 pixels whose two samples fall on nearer ones at the depth `around`."""
    color = np.full((8, 16, 4), 9.0, np.float16)
    depth = np.full((8, 16), around, np.float32)
    color[4, 8, :3], depth[4, 8] = 0.5, 50.0
    settings = Settings("naive-grid", "square", 2, camera=methods.Camera(0.3, 0.05, 2.0, max_coc=1.0))
    case = Case("rejected", settings, color, depth)
    return driver.run(case.plan.passes, case.textures(), case.size, keep=("coc", "result"))


def test_every_sample_rejected(driver):
    """No centre sample, only focused nearer neighbours: the weights sum to zero, the centre pixel is the answer."""
    output = rejected(driver, 2.0)
    assert 2.0 < output["coc"][4, 8, 3] * 8 < 3.0, "the samples must miss the pixel itself"
    np.testing.assert_array_equal(output["result"][4, 8], output["coc"][4, 8])


def test_nearly_rejected_samples_still_count(driver):
    """Weights of a thousandth each: the mean is that of the samples, not of the centre."""
    output = rejected(driver, 1.9998)
    assert 0 < output["coc"][4, 7, 3] * 30.0 < 0.002
    np.testing.assert_allclose(output["result"][4, 8, :3].astype(float), 9.0, rtol=2.0**-10)


def test_depth_of_a_tenth_of_a_millimetre(driver):
    """Depth is in metres, but nothing is wrong with a scene a millimetre deep."""
    camera = methods.Camera(1e-6, 1e-5, 1e-3, sensor_height=1e-6, max_coc=1.0)
    depth = np.array([[1e-4, 5e-4, 2e-3, 1e-5]], np.float32)
    case = Case("tiny", Settings(camera=camera), np.ones((1, 4, 4), np.float16), depth)
    coc = driver.run(case.plan.passes[:1], case.textures(), case.size, keep=("coc",))["coc"][0, :, 3]
    wanted = listings.circle_of_confusion(depth[0].astype(float), 1e-6, 1e-5, 1e-3, 1e-6, 1.0)
    np.testing.assert_allclose(coc.astype(float), wanted, rtol=1.1 * 2.0**-10)


def test_unknown_parameter_is_refused(driver):
    """A misspelt parameter must not fall back to its default."""
    misspelt = Pass("BokehConstantCoC", {"ColorSamp": "color"}, "result", {"BokehCoC": 1.0})
    with pytest.raises(KeyError):
        driver.run([misspelt], {"color": np.ones((2, 2, 4), np.float16)}, (2, 2))
