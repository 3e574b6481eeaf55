"""Listings 1 to 4 and the naive gather in float64: the arbiter of every driver.

Images are (H, W, 4) float64, rgb = linear colour, a = CoC as a fraction of the image height; depth is (H, W) in metres.
Places are in texels, from the image's corner, y down. `Image.error` is the acceptance interval that
reference/precision.py derives; it is None where no precision was asked for.
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from bokeh_validation.reference import sampling
from bokeh_validation.reference.precision import FLOAT_STEP, Precision

MAX_COLOR = 65504.0
MIN_DEPTH = 1e-6
MAX_DEPTH = 1e9
# A division counts for 2.5, as Vulkan allows; the formula of the CoC has three, five other operations, and margin.
COC_ROUNDINGS = 16
BAND_ROWS = 60
THREADS = 2


@dataclass(frozen=True)
class Image:
    """A texture and how far each value may be off.

    value      (H, W, 4) float64
    error      (H, W, 4), or None where no precision was asked for
    undecided  (H, W) bool: one of Listing 3's comparisons is within its error, here or in the pass before
    """

    value: np.ndarray
    error: np.ndarray | None = None
    undecided: np.ndarray | None = None

    @property
    def size(self) -> tuple[int, int]:
        """(width, height)"""
        return self.value.shape[1], self.value.shape[0]


def circle_of_confusion(depth, aperture_diameter, focal_length, focus_distance, sensor_height, max_coc):
    """Section 4.1: CoC diameter of a thin lens, fraction of the image height, 0 .. max_coc. All lengths in metres."""
    magnification = focal_length / (focus_distance - focal_length)
    c = aperture_diameter * magnification * np.abs(depth - focus_distance) / depth
    return np.clip(c / sensor_height, 0.0, max_coc)


def safe_color(color: np.ndarray) -> np.ndarray:
    """NaN and negative become 0, infinite the largest half float."""
    return np.where(color > 0.0, np.minimum(color, MAX_COLOR), 0.0)


def safe_depth(depth: np.ndarray) -> np.ndarray:
    """NaN, zero and negative become the smallest depth, infinite the largest."""
    return np.where(depth > MIN_DEPTH, np.minimum(depth, MAX_DEPTH), MIN_DEPTH)


def coc_map(color: np.ndarray, coc: np.ndarray | float, with_error: bool = False) -> Image:
    """Listing 1: colour beside a CoC that was computed already, (H, W) or one number."""
    value = np.empty((*color.shape[:2], 4))
    value[..., :3] = safe_color(color[..., :3].astype(np.float64))
    value[..., 3] = coc
    if not with_error:
        return Image(value)
    # the colour is copied from the nearest texel; the CoC takes a handful of float32 operations
    error = np.zeros_like(value)
    error[..., 3] = COC_ROUNDINGS * FLOAT_STEP * value[..., 3]
    return Image(value, error, np.zeros(value.shape[:2], bool))


def leakage_weight(sample_depth, sample_coc, center_depth, center_coc, bias, mult):
    """Listing 3: a nearer and clearly sharper sample counts by its own CoC, all others fully."""
    leaks = (sample_depth < center_depth) & (center_coc > sample_coc + bias)
    return np.where(leaks, np.clip(sample_coc * mult, 0.0, 1.0), 1.0)


def gather(
    image: Image,
    depth: np.ndarray,
    offsets: np.ndarray,
    bias: float,
    mult: float,
    blur_coc: bool = True,
    precision: Precision | None = None,
) -> Image:
    """Listing 3 and the naive gather: weighted mean of the samples at `offsets` times the centre's CoC.

    offsets  (N, 2) in units of the image height, x right, y down, for a CoC of 1
    """
    depth = np.asarray(depth, np.float64)
    fields = _error_fields(image) if precision else None

    def band(start: int) -> Image:
        return _gather_rows(image, depth, offsets, bias, mult, blur_coc, precision, fields, start)

    starts = range(0, image.value.shape[0], BAND_ROWS)
    with ThreadPoolExecutor(THREADS) as pool:
        bands = list(pool.map(band, starts))
    value = np.concatenate([b.value for b in bands])
    if precision is None:
        return Image(value)
    return Image(value, np.concatenate([b.error for b in bands]), np.concatenate([b.undecided for b in bands]))


@dataclass(frozen=True)
class _ErrorFields:
    """Per texel, what bounds the error of a sample taken there; each (H W, 4)."""

    stored: np.ndarray
    across: np.ndarray
    down: np.ndarray
    largest: np.ndarray


def _error_fields(image: Image) -> _ErrorFields:
    across, down = sampling.slopes(image.value)
    stored = sampling.neighbourhood(image.error)
    largest = sampling.neighbourhood(np.abs(image.value))
    return _ErrorFields(*(field.reshape(-1, 4) for field in (stored, across, down, largest)))


def _gather_rows(image, depth, offsets, bias, mult, blur_coc, precision, fields, start) -> Image:
    """`gather` for BAND_ROWS rows from `start`: bands keep the working set in the processor's cache."""
    width, height = image.size
    rows = slice(start, min(start + BAND_ROWS, height))
    center = image.value[rows]
    center_coc = center[..., 3]
    center_depth = depth[rows]
    flat_depth = depth.reshape(-1)
    y, x = np.mgrid[rows, 0:width] + 0.5
    color, total = np.zeros_like(center), np.zeros_like(center_coc)
    bound = _Bound(center, image.error[rows], precision, fields, image.size) if precision else None
    for offset in offsets:
        sample_x = x + offset[0] * height * center_coc
        sample_y = y + offset[1] * height * center_coc
        sample = sampling.bilinear(image.value, sample_x, sample_y)
        sample_depth = flat_depth[sampling.nearest_index(sample_x, sample_y, image.size)]
        weight = leakage_weight(sample_depth, sample[..., 3], center_depth, center_coc, bias, mult)
        color += sample * weight[..., None]
        total += weight
        if bound:
            bound.add(sample, weight, sample_x, sample_y, offset, flat_depth, center_depth, bias, mult)
    with np.errstate(invalid="ignore", divide="ignore"):
        value = np.where(total[..., None] > 0.0, color / total[..., None], center)
    if not blur_coc:
        value[..., 3] = center_coc
    if not bound:
        return Image(value)
    error, undecided = bound.finish(value, total, len(offsets))
    if not blur_coc:
        error[..., 3] = image.error[rows][..., 3]
    return Image(value, error, undecided | image.undecided[rows])


