"""integration/opengl, panda3d and raylib: scripts in Python, off screen. The last two have a virtual environment each,
with what their requirements.txt pins.
"""

import shutil
import sys
from pathlib import Path

from bokeh_validation import locks, paths, process
from bokeh_validation.drivers import gl
from bokeh_validation.errors import Unavailable

SECONDS, INSTALL_SECONDS = 120, 400


def run(name: str, folder: Path) -> None:
    """Leave the capture of a sample in `folder`. Raises errors.Unavailable, RuntimeError."""
    process.run([*command(name), paths.ROOT / "integration" / name / "capture.py", folder], SECONDS)


def command(name: str) -> list[str | Path]:
    """What runs a script of a sample. Raises errors.Unavailable, also where there is no OpenGL 3.3 without a window."""
    if name == "raylib":
        return [*display(), _interpreter(name)]
    gl.EGL().context.release()
    return [sys.executable if name == "opengl" else _interpreter(name)]


def display() -> list[str]:
    """What runs a program that has no OpenGL without a window. Raises errors.Unavailable, also where 3.3 is missing."""
    gl.EGL().context.release()
    if shutil.which("xvfb-run") is None:
        raise Unavailable("no display; apt-get install -y xvfb xauth libgl1 libgl1-mesa-dri")
    return ["xvfb-run", "-a"]


def requirements(name: str) -> Path:
    """The file with a sample's packages and their hashes."""
    return paths.ROOT / "integration" / name / "requirements.txt"


def _interpreter(name: str) -> Path:
    """Python with a sample's packages."""

    def install(folder: Path) -> None:
        pip = [folder / "bin/python", "-I", "-m", "pip", "install", "--disable-pip-version-check", "--no-input"]
        extra = {"PIP_CACHE_DIR": str(paths.cache_folder() / "pip")}
        try:
            process.run([sys.executable, "-I", "-m", "venv", folder], INSTALL_SECONDS)
            process.run([*pip, "--require-hashes", "-r", requirements(name)], INSTALL_SECONDS, extra=extra)
        except RuntimeError as error:
            package = requirements(name).read_text(encoding="utf-8").splitlines()[1].split()[0]
            last = str(error).splitlines()[-1]
            raise Unavailable(f"{package} is not to be had here ({last}); pip install {package}") from error

    ingredients = [requirements(name), sys.version, sys.base_prefix]
    return locks.built_once(f"engines/{name}/venv", ingredients, install) / "bin/python"
