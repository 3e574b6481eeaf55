"""Test inputs as engines have them: every convention and format gives the same depth, every camera the
documented CoC.
"""

import numpy as np
import pytest
from support import NIGHTLY, load, spread
from support_cases import CAMERA, noise_case

from bokeh_validation.frame import methods
from bokeh_validation.probes.model import flat
from bokeh_validation.reference import listings
from bokeh_validation.shaders.passes import Pass

NEAR, FAR = 0.1, 200.0
# float32: the formulas' seven operations at 2^-24 each, where a division is 2.5 (Vulkan's allowance)
ROUNDINGS = 12 * 2.0**-24
# Vulkan and WebGPU allow log2 to be off by 3 steps of 2^-23, exp2 by 3 + 2 x, where x = log2(1 + FAR) < 8; plus 3
# roundings
LOGARITHM_ROUNDINGS = 8 * np.log(2) * 4 * 2.0**-23 + (3 + 2 * 8) * 2.0**-23 + 3 * 2.0**-24
# Formats -> steps of fixed point from 0 to 1; 0 for float32
FORMATS = {"32 bit float": 0, "24 bit": 2**24 - 1, "16 bit": 2**16 - 1}
# Depths in metres, (24, 40), from just behind the near plane to just in front of the far plane
METRES = np.geomspace(NEAR * 1.01, FAR * 0.99, 24 * 40).reshape(24, 40)


def slope(metres: np.ndarray, kind: int) -> np.ndarray:
    """Return the derivative of metres by the stored value at a distance, for a convention."""
    perspective = metres**2 * (FAR - NEAR) / (NEAR * FAR)
    return {
        0: np.ones_like(metres),
        1: perspective,
        2: perspective,
        3: metres**2 / NEAR,
        4: perspective / 2,
        5: np.full_like(metres, FAR - NEAR),
        6: np.full_like(metres, FAR - NEAR),
        7: np.full_like(metres, FAR),
        8: (metres + 1.0) * np.log1p(FAR),
    }[kind]


def linearised(driver, depth, kind: int, near: float = NEAR, far: float = FAR) -> np.ndarray:
    """Run BokehLinearDepth on rows of numbers, or of texels (H, W, 4); returns metres."""
    depth = np.array(depth, np.float32)
    parameters = {"BokehDepthKind": float(kind), "BokehNear": near, "BokehFar": far}
    item = Pass("BokehLinearDepth", {"DepthSamp": "depth"}, "linear", parameters)
    return driver.run([item], {"depth": depth}, depth.shape[1::-1], "float", keep=("linear",))["linear"][..., 0]


def coc_map(driver, camera: methods.Camera, values, entry: str = "BokehCoCMap") -> np.ndarray:
    """Return the CoC of some depths in metres on a driver; the colour is white."""
    depth = np.array([values], np.float32)
    item = Pass(entry, {"ColorSamp": "color", "DepthSamp": "depth"}, "coc", camera.parameters())
    textures = {"color": flat(depth.shape[::-1], 1.0), "depth": depth}
    coc = driver.run([item], textures, depth.shape[::-1], "float", keep=("coc",))["coc"][0]
    np.testing.assert_array_equal(coc[:, :3], 1.0)
    return coc[:, 3]


# metres and clip depth are not stored in fixed-point formats
CASES = [
    (kind, name)
    for kind in listings.DEPTH_KINDS.values()
    for name in FORMATS
    if name == "32 bit float" or kind not in (0, 4)
]


@spread("kind,name", CASES, nightly_drivers=NIGHTLY)
def test_same_depth_from_every_convention(kind, name, driver):
    """Check that depth is off by no more than the format's step times the formula's slope, plus float32's roundings."""
    steps = FORMATS[name]
    expected = listings.stored_depth(METRES, kind, NEAR, FAR)
    actual = linearised(driver, np.rint(expected * steps) / steps if steps else expected, kind).astype(np.float64)
    step = 0.5 / steps if steps else 2.0**-24 * np.abs(expected)
    # 2^-24 of 1 is added where a formula subtracts from far or from 1
    step = step + 2.0**-24 * np.maximum(np.abs(expected), 1.0 if kind in (1, 4, 6) else 0.0) * 3
    # the logarithm is that of metres + 1, and 1 is subtracted again
    rounded = LOGARITHM_ROUNDINGS * (METRES + 1.0) if kind == 8 else ROUNDINGS * METRES
    allowed = slope(METRES, kind) * step + rounded
    # the slope is taken at the wanted distance; if a step moves far, the curve gets steeper on the way
    allowed *= np.where(kind in (5, 6, 7, 8, 0), 1.0, 1.0 / np.maximum(1.0 - allowed / METRES, 1e-9))
    assert (np.abs(actual - METRES) <= allowed).all()
    # the bound is meaningful: the coarsest format, 16 bits, allows 1.6 %
    assert (allowed <= 0.016 * METRES).all()


