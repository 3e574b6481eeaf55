"""Test images, each with what it must show. `PROBES` holds all of them in the order of the report."""

from bokeh_validation.patterns import exact, impulse, scenes, two_points
from bokeh_validation.patterns.model import Check, Probe, ProbeResult, run

PROBES: tuple[Probe, ...] = (*impulse.PROBES, *two_points.PROBES, *scenes.PROBES, *exact.PROBES)

__all__ = ["PROBES", "Check", "Probe", "ProbeResult", "run"]