class _Bound:
    """Running sums of the bound on the weighted mean; the formulas are those of reference/precision.py."""

    def __init__(self, center, center_error, precision: Precision, fields: _ErrorFields, size: tuple[int, int]):
        self.center, self.center_error = center, center_error
        self.precision, self.fields, self.size = precision, fields, size
        self.samples = np.zeros_like(center)
        self.open_samples = np.zeros_like(center)
        self.open_weight = np.zeros(center.shape[:2])
        self.largest = np.zeros_like(center)
        self.undecided = np.zeros(center.shape[:2], bool)

    def add(self, sample, weight, x, y, offset, depth, center_depth, bias, mult) -> None:
        width, height = self.size
        coc_error = self.center_error[..., 3]
        place_x, place_y = self.precision.place(width), self.precision.place(height)
        turned = self.precision.line * height * self.center[..., 3]
        shift_x = place_x + abs(offset[0]) * height * coc_error + turned
        shift_y = place_y + abs(offset[1]) * height * coc_error + turned
        texel = sampling.nearest_index(x, y, self.size)
        fields = self.fields
        error = fields.stored[texel] + self.precision.filter * fields.largest[texel]
        error += shift_x[..., None] * fields.across[texel] + shift_y[..., None] * fields.down[texel]
        # the slopes are those of 3 x 3 texels: they say nothing of a sample that may be elsewhere
        error[np.maximum(shift_x, shift_y) > 0.5] = np.inf

        nearest, farthest = self._depth_range(depth, x, y, shift_x, shift_y, texel)
        coc = sample[..., 3]
        margin = self.center[..., 3] - coc - bias
        tolerance = coc_error + error[..., 3] + FLOAT_STEP
        surely = (farthest < center_depth) & (margin > tolerance)
        maybe = (nearest < center_depth) & (margin > -tolerance)
        lowest = np.where(maybe, np.clip((coc - error[..., 3]) * mult, 0.0, 1.0), 1.0)
        highest = np.where(surely, np.clip((coc + error[..., 3]) * mult, 0.0, 1.0), 1.0)
        open_weight = np.maximum(highest - weight, weight - lowest)

        self.samples += (weight + open_weight)[..., None] * error
        self.open_samples += open_weight[..., None] * np.abs(sample - self.center)
        self.open_weight += open_weight
        self.largest = np.maximum(self.largest, np.abs(sample))
        self.undecided |= maybe & ~surely & (lowest < 1.0)

    def _depth_range(self, depth, x, y, shift_x, shift_y, texel) -> tuple[np.ndarray, np.ndarray]:
        """Smallest and largest depth that the nearest filter may return."""
        nearest = depth[texel]
        farthest = nearest.copy()
        open_x = np.floor(x - shift_x) != np.floor(x + shift_x)
        open_y = np.floor(y - shift_y) != np.floor(y + shift_y)
        at = np.nonzero(open_x | open_y)
        for sign_x in (-1, 1):
            for sign_y in (-1, 1):
                index = sampling.nearest_index(x[at] + sign_x * shift_x[at], y[at] + sign_y * shift_y[at], self.size)
                nearest[at] = np.minimum(nearest[at], depth[index])
                farthest[at] = np.maximum(farthest[at], depth[index])
        return nearest, farthest

    def finish(self, value, total, count: int) -> tuple[np.ndarray, np.ndarray]:
        spread = self.open_samples + self.open_weight[..., None] * np.abs(self.center - value)
        least = (total - self.open_weight)[..., None]
        with np.errstate(invalid="ignore", divide="ignore"):
            error = (self.samples + spread) / least + (count + 8) * FLOAT_STEP * self.largest
        none = (total <= 0.0) & (self.open_weight <= 0.0)
        error[none] = self.center_error[none]
        lost = ~none & (least[..., 0] <= 0.0)
        error[lost] = np.inf
        return error, self.undecided | lost


