"""Colour and depth that no renderer should hand over, what docs/inputs.md says that each counts as, and its reach."""

from collections.abc import Mapping

import numpy as np

from bokeh_validation.frame import methods
from bokeh_validation.reference import sampling, segments
from bokeh_validation.reference.lines import lines
from bokeh_validation.reference.listings import MAX_COLOR, MAX_DEPTH, MIN_DEPTH
from bokeh_validation.reference.segments import Segment
from bokeh_validation.shaders.entries import GRID, LINE, TABLE

# A half-float channel and what it counts as; 6e-8 is the smallest denormal half float
COLOR = (
    (np.nan, 0.0),
    (np.inf, MAX_COLOR),
    (-np.inf, 0.0),
    (-1.0, 0.0),
    (-MAX_COLOR, 0.0),
    (-6e-8, 0.0),
    (-0.0, 0.0),
    (6e-8, 6e-8),
    (MAX_COLOR, MAX_COLOR),
)
# Depth, metres, and what it counts as
DEPTH = (
    (np.nan, MIN_DEPTH),
    (np.inf, MAX_DEPTH),
    (-np.inf, MIN_DEPTH),
    (-1.0, MIN_DEPTH),
    (0.0, MIN_DEPTH),
    (1e-30, MIN_DEPTH),
    (1e30, MAX_DEPTH),
)
STEP = 0.8


def sprinkled(random: np.random.Generator, pixels: np.ndarray, pairs, share: float) -> np.ndarray:
    """The pixels with about `share` of their numbers replaced by the first numbers of some of `pairs`."""
    chosen = random.choice(np.array([bad for bad, _ in pairs]), pixels.shape).astype(pixels.dtype)
    return np.where(random.random(pixels.shape) < share, chosen, pixels)


def reach(plan: methods.Plan, clean: Mapping[str, np.ndarray], bad: np.ndarray, bad_depth: np.ndarray) -> np.ndarray:
    """Which pixels of the result may differ from those of an image without the bad pixels, (H, W) bool.

    clean      every texture that the passes write, for the image without them: the CoC of each pass
    bad        (H, W) bool: pixels with bad colour or depth
    bad_depth  (H, W) bool: those with bad depth, which every pass but those of exact reads

    Every pass gathers, so a pixel changes only where a texel that it reads has: its own, or one under a sample. The
    samples lie on lines whose places follow from the pixel's own CoC, and where nothing in reach changed that is the
    clean image's. A line is followed in steps of STEP texels at most, so a sample is within STEP / 2 of a step. What a
    device may be off (reference/precision.py: 2^-8 of a texel, 2^-11 of the CoC for the line's angle, 2^-11 for the
    stored CoC) is less than 0.05 texels for a CoC below 40. Together that is less than half a texel, and a place less
    than half a texel from one in texel i is less than 1 from that texel's centre. The linear filter reads texels whose
    centres are less than 1 from the place: i - 1, i, i + 1 and no others. Hence 3 x 3 texels around each step.
    """
    touched = {"coc": bad}
    height = len(bad)
    for item in plan.passes[1:]:
        read_depth = bad_depth if "DepthSamp" in item.inputs else np.zeros_like(bad)
        near = {
            slot: sampling.neighbourhood((touched[name] | read_depth)[..., None])[..., 0]
            for slot, name in item.inputs.items()
            if slot.startswith("ColorSamp")
        }
        found = np.any(list(near.values()), axis=0)
        fixed = item.spec.role in (LINE, GRID, TABLE)
        coc = np.abs(clean[item.inputs["ColorSamp"]][..., 3].astype(np.float64))
        used = height * segments.filter_coc(coc, height, 0.0 if fixed else item.values()["BokehSpacing"])
        read = [(line.slot, line.segment) for line in lines(item)]
        if item.spec.role == TABLE:
            table = plan.tables["kernel"][0, :, :2].astype(np.float64) * [item.values()["BokehSqueeze"], 1.0]
            read = [("ColorSamp", Segment(offset, np.zeros(2))) for offset in table]
        for slot, segment in read:
            found |= _on_line(near[slot], used, segment)
        touched |= dict.fromkeys(item.outputs, found)
    return touched[plan.result]


def _on_line(mask: np.ndarray, coc: np.ndarray, line: Segment) -> np.ndarray:
    """Where a line meets a texel of the mask. `coc` in texels."""
    height, width = mask.shape
    y, x = np.mgrid[0:height, 0:width] + 0.5
    count = 2 + int(np.ceil(2.0 * np.abs(line.half).max() * coc.max() / STEP))
    found = np.zeros_like(mask)
    for t in np.linspace(-1.0, 1.0, count):
        place = line.middle + t * line.half
        found |= mask.reshape(-1)[sampling.nearest_index(x + place[0] * coc, y + place[1] * coc, (width, height))]
    return found
