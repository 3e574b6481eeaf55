"""`validation/run` without a command: the brief and the full run, in several processes, and their report."""

import os
import time
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import jinja2
import numpy as np
from rich.text import Text

from bokeh_validation import __version__, engines, files, jobs, metrics, paths, pictures, probes, terminal, truth
from bokeh_validation.compile_matrix import Compilation, compile_variant
from bokeh_validation.probes import REAL, sections
from bokeh_validation.probes.model import drawn
from bokeh_validation.probes.sections import Panel, Section, loaded
from bokeh_validation.shaders.variants import load
from bokeh_validation.truth import ray_traced

# One driver for each language: GLSL, WGSL, HLSL
BRIEF_DRIVERS = ("osmesa", "wgpu", "dxc")
# Compiled by their main compilers
BRIEF_VARIANTS = ("glsl-330", "hlsl-sm3", "hlsl-sm5", "hlsl-sm6", "wgsl")
# Probes for --full only: another one shows the same on another polygon or in another place, or they are of an option
FULL_PROBES = (
    "impulse-octagon", "two-points-octagon", "exact-octagon", "exact-decagon", "halo-octagon", "near-edge-octagon",
    "layered-light-3", "layered-light-9", "layered-sweep", "cats-eye-exact", "lateral-color", "border",
)  # fmt: skip
BRIEF_PROBES = tuple(probe.name for probe in probes.PROBES if probe.name not in FULL_PROBES)
# What takes longest is begun first
SLOWEST = (
    "layered-flatness", "halo-hexagon", "cats-eye-exact", "layered-light-1", "border", "lateral-color",
    "exact-decagon", "exact-octagon", "layered-sweep", *engines.SLOWEST,
)  # fmt: skip
MINUTES = {False: 2, True: 12}


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
    """All results of a run."""

    full: bool
    compilation: Compilation
    probes: Sequence[Section]
    market: Section
    engines: Sequence[Section]

    @property
    def missing(self) -> dict[str, str]:
        """Driver or sample -> why it was not run."""
        return {k: v for section in (*self.probes, *self.engines) for k, v in section.missing.items()}

    @property
    def ok(self) -> bool:
        """Nothing failed; under CI nothing is missing either."""
        passed = self.compilation.passed and all(section.ok for section in (*self.probes, *self.engines))
        return passed and not (os.environ.get("CI") and self.missing)


def write_report(path: Path, found: Everything) -> None:
    """One page that needs no other file: a grid of probes by drivers, and the pictures."""
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
    """The shaders through compilers, on drivers, beside the truth; and the report."""
    terminal.check_writable(output)
    started = time.monotonic()
    path = output or paths.ensured(paths.cache_folder() / "report") / "index.html"
    terminal.tell(f"About {MINUTES[full]} minutes on two cores; this machine has {jobs.CORES}.")
    results = everything(full, adapter)
    write_report(path, results)
    terminal.tell(results.compilation.summary, *results.compilation.failures())
    sections.print_grid(results.probes)
    sections.print_details([*results.probes, *results.engines], False)
    for panel in results.market.strips[""][1:-1]:
        terminal.tell(f"market_7, {panel.caption}: {panel.numbers} against the truth")
    terminal.tell(f"Report: {path}   ({time.monotonic() - started:.0f} s)")
    if not full:
        more = ", ".join(name for name in REAL if name not in BRIEF_DRIVERS)
        rest = f"{len(FULL_PROBES)} probes; the other compilers and sample counts; the engines' samples"
        terminal.tell(f"Not run: {more}; {rest}. validation/run --full has them, in {MINUTES[True]} minutes.")
    terminal.end(results.ok)


def everything(full: bool, adapter: str | None) -> Everything:
    """All jobs, side by side."""
    names = REAL if full else BRIEF_DRIVERS
    samples = [(engines.section, (name,)) for name in engines.ENGINES if name not in engines.SLOW]
    chosen = [probe.name for probe in probes.PROBES] if full else BRIEF_PROBES
    variants = dict.fromkeys(program.variant for program in load()) if full else BRIEF_VARIANTS
    parts = {
        "probes": [(probes.section, (name, names, adapter)) for name in chosen],
        "engines": samples if full else [],
        "compilation": [(compile_variant, (variant, not full)) for variant in variants],
        "market": [(market, (BRIEF_DRIVERS[0], adapter))],
    }
    ordered = sorted((job for some in parts.values() for job in some), key=lambda job: job[1][0] not in SLOWEST)
    with terminal.progress("validate", len(ordered)) as step:
        results = dict(zip(ordered, jobs.run(ordered, step), strict=True))
    done = {part: [results[job] for job in some] for part, some in parts.items()}
    compilation = Compilation([row for part in done["compilation"] for row in part.rows])
    return Everything(full, compilation, done["probes"], done["market"][0], done["engines"])