def combine(a: Image, b: Image, use_max: bool) -> Image:
    """Listing 4: min or max of two images, CoC included."""
    value = (np.maximum if use_max else np.minimum)(a.value, b.value)
    if a.error is None or b.error is None:
        return Image(value)
    # |min(a', b') - min(a, b)| <= max(|a' - a|, |b' - b|), and so for max
    return Image(value, np.maximum(a.error, b.error), a.undecided | b.undecided)


def stored(image: Image, dtype: type, rounding: str = "nearest") -> Image:
    """The image as a render target of `dtype` keeps it; the interval gets wider by one step.

    rounding  'nearest', or 'zero' for devices that cut off: OpenGL and Vulkan allow both
    """
    value = rounded(image.value, dtype, rounding).astype(np.float64)
    if image.error is None:
        return Image(value)
    finite = np.where(np.isfinite(image.error), image.error, 0.0)
    return Image(value, image.error + step(np.abs(value) + finite, dtype), image.undecided)


def rounded(value: np.ndarray, dtype: type, rounding: str) -> np.ndarray:
    """Numbers of `dtype`, rounded to nearest or towards zero."""
    result = value.astype(dtype)
    if rounding == "zero":
        too_far = np.abs(result.astype(np.float64)) > np.abs(value)
        result = np.where(too_far, np.nextafter(result, dtype(0)), result)
    return result


def step(value: np.ndarray, dtype: type) -> np.ndarray:
    """Distance from a magnitude to the next larger number of `dtype`."""
    largest = float(np.finfo(dtype).max)
    return np.spacing(np.minimum(value, largest / 2).astype(dtype)).astype(np.float64)
