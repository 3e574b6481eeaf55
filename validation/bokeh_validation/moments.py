"""Size of a highlight's bokeh: second moments and extent, measured in a picture and predicted in closed form.

Prediction, at a constant CoC. A pass takes a pixel's value from samples at d_i with weights w_i, sum 1. The linear
filter gives the texel p the weight tent(p - x) in a sample at x, and over whole p

    sum tent = 1      sum p tent = x      sum p^2 tent = x^2 + f (1 - f),   f = x - floor(x)

so one pass spreads a pixel with the mean -sum(w d) and the covariance of the d_i, plus sum(w f (1 - f)) on each axis
for the pixel grid: 0 to 1/4 square pixel. Passes follow each other as convolutions: means and covariances add. Methods
that add pictures mix them. A line from -h to +h has the covariance (2h)(2h)^T v, where

    v = (N + 1) / (12 (N - 1))              N samples from end to end (Listing 2)
    v = (1 - (n + r^3) / x^3) / 12          x = n + r cells, a sample in the middle of each, weighed by its length;
                                            with a fixed number, x = N: (1 - 1 / N^2) / 12

since cells of length l, cut from a line, each leave out their own l^2 / 12 of the line's 1/12.
"""

from dataclasses import dataclass
from math import floor, radians

import numpy as np

from bokeh_validation import apertures, methods
from bokeh_validation.reference import polygons, segments
from bokeh_validation.reference.precision import FLOAT_STEP, Precision


@dataclass(frozen=True)
class Spread:
    """Where the light of a highlight is, relative to the highlight, pixels, x right, y down.

    mean    (2,)
    second  (2, 2) second moments about the mean, square pixels
    reach   (2, 2): how far to the left and up, and how far to the right and down, any light gets
    """

    mean: np.ndarray
    second: np.ndarray
    reach: np.ndarray

    def fractions(self, height: int) -> np.ndarray:
        """Width and height, as of a box with these second moments, in fractions of the image height, (2,)."""
        return np.sqrt(12.0 * np.diag(self.second)) / height


def measured(light: np.ndarray, center: tuple[float, float]) -> Spread:
    """Spread of a picture (H, W) float64 that is 0 but for the bokeh.

    center  of the highlight, in pixels from the image's corner (pixel centres at .5)

    Raises ValueError where the picture is black.
    """
    if not light.sum() > 0.0:
        raise ValueError("a black picture has no bokeh to measure")
    rows, columns = np.nonzero(light)
    places = np.stack([columns + 0.5, rows + 0.5]) - np.array(center)[:, None]
    weights = light[rows, columns] / light.sum()
    mean = places @ weights
    off = places - mean[:, None]
    return Spread(mean, (off * weights) @ off.T, np.stack([-places.min(axis=1), places.max(axis=1)]))


@dataclass(frozen=True)
class _Filter:
    """Samples of one pass, pixels: offsets (N, 2), weights (N,) with the sum 1, covariance of the offsets (2, 2)."""

    offsets: np.ndarray
    weights: np.ndarray
    covariance: np.ndarray


def ends(samples: int) -> float:
    """Variance of so many samples from end to end of a line of length 1."""
    return (samples + 1) / (12.0 * (samples - 1))


def midpoints(cells: float) -> float:
    """Variance of samples in the middles of so many cells, the last one cut short, on a line of length 1."""
    whole = floor(cells)
    return (1.0 - (whole + (cells - whole) ** 3) / cells**3) / 12.0


def predicted(settings: methods.Settings, size: tuple[int, int]) -> Spread:
    """Spread of one bright pixel at `settings.coc`, without jitter.

    `exact`, `naive` and the paper's parallelograms: all of it. The paper's hexagon with a fixed, odd number of samples:
    the reach, with NaN for the moments; its corners are samples of both parallelograms then.

    Raises ValueError for what is none of these.
    """
    paths = _paths(settings, size)
    if paths is None:
        return Spread(np.full(2, np.nan), np.full((2, 2), np.nan), _hexagon_reach(settings, size))
    means, seconds, low, high = [], [], [], []
    for _, filters in paths:
        mean = sum(item.weights @ item.offsets for item in filters)
        means.append(-mean)
        seconds.append(sum(item.covariance + _grid(item) for item in filters) + np.outer(mean, mean))
        low.append(sum(item.offsets.max(axis=0) for item in filters))
        high.append(sum(-item.offsets.min(axis=0) for item in filters))
    shares = np.array([share for share, _ in paths])
    mean = shares @ np.array(means)
    second = np.tensordot(shares, np.array(seconds), 1) - np.outer(mean, mean)
    return Spread(mean, second, np.array([np.max(low, axis=0), np.max(high, axis=0)]))


