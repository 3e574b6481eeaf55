"""Build the C++ programs of this folder with mingw-w64 into the cache folder on first use."""

import shutil
from collections.abc import Iterable, Sequence
from pathlib import Path

from bokeh_validation import locks, process
from bokeh_validation.errors import Unavailable
from bokeh_validation.shaders.passes import PARAMETERS
from bokeh_validation.windows import wine

SOURCES = Path(__file__).resolve().parent
COMMAND = (
    "x86_64-w64-mingw32-g++", "-std=c++20", "-O2", "-Wall", "-Wextra", "-static", f"-DNUM_VALUES={len(PARAMETERS)}",
)  # fmt: skip
BUILD_S = 120.0


def build(name: str, library: str) -> Path:
    """Build NAME.exe from NAME.cpp and the headers of this folder; see compiled().

    library  linker option, such as '-ld3d9'
    """
    source = f"{name}.cpp"
    return compiled(name, (*COMMAND, source, library), [SOURCES / source, *SOURCES.glob("*.h")], SOURCES)


def compiled(name: str, command: Sequence[str], files: Iterable[Path], folder: Path) -> Path:
    """Return NAME.exe, built by a command of mingw-w64 in `folder` if any of `files` has changed; '-o PROGRAM' is
    appended.

    Raises Unavailable without a compiler, RuntimeError with the compiler's messages if it fails.
    """
    if shutil.which(command[0]) is None:
        raise Unavailable(f"{command[0]} is not on this machine; {wine.INSTALL}")

    def build_in(target: Path) -> None:
        process.run([*command, "-o", target / f"{name}.exe"], BUILD_S, folder)

    return locks.built_once(f"windows/{name}", [*command, *sorted(files)], build_in) / f"{name}.exe"
