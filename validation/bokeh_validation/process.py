"""Find and run programs: each in a process of its own, with a time limit, and with nothing written beside it."""

import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import wraps
from pathlib import Path
from threading import Lock

from bokeh_validation import paths
from bokeh_validation.errors import Unavailable

# Lines of the program's output that an error repeats
LAST_LINES = 15


def run(
    command: Sequence[str | Path], seconds: float, folder: Path | None = None, extra: Mapping[str, str] | None = None
) -> str:
    """Run a command and return what it said, both streams. `folder` is where it runs, `extra` more environment.

    Raises RuntimeError with its last words where it fails or takes longer than `seconds`; its children end with it.
    The caches of Python and Mesa are in the cache folder.
    """
    cache, words = paths.ensured(paths.cache_folder()), [str(part) for part in command]
    environment = {"XDG_RUNTIME_DIR": str(cache), **os.environ, "PYTHONPYCACHEPREFIX": str(cache / "pycache")}
    environment |= {"MESA_SHADER_CACHE_DIR": str(cache / "mesa"), **(extra or {})}
    process = subprocess.Popen(
        words, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        text=True, errors="replace", start_new_session=True,
    )  # fmt: skip
    failed = ""
    try:
        output, _ = process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        _end(process)
        output, failed = process.communicate()[0], f"not done after {seconds:.0f} s"
    except BaseException:
        _end(process)
        raise
    if failed or process.returncode:
        name = " ".join(Path(part).name for part in words[:2])
        last = "\n".join(output.strip().splitlines()[-LAST_LINES:])
        raise RuntimeError(f"{name}: {failed or f'exit code {process.returncode}'}\n{last}")
    return output


def _end(process: subprocess.Popen) -> None:
    """The process and its children, which are a group of their own."""
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def find(name: str, install: str) -> str:
    """Path of a program. Raises Unavailable with the install command when there is none."""
    path = shutil.which(name)
    if path is None:
        raise Unavailable(f"{name} is not on this machine; {install}")
    return path


def once(make: Callable) -> Callable:
    """Decorator: what lives in this process is made on first use, and where it is missing, that is remembered too."""
    lock, made = Lock(), []

    @wraps(make)
    def remembered():
        with lock:
            if not made:
                try:
                    made.append(make())
                except Unavailable as error:
                    made.append(error)
                except ImportError as error:
                    made.append(Unavailable(f"{error.name} is not installed; validation/run sets it up"))
        if isinstance(made[0], Unavailable):
            raise made[0]
        return made[0]

    return remembered


def end_programs() -> None:
    """To be called before os._exit(), which runs no exit handlers: end Wine and its display, if they were used at all.

    Mesa's and wgpu's libraries tear down in an order of their own, so nothing here ends in another way.
    """
    windows = sys.modules.get("bokeh_validation.windows.wine")
    if windows:
        windows.stop()
