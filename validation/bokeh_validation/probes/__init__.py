"""Collect the probes: test images, each with what it must show. tests/shaders/test_probes.py draws them.

PROBES  all of them, in the order of the report
"""

from bokeh_validation import drivers
from bokeh_validation.probes import (  # fmt: skip
    border,
    character,
    exact,
    flatness,
    halo,
    impulse,
    lights,
    lights_apart,
    near_edges,
    rims,
    scenes,
    sweep,
    thin,
    two_points,
)
from bokeh_validation.probes.model import Check, Probe

_ROOMS = (
    impulse,
    two_points,
    scenes,
    exact,
    halo,
    near_edges,
    thin,
    lights,
    lights_apart,
    rims,
    flatness,
    sweep,
    character,
    border,
)
PROBES: tuple[Probe, ...] = tuple(probe for room in _ROOMS for probe in room.PROBES)
REAL = tuple(name for name in drivers.NAMES if name != "reference")

__all__ = ["PROBES", "REAL", "Check", "Probe"]
