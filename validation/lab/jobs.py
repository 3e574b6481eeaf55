"""Run work in several processes, each with its own drivers and browser."""

import atexit
import multiprocessing
import os
import signal
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool

from bokeh_validation.errors import UserError
from bokeh_validation.process import end_programs
from bokeh_validation.run.session import PROCESSES

# a function of a module and its arguments; both, and the result, are passed between processes
Job = tuple[Callable, tuple]


def run(jobs: Sequence[Job], step: Callable[[str], None]) -> list:
    """Return the results in the order of the jobs; `step` is called after each with its first argument."""
    with ProcessPoolExecutor(PROCESSES, multiprocessing.get_context("spawn"), _begin) as pool:
        try:
            waiting = {pool.submit(*_flat(job)): job for job in jobs}
            for future in as_completed(waiting):
                future.result()
                step(str(waiting[future][1][0]))
        except BrokenProcessPool as error:
            raise UserError("a driver took its process with it. Try validation/run doctor.") from error
        except BaseException:
            for child in multiprocessing.active_children():
                child.terminate()
            raise
    return [future.result() for future in waiting]


def _flat(job: Job) -> tuple:
    function, arguments = job
    return function, *arguments


def _begin() -> None:
    """Set up how a new worker process ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, lambda *_: _leave())
    # runs after everything that is registered later, which ends browsers and Wine
    atexit.register(_leave)


def _leave() -> None:
    end_programs()
    os._exit(0)
