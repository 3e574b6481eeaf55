"""Test the reference against closed forms, and the metrics against known distances."""

import formulas
import numpy as np
import pytest
from support_cases import noise_case

from bokeh_validation import metrics, paths, shaders
from bokeh_validation.frame import aperture_shapes, geometry, methods
from bokeh_validation.numerics import precision
from bokeh_validation.numerics.images import Image
from bokeh_validation.probes import cases, coverage_frames
from bokeh_validation.probes.cases import SWEEPS
from bokeh_validation.reference import execution, glsl, interpreter, kept, listings, pass_images
from bokeh_validation.reference.intervals import Interval
from bokeh_validation.shaders.passes import target_size


def test_circle_of_confusion_by_similar_triangles():
    """Derive the CoC in another way, c = A |v - v1| / v with the thin lens's image distances v, and compare."""
    aperture, focal, focus, sensor = 0.03, 0.05, 2.0, 0.024
    depth = np.array([0.6, 1.0, 1.7, 2.0, 3.0, 40.0])
    image = 1.0 / (1.0 / focal - 1.0 / depth)
    plane = 1.0 / (1.0 / focal - 1.0 / focus)
    diameter = aperture * np.abs(image - plane) / image
    got = listings.circle_of_confusion(depth, aperture, focal, focus, sensor, 10.0)
    np.testing.assert_allclose(got, diameter / sensor, rtol=1e-12, atol=1e-15)


def test_sines():
    """Check that the polynomial of the sines is exact to a tenth of precision.SINE, two turns either way."""
    angles = np.linspace(-4.0 * np.pi, 4.0 * np.pi, 1000).reshape(4, -1)
    run = interpreter.Run(glsl.library(shaders.text("glsl")), {}, {}, angles.shape[1])
    sines = run.result("BokehSines", [Interval(angles)], np.ones(angles.shape[1], bool))
    assert np.abs(sines.value - np.sin(angles)).max() < precision.SINE / 10


def test_leakage_weight():
    """Check that only a nearer and clearly sharper sample is reduced, by its own CoC."""
    weight = listings.leakage_weight
    assert weight(1.0, 0.01, 2.0, 0.1, 0.02, 30.0) == pytest.approx(0.3)
    assert weight(1.0, 0.0, 2.0, 0.1, 0.02, 30.0) == 0.0
    assert weight(1.0, 0.05, 2.0, 0.1, 0.02, 30.0) == 1.0
    assert weight(2.0, 0.0, 2.0, 0.1, 0.02, 30.0) == 1.0, "equal depth is not nearer"
    assert weight(1.0, 0.09, 2.0, 0.1, 0.02, 2.0) == 1.0, "within the bias"
    assert weight(3.0, 0.0, 2.0, 0.1, 0.02, 30.0) == 1.0, "behind"


def test_kernels_of_figure_4_and_table_1():
    """Check the kernels: 127 and 120 samples, the square grids of Table 1, all inside their shape."""
    hexagon, octagon = aperture_shapes.kernel("hexagon", 13), aperture_shapes.kernel("octagon", 13)
    assert len(hexagon) == 127 and len(octagon) == 120
    assert np.linalg.norm(hexagon, axis=1).max() == pytest.approx(0.5)
    assert np.abs(octagon).max() <= 0.5 and (np.abs(octagon).sum(axis=1) <= np.sqrt(0.5)).all()
    for count in (16, 64, 144, 256, 400, 576):
        side = int(np.sqrt(count))
        grid = aperture_shapes.kernel("square", side)
        assert len(grid) == count and grid.min() == pytest.approx(-0.5) and grid.max() == pytest.approx(0.5)
    for aperture in aperture_shapes.APERTURES:
        table = aperture_shapes.kernel(aperture, 13)
        assert len(np.unique(table.round(9), axis=0)) == len(table)
        np.testing.assert_allclose(table.mean(axis=0), 0.0, atol=1e-12)
    for aperture, sides in aperture_shapes.POLYGONS.items():
        polygon, table = aperture_shapes.regular_polygon(sides), aperture_shapes.kernel(aperture, 30)
        off = 0.5 * geometry.perimeter(polygon) / 29
        assert len(table) / 29**2 == pytest.approx(abs(geometry.signed_area(polygon)), abs=off)
        # reflected, and shifted by the mean, half a cell at most; a side is 0.5 cos(pi / sides) from the middle
        assert geometry.inside((1 + 1 / 29 / np.cos(np.pi / sides)) * polygon, *-table.T).all()


def test_compare_notices():
    """Check that a wrong image, a NaN and a deviation of 1 % are outside the interval."""
    random = np.random.default_rng(3)
    value = random.uniform(0.5, 2.0, (30, 30, 4)).astype(np.float16).astype(np.float64)
    good = Image(value, np.full_like(value, 2.0**-10), np.zeros((30, 30), bool))
    assert metrics.compare(value.astype(np.float16), good, True).ok
    broken = value.astype(np.float16)
    broken[3, 4, 1] = np.nan
    assert metrics.compare(broken, good, True).outside == 1
    assert not metrics.compare((value * 1.01).astype(np.float16), good, True).ok
    assert not metrics.compare((value * 1.01).astype(np.float16), good, False).ok


# Relative to the largest number in a texture. float64 rounds a few hundred operations by 2^-53 each. The shaders have
# pi with nine digits, at most 1.4e-9 too small, which moves a sample of an exact polygon 25 texels away by 3.5e-8.
ALIKE = {"paper": 1e-12, "naive": 1e-12, "naive-grid": 1e-12, "exact": 3.5e-8}


