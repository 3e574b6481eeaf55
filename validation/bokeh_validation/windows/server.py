"""Talk to a running program of this folder: lines in both directions, with a time limit (see serve.h)."""

import os
import select
import signal
import subprocess
import tempfile
from contextlib import suppress
from pathlib import Path

from bokeh_validation.errors import Unavailable
from bokeh_validation.windows import wine

START_S = 60.0


class Server:
    """Run one program, started on the first request and again after it has crashed or hung.

    program   path of the .exe
    folder    its working directory, for data
    greeting  what the program reported when it started
    """

    def __init__(self, program: Path):
        self.program = program
        self.folder = Path(tempfile.mkdtemp(dir=wine.get().work))
        self.greeting = ""
        self._process: subprocess.Popen | None = None

    def start(self) -> None:
        """Start the program unless it is running. Raises Unavailable if it does not start."""
        if self._process and self._process.poll() is None:
            return
        self._end()
        owner = wine.get()
        self._process = subprocess.Popen(
            owner.command(self.program), cwd=self.folder, env=owner.environment, stdin=subprocess.PIPE,
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, bufsize=0, start_new_session=True,
        )  # fmt: skip
        try:
            kind, _, text = self._answer(START_S).partition(" ")
        except RuntimeError as error:
            raise Unavailable(f"{error} while starting") from error
        if kind != "ready":
            raise Unavailable(f"{self.program.name}: {text or kind}")
        self.greeting = text

    def ask(self, request: str, timeout: float) -> None:
        """Send a request and wait until it is done. Raises RuntimeError with the error, a crash or a hang, and
        Unavailable.
        """
        self.start()
        with suppress(OSError):  # if the program is gone, the missing answer says so
            self._process.stdin.write(request.encode("ascii") + b"\n")
        kind, _, text = self._answer(timeout).partition(" ")
        if kind != "ok":
            raise RuntimeError(f"{self.program.name}: {text}")

    def _answer(self, timeout: float) -> str:
        """Return the next line. Once any of it can be read, the rest follows."""
        stream = self._process.stdout
        answered = select.select([stream], [], [], timeout)[0]
        if line := stream.readline() if answered else b"":
            return line.decode("utf-8", "replace").strip()
        self._end()
        raise RuntimeError(f"{self.program.name} {'crashed' if answered else f'hung: stopped after {timeout:g} s'}")

    def _end(self) -> None:
        """Kill the program with Wine's processes, which are in its process group."""
        if self._process:
            with self._process, suppress(ProcessLookupError):
                os.killpg(self._process.pid, signal.SIGKILL)
            self._process = None
