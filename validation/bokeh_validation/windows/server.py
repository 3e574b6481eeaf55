"""A running program of this folder: lines to it, lines from it, each with a time limit (see serve.h)."""

import os
import select
import signal
import subprocess
import tempfile
import threading
from contextlib import suppress
from pathlib import Path

from bokeh_validation.errors import Unavailable
from bokeh_validation.windows import wine

START_S = 60.0


class Ended(Exception):
    """A program crashed or hung on a request. The text says which; the next request starts it anew."""


class Server:
    """One program, started on the first request and again after it has crashed or hung. Threads take turns.

    program   path of the .exe
    folder    its working directory, where data go; removed at the end
    greeting  what the program said of itself when it started
    """

    def __init__(self, program: Path):
        self.program = program
        self._temporary = tempfile.TemporaryDirectory(prefix="bokeh-")
        self.folder = Path(self._temporary.name)
        self._process: subprocess.Popen | None = None
        self._lock = threading.Lock()
        self.greeting = ""
        wine.get()  # ends after what runs in it
        wine.before_stop(self.stop)

    def start(self) -> None:
        """Start the program unless it runs. Raises Unavailable where it does not come up."""
        with self._lock:
            self._start()

    def ask(self, request: str, timeout: float) -> tuple[bool, str]:
        """(Whether the answer to a request was 'ok', its text). Raises Ended and Unavailable."""
        with self._lock:
            self._start()
            with suppress(OSError):  # where it is gone the missing answer tells
                self._process.stdin.write(request.encode("ascii") + b"\n")
            kind, _, text = self._answer(timeout).partition(" ")
            return kind == "ok", text

    def _start(self) -> None:
        if self._process and self._process.poll() is None:
            return
        self._end()
        owner = wine.get()
        self._process = subprocess.Popen(
            owner.command(self.program), cwd=self.folder, env=owner.environment(), stdin=subprocess.PIPE,
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, bufsize=0, start_new_session=True,
        )  # fmt: skip
        try:
            kind, _, text = self._answer(START_S).partition(" ")
        except Ended as error:
            raise Unavailable(f"{error} while starting") from error
        if kind != "ready":
            self._end()
            raise Unavailable(f"{self.program.name}: {text or kind}")
        self.greeting = text

    def _answer(self, timeout: float) -> str:
        """The next line. Once there is something to read, the whole of it follows."""
        stream = self._process.stdout
        if not select.select([stream], [], [], timeout)[0]:
            self._end()
            raise Ended(f"{self.program.name} hung: stopped after {timeout:g} s")
        line = stream.readline()
        if not line:
            status = "unknown"
            with suppress(subprocess.TimeoutExpired):
                status = self._process.wait(5)
            self._end()
            raise Ended(f"{self.program.name} crashed: exit status {status}")
        return line.decode("utf-8", "replace").strip()

    def _end(self) -> None:
        """End the program at once, with Wine's processes, which run in its process group."""
        process, self._process = self._process, None
        if process is None:
            return
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
        process.stdin.close()
        process.stdout.close()

    def stop(self) -> None:
        """End the program and remove its folder."""
        with self._lock:
            self._end()
            self._temporary.cleanup()
