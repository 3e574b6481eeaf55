"""Test fxc and the programs under Wine, and that nothing of them is left behind."""

import os
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pytest
from support import HANG, assert_ended, load, needed

from bokeh_validation import paths, shaders
from bokeh_validation.compilers import fxc
from bokeh_validation.shaders.passes import Pass
from bokeh_validation.windows import server, wine


def copied(driver) -> bool:
    """Return whether a driver runs a pass correctly."""
    color = np.arange(48, dtype=np.float16).reshape(3, 4, 4)
    output = driver.run([Pass("BokehConstantCoC", {"ColorSamp": "color"}, "result")], {"color": color}, (4, 3))
    return np.array_equal(output["result"][..., :3], color[..., :3])


@pytest.mark.parametrize(
    ("code", "words"),
    [
        ("dcl_2d s16\n" + "".join(f"texld r0, v0, s{i}\n" for i in range(17)), "17 samplers, 16 allowed"),
        ("".join(f"mov r{i}, c0\n" for i in range(33)), "33 temporaries, 32 allowed"),
        ("".join(f"mov r0, c{i}\n" for i in range(225)), "225 constants, 224 allowed"),
        ("// approximately 513 instruction slots used (1 texture, 512 arithmetic)", "513 instruction slots, 512"),
    ],
)
def test_each_limit(code, words):
    """Check the limits of shader model 3: 512 slots, 224 constants, 16 samplers, 32 temporaries."""
    assert words in fxc.over_budget(fxc.facts(code), "ps_3_0")
    assert fxc.over_budget(fxc.facts(code), "ps_5_0") == ""


def test_a_break_that_is_never_taken():
    """Check that a `break` that compares a register with itself is found, as fxc may write it; the correct one
    compares 1 with -1.
    """
    listing = "ps_3_0\nrep i0\n  if_ge r4.w, -r0.w\n    break_ne {}\n  endif\nendrep\n"
    assert "never taken" in fxc.dead_break(listing.format("-c0.w, -c0.w"))
    assert fxc.dead_break(listing.format("c3.x, -c3.x")) == ""


def test_hang_and_crash_of_fxc_are_told_and_the_next_one_works():
    """Check that a hang and a crash of fxc are reported, and that the next compilation works."""
    with needed("fxc"):
        compiler = fxc.load()
    program = shaders.hlsl(3), "ps_3_0", "BokehDebug_PS"
    with patch.object(fxc, "COMPILE_S", 0.0):
        assert fxc.compiled(*program) == fxc.refused("fxc.exe hung: stopped after 0 s")
    assert fxc.compiled(*program).ok
    with patch.object(server.Server, "start"):
        os.killpg(compiler._process.pid, signal.SIGKILL)
        assert fxc.compiled(*program) == fxc.refused("fxc.exe crashed")
    assert fxc.compiled(*program).ok


def test_wrong_lines_and_a_dead_wine_server():
    """Check that invalid requests are reported, and that the next job works, also after Wine's server has ended."""
    driver = load("d3d9")
    driver.ask("clear")
    for line in ("drow 1", "input 16 0 linear", "input 0 7 linear", "values" + 49 * " 1.0"):
        with pytest.raises(RuntimeError, match=f"cannot use '{line}'|array::at|map::at"):
            driver.ask(line)
    assert copied(driver)
    wine.get().end_programs()
    with suppress(RuntimeError):  # noticed before the request, which restarts it, or during it
        copied(driver)
    assert copied(driver)


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
def test_nothing_is_left_running(end):
    """Check that after a normal end, and after a kill, everything ends, and another run is not disturbed.

    No process has the prefix in its environment, and the display is gone.
    """
    assert copied(load("d3d9"))
    command, environment = [sys.executable, "-c", SCRIPT, end], {**os.environ, "PYTHONPATH": str(paths.VALIDATION)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=HANG)
    prefix, display = done.stdout.split()
    assert Path(prefix) != wine.get().prefix, "two runs must not share a prefix"
    assert_ended("environ", f"WINEPREFIX={prefix}\0", lock=f"tmp/.X{display[1:]}-lock")
    assert copied(load("d3d9"))