def tolerance(settings: methods.Settings, size: tuple[int, int], precision: Precision) -> float:
    """How far a device's second moments may be from `predicted`, square pixels, on float targets.

    Places are off by e at most, in all passes together: 2 s e + e^2 of second moment, s the root of the larger moment,
    and e for f (1 - f), whose slope is 1. A sample's light goes to four texels within sqrt(2) of it; a blend off by r
    gives each up to r of it too much or too little: a pass changes the sum of p^2 by 4 r (root mean |p|^2 + sqrt(2))^2
    and the light it is divided by by 4 r. The sums in float32 come on top of r.
    """
    spread = predicted(settings, size)
    passes = len(methods.plan(settings, size).passes) - 1 if settings.method != "exact" else 2
    off = passes * (precision.place(max(size)) + precision.line * settings.coc * size[1])
    blend = precision.filter + (settings.count + 8) * FLOAT_STEP
    largest = np.sqrt(spread.second.diagonal().max())
    moments = (np.sqrt(np.trace(spread.second)) + np.sqrt(2.0)) ** 2 + largest**2
    return 2 * largest * off + off**2 + off + passes * 4 * blend * moments


def _paths(settings: methods.Settings, size: tuple[int, int]) -> list[tuple[float, list[_Filter]]] | None:
    """What is added up: shares of the light, each with the passes that it goes through; None for what is not linear."""
    pixels = settings.coc * size[1]
    if settings.method == "naive":
        table = apertures.kernel(settings.aperture, settings.count, settings.rotation) * [settings.squeeze, 1.0]
        return [(1.0, [_samples(table * pixels)])]
    if settings.method == "exact":
        return _exact_paths(settings, pixels)
    shapes = apertures.PARALLELOGRAMS[settings.aperture]
    if len(shapes) > 1:
        return None
    lines = []
    for angle in (shapes[0].first, shapes[0].second):
        turned = radians(angle + settings.rotation)
        lines.append(_line(segments.line_segment(turned, 1.0, (0.0, 0.0), settings.squeeze), pixels, settings))
    return [(1.0, lines)]


def _exact_paths(settings: methods.Settings, pixels: float) -> list[tuple[float, list[_Filter]]]:
    """All parallelograms of the exact method."""
    sides, rotation = methods.EXACT[settings.aperture], radians(settings.rotation)
    paths = []
    for k in range(2, sides // 2 + 1):
        second = _line(segments.polygon_edge(k, sides, rotation, settings.squeeze, True), pixels, settings)
        for i in range(1, k):
            first = _line(segments.polygon_edge(i, sides, rotation, settings.squeeze, False), pixels, settings)
            paths.append((segments.parallelogram(k, i, sides), [first, second]))
    total = sum(share for share, _ in paths)
    return [(share / total, filters) for share, filters in paths]


def _samples(offsets: np.ndarray) -> _Filter:
    """Equal weights: the covariance from the places themselves."""
    off = offsets - offsets.mean(axis=0)
    return _Filter(offsets, np.full(len(offsets), 1.0 / len(offsets)), off.T @ off / len(offsets))


def _line(segment: segments.Segment, pixels: float, settings: methods.Settings) -> _Filter:
    """One line at a CoC of so many pixels, its covariance in closed form."""
    whole = 2.0 * segment.half * pixels
    if settings.method == "paper" and settings.spacing <= 0.0:
        count = settings.count
        places, weights, variance = np.linspace(-0.5, 0.5, count), np.full(count, 1.0 / count), ends(count)
    else:
        cells = float(settings.count)
        if settings.spacing > 0.0:
            cells = float(np.clip(np.hypot(*whole) / settings.spacing, 1.0, settings.count))
        edges = np.append(np.arange(np.ceil(cells)), cells)
        places, weights = (edges[1:] + edges[:-1]) / (2 * cells) - 0.5, np.diff(edges) / cells
        variance = midpoints(cells)
    offsets = segment.middle * pixels + places[:, None] * whole
    return _Filter(offsets, weights, variance * np.outer(whole, whole))


def _grid(item: _Filter) -> np.ndarray:
    """What the linear filter adds to the covariance."""
    fraction = item.offsets - np.floor(item.offsets)
    return np.diag(item.weights @ (fraction * (1.0 - fraction)))


def _hexagon_reach(settings: methods.Settings, size: tuple[int, int]) -> np.ndarray:
    """Reach of the paper's hexagon."""
    if settings.aperture != "hexagon" or settings.spacing > 0.0 or settings.count % 2 == 0:
        raise ValueError(f"no closed form for {settings.method} {settings.aperture} with {settings.count} samples")
    shapes = [shape.corners(settings.rotation) for shape in apertures.PARALLELOGRAMS["hexagon"]]
    corners = polygons.clip_convex(*shapes) * [settings.squeeze, 1.0] * settings.coc * size[1]
    return np.array([-corners.min(axis=0), corners.max(axis=0)])
