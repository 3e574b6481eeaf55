"""integration/opengl and panda3d: scripts in Python, off screen through EGL. Panda3D has a virtual environment of its
own.
"""

import hashlib
import shutil
import sys
from pathlib import Path

from bokeh_validation import locks, paths
from bokeh_validation.drivers import gl
from bokeh_validation.engines import process
from bokeh_validation.errors import Unavailable

REQUIREMENTS = paths.ROOT / "integration/panda3d/requirements.txt"
SECONDS, INSTALL_SECONDS = 120, 400


def run(name: str, folder: Path) -> None:
    """Leave the capture of 'opengl' or 'panda3d' in `folder`. Raises errors.Unavailable, RuntimeError."""
    process.run([python(name), paths.ROOT / "integration" / name / "capture.py", folder], SECONDS)


def python(name: str) -> Path:
    """Interpreter of a sample. Raises errors.Unavailable, also where there is no OpenGL 3.3 without a window."""
    gl.EGL().context.release()
    return Path(sys.executable) if name == "opengl" else _with_panda3d()


@locks.held("panda3d")
def _with_panda3d() -> Path:
    base = paths.cache_folder() / "engines/panda3d"
    # the lock file and the Python decide what is in it
    key = hashlib.sha256(REQUIREMENTS.read_bytes() + f"{sys.version}{sys.base_prefix}".encode()).hexdigest()[:16]
    target = base / f"venv-{key}"
    complete = target / "complete"
    if not complete.exists():
        for old in base.glob("venv-*"):
            shutil.rmtree(old)
        paths.ensured(base)
        try:
            process.run([sys.executable, "-I", "-m", "venv", target], INSTALL_SECONDS)
            pip = [target / "bin/python", "-I", "-m", "pip", "install", "--disable-pip-version-check", "--no-input"]
            extra = {"PIP_CACHE_DIR": str(paths.cache_folder() / "pip")}
            process.run([*pip, "--require-hashes", "-r", REQUIREMENTS], INSTALL_SECONDS, extra=extra)
        except RuntimeError as error:
            last = str(error).splitlines()[-1]
            raise Unavailable(f"Panda3D is not to be had here ({last}); pip install panda3d==1.10.16") from error
        complete.touch()
    return target / "bin/python"
