"""How far a driver's picture is from the reference, and whether that is allowed."""

from dataclasses import dataclass

import numpy as np

from bokeh_validation.numerics import images
from bokeh_validation.numerics.images import Image

# Bounds for Mesa's software drivers, whose filter is exact: nearly all pixels are a rounding or two away.
CLOSE_STEPS, CLOSE_SHARE = 4, 0.995
FAR_STEPS = 32
UNDECIDED_SHARE = 0.001


@dataclass(frozen=True)
class Comparison:
    """A driver's result beside the reference's, pixel counts as shares of the image.

    close       pixels within CLOSE_STEPS half-float steps in every channel
    worst       largest number of steps where no comparison was open
    excused     pixels beyond FAR_STEPS where one of Listing 3's comparisons is within its rounding error
    undecided   all pixels where one is
    outside     pixels outside the derived interval (reference/precision.py)
    software    whether the bounds in steps apply; the interval always does
    """

    close: float
    worst: float
    excused: float
    undecided: float
    outside: int
    software: bool

    @property
    def ok(self) -> bool:
        """Within the interval and, for software drivers, within the bounds in steps."""
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
    """Distance in steps of `dtype`, per pixel the largest over the channels, (H, W) float64.

    A step is the spacing of `dtype` at the larger of the two values, but for the CoC not less than at one pixel
    (1 / height): a CoC below a pixel moves no sample by more than half a texel, so there its error counts absolutely.
    Without that floor an in-focus pixel beside a blurred one, whose CoC of 0.002 pixels is off by 0.001 because uv is a
    float32, would count as a hundred steps of a denormal number.
    """
    result, expected = result.astype(np.float64), expected.astype(np.float64)
    finite = np.isfinite(result) & np.isfinite(expected)
    magnitude = np.where(finite, np.maximum(np.abs(result), np.abs(expected)), 1.0)
    magnitude[..., 3] = np.maximum(magnitude[..., 3], 1.0 / result.shape[0])
    # the spacing below the larger value: at a power of two it is half of that above
    below = images.rounded(magnitude * (1 - 2.0**-30), dtype, "zero")
    distance = np.abs(result - expected) / images.step(below, dtype)
    return np.where(finite, distance, np.inf).max(axis=-1)


def compare(result: np.ndarray, expected: Image, software: bool) -> Comparison:
    """Compare a driver's (H, W, 4) result with the reference's image and its interval.

    The reference must have been asked for the precision of the driver (SOFTWARE or GPU) and for its rounding.
    """
    dtype = result.dtype.type
    distance = steps(result, expected.value, dtype)
    off = np.abs(result.astype(np.float64) - expected.value)
    bad = ~np.isfinite(result).all(axis=-1)
    far = distance > FAR_STEPS
    decided = distance[~expected.undecided]
    return Comparison(
        close=float((distance <= CLOSE_STEPS).mean()),
        worst=float(np.ceil(decided.max())) if decided.size else 0.0,
        excused=float((far & expected.undecided).mean()),
        undecided=float(expected.undecided.mean()),
        outside=int((((off > expected.error).any(axis=-1)) | bad).sum()),
        software=software,
    )


def tone_mapped(color: np.ndarray) -> np.ndarray:
    """Display value of linear HDR colour, 0 .. 1: x / (1 + x), gamma 2.2. Any shape."""
    color = np.maximum(color.astype(np.float64), 0.0)
    return (color / (1.0 + color)) ** (1.0 / 2.2)


def psnr(result: np.ndarray, truth: np.ndarray) -> float:
    """Peak signal to noise ratio of the tone-mapped rgb, dB."""
    error = np.mean((tone_mapped(result[..., :3]) - tone_mapped(truth[..., :3])) ** 2)
    return float("inf") if error == 0 else float(-10 * np.log10(error))


def flip(result: np.ndarray, truth: np.ndarray) -> float:
    """Mean FLIP of the rgb of two HDR images, 0 (same) to 1."""
    import flip_evaluator

    images = [np.ascontiguousarray(image[..., :3], np.float32) for image in (truth, result)]
    return float(flip_evaluator.evaluate(*images, "HDR")[1])
