"""The adaptive line and the exact polygons in float64: sections [4], [5] and [8] of the libraries beyond the paper.

Derivation of the interval, beside what reference/precision.py says. A line is 2 h long (units of the CoC), the CoC c is
off by at most e, the image H texels high, so the line's length l = 2 h c H is off by 2 h e H. Cut into x cells, it has
its samples at t h c H from its middle, |t| <= 1:

  * fixed count, or as many cells as are allowed: t does not depend on c, so a sample is off by |t| h e H.
  * cells of a given length, counted from the line's beginning: they move with it, by h e H. The last one reaches to
    the line's end, so its sample is between two places that move by that much. Its weight, its length in cells, is off
    by as many cells as the line is.

A count that differs because x is a little off adds or drops cells of a length within that error: they are all there,
with their least and largest weight. Lines of a polygon that is cut (cuts.py) are off by more: their ends by
Segment.turns, their lengths by Segment.stretch, both times Precision.line.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import pi, sin

import numpy as np

from bokeh_validation.frame import apertures
from bokeh_validation.reference import cuts
from bokeh_validation.reference.gather import Leakage, Sample, gather
from bokeh_validation.reference.images import Image
from bokeh_validation.reference.precision import FLOAT_STEP, Precision

# Interleaved gradient noise (Jimenez 2014); a frame adds 33/64, in pass p 8 p + 1 times
NOISE = (0.06711056, 0.00583715, 52.9829189)
FRAME_STEP, FRAMES, PASS_STEPS = 33 / 64, 64, 8
LENGTH_ROUNDINGS = 16


@dataclass(frozen=True)
class Segment:
    """A line: middle and half of it, units of the CoC, x right, y down, each (2,); (2, H, W) where pixels differ.

    turns    how far off its ends may be, in units of Precision.line
    stretch  the same of its length
    """

    middle: np.ndarray
    half: np.ndarray
    turns: float = 1.0
    stretch: float = 0.0

    @property
    def half_length(self) -> float | np.ndarray:
        """Half its length, units of the CoC."""
        return float(np.hypot(*self.half)) if self.half.ndim == 1 else np.hypot(*self.half)

    def part(self, rows: slice) -> "Segment":
        """Of some rows of the image: (2, 1, 1) or (2, rows, W)."""
        return replace(self, middle=part_of(self.middle, rows), half=part_of(self.half, rows))


def part_of(field: np.ndarray, rows: slice) -> np.ndarray:
    """Some rows of a vector (2,) or a field of vectors (2, H, W)."""
    return field[:, None, None] if field.ndim == 1 else field[:, rows]


@dataclass(frozen=True)
class Spacing:
    """How a line is sampled.

    spacing    pixels between samples; 0: exactly max_samples
    jitter     (H, W) phase of each pixel's samples, -0.5 .. 0.5; or 0
    open       (H, W) how far off the jitter may be; all of its range where a device's may be at the other end
    undecided  (H, W) bool: where that is so
    """

    pixels: float
    max_samples: int
    jitter: np.ndarray | float = 0.0
    open: np.ndarray | float = 0.0
    undecided: np.ndarray | bool = False


def line_segment(angle: float, length: float, middle: tuple[float, float], squeeze: float) -> Segment:
    """`BokehSegment` of the shaders. `angle` in radians."""
    shape = np.array([squeeze, 1.0])
    return Segment(np.array(middle) * shape, 0.5 * length * apertures.direction(angle) * shape)


def polygon_edge(
    k: int, sides: int, rotation: float, squeeze: float, second_pass: bool, lengths: np.ndarray | None = None
) -> Segment:
    """`BokehPolygonEdge`: edge k of a polygon as it is filtered along in one of the two passes.

    The outline begins at the corner V_0, minus half of all edges; edge k runs from V_(k-1) to V_k, its middle is M_k.
    The first pass filters along M_k - Q, Q the mean of M_1 .. M_(n-1), the second along Q - V_0 - M_k: the two together
    put the parallelogram of the edges i < k at M_i - M_k - V_0, where the tiling wants it.

    lengths  of edges 1 .. n, (n, H, W), from cuts.lengths; None: all alike, inscribed in the CoC
    """
    step, count = 2.0 * pi / sides, sides // 2
    long = np.full(count, sin(0.5 * step)) if lengths is None else lengths
    along = [apertures.direction(rotation + i * step + 0.5 * pi) for i in range(1, count + 1)]
    edges = [np.multiply.outer(direction, one) for direction, one in zip(along, long, strict=True)]
    corner = [-0.5 * sum(edges)]
    for edge in edges:
        corner.append(corner[-1] + edge)
    middles = [(corner[j] + corner[j + 1]) / 2 for j in range(count)]
    mean_of_first = sum(middles[:-1]) / (count - 1)
    middle = middles[k - 1] - mean_of_first
    if second_pass:
        middle = -middle - corner[0]
    shape = np.array([squeeze, 1.0]).reshape(2, *(1 for _ in middle.shape[1:]))
    off = (1.0, 0.0) if lengths is None else (cuts.TURNS, cuts.STRETCH)
    return Segment(middle * shape, 0.5 * edges[k - 1] * shape, *off)


def noise(size: tuple[int, int], frame: float, pass_index: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """`BokehNoise`, (H, W), -0.5 .. 0.5; how far off a device's float32 may be; and where it may wrap around.

    The seed has four roundings of 2^-24 of its size, and the factor of 53 takes them along; the sum with the frame's
    steps, whose number and size are exact, has two of its own size.
    """
    width, height = size
    steps = FRAME_STEP * ((PASS_STEPS * pass_index + 1) * (frame % FRAMES) + pass_index)
    y, x = np.mgrid[0:height, 0:width]
    seed = NOISE[0] * x + NOISE[1] * y
    fraction = seed % 1.0
    value = (NOISE[2] * fraction + steps) % 1.0
    error = NOISE[2] * 4 * FLOAT_STEP * (seed + 1.0) + 2 * FLOAT_STEP * (NOISE[2] + steps)
    wraps = (np.minimum(value, 1.0 - value) < error) | (np.minimum(fraction, 1.0 - fraction) * NOISE[2] < error)
    return value - 0.5, error, wraps


def spaced(size: tuple[int, int], spacing: float, max_samples: int, amount: float, frame: float, pass_index: int):
    """A Spacing with the noise of a pass of a frame, times its amount, 0 .. 1."""
    if amount <= 0.0:
        return Spacing(spacing, max_samples)
    value, error, wraps = noise(size, frame, pass_index)
    return Spacing(spacing, max_samples, amount * value, amount * np.where(wraps, 1.0, error), wraps)


def filter_coc(coc, image_height: float, spacing: float):
    """`BokehFilterCoC`: 0 below half a pixel, the CoC from one pixel up."""
    if spacing <= 0.0:
        return coc
    return coc * np.clip(2.0 * coc * image_height - 1.0, 0.0, 1.0)


@dataclass(frozen=True)
class SampledLine:
    """The samples of `BokehLineMean`, see gather.Pattern."""

    segment: Segment
    spacing: Spacing
    height: int

    @property
    def count(self) -> int:
        """See gather.Pattern."""
        return self.spacing.max_samples

    def used(self, coc: np.ndarray, coc_error: np.ndarray | float, line: float) -> tuple[np.ndarray, np.ndarray]:
        """The CoC that the filter uses, and how far off it may be."""
        coc = np.abs(coc)
        # the fade between half a pixel and one is steeper than the CoC itself: its slope is 4 c H - 1 <= 3
        steeper = 3.0 if self.spacing.pixels > 0.0 else 1.0
        # no CoC is off by more than 1, also where the pass before left it open
        error = steeper * np.minimum(coc_error, 1.0) + (FLOAT_STEP * LENGTH_ROUNDINGS * coc if line else 0.0)
        return filter_coc(coc, self.height, self.spacing.pixels), error

    def cells(self, used: np.ndarray, error: np.ndarray | float, line: float) -> tuple[np.ndarray, np.ndarray]:
        """`BokehCells` for a CoC from `used`: how many cells, and how far off that may be."""
        most = self.spacing.max_samples
        per_coc = 2.0 * self.segment.half_length * self.height
        if self.spacing.pixels <= 0.0:
            return np.full_like(used, most), np.zeros_like(used)
        cells, off = per_coc * used / self.spacing.pixels, per_coc * error / self.spacing.pixels
        off = off + self.segment.stretch * line * self.height * used / self.spacing.pixels
        found = np.clip(cells, 1.0, most)
        return found, np.maximum(np.clip(cells + off, 1.0, most) - found, found - np.clip(cells - off, 1.0, most))

    def samples(self, rows: slice, coc: np.ndarray, coc_error: np.ndarray | float, line: float) -> Iterator[Sample]:
        """See gather.Pattern."""
        spacing, height, segment = self.spacing, self.height, self.segment.part(rows)
        used, error = self.used(coc, coc_error, line)
        length = 2.0 * segment.half_length * used * height
        cells, cells_error = replace(self, segment=segment).cells(used, error, line)
        jitter, open_jitter = (
            field[rows] if isinstance(field, np.ndarray) else field for field in (spacing.jitter, spacing.open)
        )
        phase = 0.5 + jitter * np.clip(length / cells - 1.0, 0.0, 1.0)
        # where the jitter's amount depends on the length, that is off too
        open_phase = open_jitter + np.abs(jitter) * 2.0 * segment.half_length * error * height / cells
        count = min(int(np.ceil(np.max(cells + cells_error))), spacing.max_samples)
        turned = segment.turns * line * height * used
        for i in range(count):
            low, weight = _cell(i, cells)
            _, least = _cell(i, cells - cells_error)
            _, largest = _cell(i, cells + cells_error)
            t = 2.0 * (low + weight * phase) / cells - 1.0
            slip = open_phase * weight * 2.0 / cells
            reach = segment.half * t
            place = segment.middle + reach
            farthest = np.abs(reach if spacing.pixels <= 0.0 else segment.half)
            moved = np.abs(segment.middle) + farthest
            off = moved * error * height + turned + np.abs(segment.half) * slip * used * height
            x, y = place * used * height
            yield Sample(x, y, weight, off[0], off[1], np.maximum(weight - least, largest - weight))


def _cell(i: int, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """`BokehCell`: where cell i begins, in cells from the line's beginning, and how much of it is on the line."""
    low = np.minimum(float(i), cells)
    return low, np.minimum(i + 1.0, cells) - low


