"""Probe small scenes with depth: intensity leakage, sharp silhouettes, blurred CoC."""

from dataclasses import replace

import numpy as np

from bokeh_validation.frame import methods
from bokeh_validation.probes.model import Case, Check, Outputs, Probe, depth_of, flat
from bokeh_validation.reference import listings

SIZE = (160, 120)
CAMERA = methods.Camera(aperture_diameter=0.1, focal_length=0.05, focus_distance=2.0, max_coc=0.2)
NEAR, FOCUS, FAR = 1.0, 2.0, 20.0
# rows and columns of a bright square in the middle of the image
SQUARE = (slice(44, 76), slice(64, 96))
HALF_STEP = 2.0**-10


def thin_lens(depth):
    """Return the CoC of a depth or an array of depths in metres, fraction of the image height."""
    lens = CAMERA.aperture_diameter, CAMERA.focal_length, CAMERA.focus_distance, CAMERA.sensor_height, CAMERA.max_coc
    return listings.circle_of_confusion(depth, *lens)


def square_scene(inside: tuple[float, float], outside: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Return colour (H, W, 4) and depth (H, W) of a square in front of a background, each given as (value, metres)."""
    color, depth = flat(SIZE, outside[0]), depth_of(SIZE, outside[1])
    color[SQUARE][..., :3] = inside[0]
    depth[SQUARE] = inside[1]
    return color, depth


def _outside(image: np.ndarray) -> np.ndarray:
    """Return the values around the square, (N,)."""
    around = np.ones_like(image, bool)
    around[SQUARE] = False
    return image[around]


def _settings(aperture: str = "square", **changes) -> methods.Settings:
    return replace(methods.Settings("paper", aperture, 25, camera=CAMERA), **changes)


def _judge_leakage(outputs: dict[str, Outputs]) -> list[Check]:
    unfixed, fixed = (textures["result"][..., 1] for textures in outputs.values())
    # the square's brightness above the background
    without, leaked = (_outside(value - 0.25).sum() / 15.75 for value in (unfixed, fixed))
    # Without the fix the background collects the square's light up to half a CoC around it. A box filter gives the
    # outside the mean of |x| over the line, L / 4, per pixel of edge and for each of the two lines.
    side, line = SQUARE[0].stop - SQUARE[0].start, float(thin_lens(FAR)) * SIZE[1]
    expected = 2 * 2 * side * line / 8
    why = f"perimeter x CoC / 8 = {expected:.0f}, within a factor of two for the square's corners"
    # With the fix only samples across the edge still leak: their nearest depth is the background's, but their colour
    # contains up to half a texel of the square. That is a strip of 1/8 pixel (the integral of x over half a texel)
    # instead of line / 8 pixels.
    strip = "a strip of 1/8 pixel where samples straddle the edge, against CoC / 8 pixels; twice for two passes"
    change = float(np.abs(fixed[SQUARE] / 16.0 - 1.0).max())
    same = "CoC 0: every sample is the pixel itself; three stores of one step each"
    return [
        Check("light leaked without the fix (pixels of the square)", without, 0.5 * expected, 2.0 * expected, why),
        Check("leaked with the fix, as a fraction of the leak without it", leaked / without, 0.0, 2.0 / line, strip),
        Check("the focused square keeps its colour (relative)", change, 0.0, 3 * HALF_STEP, same),
    ]


BRIGHT_SQUARE = square_scene((16.0, FOCUS), (0.25, FAR))
LEAKAGE = Probe(
    "leakage",
    "Intensity leakage, with and without the fix (Figure 2)",
    "A halo of the bright square on the blurred background; with the fix a faint one, of samples across the outline.",
    (
        Case("without the fix", _settings(leak_fix=False), *BRIGHT_SQUARE),
        Case("with the fix", _settings(), *BRIGHT_SQUARE),
    ),
    _judge_leakage,
)


def _judge_silhouette(outputs: dict[str, Outputs]) -> list[Check]:
    value = outputs["near square in front of a focused background"]["result"][..., 1]
    change = float(np.abs(_outside(value - 0.25)).max())
    itself = "the background's CoC is 0, so it gathers nothing but itself: the artefact of section 2.1"
    row = value[(SQUARE[0].start + SQUARE[0].stop) // 2, SQUARE[1]]
    faded = int((row < 4.0 * (1 - 4 * HALF_STEP)).sum()) / 2
    coc = float(thin_lens(NEAR)) * SIZE[1]
    why = f"half a CoC ({coc / 2:.1f} pixels) at most; less where the blurred CoC shortens the later lines"
    return [
        Check("change outside the silhouette", change, 0.0, 3 * HALF_STEP * 0.25, itself),
        Check("fading inside the silhouette (pixels)", faded, 0.25 * coc, coc / 2 + 1, why),
    ]


NEAR_SQUARE = square_scene((4.0, NEAR), (0.25, FOCUS))
SILHOUETTE = Probe(
    "silhouette",
    "Sharp silhouette of a defocused foreground (Figure 3)",
    "The square fades inside its outline but does not spread over it, as a lens would make it.",
    (Case("near square in front of a focused background", _settings("hexagon"), *NEAR_SQUARE),),
    _judge_silhouette,
)


def branches() -> tuple[np.ndarray, np.ndarray]:
    """Return a slanted dark branch, slightly blurred, in front of a bright background that is blurred three times as
    much.
    """
    color, depth = flat(SIZE, 2.0), depth_of(SIZE, 3.0)
    y, x = np.mgrid[0 : SIZE[1], 0 : SIZE[0]]
    branch = np.abs(x - 80 - 0.5 * (y - 60)) < 12
    color[branch, :3] = 0.05
    depth[branch] = 1.8
    return color, depth


def _steepest(value: np.ndarray) -> float:
    """Return the largest difference of horizontal neighbours, away from the image's border."""
    return float(np.abs(np.diff(value[20:-20], axis=1)).max())


def _judge_coc_blur(outputs: dict[str, Outputs]) -> list[Check]:
    blurred, unblurred = outputs["CoC blurred"]["result"], outputs["CoC not blurred"]["result"]
    stored = outputs["CoC not blurred"]["coc"][..., 3]
    edges = _steepest(unblurred[..., 1]) / _steepest(blurred[..., 1])
    steps = _steepest(blurred[..., 3]) / _steepest(unblurred[..., 3])
    changed = float((np.abs(unblurred[..., 3] - stored) / stored).max())
    soft = "blurring the CoC softens the edges at depth discontinuities; 1 % is above what the stores can do"
    mean = "a mean over a line is smoother than what it averages"
    passed = "each pass hands the centre's CoC on: one step for each of three stores, one for reading at a rounded uv"
    return [
        Check("steepest edge, not blurred over blurred", edges, 1.01, float("inf"), soft),
        Check("steepest step of the CoC, blurred over not", steps, 0.0, 0.75, mean),
        Check("CoC changed by the passes when not blurred (relative)", changed, 0.0, 4 * HALF_STEP, passed),
    ]


COC_BLUR = Probe(
    "coc-blur",
    "CoC blurred with the colour, or not (Figure 7)",
    "With the CoC left alone the branch keeps hard edges; averaged with the colour they soften.",
    (
        Case("CoC blurred", _settings("hexagon"), *branches()),
        Case("CoC not blurred", _settings("hexagon", blur_coc=False), *branches(), ("coc", "result")),
    ),
    _judge_coc_blur,
)

PROBES = (LEAKAGE, SILHOUETTE, COC_BLUR)
