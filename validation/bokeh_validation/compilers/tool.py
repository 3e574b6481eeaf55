"""What a compiler says of a shader; compilers on the command line, run with a time limit."""

import re
import shutil
import signal
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, wraps
from pathlib import Path
from threading import Lock
from typing import TypeVar

from bokeh_validation.errors import Unavailable

T = TypeVar("T")

TIMEOUT = 30.0  # seconds; what runs here takes 0.05


@dataclass(frozen=True)
class CompileResult:
    """Outcome of one compilation; `facts` holds what the compiler says of its output (slots, warnings)."""

    ok: bool
    messages: str = ""
    binary: bytes = b""
    facts: dict[str, int] = field(default_factory=dict)


def accepted(messages: str, binary: bytes = b"", facts: Mapping[str, int] | None = None) -> CompileResult:
    """A result that is ok. What was printed all the same are warnings: their lines are counted in facts."""
    lines = messages.strip().splitlines()
    return CompileResult(
        True, messages.strip(), binary, {**(facts or {}), **({"warnings": len(lines)} if lines else {})}
    )


def refused(messages: str) -> CompileResult:
    """A result that is not ok."""
    return CompileResult(False, messages.strip() or "refused without a message")


@dataclass(frozen=True)
class Finished:
    """One run of a program.

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
        options = {"cwd": folder, "stdin": subprocess.DEVNULL, "stderr": subprocess.STDOUT, "timeout": timeout}
        try:
            done = subprocess.run([program, *arguments], stdout=subprocess.PIPE, **options)
        except subprocess.TimeoutExpired as error:
            hung = f"{name} hung: stopped after {timeout:g} s\n".encode()
            return Finished(False, _text(hung + (error.output or b"")))
        except OSError as error:
            return Finished(False, f"{name} could not be started: {error}")
        if done.returncode < 0:
            cause = f"{name} crashed: signal {-done.returncode} ({signal.strsignal(-done.returncode)})\n"
            return Finished(False, _text(cause.encode() + done.stdout))
        files = {file: Path(folder, file) for file in outputs}
        written = {file: path.read_bytes() for file, path in files.items() if path.is_file()}
        return Finished(done.returncode == 0, _text(done.stdout, inputs), written)


def _text(output: bytes, names: Sequence[str] | Mapping = ()) -> str:
    """Output without blank lines and without the lines that only name an input, which glslang prints every time."""
    lines = output.decode("utf-8", "replace").splitlines()
    return "\n".join(line.rstrip() for line in lines if line.strip() and line.strip() not in names)


@dataclass(frozen=True)
class Tool:
    """A compiler on the command line.

    install  the command that does
    option   makes it print its version, which `pattern` finds
    """

    name: str
    install: str
    option: str
    pattern: str

    def run(self, *arguments) -> Finished:
        """See run(). Raises Unavailable."""
        return run(find(self.name, self.install), *arguments)

    def version(self) -> str:
        """Such as 2023.1. Raises Unavailable."""
        match = re.search(self.pattern, self.run([self.option]).output, re.MULTILINE)
        return match[1] if match else "unknown"

    def compile(self, arguments: Sequence[str], inputs: Mapping[str, bytes], output: str = "") -> CompileResult:
        """What it says, and the file that it was to write, if any. Raises Unavailable."""
        done = self.run(arguments, inputs, [output] if output else [])
        if not done.ok:
            return refused(done.output)
        binary = done.files.get(output, b"")
        if output and not binary.strip():
            return refused(f"{self.name} ended well but wrote nothing\n{done.output}")
        return accepted(done.output, binary)


def once(make: Callable[[], T]) -> Callable[[], T]:
    """Decorator: what lives in this process is made on first use, and where it is missing, that is remembered too."""
    lock = Lock()

    @cache
    def attempt() -> T | Unavailable:
        try:
            return make()
        except Unavailable as error:
            return error
        except ImportError as error:
            return Unavailable(f"{error.name} is not installed; validation/run sets it up")

    @wraps(make)
    def remembered() -> T:
        with lock:
            result = attempt()
        if isinstance(result, Unavailable):
            raise result
        return result

    return remembered
