"""Hold a compiler's result, and run command-line compilers with a time limit."""

import os
import signal
import subprocess
import sysconfig
import tempfile
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from bokeh_validation import process

# Folder in which wheels install Khronos's compilers, next to the compilers' libraries
WHEELS = Path(sysconfig.get_path("purelib"), "cmeel.prefix")

TIMEOUT = 30.0  # seconds; these compilers take 0.05


@dataclass(frozen=True)
class CompileResult:
    """Hold the outcome of one compilation; `facts` are counts that the compiler reports, such as slots."""

    ok: bool
    messages: str = ""
    binary: bytes = b""
    facts: dict[str, int] = field(default_factory=dict)


def accepted(messages: str, binary: bytes = b"", facts: Mapping[str, int] | None = None) -> CompileResult:
    """Return a successful result; its messages are warnings."""
    return CompileResult(True, messages.strip(), binary, dict(facts or {}))


def refused(messages: str) -> CompileResult:
    """Return a failed result."""
    return CompileResult(False, messages.strip() or "refused without a message")


@dataclass(frozen=True)
class Tool:
    """Describe a command-line compiler.

    install  the command that installs it
    option   makes it print its version
    """

    name: str
    install: str
    option: str = "--version"

    def version(self) -> str:
        """Return the first line of the version that it prints. Raises Unavailable."""
        return self.run([self.option]).messages.partition("\n")[0]

    def _found(self) -> tuple[str, dict[str, str]]:
        """Return the program and its environment: from a wheel of the lock file, else from PATH. Raises Unavailable."""
        program = WHEELS / "bin" / self.name
        if not program.is_file():
            return process.find(self.name, self.install), dict(os.environ)
        variables = {name: str(WHEELS / "lib") for name in ("LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH")}
        return str(program), {**os.environ, **variables}

    def run(
        self, arguments: Sequence[str], inputs: Mapping[str, bytes] | None = None, output: str = ""
    ) -> CompileResult:
        """Run it in a temporary folder and return its messages, and the file `output` if it is to write one.

        inputs  files to put there first, by name; arguments and messages name them without a path

        After a crash or a hang the messages begin with a line that says so. Raises Unavailable.
        """
        (program, environment), inputs = self._found(), inputs or {}
        with tempfile.TemporaryDirectory(prefix="bokeh-") as folder:
            for file, data in inputs.items():
                Path(folder, file).write_bytes(data)
            options = {
                "cwd": folder,
                "env": environment,
                "stdin": subprocess.DEVNULL,
                "stderr": subprocess.STDOUT,
                "timeout": TIMEOUT,
            }
            try:
                done = subprocess.run([program, *arguments], stdout=subprocess.PIPE, **options)
            except subprocess.TimeoutExpired as error:
                return refused(f"{self.name} hung: stopped after {TIMEOUT:g} s\n{_text(error.output or b'', inputs)}")
            text, written = _text(done.stdout, inputs), Path(folder, output)
            if done.returncode < 0:
                cause = signal.strsignal(-done.returncode)
                return refused(f"{self.name} crashed: signal {-done.returncode} ({cause})\n{text}")
            if done.returncode:
                return refused(text)
            binary = written.read_bytes() if output and written.is_file() else b""
        if output and not binary.strip():
            return refused(f"{self.name} ended well but wrote nothing\n{text}")
        return accepted(text, binary)


def _text(output: bytes, names: Collection[str]) -> str:
    """Return the output without blank lines, and without lines that only name an input, which glslang always prints."""
    lines = output.decode("utf-8", "replace").splitlines()
    return "\n".join(line.rstrip() for line in lines if line.strip() and line.strip() not in names)
