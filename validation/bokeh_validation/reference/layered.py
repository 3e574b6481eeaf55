"""The passes of the layered method as the reference: their own GLSL, executed on intervals (interpreter.py)."""

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from bokeh_validation.reference import gather, sampling
from bokeh_validation.reference.images import Image
from bokeh_validation.reference.interpreter import Run
from bokeh_validation.reference.intervals import Interval, interval
from bokeh_validation.reference.precision import FLOAT_STEP, Precision
from bokeh_validation.shaders.entries import Entry

RESULTS = ("BokehResult", "BokehResultB", "BokehResultC", "BokehResultD")
# how far off the rasteriser's uv may be: the roundings of two products and two sums
UV = 4 * FLOAT_STEP
# so many run at once: their variables stay in the processor's cache
PIXELS = 8192


class Texture:
    """A texture as a linear filter with clamp reads it.

    Around each texel, in the channels of one array: how far off a sample is that is where it should be, and how much
    more for each texel that it is off its place, across and down. `near` is of 3 x 3 texels, for places off by half a
    texel; `wide` of 5 x 5, by one and a half.
    """

    def __init__(self, image: Image, precision: Precision | None):
        self.image, self.precision = image, precision
        if precision:
            still = sampling.neighbourhood(image.error) + precision.filter * sampling.neighbourhood(np.abs(image.value))
            near = np.concatenate([still, *sampling.slopes(image.value)], axis=2)
            self.near, self.wide = (field.reshape(-1, 12) for field in (near, sampling.neighbourhood(near)))

    def fetch(self, uv: Interval) -> Interval:
        """(2, pixels) to (4, pixels)."""
        size = np.array(self.image.size)[:, None]
        x, y = uv.value * size
        value = np.ascontiguousarray(sampling.bilinear(self.image.value, x, y).T)
        if self.precision is None:
            return Interval(value)
        texel = sampling.nearest_index(x, y, self.image.size)
        # the product with the size, and what the sampler makes of it
        off = self.precision.subtexel + uv.error * size + 2 * FLOAT_STEP * np.abs(uv.value * size)
        farthest = off.max(axis=0)
        error = _error(self.near[texel], off)
        beyond = farthest > 0.5
        if beyond.any():
            error[:, beyond] = _error(self.wide[texel[beyond]], off[:, beyond])
            # of what is farther off the slopes say nothing
            error[:, farthest > 1.5] = np.inf
        return Interval(value, value - error, value + error)


def _error(around: np.ndarray, off: np.ndarray) -> np.ndarray:
    still, across, down = around.T.reshape(3, 4, -1)
    return still + off[0] * across + off[1] * down


def run_pass(
    entry: Entry,
    textures: Mapping[str, Image],
    size: tuple[int, int],
    values: Mapping[str, float],
    constants: Mapping[str, int],
    precision: Precision | None,
) -> list[Image]:
    """What a layered entry writes to each of its targets; textures by their slots."""
    width, height = size
    bound = {f"Bokeh{slot}": Texture(image, precision) for slot, image in textures.items()}
    uniforms = {name: interval(value) for name, value in values.items()}
    # a viewport is cut out beforehand
    given = {**uniforms, **constants, "BOKEH_VIEWPORT": 0, **{name: name for name in bound}}

    line = precision.line if precision else 0.0

    def fetch(name: str, at: Interval) -> Interval:
        return bound[name].fetch(at)

    def part(start: int) -> list[Interval]:
        pixels = np.arange(start, min(start + PIXELS, width * height))
        uv = np.stack([(pixels % width + 0.5) / width, (pixels // width + 0.5) / height])
        place = Interval(uv, uv - UV, uv + UV) if precision else Interval(uv)
        written = Run({**given, "BokehUV": place}, fetch, line).main(entry.name, len(pixels))
        return [written[name].spread(len(pixels)) for name in RESULTS[: entry.targets]]

    with ThreadPoolExecutor(gather.THREADS) as pool:
        parts = list(pool.map(part, range(0, width * height, PIXELS)))
    return [_image([targets[k] for targets in parts], size, precision) for k in range(entry.targets)]


def _image(parts: list[Interval], size: tuple[int, int], precision: Precision | None) -> Image:
    """Undecided nowhere: open comparisons are in the interval."""
    shape = (*size[::-1], 4)
    value = np.concatenate([part.value.T for part in parts]).reshape(shape)
    if precision is None:
        return Image(value)
    error = np.concatenate([part.error.T for part in parts]).reshape(shape)
    return Image(value, np.where(np.isnan(error), np.inf, error), np.zeros(shape[:2], bool))
