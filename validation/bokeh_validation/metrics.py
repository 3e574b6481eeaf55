"""Measure how far a driver's image is from the reference, and decide whether that is allowed."""

from dataclasses import dataclass

import numpy as np

from bokeh_validation.numerics import images
from bokeh_validation.numerics.images import Image

# Bounds for Mesa's software drivers, whose filter is exact: nearly all pixels are within one or two roundings.
CLOSE_STEPS, CLOSE_SHARE = 4, 0.995
FAR_STEPS = 32
UNDECIDED_SHARE = 0.001


@dataclass(frozen=True)
class Comparison:
    """Compare a driver's result with the reference's; pixel counts are fractions of the image.

    close      fraction within CLOSE_STEPS half-float steps in every channel
    worst      largest number of steps among pixels whose comparisons are all decided
    excused    fraction beyond FAR_STEPS where one of Listing 3's comparisons is within its rounding error
    undecided  fraction of all pixels with such a comparison
    outside    number of pixels outside the derived interval (numerics/precision.py)
    software   whether the bounds in steps apply; the interval always does
    """

    close: float
    worst: float
    excused: float
    undecided: float
    outside: int
    software: bool

    @property
    def ok(self) -> bool:
        """Return whether all pixels are in the interval and, for software drivers, within the bounds in steps."""
        if self.outside:
            return False
        if not self.software:
            return True
        return self.close >= CLOSE_SHARE and self.worst <= FAR_STEPS and self.excused <= UNDECIDED_SHARE

    def __str__(self) -> str:
        return (
            f"{100 * self.close:.3f} % within {CLOSE_STEPS} steps, worst {self.worst:.0f}, "
            f"excused {100 * self.excused:.4f} %, undecided {100 * self.undecided:.4f} %, "
            f"outside the interval {self.outside}"
        )


def steps(result: np.ndarray, expected: np.ndarray, dtype: type = np.float16) -> np.ndarray:
    """Return the difference in steps of `dtype`, the largest over the channels, (H, W) float64.

    result, expected  (H, W, 4), alpha is the CoC

    A step is the spacing of `dtype` at the larger of the two values. For the CoC it is at least the spacing at one
    pixel (1 / height), because a CoC below one pixel moves no sample by more than half a texel. Without that floor an
    in-focus pixel next to a blurred one, whose CoC of 0.002 pixels is off by 0.001 since uv is a float32, would differ
    by a hundred steps of a denormal number.
    """
    result, expected = result.astype(np.float64), expected.astype(np.float64)
    finite = np.isfinite(result) & np.isfinite(expected)
    magnitude = np.where(finite, np.maximum(np.abs(result), np.abs(expected)), 1.0)
    magnitude[..., 3] = np.maximum(magnitude[..., 3], 1.0 / result.shape[0])
    # the spacing just below the larger value: at a power of two it is half of the spacing above
    below = images.rounded(magnitude * (1 - 2.0**-30), dtype, "zero")
    distance = np.abs(result - expected) / images.step(below, dtype)
    return np.where(finite, distance, np.inf).max(axis=-1)


def compare(result: np.ndarray, expected: Image, software: bool) -> Comparison:
    """Compare a driver's result (H, W, 4) with the reference's image and its interval.

    The reference must have been computed for the driver's precision (SOFTWARE or GPU) and rounding.
    """
    dtype = result.dtype.type
    distance = steps(result, expected.value, dtype)
    error = np.abs(result.astype(np.float64) - expected.value)
    not_finite = ~np.isfinite(result).all(axis=-1)
    far = distance > FAR_STEPS
    decided = distance[~expected.undecided]
    return Comparison(
        close=float((distance <= CLOSE_STEPS).mean()),
        worst=float(np.ceil(decided.max())) if decided.size else 0.0,
        excused=float((far & expected.undecided).mean()),
        undecided=float(expected.undecided.mean()),
        outside=int((((error > expected.error).any(axis=-1)) | not_finite).sum()),
        software=software,
    )


def tone_mapped(color: np.ndarray) -> np.ndarray:
    """Return the display value of linear HDR colour, 0 to 1: x / (1 + x), then gamma 2.2. Accepts any shape."""
    color = np.maximum(color.astype(np.float64), 0.0)
    return (color / (1.0 + color)) ** (1.0 / 2.2)


def psnr(result: np.ndarray, truth: np.ndarray) -> float:
    """Return the peak signal-to-noise ratio of two linear images (H, W, >= 3) after tone mapping, dB."""
    error = np.mean((tone_mapped(result[..., :3]) - tone_mapped(truth[..., :3])) ** 2)
    return float("inf") if error == 0 else float(-10 * np.log10(error))


def flip(result: np.ndarray, truth: np.ndarray) -> float:
    """Return the mean HDR-FLIP of two linear images (H, W, >= 3), from 0 (identical) to 1."""
    import flip_evaluator

    images = [np.ascontiguousarray(image[..., :3], np.float32) for image in (truth, result)]
    return float(flip_evaluator.evaluate(*images, "HDR")[1])
