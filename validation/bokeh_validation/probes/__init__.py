"""Test images, each with what it must show: the work behind `validation/run probes`.

PROBES        all of them in the order of the report
QUICK_PROBES  the same, the exact polygons at one rotation
"""

from collections.abc import Sequence

from bokeh_validation import drivers, jobs, terminal
from bokeh_validation.probes import (
    character,
    exact,
    halo,
    impulse,
    lights,
    near_edges,
    scenes,
    sections,
    two_points,
    unchanged,
)  # fmt: skip
from bokeh_validation.probes.model import Check, Probe, ProbeResult, run


def _all(exact_probes: Sequence[Probe]) -> tuple[Probe, ...]:
    paper = (*impulse.PROBES, *two_points.PROBES, *scenes.PROBES)
    layers = (*near_edges.PROBES, *lights.PROBES, *unchanged.PROBES, *character.PROBES)
    return (*paper, *exact_probes, *two_points.EXACT_PROBES, *halo.PROBES, *layers)


PROBES, QUICK_PROBES = _all(exact.PROBES), _all(exact.QUICK_PROBES)
REAL = tuple(name for name in drivers.NAMES if name != "reference")

__all__ = ["PROBES", "QUICK_PROBES", "REAL", "Check", "Probe", "ProbeResult", "probes", "run", "section"]


def section(name: str, names: Sequence[str], adapter: str | None, brief: bool) -> sections.Section:
    """A probe on drivers; brief: of QUICK_PROBES."""
    probe = next(probe for probe in (QUICK_PROBES if brief else PROBES) if probe.name == name)
    present, devices = sections.loaded([driver for driver in names if driver not in probe.but], adapter)
    if not present:
        return sections.Section(name, probe.title, probe.shows, **devices)
    return sections.of_probe([run(probe, driver) for driver in present], **devices)


def probes(driver: terminal.SeveralDrivers = None, adapter: terminal.Adapter = None) -> None:
    """The probes on the drivers, each against the reference and against what it must show."""
    names = tuple(driver or REAL)
    for name in names:
        terminal.check_driver(name)
    with terminal.progress("probe", len(PROBES)) as step:
        results = jobs.run([(section, (probe.name, names, adapter, False)) for probe in PROBES], step)
    sections.print_grid(results)
    sections.print_details(results, True)
    terminal.end(all(result.ok for result in results))
