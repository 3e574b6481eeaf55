"""Work for several processes, each with drivers, a browser and a Wine of its own."""

import atexit
import multiprocessing
import os
import signal
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool

from bokeh_validation.errors import UserError

# a function of a module and its arguments; both and the result go from one process to another
Job = tuple[Callable, tuple]

CORES = os.cpu_count() or 1
PROCESSES = min(CORES, 4)


def run(jobs: Sequence[Job], step: Callable[[str], None]) -> list:
    """Results in the order of the jobs, which begin in that order: those that take longest are best given first.

    step  called after each job with its first argument
    """
    with ProcessPoolExecutor(PROCESSES, multiprocessing.get_context("spawn"), _begin) as pool:
        try:
            waiting = {pool.submit(function, *arguments): arguments[0] for function, arguments in jobs}
            for future in as_completed(waiting):
                future.result()
                step(str(waiting[future]))
            return [future.result() for future in waiting]
        except BrokenProcessPool as error:
            raise UserError("a driver or compiler took its process with it. Try validation/run probes.") from error
        except BaseException:
            for child in multiprocessing.active_children():
                child.terminate()
            raise


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
