"""`validation/run` without a command: the brief and the full run, in several processes, and their report."""

import os
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path

import jinja2
import numpy as np
from rich.text import Text

from bokeh_validation import __version__, engines, files, jobs, metrics, paths, pictures, probes, terminal, truth
from bokeh_validation.compile_matrix import OK, Compilation, compile_variant
from bokeh_validation.probes import REAL, sections
from bokeh_validation.probes.model import drawn
from bokeh_validation.probes.sections import Panel, Section, loaded
from bokeh_validation.shaders.variants import load
from bokeh_validation.truth import ray_traced

# One driver for each language: GLSL, WGSL, HLSL
BRIEF_DRIVERS = ("osmesa", "wgpu", "dxc")
# Compiled by their main compilers
BRIEF_VARIANTS = ("glsl-330", "hlsl-sm3", "hlsl-sm5", "hlsl-sm6", "wgsl")
MINUTES = {False: "a minute", True: "12 minutes"}


def market(name: str, adapter: str | None) -> Section:
    """Every method on market_7 beside the truth, by one driver."""
    present, devices = loaded([name], adapter)
    lens = ray_traced.truth(ray_traced.MARKET, "hexagon")
    images = {"input": ray_traced.picture(ray_traced.MARKET).color}
    for driver in present:
        images["naive, 127 samples"] = drawn(driver, ray_traced.scene_case(ray_traced.MARKET, "naive", "hexagon"))
        for label in ("paper", "exact", "layered medium"):
            images[label] = truth.picture(driver, ray_traced.MARKET, label)
    panels = [Panel(k, _exposed(image), f"{metrics.psnr(image, lens):.1f} dB") for k, image in images.items()]
    panels.append(Panel("truth: ray traced through a lens", _exposed(lens)))
    text = f"Hexagon, on {name}. PSNR of tone-mapped colour against the truth; validation/run truth has more."
    return Section("market_7", "What each method makes of a scene", text, [], {"": panels}, **devices)


def _exposed(image: np.ndarray) -> str:
    return pictures.jpeg_uri(pictures.filmic(image, truth.EXPOSURE["market_7"]), 640)


@dataclass(frozen=True)
class Everything:
    """All results of a run.

    left_out  what the brief run leaves to the full one: name -> how to get it
    """

    full: bool
    compilation: Compilation
    probes: Sequence[Section]
    market: Section
    engines: Sequence[Section]
    left_out: Mapping[str, str] = field(default_factory=dict)

    @property
    def absent(self) -> dict[str, str]:
        """Driver, compiler or sample that was asked for and is not here -> the reason."""
        sections = {k: v for section in (*self.probes, *self.engines) for k, v in section.missing.items()}
        return {**sections, **self.compilation.missing}

    @property
    def not_run(self) -> dict[str, str]:
        """All that was not run, for whichever reason -> how to get it."""
        return {**self.absent, **self.left_out}

    @property
    def failed(self) -> list[str]:
        """Names of what failed; under CI, what is absent failed too."""
        names = [section.name for section in (*self.probes, *self.engines) if not section.ok]
        names += ["compilation"] * (not self.compilation.passed)
        return names + [name for name in self.absent if os.environ.get("CI")]

    @property
    def ok(self) -> bool:
        """Nothing failed."""
        return not self.failed

    @property
    def verdict(self) -> str:
        """One line: whether the shaders are right, and what says so."""
        counts, drivers = self.compilation.counts, sections.drivers_of(self.probes)
        seen = f"{len(self.probes)} probes on {', '.join(drivers) or 'no driver'}"
        seen += f", {counts[OK]} compilations"
        seen += f", {len(self.engines)} engines' samples" if self.engines else ""
        return f"FAILED: {', '.join(self.failed)} ({seen})" if self.failed else f"All ok: {seen}"


def write_report(path: Path, found: Everything) -> None:
    """Write one page that needs no other file: the verdict, the picture beside the truth, the tables, the pictures."""
    loader = jinja2.PackageLoader("bokeh_validation.run", ".")
    environment = jinja2.Environment(loader=loader, autoescape=True, trim_blocks=True, lstrip_blocks=True)
    environment.filters["plain"] = lambda line: Text.from_markup(line).plain
    page = environment.get_template("page.html").render(
        version=__version__,
        date=datetime.now().astimezone().strftime("%Y-%m-%d %H:%M %Z"),
        found=found,
        drivers=sections.drivers_of(found.probes),
        difference_steps=sections.DIFFERENCE_STEPS,
    )
    files.whole(path, lambda partial: partial.write_text(page, encoding="utf-8"))


def validate(full: bool, adapter: str | None, output: Path | None) -> None:
    """Put the shaders through compilers, on drivers and beside the truth, and write the report."""
    terminal.check_writable(output)
    started = time.monotonic()
    path = output or paths.ensured(paths.cache_folder() / "report") / "index.html"
    terminal.tell(f"About {MINUTES[full]} on two cores; this machine has {jobs.CORES}.")
    results = everything(full, adapter)
    write_report(path, results)
    sections.print_grid(results.probes)
    for section in (*results.probes, *results.engines):
        sections.print_runs(section, False)
    terminal.tell(results.compilation.summary, *results.compilation.failures())
    for panel in results.market.strips[""][1:-1]:
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


def everything(full: bool, adapter: str | None) -> Everything:
    """Run all jobs, side by side."""
    names = REAL if full else BRIEF_DRIVERS
    samples = [(engines.section, (name,)) for name in engines.ENGINES if name not in engines.SLOW]
    chosen = [probe.name for probe in probes.PROBES if full or probe.brief]
    variants = dict.fromkeys(program.variant for program in load()) if full else BRIEF_VARIANTS
    parts = {
        "probes": [(probes.section, (name, names, adapter)) for name in chosen],
        "engines": samples if full else [],
        "compilation": [(compile_variant, (variant, not full)) for variant in variants],
        "market": [(market, (BRIEF_DRIVERS[0], adapter))],
    }
    every = [job for some in parts.values() for job in some]
    with terminal.progress("validate", len(every)) as step:
        results = dict(zip(every, jobs.run(every, step), strict=True))
    done = {part: [results[job] for job in some] for part, some in parts.items()}
    compilation = Compilation([row for part in done["compilation"] for row in part.rows])
    left_out = {} if full else _left_out(len(probes.PROBES) - len(chosen))
    return Everything(full, compilation, done["probes"], done["market"][0], done["engines"], left_out)


def _left_out(count: int) -> dict[str, str]:
    """Return what only the full run has, and the command for it."""
    command = f"validation/run --full, {MINUTES[True]}"
    others = ", ".join(name for name in REAL if name not in BRIEF_DRIVERS)
    names = (f"drivers {others}", f"{count} probes of other polygons and of options")
    return dict.fromkeys((*names, "other compilers and sample counts", "the engines' samples"), command)
