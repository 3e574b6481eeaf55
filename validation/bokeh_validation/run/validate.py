"""`validation/run` without a command, and `validation/run probes`: what is run on what, in several processes."""

import os
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.table import Table

from bokeh_validation import drivers, jobs, metrics, paths, pictures, terminal, truth
from bokeh_validation.compilers.compile import Compilation, compile_programs
from bokeh_validation.drivers.base import Driver
from bokeh_validation.engines import ENGINES, Broken
from bokeh_validation.engines import run as run_engine
from bokeh_validation.errors import Unavailable, UserError
from bokeh_validation.probes import PROBES, QUICK_PROBES, Check, shapes
from bokeh_validation.probes import run as run_probe
from bokeh_validation.probes.model import compared
from bokeh_validation.run import report
from bokeh_validation.run.sections import Panel, Run, Section, drivers_of, of_capture, of_probe, strip
from bokeh_validation.shaders.variants import load
from bokeh_validation.terminal import FAILED, NOT_RUN, OK, console
from bokeh_validation.truth import ray_traced

REAL = tuple(name for name in drivers.NAMES if name != "reference")
# One driver for each language: GLSL, WGSL, HLSL
BRIEF_DRIVERS = ("osmesa", "wgpu", "dxc")
# Compiled by their main compilers
BRIEF_VARIANTS = ("glsl-330", "hlsl-sm3", "hlsl-sm5", "hlsl-sm6", "wgsl")
# Probes for --full only: another one shows the same on another polygon or in another place
FULL_PROBES = (
    "halo-octagon", "near-edge-octagon", "layered-light-3", "layered-light-9", "layered-sweep", "layered-constant",
    "cats-eye-layered", "curved-blades",
)  # fmt: skip
# What takes longest is begun first
SLOWEST = ("halo-hexagon", "exact-decagon", "exact-octagon", "layered-sweep", "layered-light-1", "bevy", "godot")
MINUTES = {False: 2, True: 11}
METHODS = ("paper", "exact", "layered")
# The middle of a scene of 640 x 480, which every driver is compared on: layered takes the reference 16 s on the whole
ROWS, COLUMNS = slice(150, 330), slice(200, 440)


# ---------------------------------------------------------------------------------------------------------------- jobs


@lru_cache
def _load(name: str, adapter: str | None) -> Driver | str:
    """A driver of this process, or why it is missing."""
    try:
        return drivers.load(name, adapter)
    except Unavailable as error:
        return str(error)


def _found(names: Sequence[str], adapter: str | None) -> tuple[list[Driver], dict]:
    """Drivers, and what a Section says of them."""
    loaded = {name: _load(name, adapter) for name in names}
    there = {name: one for name, one in loaded.items() if not isinstance(one, str)}
    missing = {name: one for name, one in loaded.items() if isinstance(one, str)}
    return list(there.values()), {"adapters": {name: d.adapter for name, d in there.items()}, "missing": missing}


def probe(name: str, names: Sequence[str], adapter: str | None, brief: bool) -> Section:
    """A probe on drivers."""
    chosen = next(one for one in (QUICK_PROBES if brief else PROBES) if one.name == name)
    there, said = _found([one for one in names if one not in chosen.but], adapter)
    if not there:
        return Section(name, chosen.title, chosen.shows, [], {}, **said)
    return replace(of_probe([run_probe(chosen, driver) for driver in there]), **said)


def market(name: str, adapter: str | None) -> Section:
    """Every method on market_7 beside the truth, by one driver."""
    there, said = _found([name], adapter)
    lens = ray_traced.truth(ray_traced.MARKET, "hexagon")
    shown = {"input": ray_traced.picture(ray_traced.MARKET).color}
    for driver in there:
        naive = ray_traced.scene_case(ray_traced.MARKET, "naive", "hexagon")
        shown["naive, 127 samples"] = driver.run(naive.plan.passes, naive.textures(), naive.size)["result"]
        for label in ("paper", "exact", "layered medium"):
            shown[label] = truth.picture(driver, ray_traced.MARKET, label)
    panels = [Panel(k, _exposed(image), f"{metrics.psnr(image, lens):.1f} dB") for k, image in shown.items()]
    panels.append(Panel("truth: ray traced through a lens", _exposed(lens)))
    text = f"Hexagon, on {name}. PSNR of tone-mapped colour against the truth; validation/run truth has more."
    return Section("market_7", "What each method makes of a scene", text, [], {"": panels}, **said)


