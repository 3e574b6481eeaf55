"""What probes, scenes and samples showed on the drivers, as the terminal and the report tell it.

Small, since it comes from other processes: pictures are data: addresses, those of what passed small ones.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from bokeh_validation import metrics, pictures
from bokeh_validation.engines.capture import Capture
from bokeh_validation.metrics import Comparison
from bokeh_validation.probes.model import CaseResult, Check, ProbeResult
from bokeh_validation.terminal import FAILED, OK

DIFFERENCE_STEPS = 8
# Pixels across of a picture that is as it should be, beside the reference's
SMALL = 96


@dataclass(frozen=True)
class Panel:
    """A picture with its caption; `difference` is the distance to the reference, of what failed."""

    caption: str
    picture: str
    numbers: str = ""
    difference: str = ""
    small: bool = False


@dataclass(frozen=True)
class Run:
    """A probe, a scene or a sample on one driver."""

    driver: str
    comparisons: Mapping[str, Comparison]
    checks: Sequence[Check] = ()

    @property
    def ok(self) -> bool:
        """All checks and all comparisons."""
        return all(one.ok for one in (*self.checks, *self.comparisons.values()))

    def lines(self, every: bool) -> Iterator[str]:
        """What was measured; `every`: that too which is as it should be."""
        for check in self.checks:
            if every or not check.ok:
                allowed = f"{check.low:.5g} .. {check.high:.5g}"
                state = OK if check.ok else f"{FAILED}: {check.why}"
                yield f"{check.name} {check.value:.5g} ({allowed}) {state}"
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
    shows: str
    runs: Sequence[Run]
    strips: Mapping[str, Sequence[Panel]]
    adapters: Mapping[str, str] = field(default_factory=dict)
    missing: Mapping[str, str] = field(default_factory=dict)

    @property
    def ok(self) -> bool:
        """On every driver."""
        return all(run.ok for run in self.runs)


def of_probe(results: Sequence[ProbeResult]) -> Section:
    """A probe on several drivers."""
    probe, runs, strips = results[0].probe, [], {}
    for result in results:
        compared = {
            f"{case.case.label}, {name}": one for case in result.cases for name, one in case.comparisons.items()
        }
        runs.append(Run(result.driver, compared, result.checks))
    for index, case in enumerate(probe.cases):
        for name in case.keep:
            label = case.label if len(case.keep) == 1 else f"{case.label}, {name}"
            strips[label] = strip(name, {result.driver: result.cases[index] for result in results})
    figure = f" (Figure {probe.figure})" if probe.figure else ""
    return Section(probe.name, probe.title + figure, probe.shows, runs, strips)


def strip(name: str, results: Mapping[str, CaseResult]) -> list[Panel]:
    """A target of one case, by the reference and by the drivers."""
    first = next(iter(results.values()))
    panels = [Panel("reference", pictures.jpeg_uri(_shown(first, first.expected[name].value)))]
    for driver, result in results.items():
        pixels, wanted = result.outputs[name], result.expected[name].value
        panels.append(panel(driver, _shown(result, pixels), pixels, wanted, result.comparisons[name]))
    return panels


def _shown(result: CaseResult, pixels: np.ndarray) -> np.ndarray:
    """8-bit rgb."""
    case = result.case
    if case.keep == ("coc",):
        coc = pixels[..., 3:4].astype(np.float64) / case.settings.camera.max_coc
        return pictures.display(np.repeat(coc, 3, axis=-1))
    return pictures.display(pixels, case.exposure, case.tone_map)


def panel(caption: str, shown: np.ndarray, pixels: np.ndarray, wanted: np.ndarray, comparison: Comparison) -> Panel:
    """In full and with its distance where it is not as the reference wants it, else small."""
    if comparison.ok:
        numbers = f"{100 * comparison.close:.2f} % within {metrics.CLOSE_STEPS} steps"
        return Panel(caption, pictures.jpeg_uri(shown, SMALL), numbers, small=True)
    heat = pictures.heat(metrics.steps(pixels, wanted, pixels.dtype.type), DIFFERENCE_STEPS)
    return Panel(caption, pictures.png_uri(shown), str(comparison), pictures.png_uri(heat))


def of_capture(name: str, capture: Capture) -> Section:
    """An engine's own colour, and beside each result what the reference makes of the same."""
    panels = []
    for shot in capture.shots:
        images = (shot.case.color, shot.expected.value, shot.result)
        source, expected, result = (pictures.display(image, tone_map=True) for image in images)
        if not panels:
            panels = [Panel("the engine's colour", pictures.jpeg_uri(source))]
            panels += [Panel(f"reference, {shot.name}", pictures.jpeg_uri(expected))]
        made = panel(shot.name, result, shot.result, shot.expected.value, shot.comparison)
        panels.append(replace(made, picture=pictures.jpeg_uri(result), small=False) if made.small else made)
    compared = {", ".join([shot.name, *shot.outside]): shot.comparison for shot in capture.shots}
    shots = Check("shots", len(capture.shots), 1, np.inf, "a capture without any shows nothing")
    return Section(name, capture.engine, capture.device, [Run(name, compared, [shots])], {"": panels})


def drivers_of(sections: Iterable[Section]) -> list[str]:
    """Those that ran, each once."""
    return list(dict.fromkeys(run.driver for section in sections for run in section.runs))
