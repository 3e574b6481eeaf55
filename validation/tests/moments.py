"""Measure the size of a highlight's bokeh, as second moments and extent, in an image, and predict it in closed form.

Prediction, at a constant CoC: a pass takes a pixel's value from samples at d_i with weights w_i, whose sum is 1. The
linear filter gives texel p the weight tent(p - x) in a sample at x, and over all integers p

    sum tent = 1      sum p tent = x      sum p^2 tent = x^2 + f (1 - f),   f = x - floor(x)

so one pass spreads a pixel with the mean -sum(w d) and the covariance of the d_i, plus sum(w f (1 - f)) on each axis
for the pixel grid: 0 to 1/4 square pixel. Consecutive passes are convolutions: means and covariances add. Methods that
sum images mix them. A line from -h to +h has the covariance (2h)(2h)^T v, where

    v = (N + 1) / (12 (N - 1))              N samples from end to end (Listing 2)
    v = (1 - (n + r^3) / x^3) / 12          x = n + r cells, a sample in the middle of each, weighted by its length;
                                            with a fixed number, x = N: (1 - 1 / N^2) / 12

since each cell of length l on the line leaves out its own l^2 / 12 of the line's 1/12.
"""

from math import floor, radians
from typing import NamedTuple

import numpy as np
from lines import Segment, edge_lengths, line_segment, parallelogram, polygon_edge

from bokeh_validation.frame import aperture_shapes, methods
from bokeh_validation.numerics.precision import FLOAT_STEP, SINE, Precision


class Spread(NamedTuple):
    """Describe where the light of a highlight goes, relative to the highlight, pixels, x right, y down.

    mean    (2,)
    second  (2, 2) second moments about the mean, square pixels
    reach   (2, 2): how far any light gets to the left and up, and to the right and down
    """

    mean: np.ndarray
    second: np.ndarray
    reach: np.ndarray


class Filter(NamedTuple):
    """Describe one pass in pixels: offsets (N, 2), their mean, and their covariance including the linear filter's
    part.
    """

    offsets: np.ndarray
    mean: np.ndarray
    second: np.ndarray


def measured(light: np.ndarray, center: tuple[float, float]) -> Spread:
    """Measure the spread of an image (H, W) float64 that is 0 outside the bokeh.

    center  of the highlight, in pixels from the image's corner (pixel centres at .5)
    """
    assert light.sum() > 0.0, "a black picture has no bokeh to measure"
    rows, columns = np.nonzero(light)
    places = np.stack([columns + 0.5, rows + 0.5]) - np.array(center)[:, None]
    weights = light[rows, columns] / light.sum()
    mean = places @ weights
    offsets = places - mean[:, None]
    return Spread(mean, (offsets * weights) @ offsets.T, np.stack([-places.min(axis=1), places.max(axis=1)]))


def ends(samples: int) -> float:
    """Return the variance of `samples` samples from end to end of a line of length 1."""
    return (samples + 1) / (12.0 * (samples - 1))


def midpoints(cells: float) -> float:
    """Return the variance of samples in the middles of `cells` cells, the last one cut short, on a line of length 1."""
    full_cells = floor(cells)
    return (1.0 - (full_cells + (cells - full_cells) ** 3) / cells**3) / 12.0


def predicted(settings: methods.Settings, size: tuple[int, int]) -> Spread:
    """Predict the spread of one bright pixel at `settings.coc`, without random sample offsets.

    Supports `exact`, `naive` and the paper's parallelograms, which have closed forms. `size` is (width, height).
    """
    pixels = settings.coc * size[1]
    paths = _paths(settings, pixels)
    shares = np.array([share for share, _ in paths]) / sum(share for share, _ in paths)
    means = np.array([-sum(pass_filter.mean for pass_filter in filters) for _, filters in paths])
    seconds = [sum(pass_filter.second for pass_filter in filters) for _, filters in paths]
    seconds = np.array([second + np.outer(mean, mean) for second, mean in zip(seconds, means, strict=True)])
    low = [sum(pass_filter.offsets.max(axis=0) for pass_filter in filters) for _, filters in paths]
    high = [sum(-pass_filter.offsets.min(axis=0) for pass_filter in filters) for _, filters in paths]
    mean = shares @ means
    second = np.tensordot(shares, seconds, 1) - np.outer(mean, mean)
    return Spread(mean, second, np.array([np.max(low, axis=0), np.max(high, axis=0)]))


