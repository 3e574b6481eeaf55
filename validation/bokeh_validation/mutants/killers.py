"""What tells a broken shader from a whole one: each pass of some small frames must be where the reference has it.

A pass is drawn on its own, from what the whole shaders left in its inputs: so the reference's interval is that of this
pass alone, and is computed once for all mutants.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from bokeh_validation import metrics
from bokeh_validation.drivers.base import Driver
from bokeh_validation.errors import UserError
from bokeh_validation.mutants import frames
from bokeh_validation.mutants.frames import Frame
from bokeh_validation.reference.device import Reference
from bokeh_validation.reference.images import Image
from bokeh_validation.shaders.passes import Pass

# One texel of NaN, to fill with it whatever is around an image in its textures
NOTHING = {"nan": np.full((1, 1, 4), np.nan, np.float16), "one": np.ones((1, 1), np.float32)}
# What a frame tells is right but for float32 and a store: a step of half floats, and of the smallest of them
TOLD, TINY = 2.0**-10, 2.0**-24


@dataclass(frozen=True)
class Judge:
    """A pass with everything that it reads, and the interval of each target in the part that it draws."""

    frame: str
    item: Pass
    main: str
    textures: Mapping[str, np.ndarray]
    size: tuple[int, int]
    storage: str
    part: tuple[slice, slice]
    wanted: Mapping[str, Image]

    def objection(self, driver: Driver) -> str:
        """What is wrong with what a driver draws, or nothing."""
        item = self.item
        if self.main:
            item = replace(item, sources={"glsl": frames.program(self.main, item.defines)})
        outputs = driver.run([item], self.textures, self.size, self.storage, keep=item.outputs)
        for name, wanted in self.wanted.items():
            outside = metrics.compare(outputs[name][self.part], wanted, False).outside
            if outside:
                return f"{item.entry}: {outside} of {wanted.value[..., 0].size} pixels are outside of their interval"
        return ""


def judges(driver: Driver, label: str, frame: Frame) -> list[Judge]:
    """One for each pass of a frame. Raises UserError where the shaders as they are do not pass."""
    around = [
        Pass("BokehDebug", {"ColorSamp": "nan", "DepthSamp": "one"}, name, scale=item.scale)
        for item in (frame.passes if frame.area else ())
        for name in item.outputs
    ]
    names = [name for item in frame.passes for name in item.outputs]
    size, textures, given = frame.size, frame.textures, {}
    if not frame.main:
        given = driver.run([*around, *frame.passes], {**textures, **NOTHING}, size, frame.storage, keep=names)
    if frame.told:
        decided = np.zeros(next(iter(frame.told.values())).shape[:2], bool)
        wanted = {name: Image(value, TOLD * np.abs(value) + TINY, decided) for name, value in frame.told.items()}
    else:
        device = driver.precision, driver.rounding
        wanted = Reference().images(frame.passes, textures, size, frame.storage, *device, given=given)
    result = []
    for item in frame.passes:
        x, y, width, height = (-(-length // item.scale) for length in frame.area or (0, 0, *size))
        part = slice(y, y + height), slice(x, x + width)
        read = {name: given[name] if name in given else textures[name] for name in item.inputs.values()}
        parts = {name: wanted[name].part(*part) for name in item.outputs if name in wanted}
        judge = Judge(label, item, frame.main, read, size, frame.storage, part, parts)
        if objection := judge.objection(driver):
            raise UserError(f"mutants: {label} fails with the shaders as they are: {objection}. See validation/test.")
        result.append(judge)
    return result
