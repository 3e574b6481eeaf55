"""integration/love: a game in Lua, run by the system's LÖVE in a window that nobody sees."""

import shutil
from pathlib import Path

from bokeh_validation import paths, process
from bokeh_validation.engines import scripts
from bokeh_validation.errors import Unavailable

SAMPLE = paths.ROOT / "integration/love"
SECONDS, VERSION_SECONDS = 120, 20  # takes 5 s on two cores
VERSION = "11."


def run(name: str, folder: Path) -> None:
    """Leave the capture of the sample in `folder`. Raises errors.Unavailable, RuntimeError."""
    process.run([*command(), "--capture", folder], SECONDS)


def command() -> list[str | Path]:
    """What runs the sample. Raises errors.Unavailable."""
    program = shutil.which("love")
    if program is None:
        raise Unavailable("LÖVE is not installed; apt-get install -y love")
    output = process.run([program, "--version"], VERSION_SECONDS)
    if not output.startswith(f"LOVE {VERSION}"):
        raise Unavailable(f"{output.strip()}: the sample is for LÖVE {VERSION}x; apt-get install -y love")
    return [*scripts.display(), program, SAMPLE]