def _exposed(image: np.ndarray) -> str:
    return pictures.jpeg_uri(pictures.filmic(image, truth.EXPOSURE["market_7"]), 640)


def scene(name: str, aperture: str, method: str, names: Sequence[str], adapter: str | None) -> Section:
    """A scene by a method: the whole by the first driver against the lens, its middle by all against the reference."""
    file = next(one for one in ray_traced.DRIVER_SCENES if one.name == name)
    case = ray_traced.scene_case(file, method, aperture)
    settings = replace(case.settings, rotation=ray_traced.TRUTH_ROTATION[aperture])
    case = replace(case, settings=settings, tone_map=True)
    there, said = _found(names, adapter)
    title = f"{name}-{method}-{aperture}"
    if not there:
        return Section(title, title, "", [], {}, **said)
    lens = ray_traced.truth(file, aperture)
    whole = there[0].run(case.plan.passes, case.textures(), case.size)["result"]
    distances = [f"untouched {metrics.psnr(case.color, lens):.1f} dB", f"{method} {metrics.psnr(whole, lens):.1f} dB"]
    text = f"Against the lens: {', '.join(distances)}."
    if method != "layered":
        text += f" Against brute force: {metrics.psnr(whole, shapes.brute_force(there[0], case)):.1f} dB."
    shown = {"input": case.color, "ray traced through a lens": lens, f"{method}, {there[0].name}": whole}
    panels = [Panel(k, pictures.jpeg_uri(pictures.display(v, tone_map=True), 320)) for k, v in shown.items()]
    middle = replace(case, color=case.color[ROWS, COLUMNS].copy(), depth=case.depth[ROWS, COLUMNS].copy())
    results = {driver.name: compared(middle, driver) for driver in there}
    strips = {"whole": panels, "the middle": strip("result", results)}
    runs = [Run(driver, result.comparisons) for driver, result in results.items()]
    return Section(title, f"{name}, {method}, {aperture}", text, runs, strips, **said)


def compiled(variant: str, brief: bool) -> Compilation:
    """The programs of a variant, through all of its compilers or the main ones."""
    return compile_programs(one for one in load(quick=brief, main=brief) if one.variant == variant)


def sample(name: str) -> Section:
    """A sample of integration/; not run: a Section without runs."""
    try:
        return of_capture(name, run_engine(name))
    except Unavailable as error:
        return Section(name, name, "", [], {}, missing={name: str(error)})
    except (RuntimeError, Broken) as error:
        return Section(name, name, "", [Run(name, {}, [Check("built and run", 0.0, 1.0, 1.0, str(error))])], {})


def _joined(parts: Sequence[Compilation]) -> Compilation:
    return Compilation([row for part in parts for row in part.rows], sum(part.seconds for part in parts))


# ------------------------------------------------------------------------------------------------------------ commands


@dataclass(frozen=True)
class Everything:
    """All results of a run."""

    full: bool
    compilation: Compilation
    probes: Sequence[Section]
    scenes: Sequence[Section]
    market: Section
    engines: Sequence[Section]

    @property
    def drawn(self) -> list[Section]:
        """The rows of the grid."""
        return [*self.probes, *self.scenes]

    @property
    def missing(self) -> dict[str, str]:
        """Driver or sample -> why it was not run."""
        return {k: v for section in (*self.drawn, *self.engines) for k, v in section.missing.items()}

    @property
    def ok(self) -> bool:
        """Nothing failed; under CI nothing is missing either."""
        found = self.compilation.passed and all(section.ok for section in (*self.drawn, *self.engines))
        return found and not (os.environ.get("CI") and self.missing)


def validate(full: bool, adapter: str | None, output: Path | None) -> None:
    """The shaders through compilers, on drivers, beside the truth; and the report."""
    terminal.check_writable(output)
    started = time.monotonic()
    path = output or paths.ensured(paths.cache_folder() / "report") / "index.html"
    console.print(f"About {MINUTES[full]} minutes on two cores; this machine has {jobs.CORES}.")
    found = everything(full, adapter)
    report.write(path, found)
    for text in (found.compilation.summary, *found.compilation.failures()):
        console.print(text, markup=False, highlight=False)
    _print_grid(found.drawn)
    for section in (*found.drawn, *found.engines):
        _print_lines(section, False)
    _print_missing(found.missing)
    for panel in found.market.strips[""][1:-1]:
        console.print(f"market_7, {panel.caption}: {panel.numbers} against the truth", highlight=False)
    console.print(f"Report: {path}   ({time.monotonic() - started:.0f} s)", highlight=False)
    if not full:
        more = [name for name in REAL if name not in BRIEF_DRIVERS]
        console.print(
            f"Not run: {', '.join(more)}; {len(FULL_PROBES)} probes; the other compilers and sample counts; scenes on "
            f"every driver; the engines' samples. validation/run --full has them, in about {MINUTES[True]} minutes.",
            highlight=False,
        )
    terminal.end(found.ok)


