"""The C programs of this folder, built with mingw-w64 into the cache folder on first use."""

import hashlib
import os
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

from bokeh_validation import locks, paths
from bokeh_validation.errors import Unavailable
from bokeh_validation.windows import wine

SOURCES = Path(__file__).resolve().parent
COMPILERS = ("x86_64-w64-mingw32-gcc", "x86_64-w64-mingw32-gcc-posix")
OPTIONS = ("-std=c11", "-O2", "-Wall", "-Wextra", "-static")
BUILD_S = 120.0


def _compiler() -> str:
    # on Windows the same compiler is called gcc
    for name in (*COMPILERS, *(("gcc",) if wine.ON_WINDOWS else ())):
        if path := shutil.which(name):
            return path
    raise Unavailable(f"{COMPILERS[0]} is not on this machine; {wine.INSTALL}")


@locks.one_at_a_time("windows")
def build(name: str, sources: Sequence[str], libraries: Sequence[str] = ()) -> Path:
    """NAME.exe from C files of this folder, in a folder of the cache that is keyed by all sources and options.

    sources    such as ['fxc.c']; headers of the folder count as well
    libraries  such as ['-ld3d9']
    Raises Unavailable without a compiler, RuntimeError with the compiler's words where it refuses.
    """
    hashed = hashlib.sha256(repr((OPTIONS, tuple(sources), tuple(libraries))).encode())
    for file in sorted({*(SOURCES / source for source in sources), *SOURCES.glob("*.h")}):
        hashed.update(file.read_bytes())
    folder = paths.cache_folder() / "windows" / f"{name}-{hashed.hexdigest()[:16]}"
    program = folder / f"{name}.exe"
    if program.exists():
        return program
    compiler = _compiler()
    paths.ensured(folder)
    partial = folder / f"{name}.{os.getpid()}.partial"
    command = [compiler, *OPTIONS, "-o", str(partial), *(str(SOURCES / source) for source in sources), *libraries]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=BUILD_S)
    except subprocess.TimeoutExpired as error:
        raise RuntimeError(f"building {name}.exe hung: stopped after {BUILD_S:g} s") from error
    if done.returncode:
        raise RuntimeError(f"{name}.exe could not be built:\n{done.stderr.strip()}")
    partial.replace(program)
    return program
