"""Build integration/wgpu from a copy in the cache folder with Cargo and run it on lavapipe, on a ray-traced scene.

The first build compiles wgpu: two minutes on two cores. Later ones take seconds.
"""

import json
from pathlib import Path

import numpy as np

from bokeh_validation import process
from engines import cargo, lavapipe

NAME = "wgpu"
EXAMPLE = "capture"
RUN_S = 120.0  # seconds; it takes 5


def run(name: str, folder: Path) -> None:
    """Run the sample, which writes its capture and picture.png to `folder`. Raises errors.Unavailable, RuntimeError."""
    scene = lavapipe.write_scene(folder)
    cargo.build(NAME, cargo.copied(NAME), "--example", EXAMPLE)
    process.run([cargo.program(NAME, EXAMPLE), folder], RUN_S, folder, environment())
    shape = (scene["height"], scene["width"], 4)
    lavapipe.write_picture(folder, [np.fromfile(folder / name, np.float16).reshape(shape) for name in _shown(folder)])


def environment() -> dict[str, str]:
    """Return the environment in which wgpu runs on lavapipe without messages on standard error. Raises
    errors.Unavailable.
    """
    return {"VK_ICD_FILENAMES": str(lavapipe.description()), "XDG_RUNTIME_DIR": "/tmp"}


def _shown(folder: Path) -> list[str]:
    """Return the files of the input and of the first result."""
    capture = json.loads((folder / "capture.json").read_text(encoding="utf-8"))
    return [capture["color"], capture["shots"][0]["result"]]
