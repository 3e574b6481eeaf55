"""Test bad input on every driver: it is treated as docs/inputs.md says, and changes only the pixels that
it can reach.
"""

from dataclasses import replace
from itertools import product

import numpy as np
from invalid_input import COLOR, DEPTH, sprinkled
from support import NIGHTLY, spread
from support_cases import everything, within

from bokeh_validation import drivers, paths
from bokeh_validation.frame.methods import Camera, Settings
from bokeh_validation.probes import cases
from bokeh_validation.probes.model import Case
from bokeh_validation.reference.listings import MAX_DEPTH, safe_color

SIZE = (96, 64)
CAMERA = Camera(0.08, 0.05, 4.0, max_coc=0.12)
METHODS = cases.tagged(cases.BAD_INPUT, CAMERA)
# One case of bad input that runs on every driver
EVERYWHERE = ("exact hexagon", "layered hexagon")
# Methods whose CoC is signed
SIGNED = ("exact", "layered")
# Textures of layered with the mean logarithm of brightness in blue, which may be negative
LEVELS = ("tiles", "tiles along rows", "dilated tiles")
# The engine's alpha, which is ignored
ALPHA = (np.nan, np.inf, -np.inf)


# ----------------------------------------------------------------------------------------------------------------------
# single bad pixels
# ----------------------------------------------------------------------------------------------------------------------


def scene(method: str) -> tuple[Case, Case]:
    """Return an image with one pixel of every bad value, and the same with the values that these are treated as.

    Random colour over a slope with steps: CoC from 0 to 6 texels, and every outcome of the leakage test.
    """
    random = np.random.default_rng(5)
    width, height = SIZE
    color = random.lognormal(0.0, 0.7, (height, width, 4)).astype(np.float16)
    steps = np.kron(random.choice([0.7, 1.0], (8, 12)), np.ones((8, 8)))
    depth = (np.linspace(2.5, 9.0, width) * steps).astype(np.float32)
    bad, counted = (Case("", METHODS[method], color.copy(), depth.copy()) for _ in range(2))
    places = iter([(9 + 15 * row, 8 + 16 * column) for row in range(4) for column in range(6)])
    for wrong, right in COLOR:
        place = next(places)
        bad.color[place][:3], counted.color[place][:3] = wrong, right
    for wrong, right in DEPTH:
        place = next(places)
        bad.depth[place], counted.depth[place] = wrong, right
    for value in ALPHA:
        bad.color[next(places)][3] = value
    return bad, counted


