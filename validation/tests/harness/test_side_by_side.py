"""Several test processes: what stays together, and that nothing runs beside a test that wants to be alone."""

import os
import subprocess
import sys
from itertools import combinations
from pathlib import Path

import pytest
import side_by_side

from bokeh_validation import locks, paths

TESTS = Path(__file__).parents[1]

PROBE = """
import time
import pytest

def run(name, seconds):
    start = time.monotonic()
    time.sleep(seconds)
    with open("times", "a") as file:
        file.write(f"{name} {start} {time.monotonic()}\\n")

@pytest.mark.parametrize("n", range(6))
def test_other(n):
    run("other", 0.1 + 0.1 * n)

@pytest.mark.alone
@pytest.mark.parametrize("n", range(4))
def test_alone(n):
    run("alone", 0.2)
"""


@pytest.mark.parametrize(
    ("a", "b", "together"),
    [
        ("tests/test_x.py::test_y[osmesa-paper-(1, 1)]", "tests/test_x.py::test_y[d3d9-paper-(1, 1)]", True),
        ("tests/test_x.py::test_y[osmesa-paper-(1, 1)]", "tests/test_x.py::test_y[osmesa-exact-(1, 1)]", False),
        ("tests/test_x.py::test_y[paper-wgpu]", "tests/test_x.py::test_y[paper-webgpu]", True),
        ("tests/test_x.py::test_y[wgpu]", "tests/test_x.py::test_z[wgpu]", False),
        ("tests/harness/test_compile.py::A::test_y[a]", "tests/harness/test_compile.py::B::test_z", True),
        ("tests/harness/test_compile.py::test_y", "tests/harness/test_compile_only.py::test_y", False),
    ],
)
def test_units(a, b, together):
    """Tests that differ in the driver only, or whose file shares what takes long to make."""
    assert (side_by_side.unit(a) == side_by_side.unit(b)) == together


def probe(folder: Path, processes: int, text: str, seconds: float = 300) -> subprocess.CompletedProcess[str]:
    """Run tests of this text with the plugin; their cache is in the folder."""
    (folder / "test_probe.py").write_text(text)
    environment = {
        **{name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")},
        "PYTHONPATH": os.pathsep.join(map(str, (paths.VALIDATION, TESTS))),
        "BOKEH_CACHE": str(folder / "cache"),
    }
    command = [sys.executable, "-m", "pytest", "-p", "side_by_side", "-p", "no:cacheprovider", "-q"]
    command += ["-n", str(processes)]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=seconds)


def test_alone(tmp_path):
    """In two processes: others run at the same time, and never anything beside one that is marked."""
    done = probe(tmp_path, 2, PROBE)
    assert done.returncode == 0 and "10 passed" in done.stdout, done.stdout + done.stderr
    lines = [line.split() for line in (tmp_path / "times").read_text().splitlines()]
    times = [(name, float(start), float(end)) for name, start, end in lines]
    overlapping = [(a[0], b[0]) for a, b in combinations(times, 2) if a[1] < b[2] and b[1] < a[2]]
    assert overlapping and set(overlapping) == {("other", "other")}


def test_the_child_of_a_test_does_not_wait(tmp_path, monkeypatch):
    """A test that runs tests is inside, and another process waits at the entrance to be alone: the child must go on."""
    monkeypatch.setenv("BOKEH_CACHE", str(tmp_path / "cache"))
    with locks.held(side_by_side.ALONE, shared=True), locks.held(side_by_side.ENTRANCE):
        done = probe(tmp_path, 0, "def test_in_the_child():\n    pass\n", 60)
    assert done.returncode == 0 and "1 passed" in done.stdout, done.stdout + done.stderr
