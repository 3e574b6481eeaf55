"""One bright pixel spread into the aperture: Figures 5, 6 and 9."""

from functools import partial

import numpy as np

from bokeh_validation import apertures, methods
from bokeh_validation.patterns.model import Case, Check, Outputs, Probe, depth_of, flat, pixel_center
from bokeh_validation.reference import polygons

SIZE = (160, 96)  # not square, so that a missing aspect ratio shows
COC = 36  # pixels
# Two samples a pixel: at one a pixel the lines at 45 degrees ripple by several per cent, and min loses that much light.
SAMPLES = 73
PEAK = 4096.0
# Not black: where a highlight's bilinear weight is 0 in float64 and 0.00003 in float32, a half float near zero would
# count thousands of steps.
AMBIENT = 0.5
# brightness of the plateau in pictures: below half, so that two of them on top of each other can be seen
PICTURE = 0.3
CENTER = (80, 48)
ROTATION = 10.0

# corners of the outline; folds of its rotational symmetry
FOLDS = {"square": 4, "diamond": 2, "hexagon": 6, "octagon": 8, "star": 8}
FIGURES = {"square": "5", "diamond": "6", "hexagon": "9a", "octagon": "9b", "star": "9c"}


def line_length() -> float:
    """Length in pixels that N samples stand for when they are spaced CoC / (N - 1) from end to end: N spacings."""
    return COC * SAMPLES / (SAMPLES - 1)


def parallelograms(aperture: str, rotation: float) -> list[np.ndarray]:
    """Corners in pixels of the parallelograms as sampled."""
    return [line_length() * p.corners(rotation) for p in apertures.PARALLELOGRAMS[aperture]]


def outlines(aperture: str, rotation: float) -> list[np.ndarray]:
    """Convex polygons whose union is the aperture: one, but two squares for the star."""
    shapes = parallelograms(aperture, rotation)
    if aperture in apertures.USES_MAX or len(shapes) == 1:
        return shapes
    return [polygons.clip_convex(*shapes)]


def analytic(aperture: str, rotation: float) -> np.ndarray:
    """Coverage of the aperture, (H, W)."""
    center = pixel_center(*CENTER)
    return np.max([polygons.coverage(p, SIZE, center) for p in outlines(aperture, rotation)], axis=0)


def plateau(aperture: str) -> float:
    """Value inside the aperture: the light of the pixel spread over one parallelogram."""
    return PEAK / abs(polygons.signed_area(parallelograms(aperture, 0.0)[0]))


def impulse_image(points: tuple[tuple[int, int], ...] = (CENTER,), size: tuple[int, int] = SIZE) -> np.ndarray:
    """Nearly black, with bright pixels."""
    image = flat(size, AMBIENT)
    for column, row in points:
        image[row, column, :3] = PEAK + AMBIENT
    return image


def constant_coc(aperture: str, rotation: float, size: tuple[int, int] = SIZE) -> methods.Settings:
    """The paper's method with a CoC of COC pixels everywhere."""
    camera = methods.Camera(max_coc=1.0)
    return methods.Settings("paper", aperture, SAMPLES, rotation, camera, coc=COC / size[1])


def _outline_length(aperture: str) -> float:
    """Perimeter of the outline in pixels; the star has 16 sides, so the sum over both squares is above it."""
    return sum(polygons.perimeter(p) for p in outlines(aperture, 0.0))


def _judge_shape(aperture: str, rotation: float, value: np.ndarray) -> list[Check]:
    """Light, area, overlap, orientation and corners of one rendering, (H, W) green channel."""
    label = f"{rotation:g} degrees"
    center = pixel_center(*CENTER)
    truth = analytic(aperture, rotation)
    seen = np.clip(value / plateau(aperture), 0.0, 1.0)
    area, edge = truth.sum(), 0.5 * _outline_length(aperture)
    turn = polygons.angle_between(
        polygons.moment_phase(seen, center, FOLDS[aperture]),
        polygons.moment_phase(truth, center, FOLDS[aperture]),
        FOLDS[aperture],
    )
    radius = max(np.linalg.norm(p, axis=1).max() for p in outlines(aperture, rotation))
    half_pixel = "the boundary is known to half a pixel: perimeter / 2 over the area"
    checks = [
        Check(f"area, {label}", seen.sum() / area, 1 - edge / area, 1 + edge / area, half_pixel),
        Check(
            f"overlap with the polygon, {label}",
            np.minimum(seen, truth).sum() / np.maximum(seen, truth).sum(),
            (area - edge) / (area + edge),
            1.0,
            half_pixel,
        ),
        Check(
            f"orientation off by, {label} (degrees)",
            turn,
            0.0,
            np.degrees(0.5 / radius),
            "half a pixel at the farthest corner",
        ),
    ]
    return checks + _corner_checks(aperture, rotation, seen, label)


