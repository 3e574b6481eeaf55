"""The engine samples of integration/, run with their own colour and depth and compared with the reference."""

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from bokeh_validation import paths
from bokeh_validation.engines import bevy, direct3d, godot, jmonkeyengine, love, ogre, pages, scripts
from bokeh_validation.engines.capture import Broken, Capture, read

__all__ = ["ENGINES", "Broken", "Capture", "Engine", "read", "run"]


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


def run(name: str) -> Capture:
    """Build, run and compare one sample. Raises errors.Unavailable, RuntimeError with what the engine said, Broken."""
    target = paths.cache_folder() / "engines" / name / "capture"
    # what an earlier run left must not pass for this one's
    shutil.rmtree(target, ignore_errors=True)
    ENGINES[name].run(name, paths.ensured(target))
    return read(target)
