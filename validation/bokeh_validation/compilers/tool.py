"""Command line compilers: found, run with a time limit, and their end told as it was."""

import shutil
import signal
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from bokeh_validation.errors import Unavailable

TIMEOUT = 30.0  # seconds; what runs here takes 0.05


@dataclass(frozen=True)
class Finished:
    """One run of a tool.

    ok      it ended by itself with exit status 0
    output  standard output and error; after a crash or a hang it begins with a line that says so
    files   contents of the files that were asked for and written, by name
    """

    ok: bool
    output: str
    files: dict[str, bytes] = field(default_factory=dict)


def find(name: str, install: str) -> str:
    """Path of a program. Raises Unavailable with the install command when there is none."""
    path = shutil.which(name)
    if path is None:
        raise Unavailable(f"{name} is not on this machine; {install}")
    return path


def run(
    program: str,
    arguments: Sequence[str],
    inputs: Mapping[str, bytes] | None = None,
    outputs: Sequence[str] = (),
    timeout: float = TIMEOUT,
) -> Finished:
    """Run a program in a temporary folder of its own.

    inputs   files to write there before, by name; arguments name them without a path, and so do the messages
    outputs  files to read from there afterwards
    """
    with tempfile.TemporaryDirectory(prefix="bokeh-") as name:
        folder = Path(name)
        for file, data in (inputs or {}).items():
            (folder / file).write_bytes(data)
        try:
            done = subprocess.run(
                [program, *arguments],
                cwd=folder,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                timeout=timeout,
            )
        except subprocess.TimeoutExpired as error:
            return Finished(False, _after(f"{Path(program).name} hung: stopped after {timeout:g} s", error.output))
        except OSError as error:
            return Finished(False, f"{Path(program).name} could not be started: {error}")
        if done.returncode < 0:
            return Finished(False, _after(f"{Path(program).name} crashed: {_signal(-done.returncode)}", done.stdout))
        files = {file: (folder / file).read_bytes() for file in outputs if (folder / file).is_file()}
        return Finished(done.returncode == 0, _text(done.stdout, tuple(inputs or ())), files)


def _signal(number: int) -> str:
    try:
        return f"signal {number} ({signal.Signals(number).name})"
    except ValueError:
        return f"signal {number}"


def _after(first: str, output: bytes | None) -> str:
    rest = _text(output or b"")
    return f"{first}\n{rest}" if rest else first


def _text(output: bytes, names: Sequence[str] = ()) -> str:
    """Output without blank lines and without the lines that only name an input, which glslang prints every time."""
    lines = output.decode("utf-8", "replace").splitlines()
    return "\n".join(line.rstrip() for line in lines if line.strip() and line.strip() not in names)
