"""Run integration/bevy: build a copy in the cache folder with Cargo and run it without a window on lavapipe.

The first build compiles Bevy, which takes about 15 minutes on two cores and 1.5 GB. Later ones take seconds.
"""

from pathlib import Path

from bokeh_validation import process
from engines import cargo, lavapipe

NAME = "bevy"
EXAMPLE = "scene"
RUN_S = 300.0  # seconds; it takes 10 to 30 on two cores


def run(name: str, folder: Path) -> None:
    """Run the sample, which writes its capture to `folder`. Raises errors.Unavailable, RuntimeError."""
    cargo.build(NAME, cargo.copied(NAME), "--example", EXAMPLE)
    capture(cargo.program(NAME, EXAMPLE), folder)


def capture(program: Path, folder: Path) -> None:
    """Run a built sample, which writes its capture to `folder`. Raises errors.Unavailable, RuntimeError."""
    extra = {"VK_ICD_FILENAMES": str(lavapipe.description()), "BEVY_ASSET_ROOT": str(folder)}
    process.run([program, folder], RUN_S, folder, extra)


def built() -> bool:
    """Return whether it was built here before, so that the next build takes seconds."""
    return cargo.program(NAME, EXAMPLE).exists()
