"""A child process with a time limit, that can be stopped from another thread."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from threading import Event

# How often is looked whether it has ended, and how long it has to end by itself, with its browser and Wine
LOOK_S, ASKED_S = 0.1, 5.0


class Stopped(Exception):
    """The run is to end: this child did not start, or was ended."""


def run(
    command: Sequence[str], seconds: float, stop: Event, said: Path, folder: Path, environment: Mapping[str, str]
) -> int:
    """Exit code of a command that runs in `folder`; what it prints goes to the file `said`.

    Raises Stopped where `stop` is set, and TimeoutError after `seconds`: then it and its children have ended.
    """
    if stop.is_set():
        raise Stopped
    # to a file: the end of a pipe is there only when the last of its children has closed it
    with said.open("wb") as file:
        process = subprocess.Popen(
            command,
            cwd=folder,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=file,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
    end = time.monotonic() + seconds
    try:
        while process.poll() is None:
            if stop.wait(LOOK_S):
                raise Stopped
            if time.monotonic() > end:
                raise TimeoutError(f"no end within {seconds} s")
        return process.returncode
    finally:
        if process.returncode is None:
            _end(process)


def _end(process: subprocess.Popen) -> None:
    """Interrupt it, then kill its process group.

    Chromium and Wine are in groups of their own. They end in the exit handlers of a process that is interrupted, and
    by themselves once their pipes from a process that was killed are closed.
    """
    if sys.platform == "win32":
        process.kill()
    else:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(ASKED_S)
        except subprocess.TimeoutExpired:
            pass
        try:
            os.killpg(process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass  # none is left in the group
    process.wait()