@dataclass(frozen=True)
class SampledLines:
    """Several lines with a share of the whole each: what `BokehLineSum` returns for them, added up. See gather.Pattern.

    shares   (H, W) where pixels differ
    sources  which image each is taken from
    """

    lines: tuple[SampledLine, ...]
    shares: tuple[float | np.ndarray, ...]
    sources: tuple[int, ...]

    @property
    def count(self) -> int:
        """See gather.Pattern."""
        return sum(line.count for line in self.lines)

    def samples(self, rows: slice, coc: np.ndarray, coc_error: np.ndarray | float, line: float) -> Iterator[Sample]:
        """See gather.Pattern. A line is divided by its cells; where all are as long, an error of these cancels out.

        The shares of a cut polygon are off by at most cuts.AREAS times the error of a length.
        """
        lengths = [one.segment.half_length for one in self.lines]
        uneven = any(np.ndim(length) or abs(length - lengths[0]) > 1e-9 for length in lengths)
        for one, share, source in zip(self.lines, self.shares, self.sources, strict=True):
            here = replace(one, segment=one.segment.part(rows))
            cells, off = here.cells(*one.used(coc, coc_error, line), line)
            share = (share[rows] if np.ndim(share) else share) / cells
            open_share = cuts.AREAS * one.segment.stretch * line / cells
            for item in one.samples(rows, coc, coc_error, line):
                weight, opened = item.weight * share, item.open_weight * share + item.weight * open_share
                if uneven:
                    opened = opened + weight * off / np.maximum(cells - off, 1.0)
                yield replace(item, weight=weight, open_weight=opened, source=source)


