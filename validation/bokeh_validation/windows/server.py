"""A running program of this folder: lines to it, lines from it, each with a time limit (see serve.h)."""

import os
import queue
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
    """One program, started on the first request and again after it has crashed or hung.

    program   path of the .exe
    folder    its working directory, where data go; removed at the end
    greeting  what the program said of itself when it started
    """

    def __init__(self, program: Path):
        self.program = program
        self._temporary = tempfile.TemporaryDirectory(prefix="bokeh-")
        self.folder = Path(self._temporary.name)
        self._process: subprocess.Popen | None = None
        self._lines: queue.Queue[str | None] = queue.Queue()
        self._lock = threading.Lock()
        self.greeting = ""
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
                self._process.stdin.flush()
            kind, _, text = self._answer(timeout).partition(" ")
            return kind == "ok", text

    def _start(self) -> None:
        if self._process and self._process.poll() is None:
            return
        self._end()
        command, environment = [str(self.program)], None
        if not wine.ON_WINDOWS:
            owner = wine.get()
            command, environment = owner.command(self.program), owner.environment()
        self._process = subprocess.Popen(
            command, cwd=self.folder, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL, start_new_session=not wine.ON_WINDOWS,
        )  # fmt: skip
        self._lines = queue.Queue()
        threading.Thread(target=_read, args=(self._process.stdout, self._lines), daemon=True).start()
        try:
            kind, _, text = self._answer(START_S).partition(" ")
        except Ended as error:
            raise Unavailable(f"{error} while starting") from error
        if kind != "ready":
            self._end()
            raise Unavailable(f"{self.program.name}: {text or kind}")
        self.greeting = text

    def _answer(self, timeout: float) -> str:
        try:
            line = self._lines.get(timeout=timeout)
        except queue.Empty:
            self._end()
            raise Ended(f"{self.program.name} hung: stopped after {timeout:g} s") from None
        if line is None:
            status = "unknown"
            with suppress(subprocess.TimeoutExpired):
                status = self._process.wait(5)
            self._end()
            raise Ended(f"{self.program.name} crashed: exit status {status}")
        return line

    def _end(self) -> None:
        """End the program at once."""
        process, self._process = self._process, None
        if process is None:
            return
        if process.poll() is None:
            if wine.ON_WINDOWS:
                process.kill()
            else:
                # Wine's processes run in our own process group
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
        for pipe in (process.stdin, process.stdout):
            with suppress(OSError):
                pipe.close()

    def stop(self) -> None:
        """End the program and remove its folder."""
        with self._lock:
            if self._process and self._process.poll() is None:
                with suppress(OSError, subprocess.TimeoutExpired):
                    self._process.stdin.close()
                    self._process.wait(5)
            self._end()
            self._temporary.cleanup()


def _read(stream, lines: "queue.Queue[str | None]") -> None:
    """Lines of a stream into a queue, and None at its end."""
    with suppress(OSError, ValueError):
        for line in stream:
            lines.put(line.decode("utf-8", "replace").strip())
    lines.put(None)
