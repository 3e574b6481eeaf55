"""The programs of this folder, in C++, built with mingw-w64 into the cache folder on first use."""

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
    """NAME.exe from NAME.cpp of this folder and its headers, and a library, such as '-ld3d9'; see compiled()."""
    source = f"{name}.cpp"
    return compiled(name, (*COMMAND, source, library), [SOURCES / source, *SOURCES.glob("*.h")], SOURCES)


def compiled(name: str, command: Sequence[str], files: Iterable[Path], folder: Path) -> Path:
    """NAME.exe by a command of mingw-w64 in `folder`; '-o PROGRAM' is added. Built anew when one of `files` changes.

    Raises Unavailable without a compiler, RuntimeError with the compiler's words where it refuses.
    """
    if shutil.which(command[0]) is None:
        raise Unavailable(f"{command[0]} is not on this machine; {wine.INSTALL}")

    def build_in(target: Path) -> None:
        process.run([*command, "-o", target / f"{name}.exe"], BUILD_S, folder)

    return locks.built_once(f"windows/{name}", [*command, *sorted(files)], build_in) / f"{name}.exe"
