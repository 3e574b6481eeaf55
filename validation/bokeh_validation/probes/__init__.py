"""Test images, each with what it must show.

PROBES        all of them in the order of the report
QUICK_PROBES  the same, the exact polygons at one rotation
"""

from bokeh_validation.probes import (
    cats_eye,
    chromatic,
    exact,
    halo,
    impulse,
    lights,
    near_edges,
    scenes,
    two_points,
    unchanged,
)
from bokeh_validation.probes.model import Check, Probe, ProbeResult, run

_PAPER = (*impulse.PROBES, *two_points.PROBES, *scenes.PROBES)
_LAYERS = (*near_edges.PROBES, *lights.PROBES, *unchanged.PROBES, *cats_eye.PROBES, *chromatic.PROBES)
PROBES: tuple[Probe, ...] = (*_PAPER, *exact.PROBES, *halo.PROBES, *_LAYERS)
QUICK_PROBES: tuple[Probe, ...] = (*_PAPER, *exact.QUICK_PROBES, *halo.PROBES, *_LAYERS)

__all__ = ["PROBES", "QUICK_PROBES", "Check", "Probe", "ProbeResult", "run"]
