"""Probe one bright pixel spread into the paper's apertures: Figures 5, 6 and 9."""

from functools import partial

import numpy as np

from bokeh_validation.frame import aperture_shapes, geometry, methods
from bokeh_validation.probes.highlight import AMBIENT, PEAK, impulse_image
from bokeh_validation.probes.model import Case, Check, Outputs, Probe, depth_of, overlap, pixel_center

SIZE = (160, 96)  # not square, so that a missing aspect ratio shows
COC = 36  # pixels
# Two samples per pixel: at one per pixel, lines at 45 degrees ripple by several per cent, and min loses as much light.
SAMPLES = 73
CENTER = (80, 48)
ROTATION = 10.0
# Length that N samples represent when they span the CoC from end to end at spacings of CoC / (N - 1): N spacings,
# pixels
LINE_LENGTH = COC * SAMPLES / (SAMPLES - 1)

# order of the outline's rotational symmetry
FOLDS = {"square": 4, "diamond": 2, "hexagon": 6, "octagon": 8, "star": 8}
FIGURES = {"square": "5", "diamond": "6", "hexagon": "9a", "octagon": "9b", "star": "9c"}


def parallelograms(aperture: str, rotation: float) -> list[np.ndarray]:
    """Return the corners of each parallelogram as sampled, (4, 2) in pixels. `rotation` is in degrees."""
    return [LINE_LENGTH * shape.corners(rotation) for shape in aperture_shapes.PARALLELOGRAMS[aperture]]


def outlines(aperture: str, rotation: float) -> list[np.ndarray]:
    """Return convex polygons (N, 2), in pixels, whose union is the aperture: two squares for the star, else one."""
    shapes = parallelograms(aperture, rotation)
    return shapes if aperture in aperture_shapes.USES_MAX or len(shapes) == 1 else [geometry.clip_convex(*shapes)]


def analytic(aperture: str, rotation: float) -> np.ndarray:
    """Return the coverage of the aperture, (H, W)."""
    shapes = outlines(aperture, rotation)
    return np.max([geometry.coverage(shape, SIZE, pixel_center(*CENTER)) for shape in shapes], axis=0)


def plateau(aperture: str) -> float:
    """Return the value inside the aperture: the pixel's light spread over one parallelogram."""
    return PEAK / abs(geometry.signed_area(parallelograms(aperture, 0.0)[0]))


def constant_coc(aperture: str, rotation: float, size: tuple[int, int] = SIZE) -> methods.Settings:
    """Return the paper's method with a CoC of COC pixels everywhere."""
    camera = methods.Camera(max_coc=1.0)
    return methods.Settings("paper", aperture, SAMPLES, rotation, camera, coc=COC / size[1])


def point_case(label: str, settings: methods.Settings, points: tuple, size: tuple[int, int]) -> Case:
    """Return a case with bright pixels at `points`, (column, row) each."""
    return Case(label, settings, impulse_image(points, size), depth_of(size, 10.0))


def _edge(aperture: str) -> float:
    """Return the area within half a pixel of the outline. For the star, with 16 sides, the two squares' sum is an
    upper bound.
    """
    return 0.5 * sum(geometry.perimeter(shape) for shape in outlines(aperture, 0.0))


def _shape_checks(aperture: str, rotation: float, value: np.ndarray) -> list[Check]:
    """Check area, overlap and orientation of one result, (H, W) without the ambient light."""
    label, center, folds = f"{rotation:g} degrees", pixel_center(*CENTER), FOLDS[aperture]
    truth = analytic(aperture, rotation)
    coverage = np.clip(value / plateau(aperture), 0.0, 1.0)
    area, edge = truth.sum(), _edge(aperture)
    turn = geometry.turn_between(coverage, truth, center, folds)
    radius = max(np.linalg.norm(shape, axis=1).max() for shape in outlines(aperture, rotation))
    overlap_bound = (area - edge) / (area + edge)
    why, farthest = "the boundary is known to half a pixel", "half a pixel at the farthest corner"
    return [
        Check(f"area, {label}", coverage.sum() / area, 1 - edge / area, 1 + edge / area, why),
        Check(f"overlap with the polygon, {label}", overlap(coverage, truth), overlap_bound, 1.0, why),
        Check(f"orientation off by, {label} (degrees)", turn, 0.0, np.degrees(0.5 / radius), farthest),
    ]


def light_kept(aperture: str) -> float:
    """Return the aperture's area over that of one parallelogram: the fraction of an isolated highlight's light after
    min or max.
    """
    shapes = parallelograms(aperture, 0.0)
    if len(shapes) == 1:
        return 1.0
    area = abs(geometry.signed_area(shapes[0]))
    common = abs(geometry.signed_area(geometry.clip_convex(*shapes)))
    return (2 * area - common) / area if aperture in aperture_shapes.USES_MAX else common / area


def _judge(aperture: str, outputs: dict[str, Outputs]) -> list[Check]:
    upright, turned = (textures["result"][..., 1] - AMBIENT for textures in outputs.values())
    checks = _shape_checks(aperture, 0.0, upright) + _shape_checks(aperture, ROTATION, turned)
    enclosing_square = 2.0 * COC * aperture_shapes.PARALLELOGRAMS["square"][0].corners()
    near = geometry.coverage(enclosing_square, SIZE, pixel_center(*CENTER)) > 0
    if len(aperture_shapes.PARALLELOGRAMS[aperture]) == 1:
        light_error = 2 * 2.0**-10
        why = "bilinear samples share their light out completely; two stores, a step of 2^-10 each"
    else:
        light_error = _edge(aperture) / analytic(aperture, 0.0).sum()
        why = "area of the outline over that of a parallelogram, boundary known to half a pixel"
    low, high = (light_kept(aperture) * (1 + error) for error in (-light_error, light_error))
    checks.append(Check("light kept", upright[near].sum() / PEAK, low, high, why))
    return checks


def probe(aperture: str) -> Probe:
    """Return the probe of one aperture, upright and rotated."""
    upright, turned = (
        point_case(f"{turn:g} degrees", constant_coc(aperture, turn), (CENTER,), SIZE) for turn in (0.0, ROTATION)
    )
    shows = f"A {aperture} of CoC {COC} pixels, upright and rotated by {ROTATION:g} degrees. Its sides are sharp."
    title = f"One bright pixel becomes a {aperture} (Figure {FIGURES[aperture]})"
    judge, brief = partial(_judge, aperture), aperture != "octagon"
    return Probe(f"impulse-{aperture}", title, shows, (upright, turned), judge, brief)


PROBES = tuple(probe(aperture) for aperture in aperture_shapes.APERTURES)
