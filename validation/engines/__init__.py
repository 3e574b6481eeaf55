"""Run the engine samples of integration/ on their own colour and depth, and compare them with the reference.

engines/tests/test_engines.py runs them.
"""

import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np

from bokeh_validation import paths, pictures
from bokeh_validation.errors import Unavailable
from bokeh_validation.probes.model import Check
from bokeh_validation.probes.outcomes import Outcome, Panel, Run, panel
from engines import bevy, desktop, direct3d, godot, pages, vulkan, wgpu
from engines.capture import Broken, Capture, read

__all__ = ["ENGINES", "QUICK", "SLOW", "Broken", "Capture", "judged", "read", "run"]

# Sample of integration/, as named for `validation/run engines` -> the function that builds it and runs it without a
# window: called with its name and a folder for its capture. It raises errors.Unavailable, with the install line, if
# the engine is missing, and RuntimeError with the engine's messages.
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
# Run only on request, since their first build takes many minutes
SLOW = (bevy.NAME,)
QUICK = tuple(name for name in ENGINES if name not in SLOW)


def run(name: str) -> Capture:
    """Build, run and compare one sample. Raises errors.Unavailable, RuntimeError with the engine's messages, Broken."""
    target = paths.cache_folder() / "engines" / name / "capture"
    # an earlier run's capture must not be taken for this one's
    shutil.rmtree(target, ignore_errors=True)
    ENGINES[name](name, paths.ensured(target))
    return read(target)


def judged(name: str) -> tuple[Outcome, Capture | None]:
    """Build and run a sample, and judge what it drew; the capture is None if the engine is missing or the sample
    failed.
    """
    try:
        capture = run(name)
    except Unavailable as error:
        return Outcome(name, name, missing={name: str(error)}), None
    except (RuntimeError, Broken) as error:
        failed = Check("built and run", 0.0, 1.0, 1.0, str(error))
        return Outcome(name, name, runs=[Run(name, {}, [failed])]), None
    return of_capture(name, capture), capture


def of_capture(name: str, capture: Capture) -> Outcome:
    """Judge a capture, with images of the engine's colour, and of each result next to the reference's."""
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
