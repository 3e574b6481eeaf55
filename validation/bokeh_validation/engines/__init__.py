"""The engine samples of integration/, run with their own colour and depth and compared with the reference.

tests/engines/test_engines.py runs them.
"""

import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np

from bokeh_validation import paths, pictures
from bokeh_validation.engines import bevy, desktop, direct3d, godot, pages, vulkan, wgpu
from bokeh_validation.engines.capture import Broken, Capture, read
from bokeh_validation.errors import Unavailable
from bokeh_validation.probes.model import Check
from bokeh_validation.probes.outcomes import Outcome, Panel, Run, panel

__all__ = ["ENGINES", "Broken", "Capture", "judged", "read", "run"]

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
    wgpu.NAME: wgpu.run,
    bevy.NAME: bevy.run,
}
# Left out unless they are asked for: the first build takes many minutes
SLOW = (bevy.NAME,)


def run(name: str) -> Capture:
    """Build, run and compare one sample. Raises errors.Unavailable, RuntimeError with what the engine said, Broken."""
    target = paths.cache_folder() / "engines" / name / "capture"
    # what an earlier run left must not pass for this one's
    shutil.rmtree(target, ignore_errors=True)
    ENGINES[name](name, paths.ensured(target))
    return read(target)


def judged(name: str) -> tuple[Outcome, Capture | None]:
    """Build and run a sample, and judge what it drew; None where the engine is missing or the sample failed."""
    try:
        capture = run(name)
    except Unavailable as error:
        return Outcome(name, name, missing={name: str(error)}), None
    except (RuntimeError, Broken) as error:
        failed = Check("built and run", 0.0, 1.0, 1.0, str(error))
        return Outcome(name, name, runs=[Run(name, {}, [failed])]), None
    return of_capture(name, capture), capture


def of_capture(name: str, capture: Capture) -> Outcome:
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
    return Outcome(name, capture.engine, capture.device, [Run(name, compared, [shots])], {"": panels})
