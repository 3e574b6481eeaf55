"""Work for several processes, each with drivers, a browser and a Wine of its own."""

import atexit
import json
import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool

from bokeh_validation import files, paths
from bokeh_validation.errors import UserError

# a function of a module and its arguments; both and the result go from one process to another
Job = tuple[Callable, tuple]

CORES = os.cpu_count() or 1
PROCESSES = min(CORES, 4)
# In the cache folder: seconds of each job
DURATIONS = "durations.json"


def run(jobs: Sequence[Job], step: Callable[[str], None]) -> list:
    """Return the results in the order of the jobs. Those that took longest here the last time begin first.

    step  called after each job with its first argument
    """
    known = _durations()
    ordered = sorted(range(len(jobs)), key=lambda index: -known.get(_name(jobs[index]), 1.0))
    results, taken = [None] * len(jobs), {}
    with ProcessPoolExecutor(PROCESSES, multiprocessing.get_context("spawn"), _begin) as pool:
        try:
            waiting = {pool.submit(_timed, *jobs[index]): index for index in ordered}
            for future in as_completed(waiting):
                job = jobs[waiting[future]]
                taken[_name(job)], results[waiting[future]] = future.result()
                step(str(job[1][0]))
        except BrokenProcessPool as error:
            raise UserError("a driver or compiler took its process with it. Try validation/run probes.") from error
        except BaseException:
            for child in multiprocessing.active_children():
                child.terminate()
            raise
    _keep(known | taken)
    return results


def _name(job: Job) -> str:
    """The name that a job's duration is kept by: its function and its first argument."""
    function, arguments = job
    return f"{function.__module__}.{function.__qualname__} {arguments[0]}"


def _timed(function: Callable, arguments: tuple) -> tuple[float, object]:
    """Seconds, and the function's result."""
    started = time.monotonic()
    result = function(*arguments)
    return round(time.monotonic() - started, 2), result


def _durations() -> dict[str, float]:
    """Name of a job -> its seconds the last time; nothing where that cannot be read."""
    try:
        return json.loads((paths.cache_folder() / DURATIONS).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}


def _keep(durations: dict[str, float]) -> None:
    """Keep the durations for the next run."""
    text = json.dumps(durations, indent=0, sort_keys=True)
    file = paths.ensured(paths.cache_folder()) / DURATIONS
    files.whole(file, lambda partial: partial.write_text(text, encoding="utf-8"))


def _begin() -> None:
    """Give a new process an end of its own."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, lambda *_: _leave())
    # runs after all that is registered later, which ends browsers and Wine
    atexit.register(_leave)


def _leave() -> None:
    end_programs()
    os._exit(0)


def end_programs() -> None:
    """To be called before os._exit(), which runs no exit handlers: end Wine and its display, if they were used at all.

    Mesa's and wgpu's libraries tear down in an order of their own, so nothing here ends in another way.
    """
    windows = sys.modules.get("bokeh_validation.windows.wine")
    if windows:
        windows.stop()
