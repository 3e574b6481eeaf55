"""The one judge of a pass: it is drawn alone, on what the reference made for its inputs, and each target must be within
the reference's interval, which is that of this pass alone.

From end to end a step in the stored CoC would count as often as a sample is taken by it, and of the layered method
whether a pixel is near is a matter of such a step. That passes are chained as the plan says is another question, which
tests/shaders/test_drivers.py asks. What the reference made is kept on disk (reference/kept.py).
"""

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np

from bokeh_validation import metrics, shaders
from bokeh_validation.drivers.base import Driver
from bokeh_validation.metrics import Comparison
from bokeh_validation.numerics.images import Image
from bokeh_validation.numerics.precision import Precision
from bokeh_validation.probes.model import Case, Outputs
from bokeh_validation.reference import pass_images
from bokeh_validation.shaders.passes import Pass, target_area

Area = tuple[int, int, int, int]
# Without an interval of the reference, float32 and a store: a step of half floats, and of the smallest of them
STEP, SMALLEST = 2.0**-10, 2.0**-24


@dataclass(frozen=True)
class Frame:
    """Passes to draw, with what they read.

    area      the viewport, where the image is a part of its textures
    expected  output -> what must be in it, (H, W, 4), in place of the reference's result
    main      body of a main function in place of the entry's
    """

    passes: tuple[Pass, ...]
    textures: Mapping[str, np.ndarray]
    size: tuple[int, int]
    storage: str = "half"
    area: Area | None = None
    expected: Mapping[str, np.ndarray] = field(default_factory=dict)
    main: str = ""


@dataclass(frozen=True)
class Judge:
    """A pass with everything that it reads, and the interval of each target in the part that it draws."""

    label: str
    item: Pass
    frame: Frame
    inputs: Mapping[str, np.ndarray]
    part: tuple[slice, slice]
    allowed: Mapping[str, Image]

    def drawn(self, driver: Driver) -> dict[str, np.ndarray]:
        """What a driver writes to each target, in that part."""
        item = self.item
        if self.frame.main:
            text = re.sub(r"\bvoid main\(\)", "void unused()", shaders.glsl(item.entry, "330", item.defines))
            item = replace(item, sources={"glsl": f"{text}\nvoid main()\n{{\n    {self.frame.main}\n}}\n"})
        outputs = driver.run([item], self.inputs, self.frame.size, self.frame.storage, keep=item.outputs)
        return {name: outputs[name][self.part] for name in self.allowed}

    def comparisons(self, driver: Driver, in_steps: Collection[str] = ()) -> dict[str, metrics.Comparison]:
        """How far each target of a driver is from the reference's; by bounds in steps too where it is `in_steps`."""
        drawn, software = self.drawn(driver), driver.software
        return {k: metrics.compare(drawn[k], image, software and k in in_steps) for k, image in self.allowed.items()}

    def objection(self, driver: Driver) -> str:
        """What is wrong with what a driver draws, or nothing."""
        for name, comparison in self.comparisons(driver).items():
            if comparison.outside:
                return f"{self.item.entry} writes {name!r} with {comparison.outside} wrong pixels of {self.label}"
        return ""


def judges(label: str, frame: Frame, precision: Precision, rounding: str, text: str | None = None) -> list[Judge]:
    """One for each pass of a frame, for a device of that precision and rounding.

    text  of all files in GLSL, where it is not that of the package as it is. Raises KeyError where that has not got
          what the frame's passes need
    """
    size, made, images, result = frame.size, {}, {}, []
    if not frame.main:
        made, images = pass_images.alone(frame.passes, frame.textures, size, frame.storage, precision, rounding, text)
    images |= {name: Image(value) for name, value in frame.expected.items()}
    for item in frame.passes:
        x, y, width, height = target_area(item.scale, frame.area or (0, 0, *size))
        part = slice(y, y + height), slice(x, x + width)
        read = {name: made.get(name, frame.textures.get(name)) for name in item.inputs.values()}
        allowed = {name: _bounded(images[name].part(*part)) for name in item.outputs}
        result.append(Judge(label, item, frame, read, part, allowed))
        # nobody may read what is around the image
        for name in item.outputs if frame.area else ():
            around = np.full_like(made[name], np.nan)
            around[part] = made[name][part]
            made[name] = around
    return result


def _bounded(image: Image) -> Image:
    """With an interval, where the reference has none."""
    if image.error is not None:
        return image
    return Image(image.value, STEP * np.abs(image.value) + SMALLEST, np.zeros(image.value.shape[:2], bool))


@dataclass(frozen=True)
class CaseResult:
    """Pictures of one case on one driver, and the reference's, and how far each target of each pass is from it."""

    case: Case
    outputs: Outputs
    expected: Mapping[str, Image]
    comparisons: Mapping[str, Comparison]


@lru_cache(maxsize=2)  # of a large scene, with all of its targets in float64, one is some 500 MB
def of_case(case: Case, precision: Precision, rounding: str) -> tuple[Judge, ...]:
    """Those of a case; kept, since drivers share them."""
    frame = Frame(case.plan.passes, case.textures(), case.size)
    return tuple(judges(case.label, frame, precision, rounding))


def compared(case: Case, driver: Driver) -> CaseResult:
    """A case on a driver: its outputs, drawn from end to end, and how far every pass is from the reference's."""
    outputs = driver.run(case.plan.passes, case.textures(), case.size, keep=case.keep)
    comparisons, expected = {}, {}
    for judge in of_case(case, driver.precision, driver.rounding):
        # bounds in steps are for pictures: sums and shares are often small differences
        comparisons |= judge.comparisons(driver, case.keep)
        expected |= judge.allowed
    return CaseResult(case, outputs, {k: expected[k] for k in case.keep}, comparisons)


def expected(case: Case, precision: Precision, rounding: str) -> dict[str, Image]:
    """The reference's outputs of a case from end to end, with the interval of a class of devices."""
    return pass_images.images(case.plan.passes, case.textures(), case.size, "half", precision, rounding)
