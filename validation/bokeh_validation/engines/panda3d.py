"""integration/panda3d: Panda3D in a virtual environment of its own, off screen through EGL."""

import hashlib
import shutil
import sys
from pathlib import Path

from bokeh_validation import locks, paths
from bokeh_validation.engines import opengl, process
from bokeh_validation.errors import Unavailable

SAMPLE = paths.ROOT / "integration/panda3d"
REQUIREMENTS = SAMPLE / "requirements.txt"
SECONDS = 120
INSTALL_SECONDS = 400


@locks.one_at_a_time("panda3d")
def python() -> Path:
    """Interpreter of the environment that has Panda3D; made on first use. Raises errors.Unavailable."""
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


def run(name: str, folder: Path) -> None:
    """Leave the capture of the sample `name` in `folder`. Raises errors.Unavailable, RuntimeError."""
    opengl.require()
    process.run([python(), SAMPLE / "capture.py", folder], SECONDS)
