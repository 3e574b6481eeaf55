"""Test images, each with what it must show: the work behind `validation/run probes`.

PROBES  all of them in the order of the report
"""

from collections.abc import Sequence

from bokeh_validation import drivers, jobs, terminal
from bokeh_validation.probes import (  # fmt: skip
    border,
    character,
    exact,
    flatness,
    halo,
    impulse,
    lights,
    near_edges,
    scenes,
    sections,
    sweep,
    two_points,
)
from bokeh_validation.probes.model import Check, Probe

_ROOMS = (impulse, two_points, scenes, exact, halo, near_edges, lights, flatness, sweep, character, border)
PROBES: tuple[Probe, ...] = tuple(probe for room in _ROOMS for probe in room.PROBES)
REAL = tuple(name for name in drivers.NAMES if name != "reference")

__all__ = ["PROBES", "REAL", "Check", "Probe", "probes", "section"]


def section(name: str, names: Sequence[str], adapter: str | None) -> sections.Section:
    """A probe on drivers."""
    probe = next(probe for probe in PROBES if probe.name == name)
    present, devices = sections.loaded(names, adapter)
    return sections.of_probe(probe, present, **devices)


def probes(driver: terminal.SeveralDrivers = None, adapter: terminal.Adapter = None) -> None:
    """The probes on the drivers, each against the reference and against what it must show."""
    names = tuple(driver or REAL)
    for name in names:
        terminal.check_driver(name)
    with terminal.progress("probe", len(PROBES)) as step:
        results = jobs.run([(section, (probe.name, names, adapter)) for probe in PROBES], step)
    sections.print_grid(results)
    sections.print_details(results, True)
    terminal.end(all(result.ok for result in results))