@spread("", [()], nightly_drivers=NIGHTLY)
def test_ends_of_the_range(driver):
    """Check near plane, far plane and infinity, exactly at the ends of a buffer's range."""
    for kind, *ends in ((1, 0.0, 1.0), (2, 1.0, 0.0), (4, -1.0, 1.0), (5, 0.0, 1.0), (6, 1.0, 0.0)):
        # far - 1 (far - near) leaves near with the rounding of far, 2^-24 far / near relative
        np.testing.assert_allclose(linearised(driver, [ends], kind), [[NEAR, FAR]], rtol=4 * 2.0**-24 * FAR / NEAR)
    np.testing.assert_allclose(linearised(driver, [[0.0, 1.0]], 3), [[listings.MAX_DEPTH, NEAR]], rtol=1e-6)
    for kind in (7, 8):
        np.testing.assert_allclose(linearised(driver, [[1.0]], kind), FAR, rtol=LOGARITHM_ROUNDINGS * (FAR + 1.0) / FAR)


@spread("", [()], nightly_drivers=NIGHTLY)
def test_depth_weighted_by_opacity(driver):
    """Check metres of surfaces that were blended over each other with their opacity, as docs/inputs.md tells it.

    Stored in float32: 2^-24 for each of both channels, and 2.5 times that for the division. Where the opacity is below
    a half, invalid or not a number, there is the sky.
    """
    opacity = np.resize(np.float32([0.5, 0.6, 0.75, 1.0]), METRES.shape)
    color = np.stack([METRES * opacity, opacity, *np.zeros((2, *METRES.shape))], axis=-1).astype(np.float32)
    np.testing.assert_allclose(linearised(driver, color, listings.WEIGHTED), METRES, rtol=4.5 * 2.0**-24)
    color[..., 1] = np.resize(np.float32([0.0, 0.49, -1.0, np.nan, -np.inf]), METRES.shape)
    np.testing.assert_array_equal(linearised(driver, color, listings.WEIGHTED), np.float32(listings.MAX_DEPTH))
    # blended in order, from an opaque wall at 20 m: glass of a quarter at 10 m, then of a half at 2 m
    stored = np.array([20.0, 1.0])
    for metres, alpha in ((10.0, 0.25), (2.0, 0.5)):
        stored = np.array([metres * alpha, alpha]) + (1.0 - alpha) * stored
    expected = 2.0 * 0.5 + 0.5 * (10.0 * 0.25 + 0.75 * 20.0)
    np.testing.assert_allclose(linearised(driver, [[[*stored, 0.0, 0.0]]], listings.WEIGHTED), expected, rtol=1e-6)


# values that no camera stores
BAD = np.array([[np.nan, np.inf, -np.inf, -1e30, -2.0, 1e30, 1e9, 0.0, 1.0]], np.float32)


@spread("kind", listings.DEPTH_KINDS.values(), nightly_drivers=NIGHTLY)
def test_bad_depth_of_every_convention(kind, driver):
    """Check that any number goes through its formula, and the result is treated like metres in docs/inputs.md.

    Tolerances at the ends of the range: perspective formulas lose far / near there; with the logarithm a 1 is
    subtracted again. The result is finite even if far - near equals far in float32, or if the far plane is at infinity.
    """
    expected = listings.linear_depth(BAD.astype(np.float64), kind, NEAR, FAR)
    atol = LOGARITHM_ROUNDINGS if kind == 8 else 0.0
    np.testing.assert_allclose(linearised(driver, BAD, kind), expected, rtol=4 * 2.0**-24 * FAR / NEAR, atol=atol)
    metres = linearised(driver, BAD, kind, 1e-6, 1e5)
    assert (metres >= np.float32(listings.MIN_DEPTH)).all() and (metres <= listings.MAX_DEPTH).all()
    assert linearised(driver, [[1.0]], 1, 1e-6, 1e5) >= 0.9e5


