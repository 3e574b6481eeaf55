"""What a probe is: pictures to render, and checks on them."""

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
    """One rendering of a probe; equal to another with the same images, settings and outputs.

    color, depth  (H, W, 4) float16 and (H, W) float32
    keep          textures to look at, the result last
    """

    label: str
    settings: methods.Settings
    color: np.ndarray
    depth: np.ndarray
    keep: tuple[str, ...] = ("result",)

    @property
    def size(self) -> tuple[int, int]:
        """(width, height)"""
        return self.color.shape[1], self.color.shape[0]

    @property
    def plan(self) -> methods.Plan:
        """Its passes."""
        return methods.plan(self.settings, self.size)

    @cached_property
    def _key(self) -> tuple:
        # not id(): another image may have that of one that was freed
        images = [(pixels.shape, blake2b(pixels.tobytes()).digest()) for pixels in (self.color, self.depth)]
        return *images, self.settings, self.keep

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Case) and self._key == other._key

    def __hash__(self) -> int:
        return hash(self._key)

    def textures(self) -> dict[str, np.ndarray]:
        """Everything the passes read."""
        return {"color": self.color, "depth": self.depth, **self.plan.tables}


@dataclass(frozen=True)
class Check:
    """A measured number and the interval it must be in; `why` derives the interval."""

    name: str
    value: float
    low: float
    high: float
    why: str

    @property
    def ok(self) -> bool:
        """NaN is not ok."""
        return self.low <= self.value <= self.high


@dataclass(frozen=True)
class Probe:
    """A test image with what it must show.

    judge  takes the outputs of every case (label -> texture name -> pixels, float64) and returns the checks
    brief  False: left to the full run, because another probe shows the same on another polygon, or it is of an option
    """

    name: str
    title: str
    shows: str
    cases: tuple[Case, ...]
    judge: Callable[[Mapping[str, Outputs]], list[Check]]
    brief: bool = True


def drawn(driver: Driver, case: Case) -> np.ndarray:
    """The result of a case on a driver, (H, W, 4)."""
    return driver.run(case.plan.passes, case.textures(), case.size)["result"]


def flat(size: tuple[int, int], value: float = 0.0, alpha: float = 1.0) -> np.ndarray:
    """A grey image (H, W, 4) float16."""
    image = np.full((size[1], size[0], 4), value, np.float16)
    image[..., 3] = alpha
    return image


def depth_of(size: tuple[int, int], metres: float) -> np.ndarray:
    """A constant depth (H, W) float32."""
    return np.full((size[1], size[0]), metres, np.float32)


def overlap(shape: np.ndarray, other: np.ndarray) -> float:
    """Of two shapes: the sum of the smaller over the sum of the larger."""
    return float(np.minimum(shape, other).sum() / np.maximum(shape, other).sum())


def pixel_center(column: int, row: int) -> tuple[float, float]:
    """Place of a pixel's centre, in pixels from the image's corner."""
    return column + 0.5, row + 0.5
