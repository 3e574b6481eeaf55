"""One bright pixel spread into the aperture: Figures 5, 6 and 9."""

from dataclasses import replace
from functools import partial

import numpy as np

from bokeh_validation.frame import apertures, methods, polygons
from bokeh_validation.probes.model import Case, Check, Outputs, Probe, depth_of, flat, overlap, pixel_center

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


def point_case(label: str, settings: methods.Settings, points: tuple, size: tuple[int, int]) -> Case:
    """Bright pixels; a plateau is PICTURE in the report."""
    exposure = PICTURE / plateau(settings.aperture)
    return Case(label, settings, impulse_image(points, size), depth_of(size, 10.0), exposure=exposure)


def _outline_length(aperture: str) -> float:
    """Perimeter of the outline in pixels; the star has 16 sides, so the sum over both squares is above it."""
    return sum(polygons.perimeter(p) for p in outlines(aperture, 0.0))


def _judge_shape(aperture: str, rotation: float, value: np.ndarray) -> list[Check]:
    """Light, area, overlap, orientation and corners of one rendering, (H, W) green channel."""
    label, center, folds = f"{rotation:g} degrees", pixel_center(*CENTER), FOLDS[aperture]
    truth = analytic(aperture, rotation)
    seen = np.clip(value / plateau(aperture), 0.0, 1.0)
    area, edge = truth.sum(), 0.5 * _outline_length(aperture)
    turn = polygons.angle_between(*(polygons.moment_phase(shape, center, folds) for shape in (seen, truth)), folds)
    radius = max(np.linalg.norm(p, axis=1).max() for p in outlines(aperture, rotation))
    limit = np.degrees(0.5 / radius)
    why = "the boundary is known to half a pixel: perimeter / 2 over the area"
    return [
        Check(f"area, {label}", seen.sum() / area, 1 - edge / area, 1 + edge / area, why),
        Check(f"overlap with the polygon, {label}", overlap(seen, truth), (area - edge) / (area + edge), 1.0, why),
        Check(f"orientation off by, {label} (degrees)", turn, 0.0, limit, "half a pixel at the farthest corner"),
        _corner_check(aperture, rotation, seen, label),
    ]


def _corner_check(aperture: str, rotation: float, seen: np.ndarray, label: str) -> Check:
    """How far the support reaches along each corner's direction, against the corner."""
    y, x = np.argwhere(seen >= 0.5).T + 0.5
    center = pixel_center(*CENTER)
    worst, allowed = -np.inf, 0.0
    for polygon in outlines(aperture, rotation):
        for corner, angle in zip(polygon, polygons.corner_angles(polygon), strict=True):
            along = corner / np.linalg.norm(corner)
            reach = ((x - center[0]) * along[0] + (y - center[1]) * along[1]).max()
            off = abs(reach - np.linalg.norm(corner))
            limit = 0.5 / np.sin(angle / 2) + np.sqrt(0.5)
            if off - limit > worst - allowed:
                worst, allowed = off, limit
    why = "edges known to half a pixel: within 0.5 / sin(half the angle); a pixel centre is within 0.71 of any place"
    return Check(f"corner off by, {label} (pixels)", worst, 0.0, allowed, why)


def light_kept(aperture: str) -> float:
    """Area of the aperture over that of one parallelogram: what min or max leaves of an isolated highlight's light."""
    shapes = parallelograms(aperture, 0.0)
    if len(shapes) == 1:
        return 1.0
    one = abs(polygons.signed_area(shapes[0]))
    common = abs(polygons.signed_area(polygons.clip_convex(*shapes)))
    return (2 * one - common) / one if aperture in apertures.USES_MAX else common / one


def _judge(aperture: str, outputs: dict[str, Outputs]) -> list[Check]:
    green = {turn: outputs[f"{turn:g} degrees"]["result"][..., 1] - AMBIENT for turn in (0.0, ROTATION)}
    checks = [check for turn, value in green.items() for check in _judge_shape(aperture, turn, value)]
    whole = 2.0 * COC * apertures.PARALLELOGRAMS["square"][0].corners()
    near = polygons.coverage(whole, SIZE, pixel_center(*CENTER)) > 0
    if len(apertures.PARALLELOGRAMS[aperture]) == 1:
        # every bilinear sample shares its light out completely, so only the stores lose any: half a step or one, each
        # of the two passes, 2^-10 relative
        off, why = 2 * 2.0**-10, "two stores in half floats, one step each"
    else:
        off = 0.5 * _outline_length(aperture) / analytic(aperture, 0.0).sum()
        why = "area of the outline over that of a parallelogram, boundary known to half a pixel"
    kept = light_kept(aperture)
    checks.append(Check("light kept", green[0.0][near].sum() / PEAK, kept * (1 - off), kept * (1 + off), why))
    return checks + (_judge_stages(outputs["0 degrees"]) if aperture == "square" else [])


def _judge_stages(outputs: Outputs) -> list[Check]:
    """Figure 5: after the first pass a line, one pixel thin."""
    lit = outputs["line 1"][..., 1] - AMBIENT > 0.5 * PEAK / line_length()
    length, thickness = (float(lit.any(axis=axis).sum()) for axis in (0, 1))
    why = f"{SAMPLES} samples half a pixel apart, ends known to half a pixel"
    return [
        Check("first pass: length (pixels)", length, line_length() - 1, line_length() + 1, why),
        Check("first pass: thickness (pixels)", thickness, 1, 1, "a horizontal line"),
    ]


def probe(aperture: str) -> Probe:
    """The probe of one aperture, upright and turned."""
    upright, turned = (
        point_case(f"{turn:g} degrees", constant_coc(aperture, turn), (CENTER,), SIZE) for turn in (0.0, ROTATION)
    )
    if aperture == "square":
        upright = replace(upright, keep=("coc", "line 1", "result"))
    shows = f"A {aperture} of CoC {COC} pixels, upright and turned by {ROTATION:g} degrees, with straight, sharp sides."
    title = f"One bright pixel becomes a {aperture}"
    return Probe(f"impulse-{aperture}", title, shows, (upright, turned), partial(_judge, aperture), FIGURES[aperture])


PROBES = tuple(probe(aperture) for aperture in apertures.APERTURES)
