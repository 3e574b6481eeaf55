"""Test validation/run bench: each language draws the package's images, what it writes, and how it judges.

Times are not tested here: `bench --judge` does that, on an otherwise idle machine.
"""

import json
import os
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from support import HANG, called, load

from bokeh_validation import paths, plan
from bokeh_validation.frame import methods
from lab import bench
from lab.bench import languages, pack

SIZE = (72, 40)
SOME = {key: bench.settings()[key] for key in ("paper", "exact low", "layered medium")} | bench.table_one((4,))


@pytest.mark.parametrize("name", ["egl", "dxc"])
def test_pictures(name, tmp_path):
    """Check that GLSL's and HLSL's frames are bit-identical to those of the drivers. test_pack.py checks WGSL."""
    driver, images = load(name), bench.textures(SIZE)
    pack.fill(tmp_path, SOME, [images], wheels=False)
    (plans,) = json.loads((tmp_path / "frames.json").read_bytes())["sizes"].values()
    _, frames = languages.DRIVERS[name](None, tmp_path, plans)
    for key, frame in frames.items():
        wall, stamps = frame.drawn(2)
        assert [len(ends) for ends in stamps] == [2 * len(plans[key]["passes"])] * 2 and wall > 0.0
        texture = frame.textures["result"]
        if name == "egl":
            data = texture.read(alignment=1)
        else:
            rows = {"bytes_per_row": 8 * SIZE[0]}
            data = frame.gpu.device.queue.read_texture({"texture": texture}, rows, texture.size)
        expected = driver.run(methods.plan(SOME[key], SIZE).passes, images, SIZE)["result"]
        np.testing.assert_array_equal(np.frombuffer(data, np.float16), expected.ravel(), err_msg=key)


def test_command(tmp_path, monkeypatch):
    """Check that the command lists every frame with its passes as `plan` prints them, their fetches,
    bytes and times.
    """
    load("wgpu")
    monkeypatch.setattr(bench, "table_one", partial(bench.table_one, (4,)))
    file = tmp_path / "times.json"
    done = called("bench", "--size", "72x40", "--rounds", "3", "--json", file)
    assert done.returncode == 0 and "layered medium" in done.stdout, done.stderr
    found, every = json.loads(file.read_text()), bench.settings() | bench.table_one()
    assert found["software"] and [row["key"] for row in found["rows"]] == list(every)
    for row in found["rows"]:
        planned = plan.frame(every[row["key"]], SIZE)
        assert [name for name, *_ in row["passes"]] == [item["entry"] for item in planned["passes"]]
        assert row["fetches"] == planned["fetches"]
        assert all(0.0 <= low <= median <= high for _, median, low, high in (row["whole"], *row["passes"]))
    # the CoC map, two targets of the first pass, and the result, 8 bytes each
    assert {row["key"]: row["bytes"] for row in found["rows"]}["exact medium"] == 8 * 4


def test_interrupted():
    """Check that an interruption while Mesa compiles or draws gives one line and exit code 130, and no crash."""
    load("egl")
    command = [sys.executable, "-P", "-m", "bokeh_validation", "bench", "--driver", "egl"]
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "cwd": paths.VALIDATION}
    environment = {**os.environ, "PYTHONPATH": str(paths.VALIDATION)}
    # a background shell makes its children ignore the signal
    foreground = {"preexec_fn": lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)}
    process = subprocess.Popen(command, env=environment, **streams, **foreground)
    threads = Path(f"/proc/{process.pid}/task")
    while process.poll() is None and not any("llvmpipe" in file.read_text() for file in threads.glob("*/comm")):
        time.sleep(0.02)
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    assert process.communicate(timeout=HANG) == ("", "error: stopped\n") and process.returncode == 130


def rows(**slower: float) -> list[dict]:
    """Return frames within every bound, some of them slower by a factor. Their medians are not judged."""
    every = {key: 1.0 for pair in bench.BOUNDS for key in pair} | {"naive 144": 3.0, "exact hexagon 576": 0.4}
    return [
        {"key": key, "passes": [], "fetches": {"color": 1.0, "depth": 0.0}, "bytes": 8.0,
         "whole": ["whole frame", 9.0, time * slower.get(key.replace(" ", "_"), 1.0), 99.0]}
        for key, time in every.items()
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("slower", "told"),
    [({}, []), ({"layered_low": 1.31}, ["layered low takes 1.31 of the time of paper; the bound is 1.30"]),
     ({"exact_hexagon_576": 1.3}, ["exact hexagon 576 takes 0.52"]), ({"paper_hexagon_144": 1.2}, ["naive 144"])],
)  # fmt: skip
def test_judged(slower, told, monkeypatch):
    """Check for exit code 1 and a line if a frame exceeds its bound relative to another; at least 12
    rounds are drawn.
    """
    asked = []

    def timed(every, *others):
        asked.append((set(every), others[-1]))
        return "llvmpipe", 1.0, rows(**slower)

    monkeypatch.setattr(bench, "timed", timed)
    done = called("bench", "--judge")
    assert done.returncode == bool(told)
    assert all(line in done.stdout for line in told) and ("the bound is" in done.stdout) == bool(told)
    assert asked == [({row["key"] for row in rows()}, bench.JUDGED_ROUNDS)]
