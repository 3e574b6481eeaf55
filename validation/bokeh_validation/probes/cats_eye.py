"""Character of a lens: a light towards a corner of the image, cut by the lens barrel, in the exact and in the layered
method (cat's eye); and curved blades.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

import numpy as np

from bokeh_validation.frame import apertures, polygons
from bokeh_validation.probes import exact, impulse, near_edges
from bokeh_validation.probes.model import Case, Check, Outputs, Probe, depth_of, flat, overlap, pixel_center

SIZE, PLACE = (280, 208), (222, 46)  # of the image; of the light
COC, AMOUNT, ROTATION = 40, 0.7, 7.0
LIGHT, AMBIENT, PIXELS = 800.0, 0.125, 3  # of the layered method's light
# The first pass has the polygons of other pixels, up to half a CoC away and on average half of that, in which a side
# moves by half of AMOUNT of the width, times that distance over the half diagonal
DRIFT = 0.5 * AMOUNT * COC * (0.25 * COC) / (0.5 * np.hypot(*SIZE))
APERTURES = ("hexagon", "octagon")


def rim(x: float, y: float, polygon: np.ndarray) -> np.ndarray:
    """How far the rims are from the middle of the aperture for a place in the image, pixels, (2,)."""
    place = (2.0 * np.array([x, y]) - SIZE) / np.hypot(*SIZE)
    apothem = np.linalg.norm(polygon + np.roll(polygon, 1, axis=0), axis=1).min() / 2
    return AMOUNT * apothem * place


def cut_area(polygon: np.ndarray, moved: np.ndarray) -> float:
    """Of what two polygons have in common, moved to both sides."""
    return abs(polygons.signed_area(polygons.clip_convex(polygon + moved, polygon - moved)))


def cut_at_light(aperture: str) -> np.ndarray:
    """The polygon as the lens barrel cuts it for the place of the light, (N, 2)."""
    polygon = COC * np.asarray(exact.polygon(aperture, ROTATION)) / exact.COC
    moved = rim(*pixel_center(*PLACE), polygon)
    return polygons.clip_convex(polygon + moved, polygon - moved)


@lru_cache
def truth(aperture: str) -> np.ndarray:
    """Share of the light that each pixel gets, (H, W): its own polygon, cut as it is there, holds the light's pixel.

    By the definition: a place is in a polygon moved to both sides where it is in both; no edges, no lengths.
    """
    polygon = COC * np.asarray(exact.polygon(aperture, ROTATION)) / exact.COC
    found = np.zeros(SIZE[::-1])
    light, reach, steps = np.array(pixel_center(*PLACE)), COC // 2 + 1, (np.arange(8) + 0.5) / 8
    for row in range(PLACE[1] - reach, PLACE[1] + reach + 1):
        for column in range(PLACE[0] - reach, PLACE[0] + reach + 1):
            moved = rim(column + 0.5, row + 0.5, polygon)
            x, y = np.meshgrid(light[0] - column - steps, light[1] - row - steps)
            within = polygons.inside(polygon + moved, x, y) & polygons.inside(polygon - moved, x, y)
            if within.any():
                found[row, column] = within.mean() / cut_area(polygon, moved)
    return found


def exact_case(aperture: str) -> Case:
    """One bright pixel; a sample a pixel."""
    image = flat(SIZE, impulse.AMBIENT)
    image[PLACE[1], PLACE[0], :3] += impulse.PEAK
    chosen = replace(exact.settings(aperture, ROTATION, SIZE, COC), cats_eye=AMOUNT)
    exposure = impulse.PICTURE * abs(polygons.signed_area(cut_at_light(aperture))) / impulse.PEAK
    return Case(aperture, chosen, image, depth_of(SIZE, 10.0), exposure=exposure)


def layered_case(sign: int) -> Case:
    """A blue light of PIXELS far behind or before a plane: as in lights.py, with a cat's eye."""
    image, rows = flat(SIZE, 0.01), [slice(at - PIXELS // 2, at + PIXELS // 2 + 1) for at in PLACE[::-1]]
    image[..., 2] = AMBIENT
    depth = depth_of(SIZE, near_edges.metres(COC, SIZE[1]) if sign > 0 else near_edges.CAMERA.focus_distance)
    image[(*rows, slice(0, 3))] = 0.0, 0.0, LIGHT + AMBIENT
    depth[tuple(rows)] = near_edges.metres(sign * COC, SIZE[1])
    chosen = near_edges.settings(preset="high", cats_eye=AMOUNT, rotation=ROTATION)
    exposure = impulse.PICTURE * abs(polygons.signed_area(cut_at_light("hexagon"))) / (LIGHT * PIXELS**2)
    return Case("far" if sign > 0 else "near", chosen, image, depth, exposure=exposure)


def checks(label: str, aperture: str, value: np.ndarray, light: float, off: float) -> list[Check]:
    """Light and shape of a light's bokeh, (H, W) without what is around; its outline may be off by `off` pixels."""
    wanted, shape = truth(aperture), cut_at_light(aperture)
    polygon = COC * np.asarray(exact.polygon(aperture, ROTATION)) / exact.COC
    area, edge = abs(polygons.signed_area(shape)), off * polygons.perimeter(shape)
    least = (area - edge) / (area + edge)
    whole = polygons.coverage(polygon, SIZE, pixel_center(*PLACE)) / abs(polygons.signed_area(polygon))
    why = f"outline known to {off:.2f} pixels: half a pixel, and the first pass has the polygons of other pixels"
    kept = value.sum() / (light * wanted.sum())
    return [
        Check(f"light, in units of the lens's, {label}", kept, 1 - edge / area / 4, 1 + edge / area / 4, why),
        Check(f"overlap with the cut polygon, {label}", overlap(value / light, wanted), least, 1.0, why),
        Check(f"the whole polygon overlaps less, {label}", overlap(wanted, whole), 0.0, least, "it shows"),
    ]


def _judge_exact(outputs: dict[str, Outputs]) -> list[Check]:
    found = []
    for label, output in outputs.items():
        value = output["result"][..., 1] - impulse.AMBIENT
        found += checks(label, label, value, impulse.PEAK, 0.5 + DRIFT)
    return found


def _judge_layered(outputs: dict[str, Outputs]) -> list[Check]:
    found = []
    for label, output in outputs.items():
        covered = truth("hexagon") * PIXELS**2 * (label == "near")
        value = output["result"][..., 2] - AMBIENT * (1.0 - covered)
        found += checks(label, "hexagon", value, LIGHT * PIXELS**2, 1.0 + DRIFT)
    return found


def _probe(name: str, cases: tuple[Case, ...], judge: Callable, but: tuple[str, ...] = ()) -> Probe:
    title = "A light towards a corner of the image is cut by the lens barrel"
    shows = "The narrow side points to the middle of the image; edges are straight, and the brightness is even."
    return Probe(name, title, shows, cases, judge, but=but)


ROUNDNESSES = (0.1, 0.5)


def rounded(roundness: float) -> np.ndarray:
    """A square with its corners cut off, for a CoC of 1: on the circle a corner takes so much of an eighth, a side the
    rest of its quarter.
    """
    half = 0.5 * (90.0 - 45.0 * roundness)
    angles = [90.0 * quarter + side * half for quarter in range(4) for side in (-1, 1)]
    return np.array([0.5 * apertures.direction(np.radians(angle + ROTATION)) for angle in angles])


def rounded_case(roundness: float) -> Case:
    """One bright pixel by the passes of the octagon."""
    image = flat(exact.SIZE, impulse.AMBIENT)
    image[exact.CENTER[1], exact.CENTER[0], :3] += impulse.PEAK
    chosen = replace(exact.settings("octagon", ROTATION), roundness=roundness)
    exposure = impulse.PICTURE * abs(polygons.signed_area(exact.COC * rounded(roundness))) / impulse.PEAK
    return Case(f"{roundness:g}", chosen, image, depth_of(exact.SIZE, 10.0), exposure=exposure)


def _judge_rounded(outputs: dict[str, Outputs]) -> list[Check]:
    found = []
    for roundness in ROUNDNESSES:
        value = outputs[f"{roundness:g}"]["result"][..., 1] - impulse.AMBIENT
        polygon = exact.COC * rounded(roundness)
        wanted = polygons.coverage(polygon, exact.SIZE, pixel_center(*exact.CENTER))
        shape = overlap(value * abs(polygons.signed_area(polygon)) / impulse.PEAK, wanted)
        light, why = value.sum() / impulse.PEAK, "bilinear samples share their light out; the rest is rounding"
        asked = "as of the square at a sample a pixel"
        found += [
            Check(f"light kept, {roundness:g}", light, 1 - exact.HALF_LIGHT, 1 + exact.HALF_LIGHT, why),
            Check(f"overlap with the polygon, {roundness:g}", shape, exact.OVERLAP["square"], 1.0, asked),
        ]
    return found


ROUND = Probe(
    "curved-blades",
    "A square that curved blades make round",
    "A square, and a square with its corners cut off, of the same light.",
    tuple(map(rounded_case, ROUNDNESSES)),
    _judge_rounded,
)
PROBES = (
    _probe("cats-eye-exact", tuple(map(exact_case, APERTURES)), _judge_exact),
    # shader model 3 has no room for it
    _probe("cats-eye-layered", tuple(map(layered_case, (1, -1))), _judge_layered, ("d3d9",)),
    ROUND,
)
