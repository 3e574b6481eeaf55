"""Inputs as engines have them: every depth convention and format gives the same depth and the same CoC."""

import numpy as np
import pytest
from support import in_each_language

from bokeh_validation.frame import methods
from bokeh_validation.probes.model import flat
from bokeh_validation.reference import listings
from bokeh_validation.reference.precision import FLOAT_STEP
from bokeh_validation.shaders.passes import Pass

NEAR, FAR = 0.1, 200.0
CAMERA = methods.Camera(0.05, 0.05, 5.0, max_coc=1.0)
# float32: seven operations of the formulas at 2^-24 each, a division counts for 2.5 (Vulkan's allowance)
ROUNDINGS = 12 * 2.0**-24
# Vulkan and WebGPU let log2 be off by 3 steps, exp2 by 3 + 2 x of 2^-23, where x = log2(1 + FAR) < 8; and 3 roundings
LOGARITHM_ROUNDINGS = 8 * np.log(2) * 4 * 2.0**-23 + (3 + 2 * 8) * 2.0**-23 + 3 * 2.0**-24
# Formats: largest distance of a stored number from the wanted one
FORMATS = {
    "32 bit float": lambda d: 2.0**-24 * np.abs(d),
    "24 bit": lambda d: np.full_like(d, 0.5 / (2**24 - 1)),
    "16 bit": lambda d: np.full_like(d, 0.5 / (2**16 - 1)),
}


def quantised(depth: np.ndarray, name: str) -> np.ndarray:
    """Depth 0 .. 1 or -1 .. 1 in a depth format, as float32 again, as a shader reads it."""
    if name == "32 bit float":
        return depth.astype(np.float32)
    steps = {"24 bit": 2**24 - 1, "16 bit": 2**16 - 1}[name]
    return (np.rint(depth * steps) / steps).astype(np.float32)


def distances() -> np.ndarray:
    """A scene's depths, (24, 40) metres, from just behind the near plane to just before the far one."""
    return np.geomspace(NEAR * 1.01, FAR * 0.99, 24 * 40).reshape(24, 40)


def slope(metres: np.ndarray, kind: int) -> np.ndarray:
    """Metres for each unit of what the buffer holds, at a distance: the formulas' derivatives."""
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


def linear_pass(kind: int, near: float = NEAR, far: float = FAR) -> Pass:
    """`BokehLinearDepth` from "depth" to "linear"."""
    parameters = {"BokehDepthKind": float(kind), "BokehNear": near, "BokehFar": far}
    return Pass("BokehLinearDepth", {"DepthSamp": "depth"}, "linear", parameters)


def linearised(driver, depth: np.ndarray, kind: int, near: float = NEAR, far: float = FAR) -> np.ndarray:
    """BokehLinearDepth on a driver, (H, W) float32."""
    item = linear_pass(kind, near, far)
    return driver.run([item], {"depth": depth}, depth.shape[::-1], "float", keep=("linear",))["linear"][..., 0]


# metres and clip depth are not kept in fixed-point formats
CASES = [
    pytest.param(kind, name, id=f"{kind_name}, {name}")
    for kind_name, kind in listings.DEPTH_KINDS.items()
    for name in FORMATS
    if name == "32 bit float" or kind not in (0, 4)
]


