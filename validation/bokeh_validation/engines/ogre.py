"""integration/ogre: built with g++ against the system's Ogre 1.12, run in a window that nobody sees."""

import shlex
import shutil
from pathlib import Path

from bokeh_validation import locks, paths, process
from bokeh_validation.engines import scripts
from bokeh_validation.errors import Unavailable

SAMPLE = paths.ROOT / "integration/ogre"
# For a shell in the sample's folder; ' -o PROGRAM' is added. It takes 4 s of one core.
BUILD = (
    "g++ -std=c++17 -O1 -Wall sample.cpp $(pkg-config --cflags --libs OGRE) "
    '-DOGRE_PLUGINS="\\"$(pkg-config --variable=plugindir OGRE)\\""'
)
NEEDED = "apt-get install -y g++ pkg-config libogre-1.12-dev"
BUILD_SECONDS, SECONDS = 300, 120


def run(name: str, folder: Path) -> None:
    """Leave the capture of the sample in `folder`. Raises errors.Unavailable, RuntimeError."""
    process.run([*command(), "--capture", folder], SECONDS, SAMPLE)


def command() -> list[str | Path]:
    """What runs the sample, in its folder; built if a source has changed. Raises errors.Unavailable, RuntimeError."""
    sources = sorted([*SAMPLE.glob("*.h"), *SAMPLE.glob("*.cpp")])
    return [*scripts.display(), locks.built_once("engines/ogre/program", [BUILD, *sources], _build) / "sample"]


def _build(folder: Path) -> None:
    if shutil.which("g++") is None or shutil.which("pkg-config") is None:
        raise Unavailable(f"no compiler; {NEEDED}")
    try:
        process.run(["pkg-config", "--exists", "OGRE >= 1.12", "OGRE < 1.13"], BUILD_SECONDS)
    except RuntimeError as error:
        raise Unavailable(f"Ogre 1.12 is not installed; {NEEDED}") from error
    process.run(["sh", "-c", f"{BUILD} -o {shlex.quote(str(folder / 'sample'))}"], BUILD_SECONDS, SAMPLE)
