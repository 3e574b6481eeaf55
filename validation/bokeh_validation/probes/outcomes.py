"""Collect what probes, scenes and samples showed on the drivers, for the terminal and the report.

Results come from other processes, so images are text (data: URIs). A target that passed shows only the reference.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
from rich.table import Table

from bokeh_validation import drivers, metrics, pictures
from bokeh_validation.drivers.base import Driver
from bokeh_validation.errors import Unavailable
from bokeh_validation.metrics import Comparison
from bokeh_validation.probes.judges import CaseResult, compared
from bokeh_validation.probes.model import Check, Probe
from bokeh_validation.terminal import FAILED, OK, console, tell_missing

DIFFERENCE_STEPS = 8


@dataclass(frozen=True)
class Panel:
    """Hold an image with its caption; `difference` shows the distance to the reference of a failed result."""

    caption: str
    picture: str
    numbers: str = ""
    difference: str = ""


@dataclass(frozen=True)
class Run:
    """Hold the result of a probe, scene or sample on one driver."""

    driver: str
    comparisons: Mapping[str, Comparison]
    checks: Sequence[Check] = ()

    @property
    def ok(self) -> bool:
        """Return whether all checks and comparisons pass."""
        return all(result.ok for result in (*self.checks, *self.comparisons.values()))

    def lines(self, every: bool) -> Iterator[str]:
        """Yield what was measured, one line each; with `every`, what passed as well."""
        for check in self.checks:
            if every or not check.ok:
                state = OK if check.ok else f"{FAILED}: {check.why}"
                yield f"{check.name} {check.value:.5g} ({check.low:.5g} .. {check.high:.5g}) {state}"
        for name, comparison in self.comparisons.items():
            if every or not comparison.ok:
                yield f"{name}: {comparison} {OK if comparison.ok else FAILED}"


@dataclass(frozen=True)
class Outcome:
    """Hold a row of the grid with its details.

    strips    heading -> images
    adapters  driver -> its device
    missing   driver -> why it was not run
    """

    name: str
    title: str
    shows: str = ""
    runs: Sequence[Run] = ()
    strips: Mapping[str, Sequence[Panel]] = field(default_factory=dict)
    adapters: Mapping[str, str] = field(default_factory=dict)
    missing: Mapping[str, str] = field(default_factory=dict)

    @property
    def ok(self) -> bool:
        """Return whether it passed on every driver."""
        return all(run.ok for run in self.runs)


@lru_cache
def driver_or_reason(name: str, adapter: str | None = None) -> Driver | str:
    """Return a driver, created once per process, or the reason why it is missing."""
    try:
        return drivers.load(name, adapter)
    except Unavailable as error:
        return str(error)


def of_probe(probe: Probe, name: str, adapter: str | None = None) -> Outcome:
    """Draw a probe on the driver with this name, compare it with the reference and judge it."""
    driver = driver_or_reason(name, adapter)
    if isinstance(driver, str):
        return Outcome(probe.name, probe.title, probe.shows, missing={name: driver})
    return of_driver(probe, driver)


def of_driver(probe: Probe, driver: Driver) -> Outcome:
    """Draw a probe on a driver, compare it with the reference and judge it."""
    results = [compared(case, driver) for case in probe.cases]
    outputs = {
        case_result.case.label: {target: pixels.astype(np.float64) for target, pixels in case_result.outputs.items()}
        for case_result in results
    }
    comparisons = {
        f"{case_result.case.label}, {name}": comparison
        for case_result in results
        for name, comparison in case_result.comparisons.items()
    }
    strips = {}
    for result in results:
        for name in result.case.keep:
            label = result.case.label if len(result.case.keep) == 1 else f"{result.case.label}, {name}"
            strips[label] = strip(driver.name, name, result)
    run = Run(driver.name, comparisons, probe.judge(outputs))
    return Outcome(probe.name, probe.title, probe.shows, [run], strips, {driver.name: driver.adapter})


def merged(outcomes: Iterable[Outcome]) -> list[Outcome]:
    """Join the outcomes of the same name, which come from different drivers."""
    by_name: dict[str, Outcome] = {}
    for outcome in outcomes:
        earlier = by_name.get(outcome.name)
        by_name[outcome.name] = outcome if earlier is None else _joined(earlier, outcome)
    return list(by_name.values())


def _joined(first: Outcome, second: Outcome) -> Outcome:
    # the first image of each strip is the reference's, which both have
    strips = {label: [*first.strips.get(label, panels[:1]), *panels[1:]] for label, panels in second.strips.items()}
    return replace(
        first,
        runs=[*first.runs, *second.runs],
        strips={**first.strips, **strips},
        adapters={**first.adapters, **second.adapters},
        missing={**first.missing, **second.missing},
    )


def strip(driver: str, name: str, result: CaseResult) -> list[Panel]:
    """Return the images of a target of one case: the reference's, and the driver's if it is outside the interval."""
    expected = result.expected[name].value
    panels = [Panel("reference", pictures.jpeg_uri(pictures.display(expected, tone_map=True)))]
    if not result.comparisons[name].ok:
        panels.append(panel(driver, result.outputs[name], expected, result.comparisons[name]))
    return panels


def panel(caption: str, pixels: np.ndarray, expected: np.ndarray, comparison: Comparison) -> Panel:
    """Return an image with its caption, and with a map of its distance to the reference if it failed."""
    displayed = pictures.display(pixels, tone_map=True)
    if comparison.ok:
        numbers = f"{100 * comparison.close:.2f} % within {metrics.CLOSE_STEPS} steps"
        return Panel(caption, pictures.jpeg_uri(displayed), numbers)
    heat = pictures.heat(metrics.steps(pixels, expected, pixels.dtype.type), DIFFERENCE_STEPS)
    return Panel(caption, pictures.png_uri(displayed), str(comparison), pictures.png_uri(heat))


def drivers_of(outcomes: Iterable[Outcome]) -> list[str]:
    """Return the drivers that ran, without duplicates."""
    return list(dict.fromkeys(run.driver for outcome in outcomes for run in outcome.runs))


def print_grid(outcomes: Sequence[Outcome]) -> None:
    """Print a table with a row per outcome and a column per driver."""
    names = drivers_of(outcomes)
    table = Table("", *names, box=None, pad_edge=False)
    for outcome in outcomes:
        states = {run.driver: OK if run.ok else FAILED for run in outcome.runs}
        table.add_row(outcome.name, *(states.get(name, "") for name in names))
    console.print(table)


def print_runs(outcome: Outcome, every: bool) -> None:
    """Print what was measured; with `every`, what passed as well."""
    for run in outcome.runs:
        who = " ".join(dict.fromkeys((run.driver, outcome.name)))
        for line in run.lines(every):
            console.print(f"{who}: {line}", highlight=False)


def print_details(outcomes: Sequence[Outcome], every: bool) -> None:
    """Print what was measured, then what was not run, without duplicates."""
    for outcome in outcomes:
        print_runs(outcome, every)
    tell_missing({name: reason for outcome in outcomes for name, reason in outcome.missing.items()})