@pytest.mark.parametrize(("kind", "name"), CASES)
def test_same_coc_from_every_convention(kind, name, driver):
    """Depth is off by no more than the format's step times the formula's slope and float32; the CoC by what follows.

    d CoC / d S2 = A f / (S1 - f) S1 / S2^2 / sensor height.
    """
    metres = distances()
    wanted = listings.stored_depth(metres, kind, NEAR, FAR)
    stored = quantised(wanted, name)
    color = np.ones((*stored.shape, 4), np.float16)
    coc_map = Pass("BokehCoCMap", {"ColorSamp": "color", "DepthSamp": "linear"}, "coc", CAMERA.parameters())
    textures, keep = {"color": color, "depth": stored}, ("linear", "coc")
    outputs = driver.run([linear_pass(kind), coc_map], textures, stored.shape[::-1], "float", keep)
    found = outputs["linear"][..., 0].astype(np.float64)
    # 2^-24 of 1 enters where a formula subtracts from far or from 1
    step = FORMATS[name](wanted) + 2.0**-24 * np.maximum(np.abs(wanted), 1.0 if kind in (1, 4, 6) else 0.0) * 3
    # the logarithm is taken of metres + 1, and 1 subtracted again
    rounded = LOGARITHM_ROUNDINGS * (metres + 1.0) if kind == 8 else ROUNDINGS * metres
    allowed = slope(metres, kind) * step + rounded
    # the slope is that at the wanted distance: where a step moves far, the curve is steeper on the way
    allowed *= np.where(kind in (5, 6, 7, 8, 0), 1.0, 1.0 / np.maximum(1.0 - allowed / metres, 1e-9))
    assert (np.abs(found - metres) <= allowed).all()
    wanted_coc = listings.circle_of_confusion(metres, *vars(CAMERA).values())
    magnification = CAMERA.focal_length / (CAMERA.focus_distance - CAMERA.focal_length)
    per_metre = CAMERA.aperture_diameter * magnification * CAMERA.focus_distance / CAMERA.sensor_height
    allowed_coc = per_metre * allowed / (metres * (metres - allowed))
    off = np.abs(outputs["coc"][..., 3] - wanted_coc)
    assert (off <= allowed_coc + listings.COC_ROUNDINGS * FLOAT_STEP * wanted_coc).all()
    # it says something: the coarsest, 16 orthographic bits at the near plane, leave open 2 % of the height, of 100 %
    assert allowed_coc.max() < 0.02


def test_ends_of_the_range(driver):
    """The near plane, the far plane and infinity, exactly at the ends of what a buffer can hold."""
    for kind, near_value, far_value in ((1, 0.0, 1.0), (2, 1.0, 0.0), (4, -1.0, 1.0), (5, 0.0, 1.0), (6, 1.0, 0.0)):
        ends = linearised(driver, np.array([[near_value, far_value]], np.float32), kind)[0]
        # far - 1 (far - near) leaves near with the rounding of far: 2^-24 far / near of it
        np.testing.assert_allclose(ends, [NEAR, FAR], rtol=4 * 2.0**-24 * FAR / NEAR)
    sky = linearised(driver, np.array([[0.0, 1.0]], np.float32), 3)[0]
    np.testing.assert_allclose(sky, [listings.MAX_DEPTH, NEAR], rtol=1e-6)
    for kind in (7, 8):
        far = linearised(driver, np.ones((1, 1), np.float32), kind)[0, 0]
        np.testing.assert_allclose(far, FAR, rtol=LOGARITHM_ROUNDINGS * (FAR + 1.0) / FAR)


# nothing that a camera stores
BAD = np.array([[np.nan, np.inf, -np.inf, -1e30, -2.0, 1e30, 1e9, 0.0, 1.0]], np.float32)


@pytest.mark.parametrize("kind", listings.DEPTH_KINDS.values(), ids=listings.DEPTH_KINDS)
def test_bad_depth_of_every_convention(kind, driver):
    """Any number goes through its formula, and what comes out counts as docs/inputs.md says of metres.

    Tolerance of the ends of the range: the formulas of perspective lose far / near there. Of the logarithm: a 1 is
    subtracted again. Where far - near is far in float32, finite all the same, and so is a far plane at infinity.
    """
    wanted = listings.linear_depth(BAD.astype(np.float64), kind, NEAR, FAR)
    atol = LOGARITHM_ROUNDINGS if kind == 8 else 0.0
    np.testing.assert_allclose(linearised(driver, BAD, kind), wanted, rtol=4 * 2.0**-24 * FAR / NEAR, atol=atol)
    metres = linearised(driver, BAD, kind, 1e-6, 1e5)
    assert (metres >= np.float32(listings.MIN_DEPTH)).all() and (metres <= listings.MAX_DEPTH).all()
    assert linearised(driver, np.float32([[1.0]]), 1, 1e-6, 1e5)[0, 0] >= 0.9e5