CAMERAS = {
    "focus at the focal length": methods.Camera(0.05, 0.05, 0.05, max_coc=0.2),
    "focus in front of it": methods.Camera(0.05, 0.05, 0.01, max_coc=0.2),
    "focus at the camera": methods.Camera(0.05, 0.05, 0.0, max_coc=0.2),
    "focus at 1e9": methods.Camera(0.05, 0.05, 1e9, max_coc=0.2),
    "focus at the largest float": methods.Camera(0.05, 0.05, 3.4e38, max_coc=0.2),
    "focus at infinity": methods.Camera(0.05, 0.05, float("inf"), max_coc=0.2),
    "focus at the near plane": methods.Camera(0.05, 0.05, 0.1, max_coc=0.2),
    "a pinhole": methods.Camera(0.0, 0.05, 5.0, max_coc=0.2),
    "no lens": methods.Camera(0.05, 0.0, 5.0, max_coc=0.2),
    "no sensor": methods.Camera(0.05, 0.05, 5.0, sensor_height=0.0, max_coc=0.2),
    # 0 is replaced by BOKEH_MIN_DEPTH: not 0 / 0 in focus, and not infinite elsewhere with so small an aperture
    "no sensor, hardly an aperture": methods.Camera(2.0**-20, 0.0625, 4.0, sensor_height=0.0, max_coc=1.0),
    "MaxCoC 0": methods.Camera(0.05, 0.05, 5.0, max_coc=0.0),
    "MaxCoC 1": methods.Camera(0.05, 0.05, 5.0, max_coc=1.0),
    "a huge lens": methods.Camera(1e6, 1.0, 1.0000001, max_coc=1.0),
    "a scene a millimetre deep": methods.Camera(1e-6, 1e-5, 1e-3, sensor_height=1e-6, max_coc=1.0),
    "f / 16": methods.Camera(0.05 / 16.0, 0.05, 4.0, max_coc=0.25),
}
DEPTHS = (np.nan, -1.0, 0.0, 1e-5, 5e-4, 0.05, 0.1, 1.0, 2.0, 3.9, 4.0, 4.1, 5.0, 8.0, 100.0, 1e5, 1e9, np.inf)


@spread("name", CAMERAS)
def test_cameras(name, driver):
    """Check that every camera gives a finite CoC from 0 to MaxCoC, as documented.

    The signed CoC has the same magnitude, and is negative where the pixel is nearer than the focus, also for invalid
    depth.
    """
    camera = CAMERAS[name]
    coc = coc_map(driver, camera, DEPTHS)
    assert np.isfinite(coc).all() and coc.min() >= 0.0 and coc.max() <= camera.max_coc
    # the difference from the focal length is computed from float32 numbers
    depth = listings.safe_depth(np.float32(DEPTHS).astype(np.float64))
    values = vars(camera) | {"focus_distance": float(np.float32(camera.focus_distance))}
    expected = listings.circle_of_confusion(depth, *values.values())
    # S1 - f and S2 - S1 lose what they have in common: 2^-24 of the larger number, over the difference
    focus = min(camera.focus_distance, listings.MAX_DEPTH)
    lost = 2.0**-23 * focus / max(abs(focus - camera.focal_length), 1e-6)
    away = np.abs(depth - focus) >= 1e-6 * focus
    np.testing.assert_allclose(coc[away], expected[away], rtol=1e-5 + min(lost, 1.0), atol=1e-7)
    signed = coc_map(driver, camera, DEPTHS, "BokehSignedCoCMap")
    np.testing.assert_array_equal(signed, np.where(depth < focus, -coc, coc))


FOCUS = methods.Camera(0.0625, 0.0625, 4.0, sensor_height=0.03125, max_coc=0.25)


