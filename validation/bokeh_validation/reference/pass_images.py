"""Compute what the passes of a frame write, in float64, and how far a correct device may be from it.

The reference has no formulas; it runs the passes' GLSL on intervals (interpreter.py). Tests show that this GLSL is
right: tests/formulas.py has the paper's formulas and the polygons' geometry. For layered, they check that light is
kept, and compare with ray-traced scenes and with images that were reviewed.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bokeh_validation.numerics.images import STORAGE, Image, Textures, stored
from bokeh_validation.numerics.precision import Precision
from bokeh_validation.reference import kept
from bokeh_validation.shaders.passes import Pass, target_area, target_size

# Distance that the shaders keep from the texels around a viewport, texels: BokehSetViewport
VIEWPORT_INSET = 1.0 / 128.0


class Alone(NamedTuple):
    """Hold the targets of passes drawn alone: each reads what the reference computed and stored for earlier passes.

    made     target -> (H, W, 4) of the storage, rounded to nearest
    allowed  target -> interval of that pass alone
    """

    made: dict[str, np.ndarray]
    allowed: dict[str, Image]


def images(
    passes: Sequence[Pass],
    textures: Textures,
    size: tuple[int, int],
    storage: str = "half",
    precision: Precision | None = None,
    rounding: str = "nearest",
    given: Textures | None = None,
) -> dict[str, Image]:
    """Compute every pass's targets in float64; with `precision`, with an interval that accumulates from the textures
    on.

    rounding  how the targets round, see images.stored
    given     name -> a device's content of a target, which later passes read instead of the computed one; each
              interval then covers one pass only
    Returns target -> image.
    """
    frame, results = _Frame(textures, size), {}
    for render_pass in passes:
        for name, image in frame.drawn(render_pass, precision).items():
            results[name] = frame.keep(render_pass, name, stored(image, STORAGE[storage], rounding))
            if given is not None and name in given:
                frame.live[name] = Image(given[name].astype(np.float64))
    return results


def alone(
    passes: Sequence[Pass],
    textures: Textures,
    size: tuple[int, int],
    storage: str,
    precision: Precision,
    rounding: str,
    text: str | None = None,
) -> Alone:
    """Compute each pass alone, on inputs computed by the reference; see execution.run_pass for `text`."""
    frame, rounded_targets, intervals = _Frame(textures, size, text), {}, {}
    for render_pass in passes:
        for name, image in frame.drawn(render_pass, precision).items():
            nearest = stored(Image(image.value), STORAGE[storage])
            intervals[name] = frame.placed(render_pass, name, stored(image, STORAGE[storage], rounding))
            # stored without its interval, so that the next pass's interval covers only that pass
            rounded_targets[name] = frame.keep(render_pass, name, nearest).value.astype(STORAGE[storage])
    return Alone(rounded_targets, intervals)


class _Frame:
    """Hold all textures of a frame while its passes are drawn.

    live  name -> what the next pass reads
    """

    def __init__(self, textures: Textures, size: tuple[int, int], text: str | None = None):
        self.size, self.text = size, text
        self.live = {name: Image(np.atleast_3d(pixels).astype(np.float64)) for name, pixels in textures.items()}
        self.scales = dict.fromkeys(textures, 1)

    def drawn(self, render_pass: Pass, precision: Precision | None) -> Mapping[str, Image]:
        """Return what a pass writes to each of its targets, before storing; with a viewport, only that part."""
        inputs = {slot: self.live[name] for slot, name in render_pass.inputs.items()}
        area = target_area(render_pass.scale, render_pass.viewport or (0, 0, *self.size))
        if render_pass.viewport and render_pass.constants["BOKEH_VIEWPORT"]:
            for slot in inputs.keys() - {"KernelSamp"}:
                inputs[slot] = inputs[slot].part(*_slices(self.scales[render_pass.inputs[slot]], render_pass.viewport))
            # the inset is treated as an error of the sampled position; it only moves positions at the edge
            precision = precision and replace(precision, subtexel=precision.subtexel + VIEWPORT_INSET)
        if precision and render_pass.spec.layers:
            render_pass = replace(render_pass, defines=render_pass.defines | dict(precision.constants))
        target_images = kept.run_pass(render_pass, inputs, area[2:], precision, self.text)
        return dict(zip(render_pass.outputs, target_images, strict=True))

    def placed(self, render_pass: Pass, name: str, image: Image) -> Image:
        """Return the whole target after a pass has written to it."""
        if not render_pass.viewport:
            return image
        target = self.live.get(name) or Image(np.zeros((*target_size(render_pass.scale, self.size)[::-1], 4)))
        return target.drawn_over(image, *_slices(render_pass.scale, render_pass.viewport))

    def keep(self, render_pass: Pass, name: str, image: Image) -> Image:
        """Store what a pass wrote into its target, for later passes, and return the whole target."""
        self.live[name], self.scales[name] = self.placed(render_pass, name, image), render_pass.scale
        return self.live[name]


def _slices(scale: int, viewport: tuple[int, int, int, int]) -> tuple[slice, slice]:
    """Return the rows and columns of a viewport in a target or a texture of this scale."""
    x, y, width, height = target_area(scale, viewport)
    return slice(y, y + height), slice(x, x + width)
