"""What probes, scenes and samples showed on the drivers, as the terminal and the report have it.

It comes from other processes, so a picture is text (a data: address). A target that passed shows the reference only.
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
    """A picture with its caption; `difference` is the distance to the reference, of what failed."""

    caption: str
    picture: str
    numbers: str = ""
    difference: str = ""


@dataclass(frozen=True)
class Run:
    """A probe, a scene or a sample on one driver."""

    driver: str
    comparisons: Mapping[str, Comparison]
    checks: Sequence[Check] = ()

    @property
    def ok(self) -> bool:
        """All checks and all comparisons."""
        return all(result.ok for result in (*self.checks, *self.comparisons.values()))

    def lines(self, every: bool) -> Iterator[str]:
        """What was measured; `every`: that too which is as it should be."""
        for check in self.checks:
            if every or not check.ok:
                state = OK if check.ok else f"{FAILED}: {check.why}"
                yield f"{check.name} {check.value:.5g} ({check.low:.5g} .. {check.high:.5g}) {state}"
        for name, comparison in self.comparisons.items():
            if every or not comparison.ok:
                yield f"{name}: {comparison} {OK if comparison.ok else FAILED}"


@dataclass(frozen=True)
class Outcome:
    """A row of the grid with its details.

    strips    heading -> pictures
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
        """On every driver."""
        return all(run.ok for run in self.runs)


@lru_cache
def driver_or_reason(name: str, adapter: str | None = None) -> Driver | str:
    """Return a driver, made once in this process, or why it is missing."""
    try:
        return drivers.load(name, adapter)
    except Unavailable as error:
        return str(error)


def of_probe(probe: Probe, name: str, adapter: str | None = None) -> Outcome:
    """Draw a probe on the driver of that name, compare it with the reference and judge it."""
    driver = driver_or_reason(name, adapter)
    if isinstance(driver, str):
        return Outcome(probe.name, probe.title, probe.shows, missing={name: driver})
    return of_driver(probe, driver)


def of_driver(probe: Probe, driver: Driver) -> Outcome:
    """Draw a probe on a driver, compare it with the reference and judge it."""
    results = [compared(case, driver) for case in probe.cases]
    outputs = {r.case.label: {k: pixels.astype(np.float64) for k, pixels in r.outputs.items()} for r in results}
    comparisons = {f"{r.case.label}, {name}": c for r in results for name, c in r.comparisons.items()}
    strips = {}
    for result in results:
        for name in result.case.keep:
            label = result.case.label if len(result.case.keep) == 1 else f"{result.case.label}, {name}"
            strips[label] = strip(driver.name, name, result)
    run = Run(driver.name, comparisons, probe.judge(outputs))
    return Outcome(probe.name, probe.title, probe.shows, [run], strips, {driver.name: driver.adapter})


def merged(outcomes: Iterable[Outcome]) -> list[Outcome]:
    """Join the outcomes of the same name, which are those of several drivers."""
    found: dict[str, Outcome] = {}
    for other in outcomes:
        one = found.get(other.name)
        found[other.name] = other if one is None else _joined(one, other)
    return list(found.values())


def _joined(one: Outcome, other: Outcome) -> Outcome:
    # the first picture of each strip is the reference's, which both have
    strips = {label: [*one.strips.get(label, panels[:1]), *panels[1:]] for label, panels in other.strips.items()}
    return replace(
        one,
        runs=[*one.runs, *other.runs],
        strips={**one.strips, **strips},
        adapters={**one.adapters, **other.adapters},
        missing={**one.missing, **other.missing},
    )


def strip(driver: str, name: str, result: CaseResult) -> list[Panel]:
    """A target of one case: the reference's picture, and the driver's if it is not within the interval."""
    expected = result.expected[name].value
    panels = [Panel("reference", pictures.jpeg_uri(pictures.display(expected, tone_map=True)))]
    if not result.comparisons[name].ok:
        panels.append(panel(driver, result.outputs[name], expected, result.comparisons[name]))
    return panels


def panel(caption: str, pixels: np.ndarray, expected: np.ndarray, comparison: Comparison) -> Panel:
    """A picture; with its distance where it is not as the reference has it."""
    shown = pictures.display(pixels, tone_map=True)
    if comparison.ok:
        numbers = f"{100 * comparison.close:.2f} % within {metrics.CLOSE_STEPS} steps"
        return Panel(caption, pictures.jpeg_uri(shown), numbers)
    heat = pictures.heat(metrics.steps(pixels, expected, pixels.dtype.type), DIFFERENCE_STEPS)
    return Panel(caption, pictures.png_uri(shown), str(comparison), pictures.png_uri(heat))


def drivers_of(outcomes: Iterable[Outcome]) -> list[str]:
    """Return the drivers that ran, each once."""
    return list(dict.fromkeys(run.driver for outcome in outcomes for run in outcome.runs))


def print_grid(outcomes: Sequence[Outcome]) -> None:
    """Print a row for each, a column for each driver."""
    names = drivers_of(outcomes)
    table = Table("", *names, box=None, pad_edge=False)
    for outcome in outcomes:
        states = {run.driver: OK if run.ok else FAILED for run in outcome.runs}
        table.add_row(outcome.name, *(states.get(name, "") for name in names))
    console.print(table)


def print_runs(outcome: Outcome, every: bool) -> None:
    """Print what was measured; `every`: that too which is as it should be."""
    for run in outcome.runs:
        who = " ".join(dict.fromkeys((run.driver, outcome.name)))
        for line in run.lines(every):
            console.print(f"{who}: {line}", highlight=False)


def print_details(outcomes: Sequence[Outcome], every: bool) -> None:
    """Print what was measured, and what was not run, each once."""
    for outcome in outcomes:
        print_runs(outcome, every)
    tell_missing({name: reason for outcome in outcomes for name, reason in outcome.missing.items()})