def _corner_checks(aperture: str, rotation: float, seen: np.ndarray, label: str) -> list[Check]:
    """How far the support reaches along each corner's direction, against the corner."""
    height, width = seen.shape
    y, x = np.mgrid[0:height, 0:width] + 0.5
    inside = seen >= 0.5
    center = pixel_center(*CENTER)
    worst, allowed = -np.inf, 0.0
    for polygon in outlines(aperture, rotation):
        for corner, angle in zip(polygon, polygons.corner_angles(polygon), strict=True):
            along = corner / np.linalg.norm(corner)
            reach = ((x - center[0]) * along[0] + (y - center[1]) * along[1])[inside].max()
            off = abs(reach - np.linalg.norm(corner))
            limit = 0.5 / np.sin(angle / 2) + np.sqrt(0.5)
            if off - limit > worst - allowed:
                worst, allowed = off, limit
    why = (
        "edges known to half a pixel meet within 0.5 / sin(half the angle); pixel centres are within 0.71 of any place"
    )
    return [Check(f"corner off by, {label} (pixels)", worst, 0.0, allowed, why)]


def light_kept(aperture: str) -> float:
    """Area of the aperture over that of one parallelogram: what min or max leaves of an isolated highlight's light."""
    shapes = parallelograms(aperture, 0.0)
    one = abs(polygons.signed_area(shapes[0]))
    if len(shapes) == 1:
        return 1.0
    common = abs(polygons.signed_area(polygons.clip_convex(*shapes)))
    return (2 * one - common) / one if aperture in apertures.USES_MAX else common / one


def _judge(aperture: str, outputs: dict[str, Outputs]) -> list[Check]:
    checks = []
    for rotation in (0.0, ROTATION):
        value = outputs[f"{rotation:g} degrees"]["result"][..., 1] - AMBIENT
        checks += _judge_shape(aperture, rotation, value)
    value = outputs["0 degrees"]["result"][..., 1] - AMBIENT
    near = (
        polygons.coverage(2.0 * COC * apertures.PARALLELOGRAMS["square"][0].corners(), SIZE, pixel_center(*CENTER)) > 0
    )
    if len(apertures.PARALLELOGRAMS[aperture]) == 1:
        # every bilinear sample shares its light out completely, so only the stores lose any: half a step or one, each
        # of the two passes, 2^-10 relative
        low, high, why = 1 - 2 * 2.0**-10, 1 + 2 * 2.0**-10, "two stores in half floats, one step each"
    else:
        edge = 0.5 * _outline_length(aperture) / analytic(aperture, 0.0).sum()
        low, high = light_kept(aperture) * (1 - edge), light_kept(aperture) * (1 + edge)
        why = "area of the outline over that of a parallelogram, boundary known to half a pixel"
    checks.append(Check("light kept", value[near].sum() / PEAK, low, high, why))
    if aperture == "square":
        checks += _judge_stages(outputs["0 degrees"])
    return checks


def _judge_stages(outputs: Outputs) -> list[Check]:
    """Figure 5: after the first pass a line, one pixel thin."""
    line = outputs["line 1"][..., 1] - AMBIENT
    lit = line > 0.5 * PEAK / line_length()
    why = f"{SAMPLES} samples half a pixel apart, ends known to half a pixel"
    return [
        Check("first pass: length (pixels)", float(lit.any(axis=0).sum()), line_length() - 1, line_length() + 1, why),
        Check("first pass: thickness (pixels)", float(lit.any(axis=1).sum()), 1, 1, "a horizontal line"),
    ]


def probe(aperture: str) -> Probe:
    """The probe of one aperture, upright and turned."""
    keep = ("coc", "line 1", "result") if aperture == "square" else ("result",)
    cases = tuple(
        Case(
            f"{rotation:g} degrees",
            constant_coc(aperture, rotation),
            impulse_image(),
            depth_of(SIZE, 10.0),
            keep if rotation == 0.0 else ("result",),
            exposure=PICTURE / plateau(aperture),
        )
        for rotation in (0.0, ROTATION)
    )
    return Probe(
        f"impulse-{aperture}",
        f"One bright pixel becomes a {aperture}",
        FIGURES[aperture],
        f"A {aperture} of CoC {COC} pixels, upright and turned by {ROTATION:g} degrees, with straight, sharp sides.",
        cases,
        partial(_judge, aperture),
    )


PROBES = tuple(probe(aperture) for aperture in apertures.APERTURES)
