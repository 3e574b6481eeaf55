"""What probes, scenes and samples showed on the drivers, as the terminal and the report have it.

It comes from other processes, so pictures are data: addresses, and what passed has none beside the reference's.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
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
class Section:
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
def _load(name: str, adapter: str | None) -> Driver | str:
    """A driver of this process, or why it is missing."""
    try:
        return drivers.load(name, adapter)
    except Unavailable as error:
        return str(error)


def loaded(names: Iterable[str], adapter: str | None) -> tuple[list[Driver], dict[str, dict[str, str]]]:
    """Drivers, and a Section's `adapters` and `missing`."""
    answers = {name: _load(name, adapter) for name in names}
    missing = {name: answer for name, answer in answers.items() if isinstance(answer, str)}
    present = [answer for answer in answers.values() if not isinstance(answer, str)]
    return present, {"adapters": {driver.name: driver.adapter for driver in present}, "missing": missing}


def of_probe(probe: Probe, present: Sequence[Driver], **devices: dict[str, str]) -> Section:
    """A probe, drawn by every driver, compared with the reference and judged."""
    runs, drawn = [], {}
    for driver in present:
        cases = drawn[driver.name] = [compared(case, driver) for case in probe.cases]
        outputs = {r.case.label: {k: pixels.astype(np.float64) for k, pixels in r.outputs.items()} for r in cases}
        comparisons = {f"{r.case.label}, {name}": c for r in cases for name, c in r.comparisons.items()}
        runs.append(Run(driver.name, comparisons, probe.judge(outputs)))
    strips = {}
    for index, case in enumerate(probe.cases if runs else ()):
        for name in case.keep:
            label = case.label if len(case.keep) == 1 else f"{case.label}, {name}"
            strips[label] = strip(name, {driver: cases[index] for driver, cases in drawn.items()})
    return Section(probe.name, probe.title, probe.shows, runs, strips, **devices)


def strip(name: str, results: Mapping[str, CaseResult]) -> list[Panel]:
    """A target of one case: the reference's picture, and those of the drivers that are not as it is."""
    first = next(iter(results.values())).expected[name].value
    panels = [Panel("reference", pictures.jpeg_uri(pictures.display(first, tone_map=True)))]
    for driver, result in results.items():
        if not result.comparisons[name].ok:
            panels.append(panel(driver, result.outputs[name], result.expected[name].value, result.comparisons[name]))
    return panels


def panel(caption: str, pixels: np.ndarray, expected: np.ndarray, comparison: Comparison) -> Panel:
    """A picture; with its distance where it is not as the reference has it."""
    shown = pictures.display(pixels, tone_map=True)
    if comparison.ok:
        numbers = f"{100 * comparison.close:.2f} % within {metrics.CLOSE_STEPS} steps"
        return Panel(caption, pictures.jpeg_uri(shown), numbers)
    heat = pictures.heat(metrics.steps(pixels, expected, pixels.dtype.type), DIFFERENCE_STEPS)
    return Panel(caption, pictures.png_uri(shown), str(comparison), pictures.png_uri(heat))


def drivers_of(sections: Iterable[Section]) -> list[str]:
    """Those that ran, each once."""
    return list(dict.fromkeys(run.driver for section in sections for run in section.runs))


def print_grid(sections: Sequence[Section]) -> None:
    """A row for each, a column for each driver."""
    names = drivers_of(sections)
    table = Table("", *names, box=None, pad_edge=False)
    for section in sections:
        states = {run.driver: OK if run.ok else FAILED for run in section.runs}
        table.add_row(section.name, *(states.get(name, "") for name in names))
    console.print(table)


def print_runs(section: Section, every: bool) -> None:
    """Print what was measured; `every`: that too which is as it should be."""
    for run in section.runs:
        who = " ".join(dict.fromkeys((run.driver, section.name)))
        for line in run.lines(every):
            console.print(f"{who}: {line}", highlight=False)


def print_details(sections: Sequence[Section], every: bool) -> None:
    """Print what was measured, and what was not run, each once."""
    for section in sections:
        print_runs(section, every)
    tell_missing({name: reason for section in sections for name, reason in section.missing.items()})
