"""Run the brief or full validation in several processes and write the report: `validation/run` without a command."""

import os
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path

import jinja2
import numpy as np
from rich.text import Text

from bokeh_validation import __version__, files, metrics, paths, pictures, probes, terminal, truth
from bokeh_validation.compile_matrix import OK, Compilation
from bokeh_validation.drivers.base import Driver
from bokeh_validation.probes import REAL, outcomes
from bokeh_validation.probes.model import drawn
from bokeh_validation.probes.outcomes import Outcome, Panel
from bokeh_validation.run import session
from bokeh_validation.run.session import BRIEF, CORES, FULL
from bokeh_validation.shaders.variants import load
from bokeh_validation.truth import ray_traced

# One driver per language: GLSL, WGSL, HLSL
BRIEF_DRIVERS = ("osmesa", "wgpu", "dxc")
# Variants that the brief run compiles, each with its language's main compiler
BRIEF_VARIANTS = ("glsl-330", "hlsl-sm3", "hlsl-sm5", "hlsl-sm6", "wgsl")
MINUTES = {False: "a minute", True: "12 minutes"}


def market(driver: Driver) -> tuple[Outcome, dict[str, float]]:
    """Draw market_7 by every method.

    Returns the images with the ray-traced truth, and method -> PSNR of tone-mapped colour against the truth, dB.
    """
    lens = ray_traced.truth(ray_traced.MARKET, "hexagon")
    images = {"input": ray_traced.picture(ray_traced.MARKET).color}
    images["naive, 127 samples"] = drawn(driver, ray_traced.scene_case(ray_traced.MARKET, "naive", "hexagon"))
    for label in ("paper", "exact", "layered medium"):
        images[label] = truth.picture(driver, ray_traced.MARKET, label)
    measured = {name: metrics.psnr(image, lens) for name, image in images.items()}
    panels = [Panel(name, _exposed(image), f"{measured[name]:.1f} dB") for name, image in images.items()]
    panels.append(Panel("truth: ray traced through a lens", _exposed(lens)))
    text = f"Hexagon, on {driver.name}. PSNR of tone-mapped colour against the truth; validation/run truth has more."
    title, devices = "What each method makes of a scene", {driver.name: driver.adapter}
    return Outcome("market_7", title, text, strips={"": panels}, adapters=devices), measured


def _exposed(image: np.ndarray) -> str:
    return pictures.jpeg_uri(pictures.filmic(image, truth.EXPOSURE["market_7"]), 640)


@dataclass(frozen=True)
class Everything:
    """Hold all results of a run.

    market    market_7 by every method; None if its driver is missing
    errors    name of a test that failed without handing over a failed result -> message
    left_out  name of a part that only the full run includes -> how to run it
    """

    full: bool
    compilation: Compilation
    probes: Sequence[Outcome]
    market: Outcome | None
    engines: Sequence[Outcome]
    errors: Mapping[str, str] = field(default_factory=dict)
    left_out: Mapping[str, str] = field(default_factory=dict)

    @property
    def absent(self) -> dict[str, str]:
        """Return what was asked for but is not on this machine: driver, compiler or sample -> reason."""
        missing = {k: v for outcome in (*self.probes, *self.engines) for k, v in outcome.missing.items()}
        return {**missing, **self.compilation.missing}

    @property
    def not_run(self) -> dict[str, str]:
        """Return everything that was not run -> how to get it."""
        return {**self.absent, **self.left_out}

    @property
    def failed(self) -> list[str]:
        """Return the names of what failed; under CI, missing things are failures too."""
        names = [outcome.name for outcome in (*self.probes, *self.engines) if not outcome.ok]
        names += [*["compilation"] * (not self.compilation.passed), *self.errors]
        return names + [name for name in self.absent if os.environ.get("CI")]

    @property
    def ok(self) -> bool:
        """Return whether nothing failed."""
        return not self.failed

    @property
    def verdict(self) -> str:
        """Return one line that says whether the shaders are right, and which checks show it."""
        counts, drivers = self.compilation.counts, outcomes.drivers_of(self.probes)
        what_was_run = f"{len(self.probes)} probes on {', '.join(drivers) or 'no driver'}"
        what_was_run += f", {counts[OK]} compilations"
        what_was_run += f", {len(self.engines)} engines' samples" if self.engines else ""
        return f"FAILED: {', '.join(self.failed)} ({what_was_run})" if self.failed else f"All ok: {what_was_run}"