def adaptive(
    sources: Image | list[Image],
    depth: np.ndarray | None,
    pattern: SampledLine | SampledLines,
    leakage: Leakage,
    blur_coc: bool = True,
    precision: Precision | None = None,
) -> Image:
    """`gather` along lines, whose jitter may leave pixels undecided."""
    found = gather(sources, depth, pattern, leakage, blur_coc, precision)
    if found.error is None:
        return found
    lines = pattern.lines if isinstance(pattern, SampledLines) else (pattern,)
    return Image(found.value, found.error, found.undecided | lines[0].spacing.undecided)


def parallelogram(k: int, i: int, sides: int, lengths: np.ndarray | None = None) -> float | np.ndarray:
    """Area of the parallelogram of edges i < k, 0 for other edges; in units of a rhombus with a right angle. Where
    `lengths` says how long the edges are: for an edge k of length 1.
    """
    area = sin((k - i) * 2.0 * pi / sides) if i < k else 0.0
    return area if lengths is None else area * lengths[i - 1]


def weight(k: int, sides: int, lengths: np.ndarray | None = None) -> float | np.ndarray:
    """`BokehExactWeight`: area of the parallelograms of edge k with all edges before it."""
    area = sum(parallelogram(k, i, sides, lengths) for i in range(1, k))
    return area if lengths is None else area * lengths[k - 1]
