"""Probe layered with thin objects beside and between near objects.

Near objects are red, and the background is blue, so that the light of both can be told apart in one image.
"""

import numpy as np

from bokeh_validation.probes.highlight import polygon_of
from bokeh_validation.probes.model import Case, Check, Outputs, Probe, depth_of, flat
from bokeh_validation.probes.near_edges import STEP, edge_spread, metres, settings

SIZE = (160, 96)
MIDDLE, ROW = SIZE[0] // 2, SIZE[1] // 2
LINE = 20.0
# The near object beside the line has less than half of the largest CoC in reach, so it is left to the gather, whose
# samples then lie far apart
GATHERED, LARGEST = 34, 76
# A local maximum is a copy of the line if it is at least this fraction of the largest one
COPY = 0.03
PRESETS = ("medium", "high")
# CoC of the line in pixels, negative in front of the focus, and preset -> copies and light kept, measured on llvmpipe
LINES = {
    (4, "medium"): (2, 1.00),
    (6, "medium"): (4, 1.00),
    (9, "medium"): (3, 1.00),
    (12, "medium"): (6, 1.01),
    (-6, "medium"): (3, 1.01),
    (-9, "medium"): (4, 1.00),
    (4, "high"): (1, 1.00),
    (6, "high"): (3, 1.00),
    (9, "high"): (5, 1.01),
    (12, "high"): (4, 0.97),
    (-6, "high"): (2, 0.96),
    (-9, "high"): (3, 0.99),
}
SLIT, BEHIND = 2, 20
# CoC of the near objects in pixels, and preset -> light through the slit, and its largest brightness, as fractions of
# the ideal
SLITS = {
    (24, "medium"): (0.99, 0.97),
    (40, "medium"): (0.78, 0.97),
    (60, "medium"): (0.70, 0.96),
    (24, "high"): (0.99, 0.97),
    (40, "high"): (0.78, 0.97),
    (60, "high"): (0.70, 0.95),
}
# Each pixel is stored three times in a layer and once in the result, and every store may lose a STEP of its light. What
# was recorded is rounded to a hundredth.
KNOWN = 4 * STEP + 0.005
RECORDED = "recorded, for a change to be seen"


def line_case(coc: int, preset: str) -> Case:
    """Return a vertical line, a pixel wide, on black of the same CoC in pixels, and near objects left of it."""
    color, depth = flat(SIZE), depth_of(SIZE, metres(coc, SIZE[1]))
    color[:, MIDDLE, 2] = LINE
    for edge, near_coc in ((MIDDLE - 20, GATHERED), (MIDDLE - 56, LARGEST)):
        color[:, :edge, 0] = 0.5
        depth[:, :edge] = metres(-near_coc, SIZE[1])
    return Case(f"a line of CoC {coc}, {preset.upper()}", settings(preset=preset), color, depth)


def slit_case(coc: int, preset: str) -> Case:
    """Return near objects with a CoC in pixels, and a vertical slit between them, through which a far plane is seen."""
    color, depth = flat(SIZE), depth_of(SIZE, metres(-coc, SIZE[1]))
    color[..., 0] = 0.5
    slit = slice(MIDDLE, MIDDLE + SLIT)
    color[:, slit, :3] = 0.0, 0.0, 1.0
    depth[:, slit] = metres(BEHIND, SIZE[1])
    return Case(f"a slit between CoC {coc}, {preset.upper()}", settings(preset=preset), color, depth)


def line_measured(coc: int, result: np.ndarray) -> tuple[int, float]:
    """Return the copies of the line that a result (H, W, >= 3) shows, and the fraction of its light."""
    reach = abs(coc) // 2 + 8
    profile = result[ROW, MIDDLE - reach : MIDDLE + reach + 1, 2]
    inner = profile[1:-1]
    is_copy = (inner > profile[:-2]) & (inner >= profile[2:]) & (inner > COPY * profile.max())
    return int(is_copy.sum()), float(profile.sum() / LINE)


def slit_measured(coc: int, result: np.ndarray) -> tuple[float, float]:
    """Return the light through the slit and its largest brightness in a result (H, W, >= 3), relative to the ideal:
    the near objects cover what their discs of `coc` pixels cover.
    """
    profile, places = result[ROW, :, 2], np.arange(SIZE[0]) - MIDDLE
    polygon = polygon_of("hexagon", 0.0, coc)
    ideal = edge_spread(polygon, places + 0.5) - edge_spread(polygon, places + 0.5 - SLIT)
    return float(profile.sum() / SLIT), float(profile.max() / ideal.max())


def _judge_lines(outputs: dict[str, Outputs]) -> list[Check]:
    checks = []
    for ((coc, _), (copies, light)), (label, textures) in zip(LINES.items(), outputs.items(), strict=True):
        seen, kept = line_measured(coc, textures["result"])
        checks += [
            Check(f"copies, {label}", seen, 1, copies, f"{RECORDED}; a lens shows 1"),
            Check(f"light kept, {label}", kept, light - KNOWN, light + KNOWN, RECORDED),
        ]
    return checks


def _judge_slits(outputs: dict[str, Outputs]) -> list[Check]:
    checks = []
    for ((coc, _), (light, _)), (label, textures) in zip(SLITS.items(), outputs.items(), strict=True):
        through, brightest = slit_measured(coc, textures["result"])
        checks += [
            Check(f"light, {label}", through, light - KNOWN, light + KNOWN, f"{RECORDED}; a lens lets through 1"),
            Check(f"brightest, {label}", brightest, 0.9, 1.0 + KNOWN, "brighter, it would be a bright line"),
        ]
    return checks


PROBES = (
    Probe(
        "thin-line",
        "A thin bright line beside a near object",
        "The line is a band as wide as its CoC, without stripes.",
        tuple(line_case(*key) for key in LINES),
        _judge_lines,
    ),
    Probe(
        "slit",
        "A slit between two near objects",
        "A faint blue band as wide as the CoC, without a bright line in it.",
        tuple(slit_case(*key) for key in SLITS),
        _judge_slits,
    ),
)
