"""What tests share: drivers, each made once, and the command line. What is missing fails under CI only."""

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from io import StringIO
from unittest.mock import patch

import pytest

from bokeh_validation import cli, drivers, needs
from bokeh_validation.compilers import tool
from bokeh_validation.compilers.tool import CompileResult
from bokeh_validation.errors import Unavailable
from bokeh_validation.probes.outcomes import driver_or_reason

# One of each language. OSMesa is EGL's device, and on 237 targets their pictures are the same
LANGUAGES = ("egl", "wgpu", "dxc")
# With --all: the rounding and the NaN of shader model 3, and another device
NIGHTLY = ("d3d9", "webgl2")
nightly = pytest.mark.nightly
DRIVERS = [*LANGUAGES, *(pytest.param(name, marks=nightly) for name in NIGHTLY)]
in_each_language = pytest.mark.parametrize("driver", LANGUAGES, indirect=True)


@contextmanager
def needed(what: str) -> Iterator[None]:
    """The end of the test where what it needs is not there."""
    try:
        yield
    except Unavailable as error:
        if os.environ.get("CI"):
            pytest.fail(f"{what} is missing: {error}")
        pytest.skip(f"{what}: {error}")


def load(name: str) -> drivers.Driver:
    """A driver, or the end of the test."""
    found = driver_or_reason(name)
    with needed(f"driver {name}"):
        if isinstance(found, str):
            raise Unavailable(found)
    return found


def spread(name: str, values, everywhere=()) -> pytest.MarkDecorator:
    """Each value in one language, in turn; those of `everywhere` in all three. With --all each value is in each
    language, and those of `everywhere` are on the drivers of NIGHTLY too.

    One language is enough for a value: parity holds the three texts to each other statement by statement, and of 237
    targets that two of the drivers drew, all llvmpipe, none differed by more than half a step.
    """
    pairs = []
    for index, value in enumerate(values):
        for driver in (*LANGUAGES, *(NIGHTLY if value in everywhere else ())):
            by_default = driver == LANGUAGES[index % len(LANGUAGES)] or (value in everywhere and driver in LANGUAGES)
            pairs.append(pytest.param(value, driver, marks=() if by_default else nightly, id=f"{value}-{driver}"))
    return pytest.mark.parametrize((name, "driver"), pairs, indirect=["driver"])


def called(*arguments: object) -> subprocess.CompletedProcess:
    """A command in this process, which saves the second that a start takes. Programs of other tests go on."""
    said, told = StringIO(), StringIO()
    with (
        redirect_stdout(said),
        redirect_stderr(told),
        patch.object(sys, "argv", ["run", *map(str, arguments)]),
        patch.object(cli.signal, "signal"),
        patch.object(cli, "end_programs"),
        patch.object(cli.os, "_exit") as ended,
    ):
        cli.main()
    return subprocess.CompletedProcess(arguments, *ended.call_args.args, said.getvalue(), told.getvalue())


def says(result: CompileResult, text: str) -> bool:
    """Refused, with this text in the messages; glslang's HLSL puts spaces between the words of #error anew."""
    return not result.ok and text.replace(" ", "") in result.messages.replace(" ", "")


def compiled(step: Callable[[], CompileResult]) -> CompileResult:
    """Result of a compiler, if it is here."""
    with needed("compiler"):
        return step()


def disassembled(module: bytes) -> str:
    """The text of a SPIR-V module."""
    disassembler = tool.Tool("spirv-dis", needs.install("glslang"))
    return compiled(lambda: disassembler.run(["a.spv"], {"a.spv": module})).messages


def refused(done: subprocess.CompletedProcess, words: list[str]) -> None:
    """Exit code 2, nothing on standard output, one line on standard error with these words."""
    assert done.returncode == 2, done.stdout + done.stderr
    assert done.stdout == ""
    lines = done.stderr.strip().splitlines()
    assert len(lines) == 1 and lines[0].startswith("error: "), done.stderr
    for word in words:
        assert word in lines[0], lines[0]