def write_report(path: Path, results: Everything) -> None:
    """Write the report as a self-contained page: the verdict, market_7 next to the truth, the tables, the images."""
    loader = jinja2.PackageLoader("bokeh_validation.run", ".")
    environment = jinja2.Environment(loader=loader, autoescape=True, trim_blocks=True, lstrip_blocks=True)
    environment.filters["plain"] = lambda line: Text.from_markup(line).plain
    page = environment.get_template("page.html").render(
        version=__version__,
        date=datetime.now().astimezone().strftime("%Y-%m-%d %H:%M %Z"),
        found=results,
        drivers=outcomes.drivers_of(results.probes),
        difference_steps=outcomes.DIFFERENCE_STEPS,
    )
    files.whole(path, lambda partial: partial.write_text(page, encoding="utf-8"))


def validate(full: bool, adapter: str | None, output: Path | None, samples: Sequence[str]) -> None:
    """Compile and draw the shaders, compare market_7 with the truth, and write the report.

    full     whether to use every driver, compiler, probe and sample
    adapter  part of a device's name
    output   the report's file; None: in the cache folder
    samples  names of the engines' samples to run
    """
    terminal.check_writable(output)
    started = time.monotonic()
    path = output or paths.ensured(paths.cache_folder() / "report") / "index.html"
    terminal.tell(f"About {MINUTES[full]} on two cores; this machine has {CORES}.")
    results = everything(full, adapter, samples)
    write_report(path, results)
    outcomes.print_grid(results.probes)
    for outcome in (*results.probes, *results.engines):
        outcomes.print_runs(outcome, False)
    terminal.tell(*(f"{name}: {error}" for name, error in results.errors.items()))
    terminal.tell(results.compilation.summary, *results.compilation.failures())
    for panel in results.market.strips[""][1:-1] if results.market else ():
        terminal.tell(f"market_7, {panel.caption}: {panel.numbers} against the truth")
    terminal.tell_missing(results.not_run)
    terminal.tell(f"{results.verdict}, in {time.monotonic() - started:.0f} s", f"Report: {path}")
    terminal.tell(f"Next: {_next(results)}")
    terminal.end(results.ok)


def _next(results: Everything) -> str:
    if not results.ok:
        return "open the report: what failed is red. docs/troubleshooting.md has common causes."
    if results.full:
        return "validation/test runs the test suite."
    return "docs/start.md leads to a first blur in your engine; validation/run --full draws on everything."


def everything(full: bool, adapter: str | None, samples: Sequence[str]) -> Everything:
    """Run the tests whose results make up the report; arguments as in validate()."""
    names = REAL if full else BRIEF_DRIVERS
    session.check_adapter(names, adapter)
    chosen_probes = [probe for probe in probes.PROBES if full or probe.brief]
    variants = dict.fromkeys(program.variant for program in load()) if full else BRIEF_VARIANTS
    tests = {
        "engines": [session.sample(name) for name in samples],
        "probes": [session.probe(probe.name, name) for probe in chosen_probes for name in names],
        "compilation": [session.variant(name) for name in variants],
        "market": [session.MARKET],
    }
    all_tests = [test for group in tests.values() for test in group]
    with terminal.progress("validate", len(all_tests)) as step:
        handed_over, errors = session.run(all_tests, step, FULL if full else BRIEF, adapter)
    done = {part: [handed_over[test] for test in group if test in handed_over] for part, group in tests.items()}
    compilation = Compilation([row for part in done["compilation"] for row in part.rows])
    left_out = {} if full else _left_out(len(probes.PROBES) - len(chosen_probes))
    market = next(iter(done["market"]), None)
    merged = outcomes.merged(done["probes"])
    return Everything(
        full, compilation, merged, market, done["engines"], session.unexplained(handed_over, errors), left_out
    )


def _left_out(count: int) -> dict[str, str]:
    """Return what only the full run includes -> the command for it; `count` is the number of probes among it."""
    command = f"validation/run --full, {MINUTES[True]}"
    others = ", ".join(name for name in REAL if name not in BRIEF_DRIVERS)
    names = (f"drivers {others}", f"{count} probes of other polygons and of options")
    return dict.fromkeys((*names, "other compilers and sample counts", "the engines' samples"), command)