def everything(full: bool, adapter: str | None) -> Everything:
    """All jobs, side by side."""
    names = REAL if full else BRIEF_DRIVERS
    scenes = [
        (scene, (file.name, aperture, method, names, adapter))
        for method in reversed(METHODS) for file in ray_traced.DRIVER_SCENES for aperture in ray_traced.TRUTHS
    ]  # fmt: skip
    probes = [one.name for one in PROBES if full or one.name not in FULL_PROBES]
    variants = dict.fromkeys(program.variant for program in load())
    parts = {
        "scenes": scenes if full else [],
        "engines": [(sample, (name,)) for name, engine in ENGINES.items() if full and not engine.slow],
        "probes": [(probe, (name, names, adapter, not full)) for name in probes],
        "compile": [(compiled, (name, not full)) for name in variants if full or name in BRIEF_VARIANTS],
        "market": [(market, (BRIEF_DRIVERS[0], adapter))],
    }
    ordered = [(part, job) for part, some in parts.items() for job in some]
    ordered.sort(key=lambda item: item[1][1][0] not in SLOWEST)
    with terminal.progress("validate", len(ordered)) as step:
        results = jobs.run([job for _, job in ordered], step)
    made = {job: result for (_, job), result in zip(ordered, results, strict=True)}
    done = {part: [made[job] for job in some] for part, some in parts.items()}
    return Everything(
        full, _joined(done["compile"]), done["probes"], done["scenes"], done["market"][0], done["engines"]
    )


def run_patterns(driver: terminal.SeveralDrivers = None, adapter: terminal.Adapter = None) -> None:
    """The probes on the drivers, each against the reference and against what it must show."""
    names = tuple(driver or REAL)
    for name in names:
        terminal.check_driver(name)
    with terminal.progress("probe", len(PROBES)) as step:
        sections = jobs.run([(probe, (one.name, names, adapter, False)) for one in PROBES], step)
    _print_grid(sections)
    for section in sections:
        _print_lines(section, True)
    _print_missing(sections[0].missing)
    terminal.end(all(section.ok for section in sections))


def run_engines(
    names: Annotated[list[str] | None, typer.Argument(metavar="[NAME]...", help="By default all quick ones.")] = None,
    everything: Annotated[bool, typer.Option("--all", help="The slow ones as well (Bevy builds for minutes).")] = False,
) -> None:
    """Build and run the samples of integration/, each compared with the reference on its own colour and depth."""
    for name in names or []:
        if name not in ENGINES:
            raise UserError(f"engine {name}: no such sample. Give some of {', '.join(ENGINES)}.")
    chosen = names or [name for name, engine in ENGINES.items() if everything or not engine.slow]
    ordered = sorted(chosen, key=lambda name: name not in SLOWEST)
    with terminal.progress("engine", len(chosen)) as step:
        sections = dict(zip(ordered, jobs.run([(sample, (name,)) for name in ordered], step), strict=True))
    passed = True
    for name in chosen:
        console.print(f"{name}: {sections[name].title}, {sections[name].shows or NOT_RUN}", highlight=False)
        _print_lines(sections[name], True)
        _print_missing(sections[name].missing)
        passed &= sections[name].ok and not (os.environ.get("CI") and sections[name].missing)
    terminal.end(passed)


def _print_grid(sections: Sequence[Section]) -> None:
    names = drivers_of(sections)
    table = Table("", *names, box=None, pad_edge=False)
    for section in sections:
        states = {run.driver: OK if run.ok else FAILED for run in section.runs}
        table.add_row(section.name, *(states.get(name, "") for name in names))
    console.print(table)


def _print_lines(section: Section, every: bool) -> None:
    for run in section.runs:
        who = " ".join(dict.fromkeys((run.driver, section.name)))
        for line in run.lines(every):
            console.print(f"{who}: {line}", highlight=False)


def _print_missing(missing: Mapping[str, str]) -> None:
    for name, reason in missing.items():
        console.print(f"{NOT_RUN} {name}: {reason}", highlight=False)