@pytest.mark.parametrize(
    "camera",
    [
        methods.Camera(0.05, 0.05, 0.05, max_coc=0.2),  # focus at the focal length
        methods.Camera(0.05, 0.05, 0.01, max_coc=0.2),  # and before it
        methods.Camera(0.05, 0.05, 1e9, max_coc=0.2),  # at infinity
        methods.Camera(0.05, 0.05, 3.4e38, max_coc=0.2),  # as others write infinity
        methods.Camera(0.05, 0.05, float("inf"), max_coc=0.2),
        methods.Camera(0.05, 0.05, 0.1, max_coc=0.2),  # at the near plane
        methods.Camera(0.0, 0.05, 5.0, max_coc=0.2),  # a pinhole
        methods.Camera(0.05, 0.0, 5.0, max_coc=0.2),  # no lens
        methods.Camera(0.05, 0.05, 5.0, sensor_height=0.0, max_coc=0.2),
        # it counts as BOKEH_MIN_DEPTH: not 0 / 0 in focus, and with so small an aperture not infinite elsewhere
        methods.Camera(2.0**-20, 0.0625, 4.0, sensor_height=0.0, max_coc=1.0),
        methods.Camera(0.05, 0.05, 5.0, max_coc=0.0),
        methods.Camera(0.05, 0.05, 5.0, max_coc=1.0),
        methods.Camera(1e6, 1.0, 1.0000001, max_coc=1.0),
        methods.Camera(1e-6, 1e-5, 1e-3, sensor_height=1e-6, max_coc=1.0),  # a scene a millimetre deep
    ],
    ids=str,
)
@in_each_language
def test_camera_at_its_limits(camera, driver):
    """Every camera gives a CoC that is finite and within 0 .. MaxCoC, the one that the documents tell."""
    depth = np.array([[1e-5, 5e-4, 0.05, 0.1, 1.0, 5.0, 100.0, 1e9, np.inf, 0.0, -1.0, np.nan]], np.float32)
    color = np.ones((1, depth.shape[1], 4), np.float16)
    item = Pass("BokehCoCMap", {"ColorSamp": "color", "DepthSamp": "depth"}, "coc", camera.parameters())
    textures = {"color": color, "depth": depth}
    coc = driver.run([item], textures, (depth.shape[1], 1), "float", keep=("coc",))["coc"][0, :, 3]
    assert np.isfinite(coc).all() and coc.min() >= 0.0 and coc.max() <= camera.max_coc
    # the difference from the focal length is taken of float32 numbers
    values = vars(camera) | {"focus_distance": float(np.float32(camera.focus_distance))}
    wanted = listings.circle_of_confusion(listings.safe_depth(depth[0].astype(np.float64)), *values.values())
    # S1 - f and S2 - S1 lose what they have in common: 2^-24 of the larger, over the difference
    focus = min(camera.focus_distance, listings.MAX_DEPTH)
    lost = 2.0**-23 * focus / max(abs(focus - camera.focal_length), 1e-6)
    near = np.abs(listings.safe_depth(depth[0]) - focus) < 1e-6 * focus
    np.testing.assert_allclose(coc[~near], wanted[~near], rtol=1e-5 + min(lost, 1.0), atol=1e-7)


@pytest.mark.parametrize("f_number", [1.4, 16.0])
@in_each_language
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


def test_constant_coc_is_clamped(driver):
    """A constant CoC below 0 is 0, one above MaxCoC is that."""
    for value, wanted in ((-0.5, 0.0), (0.125, 0.125), (0.5, 0.25)):
        parameters = {"BokehConstantCoC": value, "BokehMaxCoC": 0.25}
        item = Pass("BokehConstantCoC", {"ColorSamp": "color"}, "result", parameters)
        output = driver.run([item], {"color": flat((4, 2), 1.0)}, (4, 2))["result"]
        np.testing.assert_array_equal(output[..., 3], wanted)
