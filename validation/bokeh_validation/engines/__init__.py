"""The engine samples of integration/, run with their own colour and depth and compared with the reference.

The work behind `validation/run engines`.
"""

import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np
import typer

from bokeh_validation import jobs, paths, pictures, terminal
from bokeh_validation.engines import bevy, direct3d, godot, jmonkeyengine, love, ogre, pages, scripts
from bokeh_validation.engines.capture import Broken, Capture, read
from bokeh_validation.errors import Unavailable, UserError
from bokeh_validation.probes.model import Check
from bokeh_validation.probes.sections import Panel, Run, Section, panel, print_details

__all__ = ["ENGINES", "Broken", "Capture", "Engine", "engines", "read", "run", "section"]


class Engine(NamedTuple):
    """A sample of integration/; its name is what `validation/run engines` takes.

    run      (name, folder): builds the sample and runs it, headless, so that it leaves its capture in `folder`. Raises
             errors.Unavailable with the install line where the engine is absent, RuntimeError with what it said.
    changed  of a sample whose first build takes many minutes: whether its files differ from those that it last passed
             with, here
    """

    run: Callable[[str, Path], None]
    changed: Callable[[], bool] | None = None

    @property
    def slow(self) -> bool:
        """Left out unless it is asked for; of `validation/test` unless its files changed."""
        return self.changed is not None


ENGINES = {
    "opengl": Engine(scripts.run),
    "panda3d": Engine(scripts.run),
    "raylib": Engine(scripts.run),
    "love": Engine(love.run),
    "ogre": Engine(ogre.run),
    "jmonkeyengine": Engine(jmonkeyengine.run),
    "threejs-webgl": Engine(pages.run),
    "threejs-webgpu": Engine(pages.run),
    "babylonjs-webgl": Engine(pages.run),
    "babylonjs-webgpu": Engine(pages.run),
    "playcanvas-webgl": Engine(pages.run),
    "playcanvas-webgpu": Engine(pages.run),
    "godot": Engine(godot.run),
    "direct3d9": Engine(direct3d.run),
    "direct3d11": Engine(direct3d.run),
    "bevy": Engine(bevy.run, bevy.changed),
}
SLOWEST = ("bevy", "godot")


def run(name: str) -> Capture:
    """Build, run and compare one sample. Raises errors.Unavailable, RuntimeError with what the engine said, Broken."""
    target = paths.cache_folder() / "engines" / name / "capture"
    # what an earlier run left must not pass for this one's
    shutil.rmtree(target, ignore_errors=True)
    ENGINES[name].run(name, paths.ensured(target))
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
    chosen = names or [name for name, engine in ENGINES.items() if everything or not engine.slow]
    # what takes longest is begun first
    ordered = sorted(chosen, key=lambda name: name not in SLOWEST)
    with terminal.progress("engine", len(chosen)) as step:
        sections = dict(zip(ordered, jobs.run([(section, (name,)) for name in ordered], step), strict=True))
    passed = True
    for name in chosen:
        terminal.console.print(
            f"{name}: {sections[name].title}, {sections[name].shows or terminal.NOT_RUN}", highlight=False
        )
        print_details([sections[name]], True)
        passed &= sections[name].ok and not (os.environ.get("CI") and sections[name].missing)
    terminal.end(passed)
