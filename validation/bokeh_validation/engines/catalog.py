"""Which engines there are, and how each sample is run."""

import importlib
import shutil
from dataclasses import dataclass
from pathlib import Path

from bokeh_validation import paths
from bokeh_validation.engines.capture import Capture, read


@dataclass(frozen=True)
class Engine:
    """A sample of integration/.

    name    what `validation/run engines` takes; its files are in the folder of integration/ that it begins with
    module  of bokeh_validation.engines, with `run(name, folder)`: builds the sample and runs it, headless, so that it
            leaves its capture in `folder`. Raises errors.Unavailable with the install line where the engine is absent.
    slow    left out of `validation/test` unless its files changed, since its first build takes many minutes
    """

    name: str
    module: str
    slow: bool = False

    def load(self):
        """Its module."""
        return importlib.import_module(f"bokeh_validation.engines.{self.module}")

    def changed(self) -> bool:
        """Whether a slow sample's files differ from those that it last passed with, here."""
        return self.load().changed()


ENGINES = {
    engine.name: engine
    for engine in (
        Engine("opengl", "opengl"),
        Engine("panda3d", "panda3d"),
        Engine("threejs-webgl", "threejs"),
        Engine("threejs-webgpu", "threejs"),
        Engine("direct3d9", "direct3d"),
        Engine("direct3d11", "direct3d"),
        Engine("bevy", "bevy", slow=True),
    )
}


def folder(engine: Engine) -> Path:
    """Where its capture goes, in the cache folder."""
    return paths.cache_folder() / "engines" / engine.name / "capture"


def run(name: str) -> Capture:
    """Build, run and compare one sample. Raises errors.Unavailable, RuntimeError with what the engine said, Broken."""
    engine = ENGINES[name]
    target = folder(engine)
    # what an earlier run left must not pass for this one's
    shutil.rmtree(target, ignore_errors=True)
    paths.ensured(target)
    engine.load().run(engine.name, target)
    return read(target)
