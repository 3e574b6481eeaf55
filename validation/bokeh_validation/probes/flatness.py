"""Probe layered: an isolated far light must become a flat polygon at any width. FLIP does not notice if it does not."""

import numpy as np

from bokeh_validation.frame import geometry, methods
from bokeh_validation.probes.highlight import Bokeh, block, polygon_of
from bokeh_validation.probes.lights import AMBIENT, LIGHT, mean_spread
from bokeh_validation.probes.model import Case, Check, Outputs, Probe, depth_of, flat, overlap, pixel_center
from bokeh_validation.probes.near_edges import metres, settings

PIXELS = 3  # side of the light
# Largest CoC in pixels -> maximum ripple there; 216 is 0.1 of the height at 4K, the largest by default
MOST_RIPPLE = {100: 0.05, 216: 0.08}
LEAST_OVERLAP = 0.88
WHY = "asked for: dots are seen from about this on, and a polygon has to be one"


def flat_case(aperture: str, coc: int, preset: str = "medium") -> Case:
    """Return a case with a far light of PIXELS x PIXELS in the middle, on a plane of the same depth. `coc` is in
    pixels.
    """
    side = coc + PIXELS + 40
    color = flat((side, side))
    color[..., :3] = 0.01, 0.01, AMBIENT
    color[block(((side - 1) // 2, (side - 1) // 2), PIXELS)][..., :3] = 0.0, 0.0, LIGHT + AMBIENT
    case_settings = settings(aperture, preset=preset)
    return Case(f"{aperture} of {coc} pixels", case_settings, color, depth_of((side, side), metres(coc, side)))


def measured(case: Case, coc: int, picture: np.ndarray) -> tuple[float, float]:
    """Return ripple and overlap of a result (H, W, >= 3) of flat_case().

    Ripple is the standard deviation over the mean inside the polygon, without the outer fifth, which half resolution
    makes soft. Overlap is measured with the shape that a lens gives the light.
    """
    lit = picture[..., 2].astype(np.float64) - AMBIENT
    corners = polygon_of(case.settings.aperture, case.settings.rotation, coc)
    first = (case.size[0] - PIXELS) // 2
    bokeh = Bokeh(corners, case.size, pixel_center(first, first))
    inside = lit[geometry.coverage(0.8 * corners, case.size, (first + PIXELS / 2, first + PIXELS / 2)) == 1.0]
    return float(inside.std() / inside.mean()), overlap(lit / lit.sum(), mean_spread(bokeh, PIXELS))


def checks(case: Case, coc: int, picture: np.ndarray) -> list[Check]:
    """Return the checks of a result (H, W, >= 3) of flat_case()."""
    ripple, overlap_with_polygon = measured(case, coc, picture)
    ripple_bound = next(ripple_bound for largest, ripple_bound in MOST_RIPPLE.items() if coc <= largest)
    return [
        Check(f"ripple, {case.label}", ripple, 0.0, ripple_bound, WHY),
        Check(f"overlap with the polygon, {case.label}", overlap_with_polygon, LEAST_OVERLAP, 1.0, WHY),
    ]


COC = 80
CASES = {aperture: flat_case(aperture, COC) for aperture in methods.EXACT}


def _judge(outputs: dict[str, Outputs]) -> list[Check]:
    return [check for case in CASES.values() for check in checks(case, COC, outputs[case.label]["result"])]


FLATNESS = Probe(
    "layered-flatness",
    "A wide polygon of a far light is flat",
    "Four even shapes: no dots, stripes or chevrons.",
    tuple(CASES.values()),
    _judge,
)
PROBES = (FLATNESS,)
