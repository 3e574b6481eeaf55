"""Hold a texture of the reference with how far a correct device may be from it, and model how a target stores it."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

Textures = Mapping[str, np.ndarray]
# Formats of targets
STORAGE = {"half": np.float16, "float": np.float32}


@dataclass(frozen=True)
class Image:
    """Hold a texture and how far each value may be off.

    value      (H, W, 4) float64
    error      (H, W, 4); None if no precision was given
    undecided  (H, W) bool: one of Listing 3's comparisons is within its error, here or in the previous pass
    """

    value: np.ndarray
    error: np.ndarray | None = None
    undecided: np.ndarray | None = None

    @property
    def size(self) -> tuple[int, int]:
        """Return (width, height) in pixels."""
        return self.value.shape[1], self.value.shape[0]

    def part(self, rows: slice, columns: slice) -> "Image":
        """Return a rectangle of the image."""
        fields = (self.value, self.error, self.undecided)
        return Image(*(None if field is None else field[rows, columns] for field in fields))

    def drawn_over(self, part: "Image", rows: slice, columns: slice) -> "Image":
        """Return the image with another one drawn into a rectangle of it."""
        fields = []
        for name in ("value", "error", "undecided"):
            new, combined = getattr(part, name), getattr(self, name)
            if new is not None:
                empty = np.zeros((*self.value.shape[:2], *new.shape[2:]), new.dtype)
                combined = empty if combined is None else combined.copy()
                combined[rows, columns] = new
            fields.append(combined)
        return Image(*fields)


def stored(image: Image, dtype: type, rounding: str = "nearest") -> Image:
    """Return the image as a render target of `dtype` stores it; its interval grows by one step.

    rounding  'nearest', or 'zero' for devices that truncate: OpenGL and Vulkan allow both
    """
    value = rounded(image.value, dtype, rounding).astype(np.float64)
    if image.error is None:
        return Image(value)
    finite = np.where(np.isfinite(image.error), image.error, 0.0)
    return Image(value, image.error + step(np.abs(value) + finite, dtype), image.undecided)


def rounded(value: np.ndarray, dtype: type, rounding: str) -> np.ndarray:
    """Convert an array of any shape to `dtype`, rounding to nearest or towards zero."""
    result = value.astype(dtype)
    if rounding == "zero":
        too_far = np.abs(result.astype(np.float64)) > np.abs(value)
        result = np.where(too_far, np.nextafter(result, dtype(0)), result)
    return result


def step(value: np.ndarray, dtype: type) -> np.ndarray:
    """Return the distance from a magnitude to the next larger number of `dtype`; at the largest number, to the one
    below.
    """
    last_but_one = np.nextafter(np.finfo(dtype).max, dtype(0)).astype(np.float64)
    return np.spacing(np.minimum(value, last_but_one).astype(dtype)).astype(np.float64)
