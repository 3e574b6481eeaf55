"""What every function of the library may be given, and in what unit its error matters.

Depth 0.1 .. 100000 m; lenses of 24 to 135 mm at f/1.4 to f/16, focused at 0.5 to 100 m; CoC up to MaxCoC, 0.1; images
of 720 to 4320 rows; colour 0 .. 65504; 65 samples. Inputs that spread over decades are drawn evenly over those.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bokeh_validation.reference import listings

ROWS = 2160
MAX_COC = 0.1
MAX_SAMPLES = 65
SENSOR = 0.024
BIAS, MULT = 0.02, 30.0
NAN_SAFE = 2.0**-14
SIDES = np.array([4, 6, 8, 10])

Arguments = list
# (exact result (N, k), arguments) -> what an error of 1 in each component counts, broadcast to (N, k)
Scale = Callable[[np.ndarray, Arguments], np.ndarray]


@dataclass(frozen=True)
class Domain:
    """Inputs of a function, and the unit of its error.

    function   as the library names it
    unit       of the error, for a reader
    scale      to that unit
    arguments  (random generator, N) -> arrays (N,), (N, components) or numbers; structs as dictionaries of these
    note       what sets this row apart from another one of the same function
    """

    function: str
    unit: str
    scale: Scale
    arguments: Callable[[np.random.Generator, int], Arguments]
    note: str = ""


def _logarithmic(random: np.random.Generator, low: float, high: float, shape) -> np.ndarray:
    return np.exp(random.uniform(np.log(low), np.log(high), shape))


def _diameter(exact: np.ndarray, arguments: Arguments) -> np.ndarray:
    """A CoC, fraction of the height, as pixels."""
    return np.full_like(exact, ROWS)


def _in_coc(exact: np.ndarray, arguments: Arguments) -> np.ndarray:
    """Units of the largest CoC as pixels."""
    return np.full_like(exact, MAX_COC * ROWS)


def _relative(exact: np.ndarray, arguments: Arguments) -> np.ndarray:
    """Relative to the result; below the smallest normal half float relative to that."""
    return 1.0 / np.maximum(np.abs(exact), NAN_SAFE)


def _absolute(exact: np.ndarray, arguments: Arguments) -> np.ndarray:
    return np.ones_like(exact)


def _uv(aspect: Callable[[Arguments], np.ndarray]) -> Scale:
    """uv offsets for a CoC of 1, as pixels for the largest CoC."""

    def scale(exact: np.ndarray, arguments: Arguments) -> np.ndarray:
        across = np.broadcast_to(aspect(arguments), len(exact))
        return MAX_COC * ROWS * np.stack([across, np.ones(len(exact))], axis=1)

    return scale


def _depth(random: np.random.Generator, n: int) -> np.ndarray:
    return _logarithmic(random, 0.1, 1e5, n)


def _color(random: np.random.Generator, n: int) -> np.ndarray:
    """RGB and a CoC."""
    return np.concatenate([_logarithmic(random, 1e-6, 65504.0, (n, 3)), random.uniform(0.0, MAX_COC, (n, 1))], axis=1)


def _coc(max_coc: float):
    def arguments(random: np.random.Generator, n: int) -> Arguments:
        focal = random.uniform(0.024, 0.135, n)
        aperture = focal / _logarithmic(random, 1.4, 16.0, n)
        focus = _logarithmic(random, 0.5, 100.0, n)
        return [_depth(random, n), aperture, focal, focus, np.full(n, SENSOR), np.full(n, max_coc)]

    return arguments


def _from_depth(kind: int, with_far: bool = True):
    """What a depth buffer holds for a distance between the planes."""

    def arguments(random: np.random.Generator, n: int) -> Arguments:
        near, far = _planes(random, n)
        metres = near * (far / near) ** random.uniform(0.0, 1.0, n)
        return [listings.stored_depth(metres, kind, near, far), near, *([far] if with_far else [])]

    return arguments


def _planes(random: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray]:
    return _logarithmic(random, 0.05, 1.0, n), _logarithmic(random, 100.0, 1e5, n)


def _linear_depth(random: np.random.Generator, n: int) -> Arguments:
    near, far = _planes(random, n)
    metres = near * (far / near) ** random.uniform(0.0, 1.0, n)
    kind = random.integers(0, len(listings.DEPTH_KINDS), n)
    by_kind = [listings.stored_depth(metres, each, near, far) for each in listings.DEPTH_KINDS.values()]
    return [np.choose(kind, by_kind), kind, near, far]


def _directions(random: np.random.Generator, n: int) -> np.ndarray:
    angle = _angle(random, n)
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _angle(random: np.random.Generator, n: int) -> np.ndarray:
    return random.uniform(0.0, 2.0 * np.pi, n)


def _aspect(random: np.random.Generator, n: int) -> np.ndarray:
    return random.uniform(0.5, 2.4, n)


WIDE = 16.0 / 9.0


def _offsets(random: np.random.Generator, n: int) -> Arguments:
    count = random.integers(2, MAX_SAMPLES + 1, n)
    end = 0.5 * _directions(random, n) / np.array([WIDE, 1.0])
    return [end, np.floor(random.uniform(0.0, 1.0, n) * count).astype(np.int64), count]


def _filter_coc(max_coc: float):
    def arguments(random: np.random.Generator, n: int) -> Arguments:
        rows = random.integers(720, 4321, n).astype(float)
        return [_logarithmic(random, 1e-5, max_coc, n), rows, random.integers(0, 3, n) / 2.0]

    return arguments


def _cells(random: np.random.Generator, n: int) -> Arguments:
    return [random.uniform(0.0, MAX_COC * 4320.0, n), random.integers(0, 5, n) / 2.0]


def _default_filter(random: np.random.Generator, n: int) -> Arguments:
    return [np.stack([random.integers(1280, 7681, n), random.integers(720, 4321, n)], axis=1).astype(float)]


def _settings() -> dict[str, float]:
    """BokehFilter; what a leakage test reads of it."""
    return {"bleedingBias": BIAS, "bleedingMult": MULT}


def _segment(random: np.random.Generator, n: int) -> Arguments:
    middle = random.uniform(-0.5, 0.5, (n, 2))
    return [_angle(random, n), random.uniform(0.0, 1.0, n), middle, random.uniform(0.5, 1.0, n)]


def _leakage(random: np.random.Generator, n: int) -> Arguments:
    """CoC as RGBA16F has them."""
    sample, center = (random.uniform(0.0, MAX_COC, n).astype(np.float16).astype(float) for _ in range(2))
    return [_depth(random, n), sample, _depth(random, n), center, _settings()]


def _signed_leakage(random: np.random.Generator, n: int) -> Arguments:
    sample, center = (random.uniform(-MAX_COC, MAX_COC, n).astype(np.float16).astype(float) for _ in range(2))
    return [sample, center, _settings()]


def _resolve(random: np.random.Generator, n: int) -> Arguments:
    total = random.uniform(1.0, MAX_SAMPLES, n)
    return [_color(random, n) * total[:, None], total, _color(random, n), True]


def _polygon(random: np.random.Generator, n: int, first: int) -> tuple[np.ndarray, np.ndarray]:
    """k from `first` to sides / 2, and sides."""
    sides = random.choice(SIDES[SIDES >= 2 * first], n)
    k = first + np.floor(random.uniform(0.0, 1.0, n) * (sides // 2 - first + 1))
    return k.astype(np.int64), sides


def _edge(random: np.random.Generator, n: int) -> Arguments:
    k, sides = _polygon(random, n, 1)
    polygon = {"sides": sides, "rotation": _angle(random, n), "squeeze": random.uniform(0.5, 1.0, n)}
    return [k, polygon, random.integers(0, 2, n).astype(bool)]


def _target(random: np.random.Generator, n: int) -> Arguments:
    """Lines as BokehLineSum returns them: a mean weight in alpha, and the colour times that; none from edge k on."""
    k, sides = _polygon(random, n, 2)
    weights = random.uniform(0.1, 1.0, (4, n, 1)) * (np.arange(1, 5)[:, None, None] < k[:, None])
    lines = [np.concatenate([_color(random, n)[:, :3] * weight, weight], axis=1) for weight in weights]
    return [k, sides, *lines, _color(random, n)]


def _debug_focus(random: np.random.Generator, n: int) -> Arguments:
    return [_depth(random, n), _logarithmic(random, 0.5, 100.0, n), random.uniform(0.0, MAX_COC, n), MAX_COC]


PIXELS = "pixels"
RELATIVE = "relative"
ABSOLUTE = "absolute"
CELLS = "cells"

DOMAINS = (
    Domain("BokehCoC", PIXELS, _diameter, _coc(MAX_COC)),
    Domain("BokehCoC", PIXELS, _diameter, _coc(1.0), "MaxCoC 1"),
    Domain("BokehSignedCoC", PIXELS, _diameter, _coc(MAX_COC)),
    Domain("BokehSafeChannel", RELATIVE, _relative, lambda r, n: [_color(r, n)[:, 0]]),
    Domain("BokehSafeDepth", RELATIVE, _relative, lambda r, n: [_depth(r, n)]),
    Domain("BokehDepthFromWindow", RELATIVE, _relative, _from_depth(1)),
    Domain("BokehDepthFromReversed", RELATIVE, _relative, _from_depth(2)),
    Domain("BokehDepthFromInfinite", RELATIVE, _relative, _from_depth(3, with_far=False)),
    Domain("BokehDepthFromClip", RELATIVE, _relative, _from_depth(4)),
    Domain("BokehDepthFromOrthographic", RELATIVE, _relative, _from_depth(5)),
    Domain("BokehDepthFromFraction", RELATIVE, _relative, lambda r, n: np.delete(_from_depth(7)(r, n), 1, axis=0)),
    Domain("BokehDepthFromLogarithmic", RELATIVE, _relative, lambda r, n: np.delete(_from_depth(8)(r, n), 1, axis=0)),
    Domain("BokehLinearDepth", RELATIVE, _relative, _linear_depth),
    Domain("BokehPackCoC", RELATIVE, _relative, lambda r, n: [_color(r, n), r.uniform(0.0, MAX_COC, n)]),
    Domain("BokehDefaultFilter", RELATIVE, _relative, _default_filter),
    Domain("BokehLineEnd", PIXELS, _uv(lambda a: a[1]), lambda r, n: [_angle(r, n), _aspect(r, n)]),
    Domain("BokehMakeOffsets", PIXELS, _uv(lambda a: WIDE), _offsets),
    Domain("BokehFilterCoC", PIXELS, _diameter, _filter_coc(MAX_COC)),
    Domain("BokehFilterCoC", PIXELS, _diameter, _filter_coc(1.0), "MaxCoC 1"),
    Domain("BokehCells", CELLS, _absolute, _cells),
    Domain("BokehSegment", PIXELS, _in_coc, _segment),
    Domain("BokehLeakageWeight", ABSOLUTE, _absolute, _leakage),
    Domain("BokehSignedLeakageWeight", ABSOLUTE, _absolute, _signed_leakage),
    Domain("BokehResolve", RELATIVE, _relative, _resolve),
    Domain("BokehCombine", RELATIVE, _relative, lambda r, n: [_color(r, n), _color(r, n), False]),
    Domain("BokehRotated", PIXELS, _in_coc, lambda r, n: [_directions(r, n), _directions(r, n)]),
    Domain("BokehPolygonEdge", PIXELS, _in_coc, _edge),
    Domain("BokehExactWeight", RELATIVE, _relative, lambda r, n: [*_polygon(r, n, 2)]),
    Domain("BokehExactTarget", RELATIVE, _relative, _target),
    Domain("BokehDebugDepth", ABSOLUTE, _absolute, lambda r, n: [_depth(r, n), _logarithmic(r, 0.5, 100.0, n)]),
    Domain("BokehDebugCoC", ABSOLUTE, _absolute, lambda r, n: [r.uniform(0.0, MAX_COC, n), MAX_COC]),
    Domain("BokehDebugFocus", ABSOLUTE, _absolute, _debug_focus),
)
