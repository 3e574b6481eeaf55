"""The filters of Listing 3 in float64: weighted means of samples, with the acceptance interval of precision.py."""

from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from bokeh_validation.reference import sampling
from bokeh_validation.reference.images import Image
from bokeh_validation.reference.listings import SIGNED_SHARE, leakage_weight, safe_depth, signed_leakage_weight
from bokeh_validation.reference.precision import FLOAT_STEP, Precision

BAND_ROWS = 16
THREADS = 2


@dataclass(frozen=True)
class Leakage:
    """Listing 3's bias and multiplier."""

    bias: float
    mult: float


@dataclass(frozen=True)
class Sample:
    """One sample of every pixel of a band; all fields are (rows, W) or numbers.

    x, y              place relative to the pixel's centre, texels
    weight            of the sample, before the leakage test
    shift_x, shift_y  how far off the place may be, texels, beside the sampler's own error
    open_weight       how far off the weight may be
    source            which of the images it is taken from
    """

    x: np.ndarray
    y: np.ndarray
    weight: np.ndarray | float = 1.0
    shift_x: np.ndarray | float = 0.0
    shift_y: np.ndarray | float = 0.0
    open_weight: np.ndarray | float = 0.0
    source: int = 0


class Pattern(Protocol):
    """Where a filter takes its samples."""

    @property
    def count(self) -> int:
        """The most samples that a pixel has."""

    def samples(self, rows: slice, coc: np.ndarray, coc_error: np.ndarray | float, line: float) -> Iterator[Sample]:
        """The samples of some rows of the image.

        coc, coc_error  (rows, W): the centres' CoC and how far off it may be
        line            Precision.line, or 0
        """


@dataclass(frozen=True)
class Table:
    """The same offsets for every pixel, scaled by its CoC.

    offsets  (N, 2) in units of the image height, x right, y down, for a CoC of 1
    height   of the image, texels
    """

    offsets: np.ndarray
    height: int

    @property
    def count(self) -> int:
        """See Pattern."""
        return len(self.offsets)

    def samples(self, rows: slice, coc: np.ndarray, coc_error: np.ndarray | float, line: float) -> Iterator[Sample]:
        """See Pattern."""
        del rows
        # no CoC is off by more than 1, also where the pass before left it open
        coc_error = np.minimum(coc_error, 1.0)
        turned = line * self.height * coc
        for x, y in self.offsets * self.height:
            yield Sample(x * coc, y * coc, 1.0, abs(x) * coc_error + turned, abs(y) * coc_error + turned)


def gather(
    sources: Image | Sequence[Image],
    depth: np.ndarray | None,
    pattern: Pattern,
    leakage: Leakage,
    blur_coc: bool = True,
    precision: Precision | None = None,
) -> Image:
    """Weighted mean of a pattern's samples around each pixel; the pixel itself where every sample was rejected.

    sources  what is sampled, CoC in alpha; the first has the pixels in the middle, whose CoC scales the pattern and is
             compared
    depth    None: the CoC are signed, and the leakage test needs no depth
    """
    images = (sources,) if isinstance(sources, Image) else tuple(sources)
    depth = None if depth is None else np.asarray(depth, np.float64)
    middle = at_center(images[0], precision)
    fields = [_error_fields(image, precision) for image in images] if precision else None
    height = images[0].value.shape[0]

    def band(start: int) -> Image:
        rows = slice(start, min(start + BAND_ROWS, height))
        return _gather_rows(images, middle, depth, pattern, leakage, blur_coc, precision, fields, rows)

    starts = range(0, height, BAND_ROWS)
    if len(starts) == 1:
        return band(0)
    with ThreadPoolExecutor(THREADS) as pool:
        bands = list(pool.map(band, starts))
    value = np.concatenate([b.value for b in bands])
    if precision is None:
        return Image(value)
    return Image(value, np.concatenate([b.error for b in bands]), np.concatenate([b.undecided for b in bands]))


