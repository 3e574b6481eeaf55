"""Running a sample: in a process of its own, with a time limit, and nothing written beside it."""

import os
import signal
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

from bokeh_validation import paths

# Lines of the engine's output that an error repeats
LAST_LINES = 15


def environment(extra: Mapping[str, str] | None = None) -> dict[str, str]:
    """The caller's, with the caches of Python and Mesa in the cache folder."""
    cache = paths.cache_folder()
    return {
        "XDG_RUNTIME_DIR": str(paths.ensured(cache)),
        **os.environ,
        "PYTHONPYCACHEPREFIX": str(cache / "pycache"),
        "MESA_SHADER_CACHE_DIR": str(cache / "mesa"),
        **(extra or {}),
    }


def run(
    command: Sequence[str | Path], seconds: float, folder: Path | None = None, extra: Mapping[str, str] | None = None
) -> str:
    """Run a command and return what it said, both streams. `folder` is where it runs, `extra` more environment.

    Raises RuntimeError with its last words where it fails or takes longer than `seconds`; its children end with it.
    """
    process = subprocess.Popen(
        [str(part) for part in command],
        cwd=folder,
        env=environment(extra),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        start_new_session=True,
    )
    try:
        said, _ = process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        _end(process)
        said, _ = process.communicate()
        raise RuntimeError(f"{_named(command)}: not done after {seconds:.0f} s\n{_last(said)}") from None
    except BaseException:
        _end(process)
        raise
    if process.returncode:
        raise RuntimeError(f"{_named(command)}: exit code {process.returncode}\n{_last(said)}")
    return said


def _end(process: subprocess.Popen) -> None:
    """The process and its children, which are a group of their own."""
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def _named(command: Sequence[str | Path]) -> str:
    return " ".join(Path(part).name for part in command[:2])


def _last(said: str) -> str:
    return "\n".join(said.strip().splitlines()[-LAST_LINES:])
