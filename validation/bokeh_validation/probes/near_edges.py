"""The layered method: near edges and thin near things over what is in focus.

Red is what is near, green what is in focus, blue a light: so each can be told from the others in one picture. Levels
are alike, since the method compares brightness with that of the neighbourhood.
"""

from functools import partial
from math import ceil

import numpy as np

from bokeh_validation.frame import apertures, methods, polygons
from bokeh_validation.probes.model import Case, Check, Outputs, Probe, depth_of, flat

CAMERA = methods.Camera(aperture_diameter=1.0, focal_length=0.05, focus_distance=2.0, max_coc=1.0)
SIZE = (96, 64)
# One store in a half float that is cut off: a step of 2^-10 at most
STEP = 2.0**-10
# From a near share of 0.998 a pixel counts as covered
WHOLE = 0.002
INFINITY = float("inf")


def metres(coc: float, height: int) -> float:
    """Depth at which the signed CoC is so many pixels."""
    camera = CAMERA
    magnification = camera.focal_length / (camera.focus_distance - camera.focal_length)
    farthest = camera.aperture_diameter * magnification / camera.sensor_height * height
    return camera.focus_distance / (1.0 - coc / farthest)


def settings(aperture: str = "hexagon", **changes) -> methods.Settings:
    """The layered method through CAMERA."""
    return methods.Settings("layered", aperture, camera=CAMERA, **changes)


