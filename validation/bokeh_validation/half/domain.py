"""What every function of the library may be given, and in what unit its error matters.

Depth 0.1 .. 100000 m; lenses of 24 to 135 mm at f/1.4 to f/16, focused at 0.5 to 100 m; CoC up to MaxCoC, 0.1; images
of 720 to 4320 rows; colour 0 .. 65504; 65 samples. Inputs that spread over decades are drawn evenly over those.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from bokeh_validation.half import program
from bokeh_validation.reference import listings

ROWS = 2160
MAX_COC = 0.1
MAX_SAMPLES = 65
SENSOR = 0.024
WIDE = 16.0 / 9.0
SETTINGS = {"bleedingBias": 0.02, "bleedingMult": 30.0}  # what a leakage test reads of BokehFilter
SIDES = np.array([4, 6, 8, 10])
SMALLEST_NORMAL = 2.0**-14
PIXELS, RELATIVE, ABSOLUTE, CELLS = "pixels", "relative", "absolute", "cells"

Arguments = list


class Domain(NamedTuple):
    """Inputs of a function, and the unit of its error.

    function   as the library names it
    unit       of the error, for a reader
    arguments  (random generator, N) -> arrays (N,), (N, components) or numbers; structs as dictionaries of these
    pixels     how many an error of 1 counts: a number, or of the arguments, broadcast to (N, k)
    """

    function: str
    unit: str
    arguments: Callable[[Generator, int], Arguments]
    pixels: float | Callable[[Arguments], np.ndarray] = ROWS

    def scale(self, exact: np.ndarray, arguments: Arguments) -> np.ndarray:
        """What an error of 1 counts in each component of the exact result (N, k)."""
        if self.unit == RELATIVE:
            return 1.0 / np.maximum(np.abs(exact), SMALLEST_NORMAL)
        counts = self.pixels if self.unit == PIXELS else 1.0
        return np.broadcast_to(counts(arguments) if callable(counts) else counts, exact.shape)


def _uv(aspect) -> np.ndarray:
    """uv offsets for a CoC of 1, as pixels for the largest CoC."""
    return MAX_COC * ROWS * np.stack([aspect, np.ones_like(aspect)], axis=-1)


def _logarithmic(random: Generator, low: float, high: float, shape) -> np.ndarray:
    return np.exp(random.uniform(np.log(low), np.log(high), shape))


def _depth(random: Generator, n: int) -> np.ndarray:
    return _logarithmic(random, 0.1, 1e5, n)


def _focus(random: Generator, n: int) -> np.ndarray:
    return _logarithmic(random, 0.5, 100.0, n)


def _color(random: Generator, n: int) -> np.ndarray:
    """RGB and a CoC."""
    return np.concatenate([_logarithmic(random, 1e-6, 65504.0, (n, 3)), random.uniform(0.0, MAX_COC, (n, 1))], axis=1)


def _angle(random: Generator, n: int) -> np.ndarray:
    return random.uniform(0.0, 2.0 * np.pi, n)


def _directions(random: Generator, n: int) -> np.ndarray:
    angle = _angle(random, n)
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _size(random: Generator, n: int) -> np.ndarray:
    return np.stack([random.integers(1280, 7681, n), random.integers(720, 4321, n)], axis=1).astype(float)


def _coc(random: Generator, n: int) -> Arguments:
    focal = random.uniform(0.024, 0.135, n)
    aperture = focal / _logarithmic(random, 1.4, 16.0, n)
    focus = _focus(random, n)
    return [_depth(random, n), aperture, focal, focus, np.full(n, SENSOR), np.full(n, MAX_COC)]


def _between_planes(random: Generator, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    near, far = _logarithmic(random, 0.05, 1.0, n), _logarithmic(random, 100.0, 1e5, n)
    return near * (far / near) ** random.uniform(0.0, 1.0, n), near, far


def _from_depth(kind: str) -> Domain:
    """What a depth buffer of a convention holds for a distance between the planes."""
    function = f"BokehDepthFrom{kind.capitalize()}"

    def arguments(random: Generator, n: int) -> Arguments:
        metres, near, far = _between_planes(random, n)
        given = {"zNear": near, "zFar": far}
        given["depth"] = listings.stored_depth(metres, listings.DEPTH_KINDS[kind], near, far)
        return [given[name] for name in program.library()[function].parameters]

    return Domain(function, RELATIVE, arguments)


def _linear_depth(random: Generator, n: int) -> Arguments:
    metres, near, far = _between_planes(random, n)
    kind = random.integers(0, len(listings.DEPTH_KINDS), n)
    by_kind = [listings.stored_depth(metres, each, near, far) for each in listings.DEPTH_KINDS.values()]
    return [np.choose(kind, by_kind), kind, near, far]


def _offsets(random: Generator, n: int) -> Arguments:
    count = random.integers(2, MAX_SAMPLES + 1, n)
    end = 0.5 * _directions(random, n) / np.array([WIDE, 1.0])
    return [end, np.floor(random.uniform(0.0, 1.0, n) * count).astype(np.int64), count]


def _filter_coc(random: Generator, n: int) -> Arguments:
    rows = random.integers(720, 4321, n).astype(float)
    return [_logarithmic(random, 1e-5, MAX_COC, n), rows, random.integers(0, 3, n) / 2.0]


def _segment(random: Generator, n: int) -> Arguments:
    middle = random.uniform(-0.5, 0.5, (n, 2))
    return [_angle(random, n), random.uniform(0.0, 1.0, n), middle, random.uniform(0.5, 1.0, n)]


def _half_coc(random: Generator, n: int, least: float = 0.0) -> list[np.ndarray]:
    """CoC of sample and centre as RGBA16F has them."""
    return [random.uniform(least, MAX_COC, n).astype(np.float16).astype(float) for _ in range(2)]


def _leakage(random: Generator, n: int) -> Arguments:
    sample, center = _half_coc(random, n)
    return [_depth(random, n), sample, _depth(random, n), center, SETTINGS]


def _resolve(random: Generator, n: int) -> Arguments:
    total = random.uniform(1.0, MAX_SAMPLES, n)
    return [_color(random, n) * total[:, None], total, _color(random, n), True]


def _polygon(random: Generator, n: int, first: int = 2) -> list[np.ndarray]:
    """k from `first` to sides / 2, and sides."""
    sides = random.choice(SIDES[SIDES >= 2 * first], n)
    k = first + np.floor(random.uniform(0.0, 1.0, n) * (sides // 2 - first + 1))
    return [k.astype(np.int64), sides]


def _edge(random: Generator, n: int) -> Arguments:
    k, sides = _polygon(random, n, 1)
    polygon = {"sides": sides, "rotation": _angle(random, n), "squeeze": random.uniform(0.5, 1.0, n)}
    return [k, polygon, random.integers(0, 2, n).astype(bool)]


def _target(random: Generator, n: int) -> Arguments:
    """Lines as BokehLineSum returns them: a mean weight in alpha, and the colour times that; none from edge k on."""
    k, sides = _polygon(random, n)
    weights = random.uniform(0.1, 1.0, (4, n, 1)) * (np.arange(1, 5)[:, None, None] < k[:, None])
    lines = [np.concatenate([_color(random, n)[:, :3] * weight, weight], axis=1) for weight in weights]
    return [k, sides, *lines, _color(random, n)]


def _debug_focus(random: Generator, n: int) -> Arguments:
    return [_depth(random, n), _focus(random, n), random.uniform(0.0, MAX_COC, n), MAX_COC]


_OF_COC = MAX_COC * ROWS
DOMAINS = (
    Domain("BokehCoC", PIXELS, _coc),
    Domain("BokehSignedCoC", PIXELS, _coc),
    Domain("BokehSafeChannel", RELATIVE, lambda r, n: [_color(r, n)[:, 0]]),
    Domain("BokehSafeDepth", RELATIVE, lambda r, n: [_depth(r, n)]),
    *map(_from_depth, ("window", "reversed", "infinite", "clip", "orthographic", "fraction", "logarithmic")),
    Domain("BokehLinearDepth", RELATIVE, _linear_depth),
    Domain("BokehPackCoC", RELATIVE, lambda r, n: [_color(r, n), r.uniform(0.0, MAX_COC, n)]),
    Domain("BokehDefaultFilter", RELATIVE, lambda r, n: [_size(r, n)]),
    Domain("BokehLineEnd", PIXELS, lambda r, n: [_angle(r, n), r.uniform(0.5, 2.4, n)], lambda given: _uv(given[1])),
    Domain("BokehMakeOffsets", PIXELS, _offsets, lambda _: _uv(WIDE)),
    Domain("BokehFilterCoC", PIXELS, _filter_coc),
    Domain("BokehCells", CELLS, lambda r, n: [r.uniform(0.0, MAX_COC * 4320.0, n), r.integers(0, 5, n) / 2.0]),
    Domain("BokehSegment", PIXELS, _segment, _OF_COC),
    Domain("BokehLeakageWeight", ABSOLUTE, _leakage),
    Domain("BokehSignedLeakageWeight", ABSOLUTE, lambda r, n: [*_half_coc(r, n, -MAX_COC), SETTINGS]),
    Domain("BokehResolve", RELATIVE, _resolve),
    Domain("BokehCombine", RELATIVE, lambda r, n: [_color(r, n), _color(r, n), False]),
    Domain("BokehRotated", PIXELS, lambda r, n: [_directions(r, n), _directions(r, n)], _OF_COC),
    Domain("BokehPolygonEdge", PIXELS, _edge, _OF_COC),
    Domain("BokehExactWeight", RELATIVE, _polygon),
    Domain("BokehExactTarget", RELATIVE, _target),
    Domain("BokehDebugDepth", ABSOLUTE, lambda r, n: [_depth(r, n), _focus(r, n)]),
    Domain("BokehDebugCoC", ABSOLUTE, lambda r, n: [r.uniform(0.0, MAX_COC, n), MAX_COC]),
    Domain("BokehDebugFocus", ABSOLUTE, _debug_focus),
)
