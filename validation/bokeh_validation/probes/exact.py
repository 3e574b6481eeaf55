"""The exact polygons: shape, light and flatness for every rotation, and highlights that add up where min fails."""

from functools import partial

import numpy as np

from bokeh_validation.frame import apertures, methods, polygons
from bokeh_validation.probes import impulse, two_points
from bokeh_validation.probes.model import Case, Check, Outputs, Probe, depth_of, flat, overlap, pixel_center

SIZE = (144, 112)  # not square, so that a missing aspect ratio shows
COC = 80  # pixels
CENTER = (72, 56)
# Rotations in degrees, of the bright pixel and of the wide highlight; one for a first answer: no polygon has an edge
# along the pixels
ROTATIONS, ONE_TURN = ((0.0, 7.0, 22.5, 45.0), (0.0, 22.5)), ((7.0,), (7.0,))
BLOCK, BLOCK_LEVEL = 9, impulse.PEAK / 16  # the wide highlight: its side in pixels, and its brightness

# What is asked of the overlap with the analytic polygon at a sample a pixel. The samples of one pixel are tents on a
# lattice that is not aligned with the pixels: in the square their sum ripples most.
OVERLAP = {"square": 0.86, "hexagon": 0.92, "octagon": 0.92, "decagon": 0.92}
# Two stores in half floats lose up to one step of 2^-10 each, where a device cuts off, and a step near AMBIENT, where
# most of a thinly spread highlight is, is up to 2^-11 / plateau of it. Asked for: 0.01.
HALF_LIGHT = 0.01
FLATNESS = 0.05


def settings(aperture: str, rotation: float, size: tuple[int, int] = SIZE, coc: float = COC) -> methods.Settings:
    """The exact method at a sample a pixel, with a CoC of `coc` pixels everywhere."""
    dense = {"coc": coc / size[1], "spacing": 1.0, "samples": 2 * COC + 1}
    return methods.Settings("exact", aperture, rotation=rotation, camera=methods.Camera(max_coc=1.0), **dense)


def polygon(aperture: str, rotation: float) -> np.ndarray:
    """Corners in pixels."""
    return COC * apertures.even_polygon(methods.EXACT[aperture], rotation)


def area(aperture: str) -> float:
    """Of the polygon, square pixels."""
    return abs(polygons.signed_area(polygon(aperture, 0.0)))


def impulse_case(aperture: str, rotation: float) -> Case:
    """One bright pixel."""
    return _case(f"{rotation:g} degrees", aperture, rotation, 1, impulse.PEAK)


def block_case(aperture: str, rotation: float) -> Case:
    """A bright square of BLOCK pixels."""
    return _case(f"wide highlight, {rotation:g} degrees", aperture, rotation, BLOCK, BLOCK_LEVEL)


def _case(label: str, aperture: str, rotation: float, side: int, level: float) -> Case:
    image, half = flat(SIZE, impulse.AMBIENT), side // 2
    rows, columns = (slice(middle - half, middle + half + 1) for middle in CENTER[::-1])
    image[rows, columns, :3] += level
    exposure = impulse.PICTURE * area(aperture) / (level * side**2)
    return Case(label, settings(aperture, rotation), image, depth_of(SIZE, 10.0), exposure=exposure)


def shape_checks(aperture: str, rotation: float, value: np.ndarray, light_tolerance: float) -> list[Check]:
    """Light and overlap of an impulse, (H, W) float64 without the ambient light."""
    label, least, most = f"{rotation:g} degrees", 1 - light_tolerance, 1 + light_tolerance
    truth = polygons.coverage(polygon(aperture, rotation), SIZE, pixel_center(*CENTER))
    found = overlap(value * area(aperture) / impulse.PEAK, truth)
    why = "bilinear samples share their light out completely; the rest is rounding of the stores"
    return [
        Check(f"light kept, {label}", value.sum() / impulse.PEAK, least, most, why),
        Check(f"overlap with the polygon, {label}", found, OVERLAP[aperture], 1.0, "asked for at a sample a pixel"),
    ]


def flatness_check(aperture: str, rotation: float, value: np.ndarray) -> Check:
    """Largest distance from flat inside the blur of the block, (H, W) float64 without the ambient light."""
    plateau = BLOCK_LEVEL * BLOCK**2 / area(aperture)
    # inside for every pixel of the block, and 2 pixels from the edge
    margin = BLOCK / 2 * np.sqrt(2.0) + 2.0
    apothem = COC / 2 * np.cos(np.pi / methods.EXACT[aperture])
    inner = polygon(aperture, rotation) * (1 - margin / apothem)
    off = np.abs(value[polygons.coverage(inner, SIZE, pixel_center(*CENTER)) == 1] / plateau - 1).max()
    return Check(f"wide highlight off from flat by, {rotation:g} degrees", off, 0.0, FLATNESS, "no seam: asked for")


def _judge(aperture: str, turns: tuple, outputs: dict[str, Outputs]) -> list[Check]:
    green = {label: output["result"][..., 1] - impulse.AMBIENT for label, output in outputs.items()}
    checks = []
    for turn in turns[0]:
        checks += shape_checks(aperture, turn, green[f"{turn:g} degrees"], HALF_LIGHT)
    wide = [flatness_check(aperture, turn, green[f"wide highlight, {turn:g} degrees"]) for turn in turns[1]]
    return checks + wide


def probe(aperture: str, turns: tuple = ROTATIONS) -> Probe:
    """The probe of one polygon."""
    points, blocks = turns
    cases = [impulse_case(aperture, turn) for turn in points] + [block_case(aperture, turn) for turn in blocks]
    degrees = ", ".join(f"{turn:g}" for turn in points)
    title = f"One bright pixel becomes a {aperture} of the same light"
    shows = f"A {aperture} of CoC {COC} pixels at {degrees} degrees, of the right brightness, and flat without a seam."
    return Probe(f"exact-{aperture}", title, shows, tuple(cases), partial(_judge, aperture, turns))


def _judge_sum(outputs: dict[str, Outputs]) -> list[Check]:
    green = {label: output["result"][..., 1] - impulse.AMBIENT for label, output in outputs.items()}
    alone = green["point 1"] + green["point 2"]
    exact, paper = (np.abs(green[label] - alone).max() / alone.max() for label in ("both", "paper"))
    why = "min finds light where there is none: Figure 12 must show, or this probe shows nothing"
    return [
        Check("two highlights off from their sum by", exact, 0.0, 0.01, "the method is linear; stores in half floats"),
        Check("the same, paper", paper, 0.2, float("inf"), why),
    ]


def sum_probe(aperture: str) -> Probe:
    """Two points at the distance that exposes min, alone and together."""
    size, places = two_points.SIZE, two_points.points(aperture)
    chosen, paper = settings(aperture, 0.0, size, impulse.COC), impulse.constant_coc(aperture, 0.0, size)
    shown = (("point 1", places[:1], chosen), ("point 2", places[1:], chosen), ("both", places, chosen))
    cases = [impulse.point_case(label, use, some, size) for label, some, use in (*shown, ("paper", places, paper))]
    title = f"Two highlights that add up, {aperture}"
    shows = "Two clean shapes where min makes false ones, as bright together as each alone."
    return Probe(f"two-points-exact-{aperture}", title, shows, tuple(cases), _judge_sum, "12, 13")


SUMS = tuple(sum_probe(name) for name in ("hexagon", "octagon"))
PROBES = (*(probe(aperture) for aperture in methods.EXACT), *SUMS)
QUICK_PROBES = (*(probe(aperture, ONE_TURN) for aperture in methods.EXACT), *SUMS)