def at_center(image: Image, precision: Precision | None) -> Image:
    """An image read at each pixel's own centre through a linear filter: uv is rounded there as anywhere."""
    if precision is None:
        return image
    width, height = image.size
    across, down = sampling.slopes(image.value)
    error = image.error + precision.filter * np.abs(image.value)
    error += precision.place(width) * across + precision.place(height) * down
    return Image(image.value, error, image.undecided)


@dataclass(frozen=True)
class _ErrorFields:
    """Per texel, what bounds the error of a sample taken there; each (H W, 4).

    still         of one that is where it should be: what is stored is off, and the filter rounds
    across, down  for each texel that it may be off its place
    """

    still: np.ndarray
    across: np.ndarray
    down: np.ndarray


def _error_fields(image: Image, precision: Precision) -> _ErrorFields:
    across, down = sampling.slopes(image.value)
    still = sampling.neighbourhood(image.error) + precision.filter * sampling.neighbourhood(np.abs(image.value))
    return _ErrorFields(*(field.reshape(-1, 4) for field in (still, across, down)))


def _gather_rows(images, middle, depth, pattern, leakage, blur_coc, precision, fields, rows) -> Image:
    """`gather` for some rows: bands keep the working set in the processor's cache."""
    center, size = middle.value[rows], middle.size
    center_coc = center[..., 3]
    center_depth, flat_depth = (None, None) if depth is None else (safe_depth(depth[rows]), depth.reshape(-1))
    y, x = np.mgrid[rows, 0 : size[0]] + 0.5
    color, total = np.zeros_like(center), np.zeros_like(center_coc)
    bound = _Bound(center, middle.error[rows], precision, fields, size) if precision else None
    coc_error, line = (middle.error[rows][..., 3], precision.line) if precision else (0.0, 0.0)
    for item in pattern.samples(rows, center_coc, coc_error, line):
        sample_x, sample_y = x + item.x, y + item.y
        sample = sampling.bilinear(images[item.source].value, sample_x, sample_y)
        if depth is None:
            leak = signed_leakage_weight(sample[..., 3], center_coc, leakage.bias, leakage.mult)
        else:
            near = flat_depth[sampling.nearest_index(sample_x, sample_y, size)]
            leak = leakage_weight(near, sample[..., 3], center_depth, center_coc, leakage.bias, leakage.mult)
        color += sample * (leak * item.weight)[..., None]
        total += leak * item.weight
        if bound:
            bound.add(item, sample, leak, sample_x, sample_y, flat_depth, center_depth, leakage)
    with np.errstate(invalid="ignore", divide="ignore"):
        value = np.where(total[..., None] > 0.0, color / total[..., None], center)
    if not blur_coc:
        value[..., 3] = center_coc
    if not bound:
        return Image(value)
    error, undecided = bound.finish(value, total, pattern.count)
    if not blur_coc:
        error[..., 3] = middle.error[rows][..., 3]
    for image in (middle, *images):
        undecided = undecided | image.undecided[rows]
    return Image(value, error, undecided)


