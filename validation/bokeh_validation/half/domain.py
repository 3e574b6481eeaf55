"""What every function of the library may be given, and in what unit its error matters.

Depth 0.1 .. 100000 m; lenses of 24 to 135 mm at f/1.4 to f/16, focused at 0.5 to 100 m; CoC up to MaxCoC, 0.1; images
of 720 to 4320 rows; colour 0 .. 65504; 65 samples. Inputs that spread over decades are drawn evenly over those.
"""

import numpy as np
from numpy.random import Generator

from bokeh_validation.half import program
from bokeh_validation.reference import listings

ROWS = 2160
MAX_COC = 0.1
MAX_SAMPLES = 65
WIDE = 16.0 / 9.0
SMALLEST_NORMAL = 2.0**-14
PIXELS, RELATIVE, ABSOLUTE, CELLS = "pixels", "relative", "absolute", "cells"
DEPTHS = ("Window", "Reversed", "Infinite", "Clip", "Orthographic", "Fraction", "Logarithmic")
# Function as the library names it -> unit of its error
UNITS = {
    "BokehCoC": PIXELS,
    "BokehSignedCoC": PIXELS,
    "BokehSafeChannel": RELATIVE,
    "BokehSafeDepth": RELATIVE,
    **{f"BokehDepthFrom{kind}": RELATIVE for kind in DEPTHS},
    "BokehLinearDepth": RELATIVE,
    "BokehPackCoC": RELATIVE,
    "BokehDefaultFilter": RELATIVE,
    "BokehLineEnd": PIXELS,
    "BokehMakeOffsets": PIXELS,
    "BokehFilterCoC": PIXELS,
    "BokehCells": CELLS,
    "BokehSegment": PIXELS,
    "BokehLeakageWeight": ABSOLUTE,
    "BokehSignedLeakageWeight": ABSOLUTE,
    "BokehResolve": RELATIVE,
    "BokehCombine": RELATIVE,
    "BokehRotated": PIXELS,
    "BokehPolygonEdge": PIXELS,
    "BokehExactWeight": RELATIVE,
    "BokehExactTarget": RELATIVE,
    "BokehDebugDepth": ABSOLUTE,
    "BokehDebugCoC": ABSOLUTE,
    "BokehDebugFocus": ABSOLUTE,
}
# Pixels for an error of 1 where that is not in image heights: in CoC, or in uv for a CoC of 1 with this aspect ratio
OF_COC = ("BokehSegment", "BokehRotated", "BokehPolygonEdge")
OF_UV = {"BokehLineEnd": lambda given: given[1], "BokehMakeOffsets": lambda given: np.array(WIDE)}


def scale(function: str, exact: np.ndarray, given: list) -> np.ndarray:
    """What an error of 1 counts in each component of the exact result (N, k)."""
    if UNITS[function] == RELATIVE:
        return 1.0 / np.maximum(np.abs(exact), SMALLEST_NORMAL)
    counts = float(ROWS) if UNITS[function] == PIXELS else 1.0
    if function in OF_COC:
        counts = MAX_COC * ROWS
    elif function in OF_UV:
        aspect = OF_UV[function](given)
        counts = MAX_COC * ROWS * np.stack([aspect, np.ones_like(aspect)], axis=-1)
    return np.broadcast_to(counts, exact.shape)


def arguments(function: str, random: Generator, n: int) -> list:
    """Arrays (N,), (N, components) or numbers; structs as dictionaries of these. The same name is the same thing."""
    names = program.library()[function].parameters
    given = _depths(function, random, n) | _lens(random, n) | _shapes(random, n, 1 if "polygon" in names else 2)
    total = random.uniform(1.0, MAX_SAMPLES, n)
    given |= {
        "value": _color(random, n)[:, 0],
        # a sum of colours where there is a sum of weights
        "color": _color(random, n) * (total[:, None] if "totalWeight" in names else 1.0),
        "totalWeight": total,
        **{name: _color(random, n) for name in ("centerPixel", "a", "b")},
        "blurCoC": True,
        "useMax": False,
        "imageSize": np.stack([random.integers(1280, 7681, n), random.integers(720, 4321, n)], axis=1).astype(float),
        "imageHeight": random.integers(720, 4321, n).astype(float),
        "aspectRatio": random.uniform(0.5, 2.4, n),
        "spacing": random.integers(0, 5, n) / 2.0,
        "lengthInPixels": random.uniform(0.0, MAX_COC * 4320.0, n),
        # what a leakage test reads of it
        "settings": {"bleedingBias": 0.02, "bleedingMult": 30.0},
    }
    sample, centre = random.uniform(-MAX_COC if "Signed" in function else 0.0, MAX_COC, (2, n))
    # one in ten is all but the bias apart; both as RGBA16F has them
    sample = np.where((np.arange(n) % 10 == 0) & (centre > 0.03), centre * 0.999 - 0.02, sample)
    given |= {"sampleCoC": np.float16(sample).astype(float), "centerCoC": np.float16(centre).astype(float)}
    # lines as BokehLineSum returns them: a mean weight in alpha, and the colour times that; none from edge k on
    for edge in range(1, 5):
        weight = random.uniform(0.1, 1.0, (n, 1)) * (edge < given["k"])[:, None]
        given[f"L{edge}"] = np.concatenate([_color(random, n)[:, :3] * weight, weight], axis=1)
    return [given[name] for name in names]


