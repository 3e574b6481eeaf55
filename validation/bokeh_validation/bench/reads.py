"""What a filter pass fetches, and where: for its floor, and for the table of costs."""

from dataclasses import dataclass, replace

import numpy as np

from bokeh_validation import fetches
from bokeh_validation.entries import ADAPTIVE, COPYING_ENTRIES, GRID, LINE
from bokeh_validation.passes import Pass
from bokeh_validation.reference import listings, segments
from bokeh_validation.reference.lines import lines
from bokeh_validation.reference.segments import Segment

TARGET_BYTES = 8  # RGBA16F


@dataclass(frozen=True)
class Line:
    """Samples on a line, or on a grid.

    slot      where its colour comes from
    middle    (2,) from the pixel to the line's middle
    half      (2,) from there to its end; both in units of the CoC, x to the right, y down
    count     samples; the most of them where `spacing` > 0
    ends      True: the first and the last sample are the line's ends; False: the middles of `count` equal parts
    spacing   pixels between samples, 0: exactly `count`
    side      (2,) the same as `half` for the other side of a grid of count x count samples, or None
    """

    slot: str
    middle: np.ndarray
    half: np.ndarray
    count: int
    ends: bool = False
    spacing: float = 0.0
    side: np.ndarray | None = None

    @property
    def samples(self) -> int:
        """All of them, at most."""
        return self.count if self.side is None else self.count**2

    def counts(self, coc: np.ndarray, height: int) -> np.ndarray:
        """Samples that pixels of this CoC take: `coc` is a fraction of the image height, of any shape."""
        if self.spacing <= 0.0:
            return np.full(np.shape(coc), self.samples)
        used = segments.filter_coc(coc, height, self.spacing)
        cells = np.clip(2.0 * np.hypot(*self.half) * used * height / self.spacing, 1.0, self.count)
        return np.where(used > 0.0, np.ceil(cells), 0.0)


@dataclass(frozen=True)
class Reads:
    """All fetches of a pass beside the pixel's own colour and depth.

    depth   whether it fetches depth, at the pixel and at every sample
    lines   in the order in which the pass takes them
    others  further colour textures that it fetches at the pixel
    skips   whether a pixel whose CoC is below half a pixel takes its own colour and nothing else of the lines
    """

    lines: tuple[Line, ...]
    others: tuple[str, ...] = ()
    skips: bool = False
    depth: bool = True


def reads(item: Pass) -> Reads:
    """The fetches of a filter pass. Raises KeyError for another one."""
    role, along = item.spec.role, lines(item)
    if not along:
        raise KeyError(item.entry)
    side, spacing = None, 0.0 if role == LINE else item.values()["BokehSpacing"]
    if role == GRID:
        # its first line is one side away from the middle
        side, spacing = -along[0].segment.middle, 0.0
        along = (replace(along[0], segment=Segment(np.zeros(2), along[0].segment.half)),)
    found = tuple(
        Line(line.slot, line.segment.middle, line.segment.half, item.samples, role in (LINE, GRID), spacing, side)
        for line in along
    )
    others = ("ColorSampB",) if role in (LINE, ADAPTIVE) and "ColorSampB" in item.inputs else ()
    return Reads(found, others, role not in (LINE, GRID), "DepthSamp" in item.inputs)


@dataclass(frozen=True)
class Cost:
    """Of one picture, CoC map and all: passes, and a pixel's colour and depth fetches and bytes written.

    Fetches are means; of the layers they are the most that a pixel takes, or all that it takes in focus. A texel of a
    target of 1 / n of the size counts 1 / n^2.
    """

    passes: int
    color: float
    depth: float
    written: float


def stored_coc(item: Pass, depth: np.ndarray) -> np.ndarray:
    """Size of the CoC that the first pass stores in a half float, from depth (H, W) in metres; (H, W)."""
    values = item.values()
    if item.entry == "BokehConstantCoC":
        found = np.full(depth.shape, min(values["BokehConstantCoC"], values["BokehMaxCoC"]))
    else:
        found = listings.circle_of_confusion(
            listings.safe_depth(depth.astype(np.float64)),
            values["BokehApertureDiameter"],
            values["BokehFocalLength"],
            values["BokehFocusDistance"],
            values["BokehSensorHeight"],
            values["BokehMaxCoC"],
        )
    return found.astype(np.float16).astype(np.float64)


def cost(passes: tuple[Pass, ...], depth: np.ndarray) -> Cost:
    """Cost of a plan on this depth, (H, W) in metres: filter passes that all blur by the CoC of the first pass."""
    color, of_depth, written = 0.0, 0.0, 0.0
    coc = stored_coc(passes[0], depth)
    for item in passes:
        written += TARGET_BYTES * len(item.outputs) / item.scale**2
        if item.spec.layers:
            color += fetches.of_pass(item, not coc.any())["color"] / item.scale**2
            continue
        if item.entry in COPYING_ENTRIES:
            color += 1
            of_depth += item.entry != "BokehConstantCoC"
            continue
        found = reads(item)
        blurred = np.ones(coc.shape)
        if found.skips:
            blurred = (segments.filter_coc(coc, len(depth), item.values()["BokehSpacing"]) > 0.0).astype(float)
        samples = sum(line.counts(coc, len(depth)) for line in found.lines) * blurred
        color += float(np.mean(samples)) + 1 + len(found.others)
        of_depth += float(np.mean(samples + blurred)) if found.depth else 0.0
    return Cost(len(passes), color, of_depth, written)
