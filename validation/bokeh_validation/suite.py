"""The whole validation as data: probes on drivers, scenes on drivers against the ray-traced truth."""

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.table import Table

from bokeh_validation import exr, methods, metrics, paths, patterns, quality, terminal
from bokeh_validation.drivers.base import Driver
from bokeh_validation.patterns.model import Case, CaseResult, ProbeResult, compared

Progress = Callable[[str], None]


# aperture -> tag of the truth file
TRUTHS = {"hexagon": "hex", "octagon": "oct"}
# aperture -> degrees that turn ours as it is in the truth, where a corner is straight up
TRUTH_ROTATION = {"hexagon": 0.0, "octagon": 22.5}


@dataclass(frozen=True)
class SceneFile:
    """A ray-traced scene of validation/scenes with its camera: NAME_pin.exr, and NAME_hex.exr, its truth.

    pinhole    name of the scene whose pinhole picture it has; None: its own
    apertures  those of TRUTHS that there is a file for
    """

    name: str
    camera: methods.Camera
    pinhole: str | None = None
    apertures: tuple[str, ...] = ("hexagon",)

    @property
    def source(self) -> Path:
        """Colour and depth."""
        return paths.SCENES / f"{self.pinhole or self.name}_pin.exr"


MARKET = SceneFile("market_7", methods.Camera(0.0714, 0.05, 2.42, 0.024, 0.15))
STREET = SceneFile("street_11", methods.Camera(0.05, 0.05, 5.0, 0.024, 0.15), None, tuple(TRUTHS))
CANOPY = SceneFile("canopy_12", methods.Camera(0.0714, 0.05, 7.0, 0.024, 0.15), None, tuple(TRUTHS))
# the same with three times the aperture
WIDE_STREET = SceneFile("street_11x3", methods.Camera(0.15, 0.05, 5.0, 0.024, 0.15), "street_11")
WIDE_CANOPY = SceneFile("canopy_12x3", methods.Camera(0.2142, 0.05, 7.0, 0.024, 0.15), "canopy_12")
SCENES = (MARKET, STREET, CANOPY, WIDE_STREET, WIDE_CANOPY)
# The small ones, that every driver draws in every method
DRIVER_SCENES = (STREET, CANOPY)
SCENE_METHODS = ("paper", "exact", "layered")


def probes(quick: bool = False) -> tuple[patterns.Probe, ...]:
    """Every probe; `quick`: with less of the exact polygons."""
    return patterns.QUICK_PROBES if quick else patterns.PROBES


def run_probes(
    runtimes: Iterable[Driver], progress: Progress = lambda _: None, quick: bool = False
) -> list[ProbeResult]:
    """Every probe on every driver."""
    results = []
    for driver in runtimes:
        for probe in probes(quick):
            results.append(patterns.run(probe, driver))
            progress(f"{driver.name}: {probe.name}")
    return results


def scene_case(scene: SceneFile, method: str, aperture: str) -> Case:
    """A scene through its own camera."""
    image = picture(scene)
    return Case(scene.name, methods.Settings(method, aperture, camera=scene.camera), image.color, image.depth)


_pictures: dict[Path, exr.Scene] = {}


def picture(scene: SceneFile) -> exr.Scene:
    """Colour and depth through a pinhole, kept."""
    if scene.source not in _pictures:
        _pictures[scene.source] = exr.read(scene.source)
    return _pictures[scene.source]


def truth(scene: SceneFile, aperture: str) -> np.ndarray:
    """What a thin lens sees, ray traced, (H, W, 4)."""
    return exr.read(paths.SCENES / f"{scene.name}_{TRUTHS[aperture]}.exr", None).color


@dataclass(frozen=True)
class SceneResult:
    """A scene on one driver, its distance to the ray-traced truth (which no post-process reaches) and to brute force.

    psnr_brute  against quality.brute_force: 900 and more samples of the same polygon with the same weights
    """

    scene: SceneFile
    method: str
    aperture: str
    driver: str
    result: CaseResult
    psnr_brute: float
    psnr: float
    psnr_untouched: float
    flip: float
    flip_untouched: float


def scene_runs(quick: bool = False) -> list[tuple[SceneFile, str, str]]:
    """(scene, aperture, method) of every picture; `quick`: the exact hexagon on the street only."""
    found = list(product(DRIVER_SCENES, TRUTHS, SCENE_METHODS))
    return [run for run in found if run == (STREET, "hexagon", "exact")] if quick else found


