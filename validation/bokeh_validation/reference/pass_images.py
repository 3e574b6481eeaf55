"""What the passes of a frame write, in float64, and how far a correct device may be from it.

The reference has no formulas of its own: it runs the passes' GLSL on intervals (interpreter.py). That the text says
what it should is shown by tests: tests/formulas.py has the paper's formulas and the polygons' geometry; layered is held
to light that is kept, to ray-traced scenes, and to pictures that were found good.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bokeh_validation.numerics.images import STORAGE, Image, Textures, stored
from bokeh_validation.numerics.precision import Precision
from bokeh_validation.reference import kept
from bokeh_validation.shaders.passes import Pass, target_area, target_size

# The shaders keep so far from the texels around a viewport, texels: BokehSetViewport
VIEWPORT_INSET = 1.0 / 128.0


class Alone(NamedTuple):
    """Passes of which each reads what the reference made, stored, of those before it.

    made     target -> (H, W, 4) of the storage, rounded to nearest
    allowed  target -> the interval of one pass
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
    """Every pass's output in float64; with `precision`, each with its acceptance interval from the textures on.

    rounding  how the targets round, see images.stored
    given     name -> what a device has in a target: what later passes read in place of the result for it. Each
              interval is then that of one pass.
    """
    frame, results = _Frame(textures, size), {}
    for item in passes:
        for name, image in frame.drawn(item, precision).items():
            results[name] = frame.keep(item, name, stored(image, STORAGE[storage], rounding))
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
    """Each pass on its own, on what the reference made for its inputs; see execution.run_pass for `text`."""
    frame, made, allowed = _Frame(textures, size, text), {}, {}
    for item in passes:
        for name, image in frame.drawn(item, precision).items():
            nearest = stored(Image(image.value), STORAGE[storage])
            allowed[name] = frame.placed(item, name, stored(image, STORAGE[storage], rounding))
            # without an interval: the next pass's is its own
            made[name] = frame.keep(item, name, nearest).value.astype(STORAGE[storage])
    return Alone(made, allowed)


class _Frame:
    """All textures of a frame while its passes are drawn.

    live  what the next pass reads
    """

    def __init__(self, textures: Textures, size: tuple[int, int], text: str | None = None):
        self.size, self.text = size, text
        self.live = {name: Image(np.atleast_3d(pixels).astype(np.float64)) for name, pixels in textures.items()}
        self.scales = dict.fromkeys(textures, 1)

    def drawn(self, item: Pass, precision: Precision | None) -> Mapping[str, Image]:
        """What a pass writes to each of its targets, before it is stored; of a viewport that part alone."""
        inputs = {slot: self.live[name] for slot, name in item.inputs.items()}
        area = target_area(item.scale, item.viewport or (0, 0, *self.size))
        if item.viewport and item.constants["BOKEH_VIEWPORT"]:
            for slot in inputs.keys() - {"KernelSamp"}:
                inputs[slot] = inputs[slot].part(*_slices(self.scales[item.inputs[slot]], item.viewport))
            # the inset counts as an error of the sampler's place, which it is at the edge and nowhere else
            precision = precision and replace(precision, subtexel=precision.subtexel + VIEWPORT_INSET)
        drawn = kept.run_pass(item, inputs, area[2:], precision, self.text)
        return dict(zip(item.outputs, drawn, strict=True))

    def placed(self, item: Pass, name: str, image: Image) -> Image:
        """A whole target with what a pass wrote to it."""
        if not item.viewport:
            return image
        before = self.live.get(name) or Image(np.zeros((*target_size(item.scale, self.size)[::-1], 4)))
        return before.drawn_over(image, *_slices(item.scale, item.viewport))

    def keep(self, item: Pass, name: str, image: Image) -> Image:
        """Put what a pass wrote into its target, which later passes read, and return all of that."""
        self.live[name], self.scales[name] = self.placed(item, name, image), item.scale
        return self.live[name]


def _slices(scale: int, viewport: tuple[int, int, int, int]) -> tuple[slice, slice]:
    """Rows and columns of a viewport in a target or a texture."""
    x, y, width, height = target_area(scale, viewport)
    return slice(y, y + height), slice(x, x + width)
