"""What every function of the library may be given, and in what unit its error matters.

Depth 0.1 .. 100000 m; lenses of 24 to 135 mm at f/1.4 to f/16, focused at 0.5 to 100 m; CoC up to MaxCoC, 0.1; images
of 720 to 4320 rows; colour 0 .. 65504; 65 samples. Inputs that spread over decades are drawn evenly over those.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

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


@dataclass(frozen=True)
class Domain:
    """Inputs of a function, and the unit of its error.

    function   as the library names it
    unit       of the error, for a reader
    factor     what an error of 1 counts in it: a number, or of the arguments, broadcast to (N, k)
    arguments  (random generator, N) -> arrays (N,), (N, components) or numbers; structs as dictionaries of these
    note       what sets this row apart from another one of the same function
    """

    function: str
    unit: str
    factor: float | Callable[[Arguments], np.ndarray]
    arguments: Callable[[Generator, int], Arguments]
    note: str = ""

    def scale(self, exact: np.ndarray, arguments: Arguments) -> np.ndarray:
        """What an error of 1 counts in each component of the exact result (N, k)."""
        if self.unit == RELATIVE:
            return 1.0 / np.maximum(np.abs(exact), SMALLEST_NORMAL)
        return np.broadcast_to(self.factor(arguments) if callable(self.factor) else self.factor, exact.shape)


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


def _coc(max_coc: float):
    def arguments(random: Generator, n: int) -> Arguments:
        focal = random.uniform(0.024, 0.135, n)
        aperture = focal / _logarithmic(random, 1.4, 16.0, n)
        focus = _focus(random, n)
        return [_depth(random, n), aperture, focal, focus, np.full(n, SENSOR), np.full(n, max_coc)]

    return arguments


def _from_depth(kind: int, *planes: str):
    """What a depth buffer holds for a distance between the planes, and those of them that the function is given."""

    def arguments(random: Generator, n: int) -> Arguments:
        metres, near, far = _between_planes(random, n)
        given = {"near": near, "far": far}
        return [listings.stored_depth(metres, kind, near, far), *(given[name] for name in planes)]

    return arguments


def _between_planes(random: Generator, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    near, far = _logarithmic(random, 0.05, 1.0, n), _logarithmic(random, 100.0, 1e5, n)
    return near * (far / near) ** random.uniform(0.0, 1.0, n), near, far


def _linear_depth(random: Generator, n: int) -> Arguments:
    metres, near, far = _between_planes(random, n)
    kind = random.integers(0, len(listings.DEPTH_KINDS), n)
    by_kind = [listings.stored_depth(metres, each, near, far) for each in listings.DEPTH_KINDS.values()]
    return [np.choose(kind, by_kind), kind, near, far]


def _offsets(random: Generator, n: int) -> Arguments:
    count = random.integers(2, MAX_SAMPLES + 1, n)
    end = 0.5 * _directions(random, n) / np.array([WIDE, 1.0])
    return [end, np.floor(random.uniform(0.0, 1.0, n) * count).astype(np.int64), count]


def _filter_coc(max_coc: float):
    def arguments(random: Generator, n: int) -> Arguments:
        rows = random.integers(720, 4321, n).astype(float)
        return [_logarithmic(random, 1e-5, max_coc, n), rows, random.integers(0, 3, n) / 2.0]

    return arguments


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


def _polygon(random: Generator, n: int, first: int) -> list[np.ndarray]:
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
    k, sides = _polygon(random, n, 2)
    weights = random.uniform(0.1, 1.0, (4, n, 1)) * (np.arange(1, 5)[:, None, None] < k[:, None])
    lines = [np.concatenate([_color(random, n)[:, :3] * weight, weight], axis=1) for weight in weights]
    return [k, sides, *lines, _color(random, n)]


_OF_COC = MAX_COC * ROWS
DOMAINS = (
    Domain("BokehCoC", PIXELS, ROWS, _coc(MAX_COC)),
    Domain("BokehCoC", PIXELS, ROWS, _coc(1.0), "MaxCoC 1"),
    Domain("BokehSignedCoC", PIXELS, ROWS, _coc(MAX_COC)),
    Domain("BokehSafeChannel", RELATIVE, 1, lambda r, n: [_color(r, n)[:, 0]]),
    Domain("BokehSafeDepth", RELATIVE, 1, lambda r, n: [_depth(r, n)]),
    Domain("BokehDepthFromWindow", RELATIVE, 1, _from_depth(1, "near", "far")),
    Domain("BokehDepthFromReversed", RELATIVE, 1, _from_depth(2, "near", "far")),
    Domain("BokehDepthFromInfinite", RELATIVE, 1, _from_depth(3, "near")),
    Domain("BokehDepthFromClip", RELATIVE, 1, _from_depth(4, "near", "far")),
    Domain("BokehDepthFromOrthographic", RELATIVE, 1, _from_depth(5, "near", "far")),
    Domain("BokehDepthFromFraction", RELATIVE, 1, _from_depth(7, "far")),
    Domain("BokehDepthFromLogarithmic", RELATIVE, 1, _from_depth(8, "far")),
    Domain("BokehLinearDepth", RELATIVE, 1, _linear_depth),
    Domain("BokehPackCoC", RELATIVE, 1, lambda r, n: [_color(r, n), r.uniform(0.0, MAX_COC, n)]),
    Domain("BokehDefaultFilter", RELATIVE, 1, lambda r, n: [_size(r, n)]),
    Domain("BokehLineEnd", PIXELS, lambda a: _uv(a[1]), lambda r, n: [_angle(r, n), r.uniform(0.5, 2.4, n)]),
    Domain("BokehMakeOffsets", PIXELS, lambda a: _uv(WIDE), _offsets),
    Domain("BokehFilterCoC", PIXELS, ROWS, _filter_coc(MAX_COC)),
    Domain("BokehFilterCoC", PIXELS, ROWS, _filter_coc(1.0), "MaxCoC 1"),
    Domain("BokehCells", CELLS, 1, lambda r, n: [r.uniform(0.0, MAX_COC * 4320.0, n), r.integers(0, 5, n) / 2.0]),
    Domain("BokehSegment", PIXELS, _OF_COC, _segment),
    Domain("BokehLeakageWeight", ABSOLUTE, 1, _leakage),
    Domain("BokehSignedLeakageWeight", ABSOLUTE, 1, lambda r, n: [*_half_coc(r, n, -MAX_COC), SETTINGS]),
    Domain("BokehResolve", RELATIVE, 1, _resolve),
    Domain("BokehCombine", RELATIVE, 1, lambda r, n: [_color(r, n), _color(r, n), False]),
    Domain("BokehRotated", PIXELS, _OF_COC, lambda r, n: [_directions(r, n), _directions(r, n)]),
    Domain("BokehPolygonEdge", PIXELS, _OF_COC, _edge),
    Domain("BokehExactWeight", RELATIVE, 1, lambda r, n: _polygon(r, n, 2)),
    Domain("BokehExactTarget", RELATIVE, 1, _target),
    Domain("BokehDebugDepth", ABSOLUTE, 1, lambda r, n: [_depth(r, n), _focus(r, n)]),
    Domain("BokehDebugCoC", ABSOLUTE, 1, lambda r, n: [r.uniform(0.0, MAX_COC, n), MAX_COC]),
    Domain(
        "BokehDebugFocus",
        ABSOLUTE,
        1,
        lambda r, n: [_depth(r, n), _focus(r, n), r.uniform(0.0, MAX_COC, n), MAX_COC],
    ),
)