def _logarithmic(random: Generator, low: float, high: float, shape) -> np.ndarray:
    return np.exp(random.uniform(np.log(low), np.log(high), shape))


def _color(random: Generator, n: int) -> np.ndarray:
    """RGB and a CoC."""
    return np.concatenate([_logarithmic(random, 1e-6, 65504.0, (n, 3)), random.uniform(0.0, MAX_COC, (n, 1))], axis=1)


def _directions(random: Generator, n: int) -> np.ndarray:
    angle = random.uniform(0.0, 2.0 * np.pi, n)
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _depths(function: str, random: Generator, n: int) -> dict:
    """What a depth buffer holds for a distance between the planes; of any convention where the function takes one."""
    near, far = _logarithmic(random, 0.05, 1.0, n), _logarithmic(random, 100.0, 1e5, n)
    metres = near * (far / near) ** random.uniform(0.0, 1.0, n)
    stored = {name: listings.stored_depth(metres, k, near, far) for name, k in listings.DEPTH_KINDS.items()}
    kind = random.integers(0, len(stored), n)
    wanted = function.removeprefix("BokehDepthFrom").lower()
    depth = stored[wanted] if wanted in stored else np.choose(kind, [*stored.values()])
    return {"depth": depth, "kind": kind, "zNear": near, "zFar": far}


def _lens(random: Generator, n: int) -> dict:
    """Listing 1's names: S2 the depth, S1 the focus, A the aperture's diameter, f the focal length."""
    focal, focus = random.uniform(0.024, 0.135, n), _logarithmic(random, 0.5, 100.0, n)
    centre, *depths = (_logarithmic(random, 0.1, 1e5, n) for _ in range(3))
    # one in ten is all but equal to what it is compared with
    equal, about = np.arange(n) % 10 == 0, random.uniform(0.999, 1.001, n)
    return {
        "S2": np.where(equal, focus * about, depths[0]),
        "sampleDepth": np.where(equal, centre * about, depths[1]),
        "centerDepth": centre,
        "S1": focus,
        "f": focal,
        "A": focal / _logarithmic(random, 1.4, 16.0, n),
        "sensorHeight": np.full(n, 0.024),
        "MaxCoC": np.full(n, MAX_COC),
        "CoC": _logarithmic(random, 1e-5, MAX_COC, n),
    }


def _shapes(random: Generator, n: int, first: int) -> dict:
    """Lines, and polygons with edges k from `first` to sides / 2."""
    sides = random.choice([4, 6, 8, 10], n)
    count = random.integers(2, MAX_SAMPLES + 1, n)
    angle, squeeze = random.uniform(0.0, 2.0 * np.pi, n), random.uniform(0.5, 1.0, n)
    return {
        "sides": sides,
        "k": first + np.floor(random.uniform(0.0, 1.0, n) * (sides // 2 - first + 1)).astype(np.int64),
        "polygon": {"sides": sides, "rotation": angle, "squeeze": squeeze},
        "secondPass": random.integers(0, 2, n).astype(bool),
        "angle": angle,
        "squeeze": squeeze,
        "lineLength": random.uniform(0.0, 1.0, n),
        "lineCenter": random.uniform(-0.5, 0.5, (n, 2)),
        "lineEnd": 0.5 * _directions(random, n) / np.array([WIDE, 1.0]),
        "numSamples": count,
        "i": np.floor(random.uniform(0.0, 1.0, n) * count).astype(np.int64),
        "direction": _directions(random, n),
        "axis": _directions(random, n),
    }
