"""Test the exact polygons and the adaptive line: light, quality and noise. test_character.py tests their tiling."""

from dataclasses import replace

import numpy as np
import pytest
from formulas import noise
from support import in_each_language, load
from support_cases import CAMERA, float_result, noise_case, result

from bokeh_validation import metrics, truth
from bokeh_validation.frame import methods
from bokeh_validation.frame.methods import Settings
from bokeh_validation.probes import exact, highlight, shapes
from bokeh_validation.probes.model import depth_of
from bokeh_validation.shaders.passes import Pass
from bokeh_validation.truth import ray_traced

EXACT = tuple(methods.EXACT)


def test_noise_has_no_bias():
    """Check that interleaved gradient noise is uniform over -0.5 to 0.5, and different in every frame."""
    for frame in (0, 1, 63):
        value = noise((256, 128), frame)
        counts, _ = np.histogram(value, bins=10, range=(-0.5, 0.5))
        assert counts.min() > 0.9 * value.size / 10 and counts.max() < 1.1 * value.size / 10
    assert np.abs(noise((64, 64), 0) - noise((64, 64), 1)).mean() > 0.2
    np.testing.assert_array_equal(noise((64, 64), 3), noise((64, 64), 67))


# ----------------------------------------------------------------------------------------------------------------------
# on the drivers
# ----------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("aperture", EXACT)
@in_each_language
def test_light_on_float_targets(aperture, driver):
    """Check that an isolated highlight keeps its light to 0.002 on float32 targets, and its shape, at every rotation.

    Bilinear samples distribute the light completely. The remaining error is the sampler's: with 8 bits of sub-texel
    precision each of 1000 samples may be off by 1/512 of a texel at random, which averages to 1e-4.
    """
    for rotation in (0.0, 7.0, 22.5, 45.0):
        bokeh = exact.bokeh(aperture, rotation)
        value = float_result(driver, bokeh.case("", exact.settings(aperture, rotation)))[..., 1] - highlight.AMBIENT
        for check in bokeh.checks(f"{rotation:g} degrees", value / highlight.PEAK, 0.002, exact.OVERLAP[aperture]):
            assert check.ok, f"{check.name}: {check.value}"


@pytest.mark.parametrize("scene", ["street_11", "canopy_12"])
def test_nearer_to_brute_force_than_paper(scene):
    """Check that an octagon's tone-mapped PSNR against at least 900 samples of the polygon is 10 dB above the paper's.

    The CoC is the same everywhere: where it is not, `exact` weights a sample by the sample's CoC, and a gather does
    not.
    """
    driver = load("egl")
    chosen = next(s for s in ray_traced.DRIVER_SCENES if s.name == scene)
    cases = {method: ray_traced.scene_case(chosen, method, "octagon") for method in ("paper", "exact")}
    cases = {method: replace(case, settings=replace(case.settings, coc=0.04)) for method, case in cases.items()}
    found = {m: metrics.psnr(result(driver, one), shapes.brute_force(driver, one)) for m, one in cases.items()}
    assert found["exact"] - found["paper"] >= 10.0, found


@pytest.mark.parametrize(("scene", "better"), [("street_11", 1.2), ("canopy_12", 0.8)])
def test_nearer_to_the_truth_than_brute_force(scene, better):
    """Check that a hexagon is nearer to the ray-traced truth than the brute-force gather, and `better` dB above the
    paper.

    The brute-force gather cannot serve as a reference here, because `exact` weights a sample by the sample's CoC and
    the gather does not.
    """
    driver = load("egl")
    chosen = next(s for s in ray_traced.DRIVER_SCENES if s.name == scene)
    lens = ray_traced.truth(chosen, "hexagon")
    found = {m: metrics.psnr(truth.picture(driver, chosen, m), lens) for m in ("paper", "gather", "exact")}
    assert found["exact"] >= max(found["gather"], found["paper"] + better), found


# ----------------------------------------------------------------------------------------------------------------------
# noise
# ----------------------------------------------------------------------------------------------------------------------


