"""Chromatic aberration in float64: axial colour of section [8] of the libraries, lateral colour of [9]."""

import numpy as np

from bokeh_validation.reference import sampling
from bokeh_validation.reference.gather import at_center
from bokeh_validation.reference.images import Image
from bokeh_validation.reference.precision import FLOAT_STEP, Precision

MOST = 0.1


def lateral(image: Image, amount: float, precision: Precision | None) -> Image:
    """Red imaged larger by `amount` of its size than green, blue smaller.

    The interval is that of one filtered sample, see precision.py: the place of one has fewer roundings than a filter's.
    """
    (width, height), amount = image.size, min(max(amount, -MOST), MOST)
    found = at_center(image, precision)
    value, error = image.value.copy(), None if precision is None else found.error.copy()
    undecided = found.undecided
    y, x = np.mgrid[0:height, 0:width] + 0.5
    for channel, scale in ((0, 1.0 + amount), (2, 1.0 - amount)):
        at_x, at_y = (x - width / 2) / scale + width / 2, (y - height / 2) / scale + height / 2
        value[..., channel] = sampling.bilinear(image.value[..., channel : channel + 1], at_x, at_y)[..., 0]
        if precision is None:
            continue
        across, down = sampling.slopes(image.value)
        still = sampling.neighbourhood(image.error) + precision.filter * sampling.neighbourhood(np.abs(image.value))
        bound = still + precision.place(width) * across + precision.place(height) * down
        texel = sampling.nearest_index(at_x, at_y, image.size)
        error[..., channel] = bound[..., channel].reshape(-1)[texel]
        undecided = undecided | sampling.neighbourhood(image.undecided).reshape(-1)[texel]
    return Image(value, error, undecided)


def shifted(image: Image, shift: float) -> Image:
    """With the signed CoC of a channel that has `shift` more of it; the sum is rounded."""
    value = image.value + [0.0, 0.0, 0.0, shift]
    if image.error is None:
        return Image(value)
    return Image(value, image.error + [0.0, 0.0, 0.0, FLOAT_STEP], image.undecided)


def merged(red: Image, green: Image, blue: Image) -> Image:
    """A channel of each; the CoC is green's."""
    found = (red, green, blue, green)
    value = np.stack([one.value[..., channel] for channel, one in enumerate(found)], axis=-1)
    if green.error is None:
        return Image(value)
    error = np.stack([one.error[..., channel] for channel, one in enumerate(found)], axis=-1)
    return Image(value, error, red.undecided | green.undecided | blue.undecided)
