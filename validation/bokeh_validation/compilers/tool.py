"""Command line compilers: found, run with a time limit, and their end told as it was. Others: made once."""

import shutil
import signal
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import wraps
from pathlib import Path
from threading import Lock
from typing import TypeVar

from bokeh_validation.compilers.result import CompileResult, accepted, refused
from bokeh_validation.errors import Unavailable

T = TypeVar("T")

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
    name, inputs = Path(program).name, inputs or {}
    with tempfile.TemporaryDirectory(prefix="bokeh-") as folder:
        for file, data in inputs.items():
            Path(folder, file).write_bytes(data)
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
            return Finished(
                False, _text(f"{name} hung: stopped after {timeout:g} s\n".encode() + (error.output or b""))
            )
        except OSError as error:
            return Finished(False, f"{name} could not be started: {error}")
        if done.returncode < 0:
            cause = f"{name} crashed: signal {-done.returncode} ({signal.strsignal(-done.returncode)})\n"
            return Finished(False, _text(cause.encode() + done.stdout))
        files = {file: Path(folder, file) for file in outputs}
        written = {file: path.read_bytes() for file, path in files.items() if path.is_file()}
        return Finished(done.returncode == 0, _text(done.stdout, inputs), written)


def compiled(program: str, arguments: Sequence[str], inputs: Mapping[str, bytes], output: str = "") -> CompileResult:
    """Run a compiler: what it says, and the file that it was to write, if any."""
    done = run(program, arguments, inputs, [output] if output else [])
    if not done.ok:
        return refused(done.output)
    binary = done.files.get(output, b"")
    if output and not binary.strip():
        return refused(f"{Path(program).name} ended well but wrote nothing\n{done.output}")
    return accepted(done.output, binary, {"bytes": len(binary)} if output else None)


def _text(output: bytes, names: Sequence[str] | Mapping = ()) -> str:
    """Output without blank lines and without the lines that only name an input, which glslang prints every time."""
    lines = output.decode("utf-8", "replace").splitlines()
    return "\n".join(line.rstrip() for line in lines if line.strip() and line.strip() not in names)


def once(make: Callable[[], T]) -> Callable[[], T]:
    """Decorator: what lives in this process is made on first use, and where it is missing, that is remembered too."""
    made: list[T | Unavailable] = []
    lock = Lock()

    @wraps(make)
    def remembered() -> T:
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
