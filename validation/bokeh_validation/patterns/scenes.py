"""Small scenes with depth: intensity leakage, sharp silhouette, blurred CoC, constant field, CoC over depth."""

from dataclasses import replace

import numpy as np

from bokeh_validation import methods
from bokeh_validation.patterns.model import Case, Check, Outputs, Probe, depth_of, flat
from bokeh_validation.reference import images, listings

SIZE = (160, 120)
CAMERA = methods.Camera(aperture_diameter=0.1, focal_length=0.05, focus_distance=2.0, max_coc=0.2)
NEAR, FOCUS, FAR = 1.0, 2.0, 20.0
# a bright square in the middle of the image: rows and columns it covers
SQUARE = (slice(44, 76), slice(64, 96))
HALF_STEP = 2.0**-10


def thin_lens(depth):
    """CoC of a depth or of an array of them, fraction of the image height."""
    return listings.circle_of_confusion(
        depth,
        CAMERA.aperture_diameter,
        CAMERA.focal_length,
        CAMERA.focus_distance,
        CAMERA.sensor_height,
        CAMERA.max_coc,
    )


def coc_pixels(depth: float) -> float:
    """CoC in pixels of a depth."""
    return float(thin_lens(depth)) * SIZE[1]


def square_scene(inside: tuple[float, float], outside: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Colour and depth of a square before a background; each given as (value, depth)."""
    color, depth = flat(SIZE, outside[0]), depth_of(SIZE, outside[1])
    color[SQUARE][..., :3] = inside[0]
    depth[SQUARE] = inside[1]
    return color, depth


def _settings(aperture: str = "square", **changes) -> methods.Settings:
    return replace(methods.Settings("paper", aperture, 25, camera=CAMERA), **changes)


# ---------------------------------------------------------------------------------------------- intensity leakage

LEAK_COLOR, LEAK_DEPTH = square_scene((16.0, FOCUS), (0.25, FAR))


def _judge_leakage(outputs: dict[str, Outputs]) -> list[Check]:
    outside = np.ones((SIZE[1], SIZE[0]), bool)
    outside[SQUARE] = False
    leaked = {label: (o["result"][..., 1][outside] - 0.25).sum() for label, o in outputs.items()}
    without, fixed = leaked["without the fix"], leaked["with the fix"]
    # Without the fix the background collects the square's light over half a CoC around it. A box filter gives to the
    # outside the mean of |x| over the line, L / 4, for each pixel of edge and each of the two lines.
    side, line = SQUARE[0].stop - SQUARE[0].start, coc_pixels(FAR)
    expected = 15.75 * 2 * 2 * side * line / 8
    # With the fix only samples that straddle the edge still leak: their nearest depth is the background's, but up to
    # half a texel of the square is in their colour. That is a strip of 1/8 pixel (the integral of x over half a texel)
    # in place of line / 8 pixels.
    return [
        Check(
            "light leaked without the fix (pixels of the square)",
            without / 15.75,
            0.5 * expected / 15.75,
            2.0 * expected / 15.75,
            f"perimeter x CoC / 8 = {expected / 15.75:.0f}, within a factor of two for the square's corners",
        ),
        Check(
            "leaked with the fix, share of that without",
            fixed / without,
            0.0,
            2.0 / line,
            "a strip of 1/8 pixel where samples straddle the edge, against CoC / 8 pixels; twice for two passes",
        ),
        Check(
            "the focused square keeps its colour (relative)",
            float(np.abs(outputs["with the fix"]["result"][SQUARE][..., 1] / 16.0 - 1.0).max()),
            0.0,
            3 * HALF_STEP,
            "CoC 0: every sample is the pixel itself; three stores of one step each",
        ),
    ]


LEAKAGE = Probe(
    "leakage",
    "Intensity leakage, with and without the fix",
    "2",
    "Without the fix a halo of the focused bright square lies on the blurred background. With it a faint one is left, "
    "of samples that straddle the outline: linear filtering gives them colour of the square and the far depth.",
    (
        Case("without the fix", _settings(leak_fix=False), LEAK_COLOR, LEAK_DEPTH, tone_map=True),
        Case("with the fix", _settings(), LEAK_COLOR, LEAK_DEPTH, tone_map=True),
    ),
    _judge_leakage,
)

# ---------------------------------------------------------------------------------------------- sharp silhouette

SILHOUETTE_COLOR, SILHOUETTE_DEPTH = square_scene((4.0, NEAR), (0.25, FOCUS))


def _judge_silhouette(outputs: dict[str, Outputs]) -> list[Check]:
    value = outputs["near square before a focused background"]["result"][..., 1]
    outside = np.ones_like(value, bool)
    outside[SQUARE] = False
    row = value[(SQUARE[0].start + SQUARE[0].stop) // 2, SQUARE[1]]
    faded = int((row < 4.0 * (1 - 4 * HALF_STEP)).sum()) / 2
    coc = coc_pixels(NEAR)
    return [
        Check(
            "change outside the silhouette",
            float(np.abs(value[outside] - 0.25).max()),
            0.0,
            3 * HALF_STEP * 0.25,
            "the background's CoC is 0, so it gathers nothing but itself: the artefact of section 2.1",
        ),
        Check(
            "fading inside the silhouette (pixels)",
            faded,
            0.25 * coc,
            coc / 2 + 1,
            f"half a CoC ({coc / 2:.1f} pixels) at most; less where the blurred CoC shortens the later lines",
        ),
    ]


SILHOUETTE = Probe(
    "silhouette",
    "Sharp silhouette of a defocused foreground",
    "3",
    "The square fades inside its outline but does not spread over it, as a lens would make it.",
    (
        Case(
            "near square before a focused background",
            _settings("hexagon"),
            SILHOUETTE_COLOR,
            SILHOUETTE_DEPTH,
            tone_map=True,
        ),
    ),
    _judge_silhouette,
)

# ---------------------------------------------------------------------------------------------- CoC blurred or not


def branches() -> tuple[np.ndarray, np.ndarray]:
    """A slanted dark branch, slightly blurred, before a bright background that is blurred three times as much."""
    color, depth = flat(SIZE, 2.0), depth_of(SIZE, 3.0)
    y, x = np.mgrid[0 : SIZE[1], 0 : SIZE[0]]
    branch = np.abs(x - 80 - 0.5 * (y - 60)) < 12
    color[branch, :3] = 0.05
    depth[branch] = 1.8
    return color, depth


BRANCH_COLOR, BRANCH_DEPTH = branches()


def steepest(value: np.ndarray) -> float:
    """Largest difference of horizontal neighbours, away from the image's border."""
    return float(np.abs(np.diff(value[20:-20], axis=1)).max())


def _judge_coc_blur(outputs: dict[str, Outputs]) -> list[Check]:
    blurred = outputs["CoC blurred"]["result"]
    kept = outputs["CoC not blurred"]["result"]
    stored = outputs["CoC not blurred"]["coc"]
    return [
        Check(
            "steepest edge, not blurred over blurred",
            steepest(kept[..., 1]) / steepest(blurred[..., 1]),
            1.01,
            float("inf"),
            "blurring the CoC softens the edges at depth discontinuities; 1 % is above what the stores can do",
        ),
        Check(
            "steepest step of the CoC, blurred over not",
            steepest(blurred[..., 3]) / steepest(kept[..., 3]),
            0.0,
            0.75,
            "a mean over a line is smoother than what it averages",
        ),
        Check(
            "CoC changed by the passes when not blurred (relative)",
            float((np.abs(kept[..., 3] - stored[..., 3]) / stored[..., 3]).max()),
            0.0,
            4 * HALF_STEP,
            "each pass hands the centre's CoC on: one step for each of three stores, one for reading at a rounded uv",
        ),
    ]


COC_BLUR = Probe(
    "coc-blur",
    "CoC blurred with the colour, or not",
    "7",
    "With the CoC left alone the branch keeps hard edges; averaged with the colour they soften.",
    (
        Case("CoC blurred", _settings("hexagon"), BRANCH_COLOR, BRANCH_DEPTH, exposure=0.5),
        Case(
            "CoC not blurred",
            _settings("hexagon", blur_coc=False),
            BRANCH_COLOR,
            BRANCH_DEPTH,
            ("coc", "result"),
            exposure=0.5,
        ),
    ),
    _judge_coc_blur,
)

# ---------------------------------------------------------------------------------------------- constant field

FIELD = flat(SIZE)
FIELD[..., :3] = (0.1, 1.0, 300.0)


def field_depth() -> np.ndarray:
    """Depth from near to far, so that the CoC takes every size."""
    return np.geomspace(0.5, 500.0, SIZE[0] * SIZE[1], dtype=np.float32).reshape(SIZE[1], SIZE[0])


def _judge_constant(outputs: dict[str, Outputs]) -> list[Check]:
    expected = FIELD[..., :3].astype(np.float64)
    checks = []
    for label, textures in outputs.items():
        off = float(np.abs(textures["result"][..., :3] / expected - 1.0).max())
        passes = 4 if "octagon" in label else 1
        why = "a mean of equal numbers, rounded once in float32 and once a store; one half-float step for each pass"
        checks.append(Check(f"change, {label} (relative)", off, 0.0, passes * HALF_STEP, why))
    return checks


CONSTANT = Probe(
    "constant",
    "A constant field stays as it is",
    "-",
    "Depth runs from half a metre to 500 m, the colour is the same everywhere: nothing may change.",
    (
        Case("paper, octagon", _settings("octagon"), FIELD, field_depth()),
        Case("naive, octagon", _settings("octagon", method="naive", samples=13), FIELD, field_depth()),
    ),
    _judge_constant,
)

# ---------------------------------------------------------------------------------------------- CoC over depth


def _judge_coc(outputs: dict[str, Outputs]) -> list[Check]:
    seen = outputs["depth 0.5 m to 500 m"]["coc"][..., 3]
    camera = CAMERA
    truth = thin_lens(field_depth().astype(np.float64))
    off = np.abs(seen - truth) / images.step(truth + 16 * 2.0**-24 * truth, np.float16)
    far = camera.aperture_diameter * camera.focal_length / (camera.focus_distance - camera.focal_length)
    sky = outputs["infinite depth"]["coc"][..., 3]
    limit = far / camera.sensor_height
    return [
        Check(
            "CoC off the thin-lens formula (half-float steps)",
            float(off.max()),
            0.0,
            1.01,
            "one store in half a float, and 16 float32 roundings, 0.01 of a step",
        ),
        Check(
            "clamped to MaxCoC (share of the image)",
            float((seen >= np.float16(camera.max_coc) * (1 - HALF_STEP)).mean()),
            float((truth >= camera.max_coc).mean()) - 1e-3,
            float((truth >= camera.max_coc).mean()) + 1e-3,
            "where the formula exceeds MaxCoC; 0.1 % for pixels within a step of it",
        ),
        Check(
            "CoC at infinite depth over its limit A f / (S1 - f)",
            float(np.abs(sky / limit - 1.0).max()),
            0.0,
            HALF_STEP * 1.01,
            "one half-float step",
        ),
    ]


COC = Probe(
    "coc",
    "CoC over depth against the thin-lens formula",
    "-",
    "Depth grows from the upper left to the lower right; the CoC falls to zero at the focus distance and rises again.",
    (
        Case("depth 0.5 m to 500 m", _settings(), FIELD, field_depth(), ("coc",)),
        Case("infinite depth", _settings(), FIELD, depth_of(SIZE, np.inf), ("coc",)),
    ),
    _judge_coc,
)

PROBES = (LEAKAGE, SILHOUETTE, COC_BLUR, CONSTANT, COC)
