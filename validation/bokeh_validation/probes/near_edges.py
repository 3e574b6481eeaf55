"""Probe layered: edges of near objects over a background in focus.

Near objects are red, objects in focus are green, and lights are blue, so that they can be distinguished in one image.
Brightness levels are similar, because the method compares a pixel's brightness with its neighbourhood's.
"""

from functools import partial
from math import ceil

import numpy as np

from bokeh_validation.frame import geometry, methods
from bokeh_validation.probes.highlight import polygon_of
from bokeh_validation.probes.model import Case, Check, Outputs, Probe, depth_of, flat

CAMERA = methods.Camera(aperture_diameter=1.0, focal_length=0.05, focus_distance=2.0, max_coc=1.0)
SIZE = (96, 64)
# One store in a half float that truncates: a step of 2^-10 at most
STEP = 2.0**-10
# Largest part of a pixel that may be uncovered while the pixel is treated as covered: a near weight of 0.998
UNCOVERED = 0.002
INFINITY = float("inf")


def metres(coc: float, height: int) -> float:
    """Return the depth in metres at which the signed CoC is `coc` pixels; `height` is the image's, in pixels."""
    magnification = CAMERA.focal_length / (CAMERA.focus_distance - CAMERA.focal_length)
    farthest = CAMERA.aperture_diameter * magnification / CAMERA.sensor_height * height
    return CAMERA.focus_distance / (1.0 - coc / farthest)


def settings(aperture: str = "hexagon", **changes) -> methods.Settings:
    """Return the layered method through CAMERA."""
    return methods.Settings("layered", aperture, camera=CAMERA, **changes)


def checker(size: tuple[int, int]) -> np.ndarray:
    """Return a checker of 8-pixel squares of 0.1 and 0.8, (H, W)."""
    y, x = np.mgrid[0 : size[1], 0 : size[0]]
    return 0.1 + 0.7 * ((x // 8 + y // 8) % 2)


def edge_spread(polygon: np.ndarray, distances: np.ndarray) -> np.ndarray:
    """Return the fraction of a polygon (N, 2) left of a vertical line at each distance (M,) from its middle, pixels."""
    far = 2.0 * np.abs(polygon).max() + np.abs(distances).max()
    halves = (np.array([[-far, -far], [distance, -far], [distance, far], [-far, far]]) for distance in distances)
    areas = [geometry.signed_area(geometry.clip_convex(polygon, half)) for half in halves]
    return np.array(areas) / geometry.signed_area(polygon)


def steepest(polygon: np.ndarray) -> float:
    """Return the largest change of the edge spread over a pixel: the polygon's largest width over its area."""
    places = np.linspace(polygon[:, 0].min(), polygon[:, 0].max(), 129)
    return float((np.diff(edge_spread(polygon, places)) / np.diff(places)).max())


EDGE_COCS = (80, 24, 12)
HALF_PIXEL = "texels of half the size lie half a pixel off the pixels: so is an edge, times the steepest slope"
FILLED = "hidden pixels are filled with a mean of their surroundings, 0.1 to 0.8; three stores, over 1 - alpha"


def near_case(label: str, coc: float, near: np.ndarray, case_settings: methods.Settings) -> Case:
    """Return a red near object, `near` (H, W) bool, over a green checker in focus. `coc` is in pixels."""
    height, width = near.shape
    color, depth = flat((width, height)), depth_of((width, height), CAMERA.focus_distance)
    color[..., 0] = near
    color[..., 1] = np.where(near, 0.0, checker((width, height)))
    depth[near] = metres(-coc, height)
    return Case(label, case_settings, color, depth)


def edge_case(coc: float, aperture: str, rotation: float) -> Case:
    """Return a case with the left half near, wide enough for the blur and a margin on both sides.

    The image is at least as high as `coc` pixels, because CAMERA has no CoC above the height.
    """
    width, height = 2 * ceil(coc * 0.5) + 24, max(48, coc + 8)
    # the edge lies between the two pixels of a texel at half size
    near = np.broadcast_to(np.arange(width) < width // 2 + 1, (height, width))
    return near_case(f"CoC {coc}", coc, near, settings(aperture, rotation=rotation))


def _judge_edges(aperture: str, rotation: float, outputs: dict[str, Outputs]) -> list[Check]:
    checks = []
    for coc, (label, textures) in zip(EDGE_COCS, outputs.items(), strict=True):
        alpha, behind = textures["result"][..., 0], textures["result"][..., 1]
        height, width = alpha.shape
        edge, x = width // 2 + 1, np.arange(width)
        polygon = polygon_of(aperture, rotation, coc)
        spread_off = np.abs(alpha - edge_spread(polygon, edge - x - 0.5)).max()
        through_off = np.abs(behind - (1.0 - alpha) * checker((width, height)))[:, x >= edge].max()
        hidden = (x < edge) & (edge - x < 0.3 * coc)
        filled = (behind / np.maximum(1.0 - alpha, STEP))[:, hidden]
        spread_bound = 0.5 * steepest(polygon) + UNCOVERED + STEP
        fill_error = 3 * STEP / (1.0 - alpha[:, hidden]).min()
        through_name = f"objects in focus, off from 1 - alpha of them by, {label}"
        checks += [
            Check(f"alpha off from the edge spread by, {label}", spread_off, 0.0, spread_bound, HALF_PIXEL),
            Check(through_name, through_off, 0.0, 2 * STEP, "it adds nothing: two stores"),
            Check(f"darkest behind the edge, {label}", filled.min(), 0.1 - fill_error, INFINITY, FILLED),
            Check(f"brightest behind the edge, {label}", filled.max(), -INFINITY, 0.8 + fill_error, FILLED),
        ]
    return checks


def edge_probe(aperture: str, rotation: float) -> Probe:
    """Return the probe of one polygon. `rotation` is in degrees."""
    title = f"A near edge spreads over objects in focus, {aperture}"
    shows = "A soft edge as a lens makes it; the checker is sharp up to the edge, and goes on behind it."
    cases = tuple(edge_case(coc, aperture, rotation) for coc in EDGE_COCS)
    judge, brief = partial(_judge_edges, aperture, rotation), aperture != "octagon"
    return Probe(f"near-edge-{aperture}", title, shows, cases, judge, brief)


PROBES = (edge_probe("hexagon", 0.0), edge_probe("octagon", 17.0))