def tolerance(settings: methods.Settings, size: tuple[int, int], precision: Precision) -> float:
    """Return how far a device's second moments may be from `predicted`, square pixels, on float targets.

    Positions are off by at most e in all passes together: 2 s e + e^2 of second moment, where s is the root of the
    larger moment, and e for f (1 - f), whose slope is 1. A sample's light goes to four texels within sqrt(2) of it,
    and a blend off by r gives each up to r of it too much or too little. So a pass changes the sum of p^2 by 4 r (root
    mean |p|^2 + sqrt(2))^2, and the light that it is divided by, by 4 r. The rounding of float32 sums is added to r.
    """
    spread = predicted(settings, size)
    passes = len(methods.plan(settings, size).passes) - 1 if settings.method != "exact" else 2
    position_error = passes * (precision.place(max(size)) + SINE * settings.coc * size[1])
    blend = precision.filter + (settings.count + 8) * FLOAT_STEP
    largest = np.sqrt(spread.second.diagonal().max())
    moments = (np.sqrt(np.trace(spread.second)) + np.sqrt(2.0)) ** 2 + largest**2
    return 2 * largest * position_error + position_error**2 + position_error + passes * 4 * blend * moments


def _paths(settings: methods.Settings, pixels: float) -> list[tuple[float, list[Filter]]]:
    """Return what is summed: fractions of the light, each with the passes that it goes through. `pixels` is the CoC."""
    rotation = radians(settings.rotation)
    if settings.method == "naive":
        table = aperture_shapes.kernel(settings.aperture, settings.count, settings.rotation) * [settings.squeeze, 1.0]
        offsets = (table - table.mean(axis=0)) * pixels
        return [(1.0, [_filter(table * pixels, np.full(len(table), 1 / len(table)), offsets.T @ offsets / len(table))])]
    if settings.method == "paper":
        (shape,) = aperture_shapes.PARALLELOGRAMS[settings.aperture]
        angles = [radians(angle) + rotation for angle in (shape.first, shape.second)]
        lines = [line_segment(angle, 1.0, (0.0, 0.0), settings.squeeze) for angle in angles]
        return [(1.0, [_line(line, pixels, settings) for line in lines])]
    sides, paths = methods.EXACT[settings.aperture], []
    lengths = edge_lengths(sides)
    for k in range(2, sides // 2 + 1):
        second = _line(polygon_edge(k, sides, rotation, settings.squeeze, True, lengths), pixels, settings)
        for i in range(1, k):
            first = _line(polygon_edge(i, sides, rotation, settings.squeeze, False, lengths), pixels, settings)
            paths.append((parallelogram(k, i, sides, lengths), [first, second]))
    return paths


def _line(segment: Segment, pixels: float, settings: methods.Settings) -> Filter:
    """Return one line at a CoC of `pixels`, with its covariance in closed form."""
    full_line = 2.0 * segment.half * pixels
    if settings.method == "paper" and settings.spacing <= 0.0:
        count = settings.count
        places, weights, variance = np.linspace(-0.5, 0.5, count), np.full(count, 1.0 / count), ends(count)
    else:
        cells = float(settings.count)
        if settings.spacing > 0.0:
            cells = float(np.clip(np.hypot(*full_line) / settings.spacing, 1.0, settings.count))
        edges = np.append(np.arange(np.ceil(cells)), cells)
        places, weights = (edges[1:] + edges[:-1]) / (2 * cells) - 0.5, np.diff(edges) / cells
        variance = midpoints(cells)
    return _filter(
        segment.middle * pixels + places[:, None] * full_line, weights, variance * np.outer(full_line, full_line)
    )


def _filter(offsets: np.ndarray, weights: np.ndarray, covariance: np.ndarray) -> Filter:
    """Return the filter with its covariance increased by that of the linear filter."""
    fraction = offsets - np.floor(offsets)
    return Filter(offsets, weights @ offsets, covariance + np.diag(weights @ (fraction * (1.0 - fraction))))
