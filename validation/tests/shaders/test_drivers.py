"""Test every driver against the float64 reference: scenes, targets, debug views, single samples."""

from dataclasses import replace

import numpy as np
import pytest
from support import LANGUAGES, load, nightly
from support_cases import within

from bokeh_validation.frame import aperture_shapes, methods
from bokeh_validation.frame.methods import Settings
from bokeh_validation.probes import cases, coverage_frames, judges
from bokeh_validation.probes.model import Case, depth_of
from bokeh_validation.shaders.passes import Pass
from bokeh_validation.truth import ray_traced

SHAPES = [
    *((method, aperture) for method in ("paper", "naive") for aperture in aperture_shapes.APERTURES),
    *(("exact", aperture) for aperture in methods.EXACT),
]
# a part of the ray-traced scenes with something in focus, near and far
PART = (slice(206, 270), slice(264, 344))


@pytest.mark.parametrize(("method", "aperture"), SHAPES)
@pytest.mark.parametrize("scene", ray_traced.DRIVER_SCENES, ids=lambda s: s.name)
def test_scenes(scene, method, aperture, all_drivers):
    """Compare each method and aperture with the reference on ray-traced scenes: all drivers on one, each language on
    both.
    """
    case = ray_traced.scene_case(scene, method, aperture)
    case = replace(case, color=case.color[PART].copy(), depth=case.depth[PART].copy())
    for driver in all_drivers if scene is ray_traced.DRIVER_SCENES[0] else map(load, LANGUAGES):
        _, comparison = within(driver, case)
        assert comparison.ok, f"{driver.name}: {comparison}"


CHAINED = ("paper pentagon", "naive", "exact octagon", "lateral", "layered hexagon", "layered, one target")


@pytest.mark.parametrize("name", CHAINED)
def test_passes_are_chained(name, driver):
    """Check that a frame drawn from end to end is bit-identical to each pass drawn alone on the frame's other targets.

    Together with each pass being judged alone on the reference's inputs (probes/judges.py), this covers the whole
    frame.
    """
    frame = coverage_frames.of_settings(cases.tagged(cases.ENTRIES)[name])
    names = [output for render_pass in frame.passes for output in render_pass.outputs]
    outputs = driver.run(frame.passes, frame.textures, frame.size, keep=names)
    for render_pass in frame.passes:
        read = {given: outputs.get(given, frame.textures.get(given)) for given in render_pass.inputs.values()}
        alone = driver.run([render_pass], read, frame.size, keep=render_pass.outputs)
        for output in render_pass.outputs:
            np.testing.assert_array_equal(alone[output], outputs[output])


def test_maps_depth_and_views(driver):
    """Check CoC maps through five lenses and with a constant, depth of every kind, and the debug views, also of a
    part.

    Each has invalid numbers, and extreme ones: a MaxCoC of 0 must not divide by 0.
    """
    frames = coverage_frames.all_frames()
    for label in (label for label in frames if label.startswith(("map", "constant", "view", "depth"))):
        for judge in judges.judges(label, frames[label], driver.precision, driver.rounding):
            assert not judge.objection(driver)


def rejected(driver, around: float) -> dict[str, np.ndarray]:
    """Draw a far, blurred pixel with a CoC of 2.5 pixels whose two samples hit nearer pixels at the depth `around`."""
    color = np.full((8, 16, 4), 9.0, np.float16)
    depth = np.full((8, 16), around, np.float32)
    color[4, 8, :3], depth[4, 8] = 0.5, 50.0
    settings = Settings("naive-grid", "square", 2, camera=methods.Camera(0.3, 0.05, 2.0, max_coc=1.0))
    case = Case("rejected", settings, color, depth)
    return driver.run(case.plan.passes, case.textures(), case.size, keep=("coc", "result"))


def test_every_sample_rejected(driver):
    """Check that the centre pixel is returned if the weights sum to zero: no centre sample, only nearer neighbours in
    focus.

    With weights of a thousandth each, the result is the samples' mean, not the centre.
    """
    output = rejected(driver, 2.0)
    assert 2.0 < output["coc"][4, 8, 3] * 8 < 3.0, "the samples must miss the pixel itself"
    np.testing.assert_array_equal(output["result"][4, 8], output["coc"][4, 8])
    output = rejected(driver, 1.9998)
    assert 0 < output["coc"][4, 7, 3] * 30.0 < 0.002
    np.testing.assert_allclose(output["result"][4, 8, :3].astype(float), 9.0, rtol=2.0**-10)


def test_unknown_parameter_is_refused():
    """Check that a misspelt parameter raises an error instead of using its default."""
    with pytest.raises(KeyError):
        Pass("BokehConstantCoC", {"ColorSamp": "color"}, "result", {"BokehCoC": 1.0}).values()


@pytest.mark.parametrize("count", [2, 127, 128, 129, 200, 256, 300])
@pytest.mark.parametrize("driver", [*LANGUAGES, pytest.param("d3d9", marks=nightly)], indirect=True)
def test_many_offsets(count, driver):
    """Check that each offset is read once from a table with more offsets than shader model 3 allows loop iterations.

    The offsets are whole pixels along a row, all different, with random values at the pixels.
    """
    width, coc = 1024, 0.5
    random = np.random.default_rng(count)
    color = np.ones((2, width, 4), np.float16)
    color[..., :3] = random.integers(0, 2, (2, width, 1))
    places = random.permutation(count) - count // 2
    # a width is 1 in uv; offsets are the CoC over an aspect ratio of 512, so a pixel is 1 / 1024 of uv
    kernel = np.zeros((1, count, 4), np.float32)
    kernel[0, :, 0] = places / width / coc * (width / 2)
    first = Pass("BokehConstantCoC", {"ColorSamp": "color"}, "coc", {"BokehConstantCoC": coc, "BokehMaxCoC": 1.0})
    inputs = {"ColorSamp": "coc", "DepthSamp": "depth", "KernelSamp": "kernel"}
    parameters = {"BokehAspectRatio": width / 2, "BokehBleedingBias": 1.0}
    gather = Pass("BokehNaiveGather", inputs, "result", parameters, samples=count)
    textures = {"color": color, "depth": depth_of((width, 2), 5.0), "kernel": kernel}
    output = driver.run([first, gather], textures, (width, 2), "float")["result"]
    expected = np.mean(
        [color[:, np.clip(np.arange(width) + place, 0, width - 1), 0] for place in places], axis=0, dtype=float
    )
    # Weights are 1, and sums of 0 and 1 are exact. A position is off by three roundings of 2^-24 of 1024 texels, and
    # the filter with it, 1.8e-4; a sample that is left out changes the mean by at least 1.6e-3.
    np.testing.assert_allclose(output[..., 0], expected, atol=2.0**-11)