def checker(size: tuple[int, int]) -> np.ndarray:
    """Squares of 8 pixels of 0.1 and 0.8, (H, W)."""
    y, x = np.mgrid[0 : size[1], 0 : size[0]]
    return 0.1 + 0.7 * ((x // 8 + y // 8) % 2)


def edge_spread(polygon: np.ndarray, distances: np.ndarray) -> np.ndarray:
    """Share of a polygon on the left of an upright line at each distance from its middle: the integral of its width."""
    far = 2.0 * np.abs(polygon).max() + np.abs(distances).max()
    area = abs(polygons.signed_area(polygon))
    left, right = polygon[:, 0].min(), polygon[:, 0].max()
    found = (np.asarray(distances) >= right).astype(float)
    for index, distance in enumerate(distances):
        if left < distance < right:
            half = np.array([[-far, -far], [distance, -far], [distance, far], [-far, far]])
            found[index] = abs(polygons.signed_area(polygons.clip_convex(polygon, half))) / area
    return found


def steepest(polygon: np.ndarray) -> float:
    """Largest change of the edge spread over a pixel: the polygon's largest width over its area."""
    places = np.linspace(polygon[:, 0].min(), polygon[:, 0].max(), 129)
    return float((np.diff(edge_spread(polygon, places)) / np.diff(places)).max())


def polygon_of(aperture: str, rotation: float, coc: float) -> np.ndarray:
    """Corners in pixels."""
    return abs(coc) * apertures.even_polygon(methods.EXACT[aperture], rotation)


EDGE_COCS = (80, 24, 12)
HALF_PIXEL = "texels of half the size lie half a pixel off the pixels: so is an edge, times the steepest slope"
FILLED = "what is hidden is filled with a mean of what is around, 0.1 to 0.8; three stores, over 1 - alpha"


def edge_size(coc: float) -> tuple[int, int]:
    """As wide as the blur and some pixels on both sides; CAMERA has no CoC above the height."""
    return 2 * ceil(coc * 0.5) + 24, max(48, coc + 8)


def near_case(label: str, coc: float, held: np.ndarray, chosen: methods.Settings) -> Case:
    """Something red and near, held (H, W) bool, over a green checker in focus."""
    height, width = held.shape
    color, depth = flat((width, height)), depth_of((width, height), CAMERA.focus_distance)
    color[..., 0] = held
    color[..., 1] = np.where(held, 0.0, checker((width, height)))
    depth[held] = metres(-coc, height)
    return Case(label, chosen, color, depth)


def edge_case(coc: float, aperture: str, rotation: float) -> Case:
    """The left half is near; the edge lies between two pixels of a texel of half the size."""
    width, height = edge_size(coc)
    held = np.broadcast_to(np.arange(width) < width // 2 + 1, (height, width))
    return near_case(f"CoC {coc}", coc, held, settings(aperture, rotation=rotation))


def _judge_edges(aperture: str, rotation: float, outputs: dict[str, Outputs]) -> list[Check]:
    checks = []
    for coc in EDGE_COCS:
        width, _ = size = edge_size(coc)
        result = outputs[f"CoC {coc}"]["result"]
        alpha, behind = result[..., 0], result[..., 1]
        edge, x = width // 2 + 1, np.arange(width)
        polygon = polygon_of(aperture, rotation, coc)
        spread_off = np.abs(alpha - edge_spread(polygon, edge - x - 0.5)).max()
        through_off = np.abs(behind - (1.0 - alpha) * checker(size))[:, x >= edge].max()
        hidden = (x < edge) & (edge - x < 0.3 * coc)
        filled = (behind / np.maximum(1.0 - alpha, STEP))[:, hidden]
        known = 0.5 * steepest(polygon) + WHOLE + STEP
        off = 3 * STEP / (1.0 - alpha[:, hidden]).min()
        through, own = "what is in focus, off from 1 - alpha of it by", "it adds nothing of its own: two stores"
        checks += [
            Check(f"alpha off from the edge spread by, CoC {coc}", spread_off, 0.0, known, HALF_PIXEL),
            Check(f"{through}, CoC {coc}", through_off, 0.0, 2 * STEP, own),
            Check(f"darkest behind the edge, CoC {coc}", filled.min(), 0.1 - off, INFINITY, FILLED),
            Check(f"brightest behind the edge, CoC {coc}", filled.max(), -INFINITY, 0.8 + off, FILLED),
        ]
    return checks


def edge_probe(aperture: str, rotation: float) -> Probe:
    """The probe of one polygon."""
    title = f"A near edge spreads over what is in focus, {aperture}"
    shows = "A soft edge as a lens makes it; the checker is sharp up to the edge, and goes on behind it."
    cases = tuple(edge_case(coc, aperture, rotation) for coc in EDGE_COCS)
    return Probe(f"near-edge-{aperture}", title, shows, cases, partial(_judge_edges, aperture, rotation))


# An upright near line of three pixels, an odd column first
BRANCH_SIZE, BRANCH_COC = (80, 48), 24
BRANCH_WIDTH, BRANCH_FIRST = 3, BRANCH_SIZE[0] // 2 - 1


def branch_case() -> Case:
    """The line over the checker."""
    held = np.zeros(BRANCH_SIZE[::-1], bool)
    held[:, BRANCH_FIRST : BRANCH_FIRST + BRANCH_WIDTH] = True
    return near_case("branch", BRANCH_COC, held, settings())


def _judge_branch(outputs: dict[str, Outputs]) -> list[Check]:
    alpha = outputs["branch"]["result"][..., 0]
    x, polygon = np.arange(BRANCH_SIZE[0]), polygon_of("hexagon", 0.0, BRANCH_COC)
    after, before = (edge_spread(polygon, BRANCH_FIRST + e - x - 0.5) for e in (BRANCH_WIDTH, 0))
    wanted = after - before
    off = np.abs(alpha - wanted).max()
    known = np.abs(np.diff(wanted)).max() + WHOLE * wanted.max() + STEP
    why = "its texels of half the size reach a pixel beyond it on either side, times the steepest slope"
    light = alpha.sum(axis=1) / BRANCH_WIDTH
    return [
        Check("alpha off from the spread of the line by", off, 0.0, known, why),
        Check("light kept, darkest row", light.min(), 0.99, 1.01, "asked for of isolated lights"),
        Check("light kept, brightest row", light.max(), 0.99, 1.01, "the same"),
    ]


BRANCH = Probe(
    "near-branch",
    "A thin near branch becomes a soft band",
    "A faint red band without grain, and the checker sharp through it.",
    (branch_case(),),
    _judge_branch,
)

PROBES = (edge_probe("hexagon", 0.0), edge_probe("octagon", 17.0), BRANCH)
