"""Test validation/run bench --pack: a folder whose script draws the package's images and times them."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest
from support import called, load, refused

from bokeh_validation import plan
from bokeh_validation.frame import methods
from lab import bench
from lab.bench import pack, script

SIZE = (72, 40)


@pytest.fixture(scope="module")
def packed(tmp_path_factory):
    """Return a packed folder."""
    folder = tmp_path_factory.mktemp("a folder") / "times here"
    done = called("bench", "--pack", folder, "--size", "72x40")
    assert done.returncode == 0, done.stderr
    return folder


def run(packed, folder, *options):
    """Run the script from another folder, without the package in its path."""
    command = [sys.executable, "-I", str(packed / "bench.py"), *options]
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=300)


def test_times(packed, tmp_path):
    """Check that every pass of every plan has a time."""
    load("wgpu")
    done = run(packed, tmp_path, "--seconds", "0")
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "times.json").read_text())
    assert found["adapter"]["device"] in done.stdout
    assert found["sizes"]["72x40"]["frames"].keys() == bench.settings().keys()
    for key, settings in bench.settings().items():
        (_, whole, *_), *passes = found["sizes"]["72x40"]["frames"][key]
        assert [name for name, *_ in passes] == [item["entry"] for item in plan.frame(settings, SIZE)["passes"]]
        assert all(0.0 <= low <= median <= high for _, median, low, high in passes) and f"{whole:.3f}" in done.stdout


def test_pictures(packed):
    """Check that its frames are bit-identical to the package's, each drawn after all others in the same textures."""
    driver, pool, images = load("wgpu"), {}, bench.textures(SIZE)
    gpu, data = script.GPU(folder=packed), json.loads((packed / "frames.json").read_text())
    module = gpu.device.create_shader_module(code="".join((packed / name).read_text() for name in data["files"]))
    frames = {key: script.Frame(gpu, one, module, pool) for key, one in data["sizes"]["72x40"].items()}
    for key, settings in bench.settings().items():
        frames[key].drawn(2)
        texture = frames[key].textures["result"]
        data = gpu.device.queue.read_texture({"texture": texture}, {"bytes_per_row": 8 * SIZE[0]}, texture.size)
        expected = driver.run(methods.plan(settings, SIZE).passes, images, SIZE)["result"]
        np.testing.assert_array_equal(np.frombuffer(data, np.float16), expected.ravel(), err_msg=key)


def test_requirements(packed):
    """Check that every package is listed with version and hashes."""
    text = (packed / "requirements.txt").read_text()
    names = [line.partition("==")[0] for line in text.splitlines() if "==" in line]
    assert names == ["cffi", "pycparser", "wgpu", "rubicon-objc"] and text.count("--hash") > len(names)


def test_refused(packed, tmp_path, monkeypatch):
    """Check that wrong options give one line and exit code 2."""
    refused(called("bench", "--pack", packed), ["is not empty"])
    refused(run(packed, tmp_path, "--adapter", "nothing"), ["no adapter nothing"])
    refused(run(packed, tmp_path, "--second", "x"), ["--seconds"])
    monkeypatch.setattr(pack, "PIP", ["pip", "no-such-command"])
    refused(called("bench", "--pack", tmp_path / "new", "--wheels", "--size", "16x16"), ["--wheels", "network"])
    assert not (tmp_path / "new").exists()
