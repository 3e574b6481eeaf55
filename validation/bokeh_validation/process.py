"""Find and run programs: in their own process group, with a time limit, leaving no files behind. Hold back signals."""

import os
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import wraps
from pathlib import Path

from bokeh_validation import paths
from bokeh_validation.errors import Unavailable

# Number of the output's last lines that an error message repeats
LAST_LINES = 15


def run(
    command: Sequence[str | Path], seconds: float, folder: Path | None = None, extra: Mapping[str, str] | None = None
) -> str:
    """Run a command and return its output, both streams together.

    seconds  time limit
    folder   working directory
    extra    additional environment variables

    Python's and Mesa's caches are placed in the cache folder. Raises RuntimeError with the last lines of the output if
    the command fails or exceeds the time limit; its child processes are ended too.
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
    """Kill the process and its children, which form one process group."""
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Hold back an interruption until the block ends: C code that calls Python can crash when such a call raises.

    Only the main thread handles signals; in other threads this does nothing.
    """
    received, handlers = [], {}
    if threading.current_thread() is threading.main_thread():
        for number in (signal.SIGINT, signal.SIGTERM):
            handlers[number] = signal.signal(number, lambda number, _: received.append(number))
    try:
        yield
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)
        for number in received[:1]:
            signal.raise_signal(number)


def find(name: str, install: str) -> str:
    """Return the path of a program. Raises Unavailable with `install`, how to install it, if there is none."""
    path = shutil.which(name)
    if path is None:
        raise Unavailable(f"{name} is not on this machine; {install}")
    return path


def once(make: Callable) -> Callable:
    """Decorate a function without arguments so that it runs once per process; an Unavailable that it raises is
    remembered too.
    """
    lock, outcome = threading.Lock(), []

    @wraps(make)
    def remembered():
        with lock:
            if not outcome:
                try:
                    outcome.append(make())
                except Unavailable as error:
                    outcome.append(error)
                except ImportError as error:
                    outcome.append(Unavailable(f"{error.name} is not installed; validation/run sets it up"))
        if isinstance(outcome[0], Unavailable):
            raise outcome[0]
        return outcome[0]

    return remembered


def end_programs() -> None:
    """End Wine and its display if they were used; call this before os._exit(), which runs no exit handlers.

    The program ends with os._exit() because Mesa's and wgpu's libraries clean up in an order that it does not control.
    """
    windows = sys.modules.get("bokeh_validation.windows.wine")
    if windows:
        windows.stop()
