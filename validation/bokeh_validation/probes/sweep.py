"""Probe layered: nothing may jump while the CoC grows."""

import numpy as np

from bokeh_validation.probes.model import Case, Check, Outputs, Probe, depth_of, flat
from bokeh_validation.probes.near_edges import STEP, metres, settings

SWEEP_STEP = 0.25
# CoC ranges in pixels: through the focus, and where a plane moves from the gather into the near and the far layer
SWEEPS = ((-9.75, -8.25), (-3.0, 0.0), (0.0, 3.0), (12.25, 13.75))
SWEEP_COCS = [np.arange(first, last + SWEEP_STEP / 2, SWEEP_STEP) for first, last in SWEEPS]
SWEEP_SIZE = (40, 32)


def hills() -> np.ndarray:
    """Return random values 6 pixels apart with linear slopes between them, 0 to 1, (H, W, 4) float16 of SWEEP_SIZE."""
    width, height = SWEEP_SIZE
    values = np.random.default_rng(3).random((height // 6 + 2, width // 6 + 2, 3))
    for axis, length in ((0, height), (1, width)):
        place = np.arange(length) / 6.0
        first = place.astype(int)
        weight = np.expand_dims(place - first, (1 - axis, 2))
        values = values.take(first, axis) * (1.0 - weight) + values.take(first + 1, axis) * weight
    color = flat(SWEEP_SIZE)
    color[..., :3] = values
    return color


def jump_allowed(first: np.ndarray, last: np.ndarray) -> float:
    """Return how much a pixel of hills() may change in one step of a sweep, given the results at its ends, (H, W, 3).

    A lens moves what a pixel sees by at most half of the step: half the step times the largest difference of
    neighbours along each axis. A plane enters a layer within 1.2 pixels of CoC (its weight is 5 (c - 6) / 6 - 2 in the
    near layer, 5 (c - 10) / 6 - 2 in the far layer). The change from one end of the sweep to the other happens at that
    rate, or at twice that rate where two weights are multiplied: 0.42 of it in a quarter of a pixel. The first ring of
    the gather, one pixel away, appears with a weight of 2 (r - 1/2) / max(r^2, 1/4), where r is half the CoC less half
    a pixel, against 1/4 / max(r^2, 1/4) for the centre: half of it within the first quarter. So half of the whole
    change is allowed in one step; a pop would be all of it.
    """
    image = hills()[..., :3].astype(np.float64)
    slopes = sum(np.abs(np.diff(image, axis=axis)).max() for axis in (0, 1))
    return float(SWEEP_STEP * 0.5 * slopes + 0.5 * np.abs(last - first).max() + 2 * STEP)


def _judge_sweep(outputs: dict[str, Outputs]) -> list[Check]:
    checks, why = [], "half of all that the sweep does, and a lens's own change: derived at jump_allowed"
    for cocs in SWEEP_COCS:
        pictures = np.array([outputs[f"CoC {coc:g}"]["result"][..., :3] for coc in cocs])
        name = f"largest change in steps of {SWEEP_STEP} pixels, CoC {cocs[0]:g} to {cocs[-1]:g}"
        largest = np.abs(np.diff(pictures, axis=0)).max()
        checks.append(Check(name, largest, 0.0, jump_allowed(pictures[0], pictures[-1]), why))
    return checks


SWEEP = Probe(
    "layered-sweep",
    "Nothing pops as the CoC goes through zero and into the layers",
    "Hills that get blurred a little more from picture to picture.",
    tuple(
        Case(f"CoC {coc:g}", settings(), hills(), depth_of(SWEEP_SIZE, metres(coc, SWEEP_SIZE[1])))
        for coc in np.unique(np.concatenate(SWEEP_COCS))
    ),
    _judge_sweep,
    brief=False,
)
PROBES = (SWEEP,)
