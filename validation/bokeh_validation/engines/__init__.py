"""The engine samples of integration/, run with their own colour and depth and compared with the reference.

The work behind `validation/run engines`.
"""

import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from bokeh_validation import jobs, paths, pictures, terminal
from bokeh_validation.engines import bevy, desktop, direct3d, godot, pages, vulkan
from bokeh_validation.engines.capture import Broken, Capture, read
from bokeh_validation.errors import Unavailable, UserError
from bokeh_validation.probes.model import Check
from bokeh_validation.probes.sections import Panel, Run, Section, panel, print_details

__all__ = ["ENGINES", "Broken", "Capture", "engines", "read", "run", "section"]

# Sample of integration/, which is what `validation/run engines` takes -> what builds it and runs it, headless: called
# with its name and a folder to leave its capture in. It raises errors.Unavailable, with the install line, where the
# engine is absent, and RuntimeError with what the engine said.
ENGINES: dict[str, Callable[[str, Path], None]] = {
    **dict.fromkeys(("opengl", "panda3d", "raylib", "love", "ogre", "jmonkeyengine"), desktop.run),
    **dict.fromkeys(pages.NAMES, pages.run),
    "godot": godot.run,
    "direct3d9": direct3d.run,
    "direct3d11": direct3d.run,
    **dict.fromkeys(vulkan.NAMES, vulkan.run),
    "bevy": bevy.run,
}
# Left out unless they are asked for: the first build takes many minutes
SLOW = ("bevy",)


def run(name: str) -> Capture:
    """Build, run and compare one sample. Raises errors.Unavailable, RuntimeError with what the engine said, Broken."""
    target = paths.cache_folder() / "engines" / name / "capture"
    # what an earlier run left must not pass for this one's
    shutil.rmtree(target, ignore_errors=True)
    ENGINES[name](name, paths.ensured(target))
    return read(target)


def section(name: str) -> Section:
    """A sample for the report; not run: a Section without runs."""
    try:
        return of_capture(name, run(name))
    except Unavailable as error:
        return Section(name, name, missing={name: str(error)})
    except (RuntimeError, Broken) as error:
        return Section(name, name, runs=[Run(name, {}, [Check("built and run", 0.0, 1.0, 1.0, str(error))])])


def of_capture(name: str, capture: Capture) -> Section:
    """An engine's own colour, and beside each result what the reference makes of the same."""
    panels = []
    for shot in capture.shots:
        source, expected = (pictures.display(image, tone_map=True) for image in (shot.case.color, shot.expected.value))
        if not panels:
            panels = [Panel("the engine's colour", pictures.jpeg_uri(source))]
            panels += [Panel(f"reference, {shot.name}", pictures.jpeg_uri(expected))]
        panels.append(panel(shot.name, shot.result, shot.expected.value, shot.comparison))
    compared = {", ".join([shot.name, *shot.outside]): shot.comparison for shot in capture.shots}
    shots = Check("shots", len(capture.shots), 1, np.inf, "a capture without any shows nothing")
    return Section(name, capture.engine, capture.device, [Run(name, compared, [shots])], {"": panels})


def engines(
    names: Annotated[list[str] | None, typer.Argument(metavar="[NAME]...", help="By default all quick ones.")] = None,
    everything: Annotated[bool, typer.Option("--all", help="The slow ones as well (Bevy builds for minutes).")] = False,
) -> None:
    """Build and run the samples of integration/, each compared with the reference on its own colour and depth."""
    for name in names or []:
        if name not in ENGINES:
            raise UserError(f"engine {name}: no such sample. Give some of {', '.join(ENGINES)}.")
    chosen = names or [name for name in ENGINES if everything or name not in SLOW]
    with terminal.progress("engine", len(chosen)) as step:
        sections = dict(zip(chosen, jobs.run([(section, (name,)) for name in chosen], step), strict=True))
    passed = True
    for name in chosen:
        terminal.console.print(
            f"{name}: {sections[name].title}, {sections[name].shows or terminal.NOT_RUN}", highlight=False
        )
        print_details([sections[name]], True)
        passed &= sections[name].ok and not (os.environ.get("CI") and sections[name].missing)
    terminal.end(passed)