class _Bound:
    """Running sums of the bound on the weighted mean; the formulas are those of reference/precision.py."""

    def __init__(self, center, center_error, precision: Precision, fields: list[_ErrorFields], size: tuple[int, int]):
        self.center, self.center_error = center, center_error
        self.precision, self.fields, self.size = precision, fields, size
        self.samples = np.zeros_like(center)
        self.open_samples = np.zeros_like(center)
        self.open_weight = np.zeros(center.shape[:2])
        self.largest = np.zeros_like(center)
        self.undecided = np.zeros(center.shape[:2], bool)

    def add(self, item: Sample, sample, leak, x, y, depth, center_depth, leakage: Leakage) -> None:
        """A sample at x, y, which the leakage test gave the weight `leak`."""
        width, height = self.size
        shift_x = self.precision.place(width) + item.shift_x
        shift_y = self.precision.place(height) + item.shift_y
        texel = sampling.nearest_index(x, y, self.size)
        fields = self.fields[item.source]
        error = fields.still.take(texel, axis=0)
        across, down = fields.across.take(texel, axis=0), fields.down.take(texel, axis=0)
        error += shift_x[..., None] * across + shift_y[..., None] * down
        # the slopes are those of 3 x 3 texels: they say nothing of a sample that may be elsewhere
        error[np.maximum(shift_x, shift_y) > 0.5] = np.inf

        # a signed CoC that is off by so much has a size that is off by no more
        coc = np.abs(sample[..., 3])
        margin = self.center[..., 3] * (SIGNED_SHARE if depth is None else 1.0) - coc - leakage.bias
        tolerance = self.center_error[..., 3] + error[..., 3] + FLOAT_STEP
        surely, maybe = margin > tolerance, margin > -tolerance
        if depth is not None:
            nearest, farthest = self._depth_range(depth, x, y, shift_x, shift_y, texel)
            surely &= farthest < center_depth
            maybe &= nearest < center_depth
        # no CoC is off by more than 1: an infinite error times a multiplier of 0 would be none
        coc_error = np.minimum(error[..., 3], 1.0)
        power = 2 if depth is None else 1
        lowest = np.where(maybe, np.clip((coc - coc_error) * leakage.mult, 0.0, 1.0) ** power, 1.0)
        highest = np.where(surely, np.clip((coc + coc_error) * leakage.mult, 0.0, 1.0) ** power, 1.0)
        most = item.weight + item.open_weight
        open_weight = np.maximum(highest - leak, leak - lowest) * most + leak * item.open_weight

        share = leak * item.weight + open_weight
        counted = share > 0.0
        error[~counted] = 0.0
        self.samples += share[..., None] * error
        self.open_samples += open_weight[..., None] * np.abs(sample - self.center)
        self.open_weight += open_weight
        np.maximum(self.largest, np.abs(sample), out=self.largest, where=counted[..., None])
        self.undecided |= counted & maybe & ~surely & (lowest < 1.0)

    def _depth_range(self, depth, x, y, shift_x, shift_y, texel) -> tuple[np.ndarray, np.ndarray]:
        """Smallest and largest depth that the nearest filter may return.

        NaN stands for any: Direct3D 9 finds it nearer, IEEE 754 does not, and GLSL and WGSL leave it open.
        """
        nearest = depth[texel]
        farthest = nearest.copy()
        open_x = np.floor(x - shift_x) != np.floor(x + shift_x)
        open_y = np.floor(y - shift_y) != np.floor(y + shift_y)
        at = np.nonzero(open_x | open_y)
        for sign_x in (-1, 1) if at[0].size else ():
            for sign_y in (-1, 1):
                index = sampling.nearest_index(x[at] + sign_x * shift_x[at], y[at] + sign_y * shift_y[at], self.size)
                nearest[at] = np.minimum(nearest[at], depth[index])
                farthest[at] = np.maximum(farthest[at], depth[index])
        unknown = np.isnan(nearest)
        return np.where(unknown, -np.inf, nearest), np.where(unknown, np.inf, farthest)

    def finish(self, value, total, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Error of the mean (rows, W, 4), and which pixels are undecided (rows, W)."""
        spread = self.open_samples + self.open_weight[..., None] * np.abs(self.center - value)
        least = (total - self.open_weight)[..., None]
        with np.errstate(invalid="ignore", divide="ignore"):
            error = (self.samples + spread) / least + (count + 8) * FLOAT_STEP * self.largest
        none = (total <= 0.0) & (self.open_weight <= 0.0)
        error[none] = self.center_error[none]
        lost = ~none & (least[..., 0] <= 0.0)
        error[lost] = np.inf
        return error, self.undecided | lost
