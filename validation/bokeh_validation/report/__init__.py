"""One self-contained HTML page: compile matrix, probes and scenes with pictures."""

import datetime
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import jinja2
import numpy as np

from bokeh_validation import __version__, doctor, files, metrics, paths, pictures
from bokeh_validation.engines.capture import Capture
from bokeh_validation.mutants import outcomes
from bokeh_validation.patterns.model import CaseResult, Check, ProbeResult
from bokeh_validation.suite import SceneResult

DIFFERENCE_STEPS = 8


@dataclass(frozen=True)
class Panel:
    """A picture with its caption; `difference` is the distance to the reference, or None for the reference itself."""

    caption: str
    picture: str
    difference: str | None = None
    numbers: str = ""
    ok: bool = True


@dataclass(frozen=True)
class Strip:
    """One output of one case, on the reference and on every driver."""

    label: str
    panels: list[Panel]


@dataclass(frozen=True)
class ProbeSection:
    """One probe: its checks by driver, its strips."""

    title: str
    anchor: str
    figure: str
    shows: str
    ok: bool
    checks: list[tuple[str, list[tuple[str, Check]]]]
    strips: list[Strip]


def default_path() -> Path:
    """Where the page goes unless told otherwise."""
    return paths.cache_folder() / "report" / "index.html"


def write(
    path: Path,
    matrix: object,
    probes: list[ProbeResult],
    scenes: list[SceneResult],
    missing: dict,
    captures: list[Capture] | None = None,
) -> None:
    """Write the page. `matrix` is what matrix.run returned, or None where nothing was compiled.

    captures  of the engine samples that ran
    """
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("bokeh_validation.report", "."),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    page = environment.get_template("page.html").render(
        version=__version__,
        date=datetime.datetime.now().astimezone().strftime("%Y-%m-%d %H:%M %Z"),
        environment=doctor.environment(),
        findings=doctor.findings(),
        matrix=matrix,
        probes=_probe_sections(probes),
        scenes=_scene_strips(scenes),
        engines=[_engine_strip(capture) for capture in captures or []],
        mutants=outcomes.read(),
        missing=missing,
        difference_steps=DIFFERENCE_STEPS,
        counts=_counts(probes, scenes),
    )
    files.whole(path, lambda partial: partial.write_text(page, encoding="utf-8"))


def _counts(probes: list[ProbeResult], scenes: list[SceneResult]) -> dict[str, int]:
    return {
        "probes": len(probes),
        "probes_ok": sum(r.ok for r in probes),
        "scenes": len(scenes),
        "scenes_ok": sum(c.ok for r in scenes for c in r.result.comparisons.values()),
    }


def _probe_sections(results: list[ProbeResult]) -> list[ProbeSection]:
    by_probe: dict[str, list[ProbeResult]] = {}
    for result in results:
        by_probe.setdefault(result.probe.name, []).append(result)
    return [_probe_section(group) for group in by_probe.values()]


def _probe_section(group: list[ProbeResult]) -> ProbeSection:
    probe = group[0].probe
    names = [check.name for check in group[0].checks]
    checks = [(name, [(r.driver, r.checks[i]) for r in group]) for i, name in enumerate(names)]
    strips = []
    for index, case in enumerate(probe.cases):
        for name in case.keep:
            label = case.label if len(case.keep) == 1 else f"{case.label}: {name}"
            strips.append(_strip(label, name, [(r.driver, r.cases[index]) for r in group]))
    return ProbeSection(probe.title, probe.name, probe.figure, probe.shows, all(r.ok for r in group), checks, strips)


def _strip(label: str, name: str, results: Iterable[tuple[str, CaseResult]]) -> Strip:
    results = list(results)
    panels = [Panel("reference", _picture(results[0][1], results[0][1].expected[name].value))]
    for driver, result in results:
        output, comparison = result.outputs[name], result.comparisons[name]
        distance = metrics.steps(output, result.expected[name].value, output.dtype.type)
        panels.append(
            Panel(
                driver,
                _picture(result, output),
                pictures.data_uri(_scaled(pictures.heat(distance, DIFFERENCE_STEPS))),
                str(comparison),
                comparison.ok,
            )
        )
    return Strip(label, panels)


def _picture(result: CaseResult, pixels: np.ndarray) -> str:
    case = result.case
    if case.keep == ("coc",):
        coc = pixels[..., 3:4].astype(np.float64) / case.settings.camera.max_coc
        shown = pictures.display(np.repeat(coc, 3, axis=-1))
    else:
        shown = pictures.display(pixels, case.exposure, case.tone_map)
    return pictures.data_uri(_scaled(shown))


def _engine_strip(capture: Capture) -> dict:
    """An engine's own colour, and beside each result what the reference makes of the same."""

    def shown(image: np.ndarray) -> str:
        return pictures.data_uri(pictures.display(image, tone_map=True))

    panels = []
    for shot in capture.shots:
        distance = metrics.steps(shot.result, shot.expected.value, shot.result.dtype.type)
        heat = pictures.data_uri(pictures.heat(distance, DIFFERENCE_STEPS))
        panels.append(Panel(shot.name, shown(shot.result), heat, str(shot.comparison), shot.comparison.ok))
    first = capture.shots[0]
    return {
        "name": capture.engine,
        "device": capture.device,
        "input": shown(first.case.color),
        "expected": shown(first.expected.value),
        "first": first.name,
        "panels": panels,
    }


def _scaled(pixels: np.ndarray) -> np.ndarray:
    """Small pictures three times as large."""
    return pictures.enlarged(pixels, 3) if pixels.shape[1] < 300 else pixels


def _scene_strips(results: list[SceneResult]) -> list[dict]:
    groups: dict[tuple[str, str, str], list[SceneResult]] = {}
    for result in results:
        groups.setdefault((result.scene.name, result.method, result.aperture), []).append(result)
    strips = []
    for (scene, method, aperture), group in groups.items():
        case = group[0].result.case
        strip = _strip(f"{scene}, {method} {aperture}", "result", [(r.driver, _tone_mapped(r.result)) for r in group])
        untouched = pictures.data_uri(pictures.display(case.color, tone_map=True))
        lens = pictures.data_uri(pictures.display(_lens(group[0]), tone_map=True))
        strips.append(
            {
                "strip": strip,
                "untouched": untouched,
                "lens": lens,
                "distances": [(r.driver, r.psnr, r.flip, r.psnr_brute) for r in group],
                "untouched_distance": (group[0].psnr_untouched, group[0].flip_untouched),
            }
        )
    return strips


def _lens(result: SceneResult) -> np.ndarray:
    from bokeh_validation import suite

    return suite.truth(result.scene, result.aperture)


def _tone_mapped(result: CaseResult) -> CaseResult:
    """The same result, its pictures tone-mapped."""
    from dataclasses import replace

    return replace(result, case=replace(result.case, tone_map=True))