@spread("scale", [(1.0, 1.0), (0.0, 1.0), (1.0, 0.0), (0.5, 2.0)])
def test_focus_controls(scale, driver):
    """Check the focus controls: sharp from 3.5 to 5 m; outside, the CoC of a lens focused at the end of the range.

    It is multiplied by the side's factor, which may be 0, and limited to the side's maximum. Depth comes from a
    rectangle of a larger buffer, half of its width.
    """
    metres = np.array([[0.5, 1.0, 2.0, 3.0, 3.5, 3.75], [4.0, 4.5, 5.0, 6.0, 8.0, 1024.0]])
    controls = methods.Focus((0.5, 1.0), scale, (0.0625, 0.03125))
    place = {"BokehDepthX": 0.5, "BokehDepthY": 0.25, "BokehDepthWidth": 0.5, "BokehDepthHeight": 0.5}
    depth = np.full((4, 12), 100.0, np.float32)
    depth[1:3, 6:] = metres
    parameters = FOCUS.parameters() | controls.parameters() | place
    item = Pass("BokehSignedCoCMap", {"ColorSamp": "color", "DepthSamp": "depth"}, "coc", parameters)
    actual = driver.run([item], {"color": flat((6, 2), 1.0), "depth": depth}, (6, 2), "float", keep=("coc",))["coc"]
    near, far = (
        listings.circle_of_confusion(metres, *(vars(FOCUS) | {"focus_distance": end}).values()) for end in (3.5, 5.0)
    )
    near, far = np.minimum(scale[0] * near, 0.0625), np.minimum(scale[1] * far, 0.03125)
    expected = np.where(metres < 3.5, -near, np.where(metres > 5.0, far, 0.0))
    np.testing.assert_allclose(actual[..., 3], expected, rtol=ROUNDINGS, atol=2.0**-24)


@spread("kind", [5, 6])
def test_orthographic_camera_with_a_near_plane_below_zero(kind, driver):
    """Check the recipe of docs/inputs.md: adding a constant to the planes and the focus moves the camera, but no
    surface.
    """
    near, far, back = -2.0, 8.0, 3.0
    metres = np.linspace(near, far, 21)
    stored = (metres - near) / (far - near) if kind == 5 else (far - metres) / (far - near)
    moved = linearised(driver, [stored], kind, near + back, far + back)[0]
    # stored depth is off by half a step of float32 at 1, which stands for far - near metres
    np.testing.assert_allclose(moved, metres + back, rtol=ROUNDINGS, atol=2.0**-25 * (far - near))
    coc = coc_map(driver, methods.Camera(0.05, 0.05, 1.5 + back, max_coc=0.2), moved, "BokehSignedCoCMap")
    assert (coc[metres < 1.5] < 0.0).all() and (coc[metres > 1.5] > 0.0).all() and abs(coc[metres == 1.5]) < 1e-6


@pytest.mark.parametrize("method", ["exact", "layered"])
def test_glass_with_a_coc_of_its_own(method):
    """Check recipe 3 of docs/inputs.md: drawing the CoC into the map's alpha is bit-identical to using the glass's
    depth.

    In this image no pixel is 1.3 times as bright as its neighbour, because next to a light and on its rim the map has
    the light's CoC, which the recipe does not draw.
    """
    case, driver = noise_case((48, 32), methods.Settings(method, "hexagon", camera=CAMERA)), load("egl")
    case.color[..., :3] = 4.0 + 0.5 * case.color[..., :3].clip(0.0, 2.0)
    (first, *rest), glass = case.plan.passes, (slice(8, 24), slice(10, 30))
    depth = case.depth.copy()
    depth[glass] = 2.5
    recipe_1 = driver.run(case.plan.passes, {**case.textures(), "depth": depth}, case.size)["result"]
    opaque = driver.run([first], case.textures(), case.size, keep=("coc",))["coc"]
    own = driver.run([first], {**case.textures(), "depth": np.full_like(depth, 2.5)}, case.size, keep=("coc",))["coc"]
    opaque[glass][..., 3] = own[glass][..., 3]
    recipe_3 = driver.run(rest, {"coc": opaque}, case.size)["result"]
    np.testing.assert_array_equal(recipe_3, recipe_1)
    assert np.abs(recipe_3 - driver.run(case.plan.passes, case.textures(), case.size)["result"]).max() > 0.1
