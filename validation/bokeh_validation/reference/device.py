"""The float64 reference as a driver: the same passes, computed instead of drawn.

What a pass should give is said twice: by formulas.py, and by its own GLSL, which interpreter.py runs. The formulas
answer where a number is wanted, the GLSL where it is to be known how far off a correct device may be, and for the
layered method, which has no formulas.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from bokeh_validation.drivers.base import STORAGE, Textures
from bokeh_validation.numerics.images import Image, stored
from bokeh_validation.numerics.precision import SOFTWARE, Precision
from bokeh_validation.reference import execution, formulas
from bokeh_validation.shaders.passes import Pass, target_area, target_size

# The shaders keep so far from the texels around a viewport, texels: BokehSetViewport
VIEWPORT_INSET = 1.0 / 128.0


class Reference:
    """NumPy, float64, rounded to the targets' format between passes. No language, no device."""

    name = "reference"
    adapter = "NumPy float64"
    software = True
    precision = SOFTWARE
    rounding = "nearest"

    def __init__(self, adapter: str | None = None):
        del adapter

    def run(
        self,
        passes: Sequence[Pass],
        textures: Textures,
        size: tuple[int, int],
        storage: str = "half",
        keep: Iterable[str] = ("result",),
    ) -> dict[str, np.ndarray]:
        """See drivers.base.Driver.run."""
        images = self.images(passes, textures, size, storage)
        return {name: images[name].value.astype(STORAGE[storage]) for name in keep}

    def images(
        self,
        passes: Sequence[Pass],
        textures: Textures,
        size: tuple[int, int],
        storage: str = "half",
        precision: Precision | None = None,
        rounding: str = "nearest",
        given: Textures | None = None,
    ) -> dict[str, Image]:
        """Every pass's output in float64; with `precision`, each with its acceptance interval.

        rounding  how the targets round, see images.stored
        given     name -> what a device has in a target: what later passes read in place of the result for it. Each
                  interval is then that of one pass.
        """
        live = {name: Image(np.atleast_3d(pixels).astype(np.float64)) for name, pixels in textures.items()}
        results: dict[str, Image] = {}
        scales = dict.fromkeys(textures, 1)
        for item in passes:
            inputs = {slot: live[name] for slot, name in item.inputs.items()}
            allowed, area = precision, target_area(item.scale, item.viewport or (0, 0, *size))
            if item.viewport and item.constants["BOKEH_VIEWPORT"]:
                for slot in inputs.keys() - {"KernelSamp"}:
                    inputs[slot] = inputs[slot].part(*_slices(scales[item.inputs[slot]], item.viewport))
                # the inset counts as an error of the sampler's place, which it is at the edge and nowhere else
                allowed = precision and replace(precision, subtexel=precision.subtexel + VIEWPORT_INSET)
            drawn = _run_pass(item, inputs, area[2:], allowed)
            for name, image in zip(item.outputs, drawn, strict=True):
                kept = stored(image, STORAGE[storage], rounding)
                if item.viewport:
                    before = live.get(name) or Image(np.zeros((*target_size(item.scale, size)[::-1], 4)))
                    kept = before.drawn_over(kept, *_slices(item.scale, item.viewport))
                live[name] = results[name] = kept
                scales[name] = item.scale
                if given is not None and name in given:
                    live[name] = Image(given[name].astype(np.float64))
        return results


def _slices(scale: int, viewport: tuple[int, int, int, int]) -> tuple[slice, slice]:
    """Rows and columns of a viewport in a target or a texture."""
    x, y, width, height = target_area(scale, viewport)
    return slice(y, y + height), slice(x, x + width)


def _run_pass(item: Pass, inputs: Mapping[str, Image], size: tuple[int, int], precision) -> list[Image]:
    """What a pass writes to each of its targets, from what is in its slots."""
    if precision is None and not item.spec.layers:
        return [Image(value) for value in formulas.run_pass(item, {slot: one.value for slot, one in inputs.items()})]
    return execution.run_pass(item, inputs, size, precision)