def differing(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return (H, W) bool: pixels that are not bit-identical, ignoring the sign of 0."""
    return (a != b).any(axis=-1)


def assert_safe(found: dict[str, np.ndarray], settings: Settings) -> None:
    """Check that every number of every texture is finite and not negative, except a signed CoC, and LEVELS."""
    for name, pixels in found.items():
        assert np.isfinite(pixels).all(), f"{name}: {np.count_nonzero(~np.isfinite(pixels))} numbers are not finite"
        numbers = pixels[..., : 2 if name in LEVELS else 3] if settings.method in SIGNED else pixels
        assert (numbers >= 0).all(), f"{name}: {np.count_nonzero(numbers < 0)} numbers are negative"


def assert_right(driver: drivers.Driver, case: Case) -> None:
    """Check that all textures are safe and the result is within the reference's interval."""
    assert_safe(everything(driver, case), case.settings)
    within(driver, case)


@spread("method", METHODS, EVERYWHERE)
def test_bad_pixels_count_as_documented(method, driver):
    """Check that every texture of every pass is bit-identical to that with the documented replacement values."""
    actual, expected = (everything(driver, case) for case in scene(method))
    assert_safe(actual, METHODS[method])
    for name in actual:
        where = np.argwhere(differing(actual[name], expected[name]))
        assert not len(where), f"{name}: {len(where)} pixels, the first in row, column {where[0]}"


@spread("method", METHODS)
def test_damage_is_confined(method, driver):
    """Check that one bad pixel in a wide image changes nothing farther away than the passes reach, bit for bit.

    In other methods each pass reads texels within a CoC and the texels next to them. In layered, a pixel changes its
    tile; the largest CoC spreads over R = ceil(largest / 16) + 2 tiles, and the mean CoC of a layer over R more. A
    tile is read through the linear filter, which adds a tile, three times: for the split, for the layer CoC, for the
    last passes. Then a CoC is added once more, with the texels of half and quarter size around it.
    """
    random, largest = np.random.default_rng(4), 8
    color = random.lognormal(0.0, 0.7, (16, 256, 4)).astype(np.float16)
    depth = random.uniform(2.5, 9.0, (16, 256)).astype(np.float32)
    clean = Case("clean", replace(METHODS[method], camera=replace(CAMERA, max_coc=0.5)), color, depth)
    farthest = (len(clean.plan.passes) - 1) * (largest + 2)
    if clean.settings.method == "layered":
        tiles = 2 * (np.ceil(largest / 16) + 2) + 1 + 3
        farthest = int(8 * tiles + largest + 8)
    plain = everything(driver, clean)["result"]
    for texture in ("color", "depth"):
        for value in (np.nan, np.inf):
            case = replace(clean, color=color.copy(), depth=depth.copy())
            getattr(case, texture)[8, 20] = value
            changed = differing(everything(driver, case)["result"], plain)
            assert changed[8, 20]
            assert np.flatnonzero(changed.any(axis=0)).max() <= 20 + farthest < 220, (texture, value)


# ----------------------------------------------------------------------------------------------------------------------
# a third of all pixels bad: cameras, sample counts, sizes
# ----------------------------------------------------------------------------------------------------------------------


def littered(size: tuple[int, int], settings: Settings, share: float = 0.3) -> Case:
    """Return random colour and depth with a fraction `share` of bad numbers, also in alpha. `size` is
    (width, height).
    """
    random = np.random.default_rng(11)
    width, height = size
    color = random.lognormal(0.0, 1.0, (height, width, 4)).astype(np.float16)
    depth = random.choice([0.5, 2.0, 4.0, 30.0], (height, width)).astype(np.float32)
    return Case("littered", settings, sprinkled(random, color, COLOR, share), sprinkled(random, depth, DEPTH, share))


@spread("method", METHODS)
def test_in_focus_nothing_changes(method, driver):
    """Check that with a CoC of 0 everywhere the safe colours come out bit-identical.

    64 and 32 are powers of two, so that uv is exact in float32, and the linear filter at a texel's centre is a copy.
    """
    case = littered((64, 32), replace(METHODS[method], camera=replace(CAMERA, max_coc=0.0)))
    found = everything(driver, case)
    np.testing.assert_array_equal(found["result"][..., :3], safe_color(case.color[..., :3]).astype(np.float16))
    np.testing.assert_array_equal(found["result"][..., 3], 0.0)


# Shader model 3 limits a loop to 254 iterations; render.py allows 1024, and kernels of 8192 offsets
MOST_SAMPLES = {"d3d9": 254}
# Samples along a side: 90 x 90 = 8100 offsets in the kernel; 24 is the largest grid of the paper's Table 1
MOST_SIDE = {"naive": 90, "naive grid": 24}


COUNTS = ("paper hexagon", "paper pentagon", "exact, preset", "exact hexagon", "naive", "naive grid")


@spread("method,count", product(COUNTS, ["fewest", "most"]), nightly_drivers=MOST_SAMPLES)
def test_sample_counts(method, count, driver):
    """Check two samples on a line, and the maximum: 254 in shader model 3, 1024 elsewhere."""
    samples = 2 if count == "fewest" else MOST_SIDE.get(method, MOST_SAMPLES.get(driver.name, 1024))
    settings = replace(METHODS[method], aperture="square", samples=samples)
    if settings.spacing:
        # a hundredth of a pixel, so that the blur needs more samples than the maximum
        settings = replace(settings, spacing=0.01)
    assert_right(driver, littered((9, 7), settings, 0.1))


@spread("aperture", ["octagon", "decagon"], nightly_drivers=NIGHTLY)
def test_clipped_highlights_do_not_overflow(aperture, driver):
    """Check that colours of 65504 and 65472, the two largest half floats, do not overflow when targets are drawn one
    by one.

    If one target is rounded down and the next one up, by 16 each, a sum of three exceeds 65520 and would become
    infinite.
    """
    random = np.random.default_rng(2)
    color = random.choice(np.array([65504.0, 65472.0]), (16, 16, 4)).astype(np.float16)
    depth = np.ones((16, 16), np.float32)
    for rotation in (0.0, 20.0, 45.0):
        settings = Settings("exact", aperture, None, rotation, Camera(max_coc=1.0), coc=0.3, use_mrt=False)
        assert_right(driver, Case("clipped", settings, color, depth))


# ----------------------------------------------------------------------------------------------------------------------
# parameters out of range
# ----------------------------------------------------------------------------------------------------------------------

CAMERA_ONLY = ("paper hexagon", "exact, preset")
LINES = ("paper pentagon",)
COUNTED = ("paper pentagon", "exact hexagon", "layered hexagon")
ALL = ("paper hexagon", "exact hexagon", "exact decagon, one target", "naive", "layered hexagon", "layered, one target")
CHARACTER = ("exact octagon, cut",)
READERS = cases.tagged(cases.COVERAGE, CAMERA)
# Parameter -> methods that read it in different places, and values that it may have by mistake or before a frame sets
# it
MISTAKES = {
    "BokehApertureDiameter": (CAMERA_ONLY, (-1.0, 1e30)),
    "BokehFocalLength": (CAMERA_ONLY, (-0.05, 0.0, 1e30)),
    "BokehFocusDistance": (CAMERA_ONLY, (-1.0, 0.0, 1e30, float("inf"))),
    "BokehSensorHeight": (CAMERA_ONLY, (-1.0, 0.0)),
    "BokehMaxCoC": (ALL, (2.0, 1e4)),
    "BokehAspectRatio": (ALL, (0.0, -1.5, 1e-6, 7.0, 1e30)),
    "BokehAngle": (ALL, (1e4, 1e9)),
    "BokehBleedingBias": (ALL, (-1.0, -0.02, 1e30)),
    "BokehBleedingMult": (ALL, (0.0, -30.0, 1e30)),
    "BokehLineLength": (LINES, (0.0, -1.0, 1e30)),
    "BokehLineCenterX": (LINES, (1e30,)),
    "BokehSqueeze": (ALL, (0.0, -1.0, 1e30)),
    "BokehSpacing": (COUNTED, (-1.0, 1e-30, 1e30)),
    "BokehImageWidth": (COUNTED, (0.0, -64.0)),
    "BokehImageHeight": (COUNTED, (0.0, -64.0, 1e30)),
    "BokehJitter": (COUNTED, (-5.0, 5.0, 1e30)),
    "BokehFrame": (COUNTED, (-1.0, 1e9)),
    "BokehPassIndex": (LINES, (-1.0, 1e9)),
    "BokehCatsEye": (CHARACTER, (-1.0, 1e30)),
    "BokehRoundness": (CHARACTER, (-1.0, 1e30)),
    "BokehLateral": (("lateral",), (1.0, -1.0, 1e30)),
    **{f"Bokeh{side}Range": (("exact, focus",), (-1.0, 1e30)) for side in ("Front", "Back")},
    **{f"Bokeh{side}Scale": (("exact, focus",), (-1.0, 1e30)) for side in ("Near", "Far")},
    **{f"Bokeh{side}MaxCoC": (("exact, focus",), (-1.0, 1e30)) for side in ("Near", "Far")},
    **{f"BokehDepth{part}": (("exact, focus",), (-1.0, 0.0, 1e30)) for part in ("X", "Y", "Width", "Height")},
    "BokehConstantCoC": (("constant CoC",), (-1.0, 5.0, 1e30)),
    "BokehSides": (("exact decagon, one target", "layered, one target"), (1.0, 2.0, -6.0, 5.0, 1e30)),
}


@spread("name", MISTAKES)
def test_parameters_out_of_range(name, driver):
    """Check that the result is finite and not negative, also with bad pixels; it need not be a useful blur."""
    readers, values = MISTAKES[name]
    for method in readers:
        case = littered((24, 16), READERS[method], 0.1)
        for value in values:
            try:
                assert_safe(everything(driver, case, **{name: value}), case.settings)
            except AssertionError as error:
                raise AssertionError(f"{method}, {name} {value:g}: {error}") from error


# method, a parameter out of range, and the value that docs/inputs.md says it is treated as
EQUIVALENTS = [
    ("exact hexagon", "BokehImageHeight", -64.0, 0.0),
    ("paper hexagon", "BokehBleedingMult", -30.0, 0.0),
    ("paper hexagon", "BokehFocusDistance", -1.0, 0.0),
    ("paper hexagon", "BokehFocusDistance", float("inf"), 1e9),
    ("paper hexagon", "BokehFocusDistance", 3.4e38, 1e9),
    ("paper hexagon", "BokehApertureDiameter", -1.0, 0.0),
    ("paper hexagon", "BokehSensorHeight", -1.0, 0.0),
    ("exact decagon, one target", "BokehSides", 0.0, 6.0),
    ("layered, one target", "BokehSides", 0.0, 6.0),
]


@spread("method,name,wrong,right", EQUIVALENTS)
def test_parameters_count_as_documented(method, name, wrong, right, driver):
    """Check that both values give bit-identical results."""
    case = littered((24, 16), METHODS[method], 0.1)
    actual, expected = (everything(driver, case, **{name: value})["result"] for value in (wrong, right))
    assert not differing(actual, expected).any()


@spread("", [()])
def test_a_spacing_that_is_none_is_the_presets(driver):
    """Check that a spacing of 0 or less is bit-identical to the preset's 1.5 pixels.

    Lines are up to 32 pixels long, so that another spacing shows.
    """
    settings = replace(METHODS["exact, preset"], camera=replace(CAMERA, aperture_diameter=0.4, max_coc=0.5))
    case = littered(SIZE, settings, 0.1)
    found = {value: everything(driver, case, BokehSpacing=value)["result"] for value in (0.0, -1.0, 1.5, 3.0)}
    assert not any(differing(found[value], found[1.5]).any() for value in (0.0, -1.0))
    assert differing(found[3.0], found[1.5]).mean() > 0.1


# Rows of docs/inputs.md, Bad input: invalid value -> value that replaces it. The numbers are tested above: COLOR and
# DEPTH by test_bad_pixels_count_as_documented, parameters by EQUIVALENTS.
PAGE_ROWS = {
    "colour NaN or negative": "{color_nan:g}",
    "colour +infinite": "{color_infinite:g}",
    "depth NaN, 0 or negative": "{depth_nan:f} m",
    "depth above {most_depth:.0f} m, or infinite": "{depth_infinite:.0f} m",
    "stored depth NaN or below 0, kind 3": "{depth_infinite:.0f} m, the depth of the sky",
    "stored depth NaN or below 0, kind 8": "{depth_nan:f} m",
    "`BokehFocusDistance` not above the focal length": "{depth_nan:f} m more than the focal length",
    "`BokehFocusDistance` above {most_depth:.0f} m, or infinite": "{focus_infinite:.0f} m",
    "`BokehApertureDiameter` or `BokehBleedingMult` negative": "{aperture_negative:g}",
}


def test_page_has_what_is_tested():
    """Compare the table of docs/inputs.md with the numbers that COLOR, DEPTH and EQUIVALENTS test."""

    def counted(pairs, expected: float) -> float:
        """Return what a bad number is treated as; `wanted` may be NaN."""
        (actual,) = {right for wrong, right in pairs if wrong == expected or np.isnan(wrong) and np.isnan(expected)}
        return actual

    parameters = {(name, wrong): right for _, name, wrong, right in EQUIVALENTS}
    numbers = {
        "color_nan": counted(COLOR, np.nan),
        "color_infinite": counted(COLOR, np.inf),
        "depth_nan": counted(DEPTH, np.nan),
        "depth_infinite": counted(DEPTH, np.inf),
        "most_depth": MAX_DEPTH,
        "focus_infinite": parameters["BokehFocusDistance", float("inf")],
        "aperture_negative": parameters["BokehApertureDiameter", -1.0],
    }
    assert numbers["aperture_negative"] == parameters["BokehBleedingMult", -30.0]
    page = (paths.ROOT / "docs/inputs.md").read_text(encoding="utf-8").split("## Bad input")[1].split("\n## ")[0]
    rows = [line.strip("|").split("|") for line in page.splitlines() if line.startswith("|")][2:]
    expected = {left.format_map(numbers): right.format_map(numbers) for left, right in PAGE_ROWS.items()}
    assert {left: right for left, right in rows if left in expected} == expected
    # other rows are of parameters in EQUIVALENTS or have no number; a new row belongs in PAGE_ROWS
    assert len(rows) == len(expected) + 6
