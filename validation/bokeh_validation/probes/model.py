"""What a probe is: pictures to render, checks on them, and the comparison with the reference."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from hashlib import blake2b

import numpy as np

from bokeh_validation import metrics
from bokeh_validation.drivers.base import Driver
from bokeh_validation.frame import methods
from bokeh_validation.metrics import Comparison
from bokeh_validation.numerics import precision
from bokeh_validation.numerics.images import Image
from bokeh_validation.reference.device import Reference

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
    """

    name: str
    title: str
    shows: str
    cases: tuple[Case, ...]
    judge: Callable[[Mapping[str, Outputs]], list[Check]]


@dataclass(frozen=True)
class CaseResult:
    """Pictures of one case on one driver and on the reference, and how far they are apart."""

    case: Case
    outputs: Outputs
    expected: Mapping[str, Image]
    comparisons: Mapping[str, Comparison]


@lru_cache(maxsize=16)  # scenes are 20 MB each
def expected(case: Case, kind: precision.Precision, rounding: str) -> dict[str, Image]:
    """The reference's outputs with the acceptance interval of a class of devices; kept, since drivers share them."""
    images = Reference().images(case.plan.passes, case.textures(), case.size, precision=kind, rounding=rounding)
    # what nobody looks at is not kept: a scene's passes are a hundred megabytes
    return {name: images[name] for name in case.keep}


def compared(case: Case, driver: Driver) -> CaseResult:
    """A case on a driver: its outputs, the reference's, and how far they are apart, for each of case.keep.

    It is compared pass by pass, each with what the device had in its inputs: all targets must be within their
    intervals. From end to end a step in the stored CoC would count as often as a sample is taken by it, and of the
    layered method whether a pixel is near is a matter of such a step.
    """
    passes, textures, software = case.plan.passes, case.textures(), driver.software
    names = [name for item in passes for name in item.outputs]
    outputs = driver.run(passes, textures, case.size, keep=names)
    images = Reference().images(passes, textures, case.size, "half", driver.precision, driver.rounding, given=outputs)
    # bounds in steps are for pictures: sums and shares are often small differences
    comparisons = {k: metrics.compare(outputs[k], images[k], software and k in case.keep) for k in names}
    return CaseResult(case, {k: outputs[k] for k in case.keep}, {k: images[k] for k in case.keep}, comparisons)


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