def test_jitter_leaves_dense_samples_alone():
    """Check that samples a pixel apart get no random offsets, since there is no pattern to hide."""
    for aperture in EXACT:
        settings = Settings("exact", aperture, camera=CAMERA, spacing=1.0)
        cases = [noise_case((61, 48), replace(settings, jitter=jitter)) for jitter in (0.0, 1.0)]
        np.testing.assert_array_equal(*(result(load("egl"), case) for case in cases))


@pytest.mark.parametrize("name", ["egl", "wgpu", "d3d9"])
@pytest.mark.parametrize(
    ("method", "aperture", "targets"),
    [
        ("paper", "octagon", True),
        ("paper", "pentagon", True),
        ("exact", "hexagon", True),
        ("exact", "decagon", True),
        ("exact", "decagon", False),
    ],
)
def test_every_frame_and_pass_has_its_own_noise(method, aperture, targets, name):
    """Check that lines of `paper` are numbered, and that each pass has different noise in the next frame.

    One pass at a time gets the next frame's number; its result must change, so it uses its own. Noise repeats after 64
    frames.
    """
    driver = load(name)
    settings = Settings(method, aperture, camera=CAMERA, coc=0.3, spacing=1.0, samples=3, jitter=1.0)
    settings = replace(settings, use_mrt=targets)
    case = noise_case((61, 48), settings)
    following = replace(case, settings=replace(settings, frame=1)).plan.passes
    passes = case.plan.passes
    # the exact passes have fixed numbers: the second must differ from the first
    numbers = [render_pass.values()["BokehPassIndex"] for render_pass in passes[1:]]
    assert method == "exact" or numbers == list(range(len(numbers))), numbers
    written = [output for render_pass in passes for output in render_pass.outputs]
    before = driver.run(passes, case.textures(), case.size, keep=written)
    for index in range(1, len(passes)):
        changed = (*passes[:index], following[index], *passes[index + 1 :])
        after = driver.run(changed, case.textures(), case.size, keep=written)
        for output in passes[index].outputs:
            share = (after[output] != before[output]).any(axis=-1).mean()
            assert share > 0.5, (output, share)


@in_each_language
def test_noise_comes_again(driver):
    """Check that noise repeats after 64 frames, also at frame 2^22, where frame times 33/64 has no bits left for a
    fraction.
    """
    camera = methods.Camera(max_coc=1.0)
    settings = methods.Settings("exact", coc=0.5, camera=camera, samples=3, spacing=1.0, jitter=1.0)
    results = []
    for frame in (5, 64 + 5, 2**22 + 5, 6):
        case = noise_case((61, 48), replace(settings, frame=frame))
        results.append(driver.run(case.plan.passes, case.textures(), case.size)["result"])
    np.testing.assert_array_equal(results[1], results[0])
    np.testing.assert_array_equal(results[2], results[0])
    assert (metrics.steps(results[0], results[3]) > metrics.FAR_STEPS).mean() > 0.02


@pytest.mark.parametrize("method", ["paper", "exact"])
@in_each_language
def test_half_a_pixel_is_in_focus(method, driver):
    """Check that a CoC of up to half a pixel leaves the image bit-identical, and that one of a pixel blurs it."""
    camera = methods.Camera(max_coc=1.0)
    # so dense that a line of one pixel has several samples
    settings = methods.Settings(method, "hexagon", spacing=0.1, leak_fix=False, camera=camera)
    results = {}
    for coc in (0.3, 0.5, 1.0):
        # powers of two, so that uv and half a pixel are exact
        case = noise_case((64, 32), replace(settings, coc=coc / 32.0))
        results[coc] = driver.run(case.plan.passes, case.textures(), case.size, keep=("coc", "result"))
    for coc in (0.3, 0.5):
        np.testing.assert_array_equal(results[coc]["result"], results[coc]["coc"])
    assert (metrics.steps(results[1.0]["coc"], results[1.0]["result"]) > metrics.FAR_STEPS).mean() > 0.02


def test_a_line_of_no_length(driver):
    """Check that an adaptive line of length 0 off the pixel is a single sample there: the image is shifted.

    Everything is a power of two, so that uv and the sample's position are exact.
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
    # the CoC is 8 pixels, so the shift is 4 to the right and 2 up
    np.testing.assert_array_equal(output[2:, :-4, :3], color[:-2, 4:, :3])