def run_scenes(
    runtimes: Iterable[Driver], progress: Progress = lambda _: None, quick: bool = False
) -> list[SceneResult]:
    """DRIVER_SCENES, hexagon and octagon, by SCENE_METHODS, on every driver."""
    results = []
    brute: dict[tuple[str, str, str], np.ndarray] = {}
    for driver in runtimes:
        for scene, aperture, method in scene_runs(quick):
            case = scene_case(scene, method, aperture)
            case = replace(case, settings=replace(case.settings, rotation=TRUTH_ROTATION[aperture]))
            key = (scene.name, aperture, method)
            # on the first driver only: it is a thousand fetches a pixel, and no driver is far from another
            if key not in brute:
                brute[key] = quality.brute_force(driver, case)
            result = CaseResult(case, *compared(case, driver))
            outputs = result.outputs
            lens = truth(scene, aperture)
            results.append(
                SceneResult(
                    scene,
                    method,
                    aperture,
                    driver.name,
                    result,
                    metrics.psnr(outputs["result"], brute[key]),
                    metrics.psnr(outputs["result"], lens),
                    metrics.psnr(case.color, lens),
                    metrics.flip(outputs["result"], lens),
                    metrics.flip(case.color, lens),
                )
            )
            progress(f"{driver.name}: {scene.name}, {method} {aperture}")
    return results


# ------------------------------------------------------------------------------------------------------------ commands


def validate(adapter: str | None = None, quick: bool = False, output: Path | None = None) -> None:
    """Everything, and the report."""
    from bokeh_validation import doctor, matrix, report
    from bokeh_validation.engines import engines_command

    started = time.monotonic()
    doctor.doctor()
    rows = matrix.load(quick=quick)
    with terminal.progress("compile", matrix.count(rows)) as step:
        compiled = matrix.run(rows, step)
    for part in matrix.tables(compiled):
        terminal.console.print(part)
    runtimes, missing = terminal.pick_drivers(None, adapter)
    runtimes = runtimes[:1] if quick else runtimes
    with terminal.progress("probe", len(runtimes) * len(probes(quick))) as step:
        found = run_probes(runtimes, step, quick)
    _print_probes(found, missing)
    with terminal.progress("scene", len(runtimes) * len(scene_runs(quick))) as step:
        drawn = run_scenes(runtimes, step, quick)
    _print_scenes(drawn)
    captures, engines_ok = ([], True) if quick else engines_command.run_all(engines_command.quick_ones())
    path = output or report.default_path()
    if output is None:
        paths.ensured(path.parent)
    report.write(path, compiled, found, drawn, missing, captures)
    terminal.console.print(f"Report: {path}   ({time.monotonic() - started:.0f} s)")
    passed = matrix.passed(compiled) and engines_ok and all(p.ok for p in found)
    terminal.end(passed and all(c.ok for s in drawn for c in s.result.comparisons.values()))


def patterns_command(driver: terminal.SeveralDrivers = None, adapter: terminal.Adapter = None) -> None:
    """The probes on the drivers, each against the reference and against what it must show."""
    runtimes, missing = terminal.pick_drivers(driver, adapter)
    with terminal.progress("probe", len(runtimes) * len(probes())) as step:
        results = run_probes(runtimes, step)
    _print_probes(results, missing, details=True)
    terminal.end(all(r.ok for r in results))


def report(
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="The page; in the cache folder by default.")
    ] = None,
    adapter: terminal.Adapter = None,
) -> None:
    """One self-contained HTML page with pictures."""
    terminal.check_writable(output)
    validate(adapter, output=output)


def _print_probes(results, missing: dict[str, str], details: bool = False) -> None:
    names = list(dict.fromkeys(r.driver for r in results))
    table = Table("probe", "figure", *names, box=None, pad_edge=False)
    for probe in dict.fromkeys(r.probe.name for r in results):
        group = {r.driver: r for r in results if r.probe.name == probe}
        figure = next(iter(group.values())).probe.figure
        cells = [terminal.OK if group[n].ok else terminal.FAILED for n in names]
        table.add_row(probe, figure, *cells)
    terminal.console.print(table)
    for result in results:
        for check in result.checks:
            if details or not check.ok:
                state = terminal.OK if check.ok else terminal.FAILED
                allowed = f"{check.low:.5g} .. {check.high:.5g}"
                terminal.console.print(
                    f"{result.driver} {result.probe.name}: {check.name} {check.value:.5g} ({allowed}) {state}"
                )
        for case in result.cases:
            for name, comparison in case.comparisons.items():
                if details or not comparison.ok:
                    state = terminal.OK if comparison.ok else terminal.FAILED
                    terminal.console.print(
                        f"{result.driver} {result.probe.name}, {case.case.label}, {name}: {comparison} {state}"
                    )
    for name, reason in missing.items():
        terminal.console.print(f"{terminal.NOT_RUN} {name}: {reason}")


def _print_scenes(results) -> None:
    for result in results:
        comparison = result.result.comparisons["result"]
        state = terminal.OK if comparison.ok else terminal.FAILED
        terminal.console.print(
            f"{result.driver} {result.scene.name}, {result.method} {result.aperture}: {comparison} {state}; "
            f"against brute force {result.psnr_brute:.1f} dB, "
            f"against the lens {result.psnr:.1f} dB, FLIP {result.flip:.3f} "
            f"(untouched {result.psnr_untouched:.1f} dB, {result.flip_untouched:.3f})"
        )
