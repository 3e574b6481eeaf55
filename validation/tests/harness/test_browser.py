"""The browser below webgl2, webgpu, angle and tint: crashes, hangs, mistakes, and that nothing of it is left."""

import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pytest
from support import load

from bokeh_validation import browser, drivers, paths, shaders
from bokeh_validation.compilers import angle_tint, naga
from bokeh_validation.compilers.tool import CompileResult
from bokeh_validation.errors import Unavailable
from bokeh_validation.shaders.passes import Pass

COPY = Pass("BokehConstantCoC", {"ColorSamp": "color"}, "result", {"BokehConstantCoC": 0.0})
NAMES = ("webgl2", "webgpu")
# the page's functions are found by name, and so is JavaScript's own way to make one
ENDLESS = "constructor.constructor('for (;;);')"


@pytest.fixture(params=NAMES)
def driver(request) -> drivers.Driver:
    return load(request.param)


@pytest.fixture
def session() -> browser.Session:
    load("webgl2")
    return browser.session()


def copied(driver: drivers.Driver, storage: str = "half") -> bool:
    """Whether the driver copies a picture of odd size, no row of which fills 256 bytes."""
    color = np.random.default_rng(1).random((5, 3, 4)).astype(np.float16)
    output = driver.run([COPY], {"color": color}, (3, 5), storage)["result"]
    return np.array_equal(output[..., :3], color[..., :3])


def wgsl(vertex: str, fragment: str, source: str | None = None, targets: int = 1) -> CompileResult:
    source = source or shaders.wgsl()
    stages = naga.Stage(source, vertex), naga.Stage(source, fragment, targets=targets)
    return angle_tint.tint(*stages)


def running(group: int) -> list[str]:
    """Processes of a group, without those that have ended and wait for their parent to ask."""
    found = []
    for file in Path("/proc").glob("[0-9]*/stat"):
        try:
            name, state, _, owner = re.fullmatch(r"\d+ \((.*)\) (\w) (\d+) (\d+) .*", file.read_text(), re.S).groups()
        except OSError:  # it has ended meanwhile
            continue
        if int(owner) == group and state != "Z":
            found.append(name)
    return found


class TestEnds:
    """Crashes and hangs are told as what they are, and the next call has a new browser."""

    def test_crash(self, driver):
        os.kill(browser.session()._process, signal.SIGKILL)
        with pytest.raises(browser.BrowserError, match="^Chromium crashed: "):
            copied(driver)
        assert copied(driver)

    def test_hang(self, session, driver):
        with pytest.raises(browser.BrowserError, match="^Chromium hung: stopped after 1 s$"):
            session.call(ENDLESS, limit=1.0)
        assert session.dead
        with pytest.raises(browser.BrowserError, match="hung"):
            session.call("webgl2.describe")
        assert copied(driver)

    @pytest.mark.parametrize("end", ["pass", "os.kill(s._process, 9)"])
    def test_nothing_is_left(self, end, session):
        """At the end of Python neither processes nor files."""
        lines = ["import os", "from bokeh_validation import browser", "s = browser.session()"]
        lines += ["s.call('webgl2.describe')", "print(s._process, flush=True)", end]
        with tempfile.TemporaryDirectory(prefix="b-", dir="/tmp") as folder:
            environment = {**os.environ, "PYTHONPATH": str(paths.VALIDATION), "TMPDIR": folder}
            done = subprocess.run(
                [sys.executable, "-c", "\n".join(lines)], env=environment, capture_output=True, text=True, timeout=60
            )
            assert done.stderr == "" and os.listdir(folder) == []
        end = time.monotonic() + 5.0
        while running(int(done.stdout)) and time.monotonic() < end:
            time.sleep(0.1)
        assert not running(int(done.stdout))


class TestMissing:
    """What is not there is told with what installs it."""

    def test_no_chromium(self, monkeypatch):
        monkeypatch.delenv(browser.VARIABLE, raising=False)
        monkeypatch.setenv("PATH", "/nonexistent")
        with pytest.raises(Unavailable, match="apt-get install -y --no-install-recommends chromium"):
            browser.Session()


class TestCompilers:
    """angle and tint report what is wrong; undeclared names are in test_compile.py."""

    def test_link_of_stages_that_do_not_fit(self, session):
        vertex = shaders.glsl("BokehFullScreen", "300es").replace("out vec2 BokehUV", "out vec3 BokehUV")
        vertex = vertex.replace("BokehUV = vec2(", "BokehUV = vec3(0.0, ").replace("BokehUV * 2.0", "BokehUV.xy * 2.0")
        result = angle_tint.angle(vertex, shaders.glsl("BokehDebug", "300es"))
        assert not result.ok and result.messages.startswith("link: ") and "BokehUV" in result.messages

    def test_tint_misses_a_target(self, session):
        """A target that the entry does not write is refused: the number of targets is checked."""
        result = wgsl("BokehFullScreen_VS", "BokehHexagonFirst_PS", targets=3)
        assert not result.ok and "targets[2]" in result.messages

    def test_linear_filter_on_depth(self, session):
        direct = "Nearest(DepthSamp, sampleCoords)"
        source = shaders.wgsl().replace(direct, "(DepthSamp, ColorSampSampler, sampleCoords)")
        result = wgsl("BokehFullScreen_VS", "BokehDepthOfField_PS", source)
        assert not result.ok and "UnfilterableFloat" in result.messages


@pytest.mark.parametrize("name", NAMES)
def test_adapter(name):
    """A part of the device's name."""
    assert drivers.load(name, "SwiftShader").adapter == load(name).adapter
