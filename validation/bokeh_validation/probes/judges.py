"""Judge a pass: draw it alone, on inputs made by the reference, and require each target to be in the reference's
interval.

The interval covers this pass only. If passes were compared from end to end, every sample would amplify one rounding
step of the stored CoC that it uses, and in layered that step could decide whether a pixel is near.
tests/shaders/test_drivers.py tests that passes are chained as planned. Results of the reference are kept on disk
(reference/kept.py).
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
# Interval for a pass that has none from the reference: the error of float32 and of a store, as a relative step of half
# floats plus their smallest step
STEP, SMALLEST = 2.0**-10, 2.0**-24


@dataclass(frozen=True)
class Frame:
    """Hold passes to draw, with the textures that they read.

    area      the viewport (x, y, width, height), if the image is a part of its textures
    expected  output -> what must be in it, (H, W, 4), instead of the reference's result
    main      body of a main function that replaces the entry's
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
    """Hold a pass with everything that it reads, and the allowed interval of each target in the part that is drawn."""

    label: str
    item: Pass
    frame: Frame
    inputs: Mapping[str, np.ndarray]
    part: tuple[slice, slice]
    allowed: Mapping[str, Image]

    def drawn(self, driver: Driver) -> dict[str, np.ndarray]:
        """Return what a driver writes to each target, cropped to that part."""
        render_pass = self.item
        if self.frame.main:
            text = re.sub(
                r"\bvoid main\(\)", "void unused()", shaders.glsl(render_pass.entry, "330", render_pass.defines)
            )
            render_pass = replace(
                render_pass, sources={"glsl": f"{text}\nvoid main()\n{{\n    {self.frame.main}\n}}\n"}
            )
        outputs = driver.run([render_pass], self.inputs, self.frame.size, self.frame.storage, keep=render_pass.outputs)
        return {name: outputs[name][self.part] for name in self.allowed}

    def comparisons(self, driver: Driver, in_steps: Collection[str] = ()) -> dict[str, metrics.Comparison]:
        """Compare each target of a driver with the reference's; those named in `in_steps` by the bounds in steps as
        well.
        """
        pixels, software = self.drawn(driver), driver.software
        return {
            target: metrics.compare(pixels[target], image, software and target in in_steps)
            for target, image in self.allowed.items()
        }

    def objection(self, driver: Driver) -> str:
        """Return the first objection to a driver's result, or ''."""
        for name, comparison in self.comparisons(driver).items():
            if comparison.outside:
                return f"{self.item.entry} writes {name!r} with {comparison.outside} wrong pixels of {self.label}"
        return ""


def judges(label: str, frame: Frame, precision: Precision, rounding: str, text: str | None = None) -> list[Judge]:
    """Return a judge for each pass of a frame, for a device of this precision and rounding.

    text  all GLSL files as one text; None: the package's files. Raises KeyError if it lacks something that the
          frame's passes need
    """
    size, computed, images, result = frame.size, {}, {}, []
    if not frame.main:
        computed, images = pass_images.alone(
            frame.passes, frame.textures, size, frame.storage, precision, rounding, text
        )
    images |= {name: Image(value) for name, value in frame.expected.items()}
    for render_pass in frame.passes:
        x, y, width, height = target_area(render_pass.scale, frame.area or (0, 0, *size))
        part = slice(y, y + height), slice(x, x + width)
        inputs = {name: computed.get(name, frame.textures.get(name)) for name in render_pass.inputs.values()}
        intervals = {name: _bounded(images[name].part(*part)) for name in render_pass.outputs}
        result.append(Judge(label, render_pass, frame, inputs, part, intervals))
        # fill everything around the image with NaN: no pass may read it
        for name in render_pass.outputs if frame.area else ():
            only_inside = np.full_like(computed[name], np.nan)
            only_inside[part] = computed[name][part]
            computed[name] = only_inside
    return result


def _bounded(image: Image) -> Image:
    """Return the image with an interval, if the reference gave none."""
    if image.error is not None:
        return image
    return Image(image.value, STEP * np.abs(image.value) + SMALLEST, np.zeros(image.value.shape[:2], bool))


@dataclass(frozen=True)
class CaseResult:
    """Hold the outputs of one case on a driver and from the reference, and the comparison of each target
    of each pass.
    """

    case: Case
    outputs: Outputs
    expected: Mapping[str, Image]
    comparisons: Mapping[str, Comparison]


@lru_cache(maxsize=2)  # one of a large scene takes some 500 MB, with all its targets in float64
def of_case(case: Case, precision: Precision, rounding: str) -> tuple[Judge, ...]:
    """Return the judges of a case, cached, since drivers share them."""
    frame = Frame(case.plan.passes, case.textures(), case.size)
    return tuple(judges(case.label, frame, precision, rounding))


def compared(case: Case, driver: Driver) -> CaseResult:
    """Draw a case on a driver from end to end, and compare each of its passes with the reference."""
    outputs = driver.run(case.plan.passes, case.textures(), case.size, keep=case.keep)
    comparisons, expected = {}, {}
    for judge in of_case(case, driver.precision, driver.rounding):
        # the bounds in steps are for images; sums and weights are often small differences
        comparisons |= judge.comparisons(driver, case.keep)
        expected |= judge.allowed
    return CaseResult(case, outputs, {target: expected[target] for target in case.keep}, comparisons)


def expected(case: Case, precision: Precision, rounding: str) -> dict[str, Image]:
    """Return the reference's outputs of a case from end to end, with the interval of a class of devices."""
    return pass_images.images(case.plan.passes, case.textures(), case.size, "half", precision, rounding)
