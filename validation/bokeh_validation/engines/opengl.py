"""integration/opengl: a renderer in Python and moderngl, off screen through EGL."""

import sys
from pathlib import Path

from bokeh_validation import paths
from bokeh_validation.drivers import gl
from bokeh_validation.engines import process

SAMPLE = paths.ROOT / "integration/opengl"
SECONDS = 120


def require() -> None:
    """Raises errors.Unavailable, with the install line, where there is no OpenGL 3.3 without a window."""
    gl.EGL().context.release()


def run(name: str, folder: Path) -> None:
    """Leave the capture of the sample `name` in `folder`. Raises errors.Unavailable, RuntimeError."""
    require()
    process.run([sys.executable, SAMPLE / "capture.py", folder], SECONDS)
