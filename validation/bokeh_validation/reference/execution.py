"""Execute passes from their own GLSL on intervals (interpreter.py): the value, and how far off a device may be."""

import multiprocessing
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import cached_property

import numpy as np

from bokeh_validation import shaders
from bokeh_validation.numerics.images import Image
from bokeh_validation.numerics.precision import FLOAT_STEP, Precision
from bokeh_validation.reference import glsl, sampling
from bokeh_validation.reference.interpreter import Run
from bokeh_validation.reference.intervals import Interval, interval
from bokeh_validation.shaders.passes import Pass, is_linear

# a worker process shares the cores with others and uses one thread
THREADS = 2 if multiprocessing.parent_process() is None else 1
RESULTS = ("BokehResult", "BokehResultB", "BokehResultC", "BokehResultD")
# error of the rasteriser's uv: the roundings of two products and two sums
UV = 4 * FLOAT_STEP
# pixels per chunk, so that their variables fit into the processor's cache
PIXELS = 8192


class Texture:
    """Sample a texture with clamp, as the shaders read it. uv is (2, pixels), the result (channels, pixels).

    precision  of the device; None: no error is computed
    is_linear  whether its sampler has a linear filter, which Direct3D 9 also uses to read single texels
    """

    def __init__(self, image: Image, precision: Precision | None, is_linear: bool):
        self.image, self.precision, self.is_linear = image, precision, is_linear
        self.value = image.value.reshape(-1, image.value.shape[2])
        self.error = None if image.error is None else image.error.reshape(self.value.shape)

    @cached_property
    def around(self) -> tuple[np.ndarray, np.ndarray]:
        """Return error bounds around each texel, in the channels of two arrays: over 3 x 3 texels, for positions off
        by up to half a texel, and over 5 x 5, for up to one and a half.

        Channels are the error of a filtered sample at the right position, then how much it grows per texel that the
        position is off, horizontally and vertically. A shifted lookup changes by at most the shift times the steepest
        slope; the filter rounds by a fraction of the largest texel.
        """
        value = self.image.value
        still = self.precision.filter * sampling.neighbourhood(np.abs(value))
        if self.error is not None:
            still += sampling.neighbourhood(self.image.error)
        near = np.concatenate([still, *sampling.slopes(value)], axis=2)
        wide = sampling.neighbourhood(near)
        return near.reshape(-1, near.shape[2]), wide.reshape(-1, near.shape[2])

    def off(self, uv: Interval) -> np.ndarray:
        """Return the largest error of a position in texels, (2, pixels), from uv, its product with the size, and the
        sampler.
        """
        size = np.array(self.image.size)[:, None]
        return self.precision.subtexel + uv.error * size + 2 * FLOAT_STEP * np.abs(uv.value * size)

    def linear(self, uv: Interval) -> Interval:
        """Sample with the linear filter."""
        x, y = uv.value * np.array(self.image.size)[:, None]
        value = np.ascontiguousarray(sampling.bilinear(self.image.value, x, y).T)
        if self.precision is None:
            return Interval(value)
        texel, offsets, (near, wide) = sampling.nearest_index(x, y, self.image.size), self.off(uv), self.around
        farthest = offsets.max(axis=0)
        error = _error(near[texel], offsets)
        is_far = farthest > 0.5
        if is_far.any():
            error[:, is_far] = _error(wide[texel[is_far]], offsets[:, is_far])
            # the slopes say nothing about positions that are farther off
            error[:, farthest > 1.5] = np.inf
        return Interval(value, value - error, value + error)

    def nearest(self, uv: Interval) -> Interval:
        """Fetch the nearest texel; if devices may choose different ones, the interval covers them. May be NaN."""
        if self.is_linear:
            return self.linear(uv)
        position = uv.value * np.array(self.image.size)[:, None]
        texel = sampling.nearest_index(*position, self.image.size)
        value = self.value[texel].T
        if self.precision is None:
            return Interval(value)
        offsets = self.off(uv)
        first, last = position - offsets, position + offsets
        if self.error is None and (np.floor(first) == np.floor(last)).all():
            return Interval(value)
        low, high = value, value
        for x in (first[0], last[0]):
            for y in (first[1], last[1]):
                texel = sampling.nearest_index(x, y, self.image.size)
                error = 0.0 if self.error is None else self.error[texel].T
                low, high = np.minimum(low, self.value[texel].T - error), np.maximum(high, self.value[texel].T + error)
        return Interval(value, low, high)

    def depth(self, uv: Interval) -> Interval:
        """Fetch red and green of the nearest texel; a texture of one channel has no green, which is then 0."""
        texel, missing = self.nearest(uv), np.zeros((max(2 - self.value.shape[-1], 0), uv.value.shape[-1]))
        return Interval(*(np.concatenate([part[:2], missing]) for part in (texel.value, texel.low, texel.high)))


def _error(bounds: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    still, across, down = bounds.T.reshape(3, -1, offsets.shape[1])
    return still + offsets[0] * across + offsets[1] * down


def run_pass(
    render_pass: Pass,
    inputs: Mapping[str, Image],
    size: tuple[int, int],
    precision: Precision | None,
    text: str | None = None,
) -> list[Image]:
    """Return what a pass writes to each of its targets.

    inputs     slot -> texture
    size       (width, height) of the targets
    precision  of the device; None: no errors are computed
    text       all GLSL files as one text; None: the package's files
    """
    entry = render_pass.spec
    width, height = size
    textures = {
        f"Bokeh{slot}": Texture(image, precision, is_linear(entry.name, slot)) for slot, image in inputs.items()
    }
    uniforms = {name: interval(value) for name, value in render_pass.given().items()}
    library = glsl.library(text or shaders.text("glsl"))
    # the caller has already cropped the textures to the viewport
    scope = {**uniforms, **render_pass.constants, "BOKEH_VIEWPORT": 0, **{name: name for name in textures}}

    def part(start: int) -> tuple[list[Interval], np.ndarray]:
        pixels = np.arange(start, min(start + PIXELS, width * height))
        uv = np.stack([(pixels % width + 0.5) / width, (pixels // width + 0.5) / height])
        uv_interval = Interval(uv, uv - UV, uv + UV) if precision else Interval(uv)
        run = Run(library, {**scope, "BokehUV": uv_interval}, textures, len(pixels))
        written = run.main(entry.name)
        return [written[name].spread(len(pixels)) for name in RESULTS[: entry.targets]], run.undecided

    with ThreadPoolExecutor(THREADS) as pool:
        parts = list(pool.map(part, range(0, width * height, PIXELS)))
    undecided = np.concatenate([chunk[1] for chunk in parts]).reshape(height, width) & (not entry.layers)
    for image in inputs.values():
        if image.undecided is not None and image.size == size:
            undecided = undecided | image.undecided
    return [_image([targets[k] for targets, _ in parts], undecided, precision) for k in range(entry.targets)]


def _image(parts: list[Interval], undecided: np.ndarray, precision: Precision | None) -> Image:
    shape = (*undecided.shape, 4)
    value = np.concatenate([chunk.value.T for chunk in parts]).reshape(shape)
    if precision is None:
        return Image(value)
    error = np.concatenate([chunk.error.T for chunk in parts]).reshape(shape)
    return Image(value, np.where(np.isnan(error), np.inf, error), undecided)