@pytest.mark.parametrize("method", ALIKE)
def test_formulas_and_programs_agree(method):
    """Check that formulas and shaders agree, pass by pass, in every setting.

    They are two independent ways to the result: one has an interval, the other never uses the shaders' text. Pixels
    are ignored where a comparison of Listing 3, or the side of a random offset, is within float32's error, so that it
    might be within float64's as well: at most one in twenty-five.
    """
    frames = [*cases.tagged(cases.COVERAGE).values(), *(one for group in SWEEPS.values() for one in group)]
    for settings in (one for one in frames if one.method == method):
        case = noise_case((61, 48), settings)
        computed = pass_images.alone(
            case.plan.passes, case.textures(), case.size, "half", precision.SOFTWARE, "nearest"
        )
        computed = case.textures() | computed.made
        uploaded = {name: Image(np.atleast_3d(pixels).astype(np.float64)) for name, pixels in computed.items()}
        for render_pass in case.plan.passes:
            inputs = {slot: uploaded[name] for slot, name in render_pass.inputs.items()}
            written = formulas.run_pass(render_pass, {slot: image.value for slot, image in inputs.items()})
            ran = kept.run_pass(render_pass, inputs, case.size, precision.SOFTWARE)
            for value, image in zip(written, ran, strict=True):
                difference = np.abs(value - image.value).max(axis=-1) / np.abs(value).max()
                assert difference[~image.undecided].max() <= ALIKE[method], (render_pass.entry, settings)
                assert image.undecided.mean() <= 0.04, (render_pass.entry, settings)


@pytest.mark.parametrize("is_part", [False, True], ids=["whole", "part"])
def test_alone(is_part):
    """Check that each interval of alone() covers one pass, from inputs without an interval, also inside a viewport."""
    frame = coverage_frames.of_settings(cases.PAPER, coverage_frames.PART_SIZE)
    frame = coverage_frames.in_part(frame) if is_part else frame
    given = frame.passes, frame.textures, frame.size, "half", precision.SOFTWARE, "zero"
    made, allowed = pass_images.alone(*given)
    for name, expected in pass_images.images(*given, given=made).items():
        for actual, value in zip(vars(allowed[name]).values(), vars(expected).values(), strict=True):
            np.testing.assert_array_equal(actual, value)


CHANGES = [
    {"jitter": 1.0, "squeeze": 0.7},
    {"aperture": "octagon", "cats_eye": 0.7, "use_mrt": False},
    {"preset": "low"},
    {"preset": "mobile"},
    {"method": "paper"},
    {"method": "exact", "spacing": 1.0, "cats_eye": 0.5},
    {"method": "naive", "samples": 7},
]


@pytest.mark.parametrize("share", [2.0**-14, 2.0**-8], ids=["little", "much"])
@pytest.mark.parametrize("changes", CHANGES, ids=str)
def test_intervals_hold_what_they_say(changes, share, monkeypatch):
    """Check that every pass stays within its interval if textures and sampler positions are off by as much as allowed.

    They are off in both directions, which leaves branches, loops and whole numbers open. With samplers a hundred times
    as far off some pass must leave its interval, so the interval is not too wide.
    """
    camera = methods.Camera(3.3, 0.05, 8.0, max_coc=0.9)
    settings = methods.Settings(**{"method": "layered", "aperture": "hexagon", "camera": camera, **changes})
    case = noise_case((41, 27), settings)
    computed, random = pass_images.images(case.plan.passes, case.textures(), case.size), np.random.default_rng(1)
    uploaded = {name: Image(np.atleast_3d(pixels).astype(np.float64)) for name, pixels in case.textures().items()}
    linear, times = execution.Texture.linear, 1.0

    def off_its_place(texture: execution.Texture, uv: Interval) -> Interval:
        if texture.precision is None:
            offset = random.choice([-1.0, 1.0], uv.value.shape) * precision.GPU.subtexel * times
            uv = Interval(uv.value + offset / np.array(texture.image.size)[:, None])
        return linear(texture, uv)

    monkeypatch.setattr(execution.Texture, "linear", off_its_place)
    left_interval = 0
    for render_pass in case.plan.passes[1:]:
        inputs = {slot: (uploaded | computed)[name].value for slot, name in render_pass.inputs.items()}
        errors = {slot: share * ("ColorSamp" in slot) * np.abs(value) for slot, value in inputs.items()}
        uncertain = {slot: Image(value, errors[slot]) for slot, value in inputs.items()}
        moved = {k: Image(value + errors[k] * random.choice([-1.0, 1.0], value.shape)) for k, value in inputs.items()}
        size = target_size(render_pass.scale, case.size)
        expected = execution.run_pass(render_pass, uncertain, size, precision.GPU)
        for times in (1.0, 100.0):
            for image, result in zip(expected, execution.run_pass(render_pass, moved, size, None), strict=True):
                outside = np.abs(result.value - image.value) > image.error
                assert times > 1.0 or not outside.any(), render_pass.entry
                left_interval += outside.sum()
    assert left_interval > 0 or share > 2.0**-10


def test_a_kept_pass_that_is_not_whole(tmp_path, monkeypatch):
    """Check that a truncated file in the cache is recomputed with the same numbers."""
    monkeypatch.setattr(paths, "cache_folder", lambda: tmp_path)
    case = noise_case((9, 7), cases.PAPER)
    item = case.plan.passes[0]
    inputs = {"ColorSamp": Image(case.color.astype(float)), "DepthSamp": Image(case.depth[..., None].astype(float))}
    first = kept.run_pass(item, inputs, case.size, precision.SOFTWARE)
    (file,) = (tmp_path / kept.FOLDER).iterdir()
    file.write_bytes(file.read_bytes()[:400])
    again = kept.run_pass(item, inputs, case.size, precision.SOFTWARE)
    np.testing.assert_array_equal(first[0].value, again[0].value)
    assert len(file.read_bytes()) > 400
