"""Define a probe: cases to render, and checks of the results."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from hashlib import blake2b

import numpy as np

from bokeh_validation.drivers.base import Driver
from bokeh_validation.frame import methods

Outputs = Mapping[str, np.ndarray]


@dataclass(frozen=True, eq=False)
class Case:
    """Hold one rendering of a probe; two are equal if their images, settings and outputs are.

    color  (H, W, 4) float16
    depth  (H, W) float32, metres
    keep   textures to return, the result last
    """

    label: str
    settings: methods.Settings
    color: np.ndarray
    depth: np.ndarray
    keep: tuple[str, ...] = ("result",)

    @property
    def size(self) -> tuple[int, int]:
        """Return (width, height) in pixels."""
        return self.color.shape[1], self.color.shape[0]

    @property
    def plan(self) -> methods.Plan:
        """Return the plan of its passes."""
        return methods.plan(self.settings, self.size)

    @cached_property
    def _key(self) -> tuple:
        # not id(), which may be that of a freed image
        images = [(pixels.shape, blake2b(pixels.tobytes()).digest()) for pixels in (self.color, self.depth)]
        return *images, self.settings, self.keep

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Case) and self._key == other._key

    def __hash__(self) -> int:
        return hash(self._key)

    def textures(self) -> dict[str, np.ndarray]:
        """Return name -> texture, (H, W, C) or (H, W), for everything that the passes read."""
        return {"color": self.color, "depth": self.depth, **self.plan.tables}


@dataclass(frozen=True)
class Check:
    """Hold a measured number and the interval that it must lie in; `why` explains the interval."""

    name: str
    value: float
    low: float
    high: float
    why: str

    @property
    def ok(self) -> bool:
        """Return whether the value lies in the interval; NaN does not."""
        return self.low <= self.value <= self.high


@dataclass(frozen=True)
class Probe:
    """Hold a test image with what it must show.

    judge  takes the outputs of every case (label -> texture name -> pixels, float64) and returns the checks
    brief  False: only in the full run, because another probe shows the same on another polygon, or it tests an option
    """

    name: str
    title: str
    shows: str
    cases: tuple[Case, ...]
    judge: Callable[[Mapping[str, Outputs]], list[Check]]
    brief: bool = True


def drawn(driver: Driver, case: Case) -> np.ndarray:
    """Draw a case on a driver and return the result, (H, W, 4)."""
    return driver.run(case.plan.passes, case.textures(), case.size)["result"]


def flat(size: tuple[int, int], value: float = 0.0, alpha: float = 1.0) -> np.ndarray:
    """Return a grey image (H, W, 4) float16; `size` is (width, height)."""
    image = np.full((size[1], size[0], 4), value, np.float16)
    image[..., 3] = alpha
    return image


def depth_of(size: tuple[int, int], metres: float) -> np.ndarray:
    """Return a constant depth (H, W) float32."""
    return np.full((size[1], size[0]), metres, np.float32)


def overlap(shape: np.ndarray, other: np.ndarray) -> float:
    """Return the overlap of two shapes: the sum of the pixelwise minimum divided by the sum of the maximum."""
    return float(np.minimum(shape, other).sum() / np.maximum(shape, other).sum())


def pixel_center(column: int, row: int) -> tuple[float, float]:
    """Return the position of a pixel's centre, in pixels from the image's corner."""
    return column + 0.5, row + 0.5
