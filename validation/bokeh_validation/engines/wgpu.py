"""integration/wgpu: built by Cargo from a copy in the cache folder, run on lavapipe on a scene that it is handed.

The first build compiles wgpu: two minutes on two cores. Later ones take seconds.
"""

import json
from pathlib import Path

import numpy as np

from bokeh_validation import process
from bokeh_validation.engines import cargo, lavapipe

NAME = "wgpu"
EXAMPLE = "capture"
RUN_S = 120.0  # takes 5


def run(name: str, folder: Path) -> None:
    """Leave the capture of the sample, and picture.png, in `folder`. Raises errors.Unavailable, RuntimeError."""
    scene = lavapipe.write_scene(folder)
    cargo.build(NAME, cargo.copied(NAME), "--example", EXAMPLE)
    process.run([cargo.program(NAME, EXAMPLE), folder], RUN_S, folder, environment())
    shape = (scene["height"], scene["width"], 4)
    lavapipe.write_picture(folder, [np.fromfile(folder / name, np.float16).reshape(shape) for name in _shown(folder)])


def environment() -> dict[str, str]:
    """What a program of wgpu needs to run on lavapipe without a word on standard error. Raises errors.Unavailable."""
    return {"VK_ICD_FILENAMES": str(lavapipe.description()), "XDG_RUNTIME_DIR": "/tmp"}


def _shown(folder: Path) -> list[str]:
    """The files of the input and of the first result."""
    capture = json.loads((folder / "capture.json").read_text(encoding="utf-8"))
    return [capture["color"], capture["shots"][0]["result"]]
