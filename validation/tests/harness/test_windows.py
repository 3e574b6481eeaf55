"""fxc, the programs under Wine, and that nothing of them stays behind."""

import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from support import load, needed

from bokeh_validation import paths, shaders
from bokeh_validation.compilers import fxc
from bokeh_validation.shaders.passes import Pass
from bokeh_validation.windows import server, wine

COPY = Pass("BokehConstantCoC", {"ColorSamp": "color"}, "result")


@pytest.fixture
def compiler() -> fxc.Process:
    """fxc, or the end of the test."""
    with needed("fxc"):
        return fxc.load()


@pytest.fixture
def d3d9():
    """The Direct3D 9 driver, or the end of the test."""
    return load("d3d9")


def copied(driver) -> bool:
    """Whether a driver runs a pass as it should."""
    color = np.arange(48, dtype=np.float16).reshape(3, 4, 4)
    output = driver.run([COPY], {"color": color}, (4, 3))["result"]
    return np.array_equal(output[..., :3], color[..., :3])


class TestBudgets:
    """Shader model 3: 512 slots, 224 constants, 16 samplers, 32 temporaries."""

    @pytest.mark.parametrize(
        ("code", "words"),
        [
            ("dcl_2d s16\n" + "".join(f"texld r0, v0, s{i}\n" for i in range(17)), "17 samplers, 16 allowed"),
            ("".join(f"mov r{i}, c0\n" for i in range(33)), "33 temporaries, 32 allowed"),
            ("".join(f"mov r0, c{i}\n" for i in range(225)), "225 constants, 224 allowed"),
            ("// approximately 513 instruction slots used (1 texture, 512 arithmetic)", "513 instruction slots, 512"),
        ],
    )
    def test_each_limit(self, code, words):
        assert words in fxc.over_budget(fxc.facts(code), "ps_3_0")
        assert fxc.over_budget(fxc.facts(code), "ps_5_0") == ""


class TestFxc:
    """The compiler as a server."""

    def test_hang_and_crash_are_told_and_the_next_one_works(self, compiler, monkeypatch):
        monkeypatch.setattr(fxc, "COMPILE_S", 0.0)
        result = compiler.compile(shaders.hlsl(3), "ps_3_0", "BokehNaiveGrid_PS")
        assert not result.ok and result.messages == "fxc.exe hung: stopped after 0 s"
        monkeypatch.undo()
        assert compiler.compile(shaders.hlsl(3), "ps_3_0", "BokehNaiveGrid_PS").ok
        with monkeypatch.context() as patch:
            patch.setattr(server.Server, "start", lambda self: None)
            os.killpg(compiler._server._process.pid, signal.SIGKILL)
            result = compiler.compile(shaders.hlsl(3), "ps_3_0", "BokehDebug_PS")
        assert not result.ok and result.messages == "fxc.exe crashed"
        assert compiler.compile(shaders.hlsl(3), "ps_3_0", "BokehDebug_PS").ok


class TestDirect3D:
    """The runners as servers."""

    @pytest.mark.parametrize("line", ["drow 1", "input 16 0 linear", "input 0 7 linear", "values" + 41 * " 1.0"])
    def test_a_wrong_line_is_told(self, line, d3d9):
        d3d9.ask("clear")
        with pytest.raises(RuntimeError, match=f"cannot use '{line}'|array::at|map::at"):
            d3d9.ask(line)
        assert copied(d3d9)

    def test_dead_wine_server(self, d3d9):
        wine.get().end_programs()
        # it may be seen before the request, where it is started again, or during it
        with suppress(RuntimeError):
            copied(d3d9)
        assert copied(d3d9)


def running(prefix: Path) -> list[str]:
    """Command lines of processes whose environment names a Wine prefix."""
    found = []
    for folder in Path("/proc").iterdir():
        try:
            if f"WINEPREFIX={prefix}\0".encode() in (folder / "environ").read_bytes():
                found.append((folder / "cmdline").read_bytes().replace(b"\0", b" ").decode("utf-8", "replace"))
        except OSError:
            pass
    return found


SCRIPT = """
import os, signal, sys
from bokeh_validation import drivers
from bokeh_validation.windows import wine
driver = drivers.load("d3d9")
print(wine.get().prefix, wine.get().environment["DISPLAY"], flush=True)
if sys.argv[1] == "kill":
    os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.parametrize("end", ["exit", "kill"])
def test_nothing_is_left_running(end, d3d9):
    """After an end as it should be, and after a kill, when there is no one left to clean up."""
    environment = {**os.environ, "PYTHONPATH": str(paths.VALIDATION)}
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, end], env=environment, capture_output=True, text=True, timeout=200
    )
    prefix, display = done.stdout.split()
    assert Path(prefix) != wine.get().prefix, "two runs must not share a prefix"
    deadline, left = time.monotonic() + 30, ["?"]
    while left and time.monotonic() < deadline:
        time.sleep(0.2)
        left = running(Path(prefix)) + [lock for lock in Path("/tmp").glob(f".X{display[1:]}-lock")]
    assert not left
    assert copied(d3d9)


def test_a_break_that_is_never_taken():
    """Seen of fxc: a `break` that compares a register with itself. The right one compares 1 with -1."""
    listing = "ps_3_0\nrep i0\n  if_ge r4.w, -r0.w\n    break_ne {}\n  endif\nendrep\n"
    assert "never taken" in fxc.dead_break(listing.format("-c0.w, -c0.w"))
    assert fxc.dead_break(listing.format("c3.x, -c3.x")) == ""
