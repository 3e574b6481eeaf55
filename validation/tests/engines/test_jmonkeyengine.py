"""integration/jmonkeyengine: its autofocus, its table of passes, its versions, its picture."""

import json
import re
from math import exp

import numpy as np
import pytest
from PIL import Image
from support import needed

from bokeh_validation import paths
from bokeh_validation.engines import jmonkeyengine

SAMPLE = jmonkeyengine.SAMPLE
SIZE = (256, 384)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    target = tmp_path_factory.mktemp("jmonkeyengine")
    with needed("jmonkeyengine"):
        jmonkeyengine.run("jmonkeyengine", target)
    return target


def test_autofocus(folder):
    """The depth under a point is what the first pass wrote there; of two points the nearer wins; 1 / distance is pulled.

    The pull is exact but for float32. A ray does not go through a pixel's centre, so the depths around it bound its own.
    """
    pull = json.loads((folder / "pull.json").read_text(encoding="utf-8"))
    metres = np.fromfile(folder / "depth.f32", np.float32).reshape(SIZE)
    for name in ("tower", "ball"):
        x, y = pull[name]["point"]
        row, column = int(y * SIZE[0]), int(x * SIZE[1])
        around = metres[row - 1 : row + 2, column - 1 : column + 2]
        assert around.min() <= pull[name]["depth"] <= around.max() < 1.01 * around.min(), name
    tower, ball = pull["tower"]["depth"], pull["ball"]["depth"]
    assert tower > 1.5 * ball
    wanted, pulled = [], 1.0 / tower
    # the tower and the ball, then the sky
    for target in (1.0 / ball, 0.0):
        for _ in range(pull["frames"]):
            pulled += (1.0 - exp(-pull["frame"] / pull["seconds"])) * (target - pulled)
            wanted.append(1.0 / pulled)
    assert pull["distances"] == pytest.approx(wanted, rel=1e-5)


def test_table_of_passes():
    """The enum has the names of bokeh_passes.glsl in their order: the ordinal is what BOKEH_PASS is."""
    own = (SAMPLE / "BokehPass.java").read_text(encoding="ascii")
    names = re.findall(r"[A-Z_]+", own[own.index("{") : own.index(";")])
    table = re.findall(r"^#define BOKEH_([A-Z_]+) (\d+)$", paths.passes("glsl").read_text(encoding="ascii"), re.MULTILINE)
    # the vertex shader comes last
    wanted = [name for name, number in table if name != "TARGETS"][:-1]
    assert names == wanted


def test_versions():
    """The guide, the table of integration/README.md and jars.txt have the same."""
    (version,) = {jar.version for jar in jmonkeyengine.pinned() if jar.group == "org.jmonkeyengine"}
    guide = (SAMPLE / "README.md").read_text(encoding="utf-8")
    assert set(re.findall(r"org\.jmonkeyengine:\S+?:([\w.-]+\w)", guide)) == {version}
    table = (paths.ROOT / "integration/README.md").read_text(encoding="utf-8")
    (shown,) = re.findall(r"^\| \[.*\(jmonkeyengine/README.md\) \| ([\d.]+) ", table, re.MULTILINE)
    assert f"{version}-".startswith(f"{shown}-")


def test_picture(tmp_path):
    """The sample draws the picture of the guide, but for what another device rounds: half a step of 255 on average."""
    drawn = tmp_path / "picture.png"
    with needed("jmonkeyengine"):
        jmonkeyengine.run_class("Sample", drawn)
    with Image.open(drawn) as a, Image.open(SAMPLE / "picture.png") as b:
        assert a.size == b.size
        off = np.abs(np.asarray(a.convert("RGB"), float) - np.asarray(b.convert("RGB"), float)).mean()
    assert off < 0.5, f"{off:.2f} of 255 off on average"
