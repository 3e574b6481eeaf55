"""Share drivers, each created once, and the command line between tests. A missing tool fails a test only under CI."""

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout, suppress
from io import StringIO
from pathlib import Path
from unittest.mock import patch

import pytest

from bokeh_validation import cli, drivers, needs
from bokeh_validation.compilers import tool
from bokeh_validation.compilers.tool import CompileResult
from bokeh_validation.errors import Unavailable
from bokeh_validation.probes.outcomes import driver_or_reason

# One driver per language. OSMesa is the same device as EGL, and gave the same images on 237 targets
LANGUAGES = ("egl", "wgpu", "dxc")
# Additional drivers with --all: shader model 3 with its rounding and NaN, and another device
NIGHTLY = ("d3d9", "webgl2")
nightly = pytest.mark.nightly
DRIVERS = [*LANGUAGES, *(pytest.param(name, marks=nightly) for name in NIGHTLY)]
# Seconds after which a test gives up on a program that hangs: minutes, since no test requires a speed
HANG = 300.0
in_each_language = pytest.mark.parametrize("driver", LANGUAGES, indirect=True)


def assert_ended(file: str, text: str, lock: str = "") -> None:
    """Wait until no process has the text in this file of /proc (environ, cmdline), and the lock is no more."""
    end, left = time.monotonic() + HANG, [text]
    while left and time.monotonic() < end:
        time.sleep(0.1)
        left = list(Path("/").glob(lock)) if lock else []
        for process in Path("/proc").glob(f"[0-9]*/{file}"):
            with suppress(OSError):  # it has ended meanwhile
                left += [process] * (text.encode() in process.read_bytes())
    assert not left


@contextmanager
def needed(what: str) -> Iterator[None]:
    """Skip the test if what it needs is missing; under CI, fail it."""
    try:
        yield
    except Unavailable as error:
        if os.environ.get("CI"):
            pytest.fail(f"{what} is missing: {error}")
        pytest.skip(f"{what}: {error}")


def load(name: str) -> drivers.Driver:
    """Return a driver; skips the test if it is missing."""
    loaded = driver_or_reason(name)
    with needed(f"driver {name}"):
        if isinstance(loaded, str):
            raise Unavailable(loaded)
    return loaded


def spread(names: str, values, everywhere=(), nightly_drivers=()) -> pytest.MarkDecorator:
    """Parametrize a test with each value in one language, in turn, and with values of `everywhere` in all three.

    names   of the parameters, separated by commas; '': none, the test runs in one language
    values  of the parameter, or tuples for several of them
    With --all each value runs in every language and on `nightly_drivers`; values of `everywhere` on all of NIGHTLY.

    One language is enough for a value: parity compares the three texts statement by statement, and on 237 targets that
    two drivers drew, all on llvmpipe, results differed by at most half a step.
    """
    parameters, rows = [*filter(None, names.split(",")), "driver"], []
    for index, value in enumerate(values):
        for driver in (*LANGUAGES, *(NIGHTLY if value in everywhere else nightly_drivers)):
            by_default = driver == LANGUAGES[index % len(LANGUAGES)] or (value in everywhere and driver in LANGUAGES)
            row = (*(value if len(parameters) != 2 else (value,)), driver)
            rows.append(pytest.param(*row, marks=() if by_default else nightly, id="-".join(map(str, row))))
    return pytest.mark.parametrize(parameters, rows, indirect=["driver"])


def called(*arguments: object) -> subprocess.CompletedProcess:
    """Run a command in this process, which saves the second of a start, without ending the programs of other tests."""
    standard_output, standard_error = StringIO(), StringIO()
    with (
        redirect_stdout(standard_output),
        redirect_stderr(standard_error),
        patch.object(sys, "argv", ["run", *map(str, arguments)]),
        patch.object(cli.signal, "signal"),
        patch.object(cli, "end_programs"),
        patch.object(cli.os, "_exit") as ended,
    ):
        cli.main()
    return subprocess.CompletedProcess(
        arguments, *ended.call_args.args, standard_output.getvalue(), standard_error.getvalue()
    )


def says(result: CompileResult, text: str) -> bool:
    """Return whether a compiler failed with this text; spaces are ignored, since glslang changes the spaces of HLSL's
    #error.
    """
    return not result.ok and text.replace(" ", "") in result.messages.replace(" ", "")


def compiled(step: Callable[[], CompileResult]) -> CompileResult:
    """Return the result of a compiler; skips the test if it is missing."""
    with needed("compiler"):
        return step()


def disassembled(module: bytes) -> str:
    """Return a SPIR-V module as text."""
    disassembler = tool.Tool("spirv-dis", needs.install("glslang"))
    return compiled(lambda: disassembler.run(["a.spv"], {"a.spv": module})).messages


def refused(done: subprocess.CompletedProcess, words: list[str]) -> None:
    """Check for exit code 2, empty standard output, and one line on standard error with these words."""
    assert done.returncode == 2, done.stdout + done.stderr
    assert done.stdout == ""
    lines = done.stderr.strip().splitlines()
    assert len(lines) == 1 and lines[0].startswith("error: "), done.stderr
    for word in words:
        assert word in lines[0], lines[0]
