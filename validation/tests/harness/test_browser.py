"""The browser below webgl2, webgpu, angle and tint: crashes, hangs, mistakes, and that nothing of it is left."""

import os
import subprocess
import sys
import tempfile
import time
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from support import load

from bokeh_validation import browser, drivers, shaders
from bokeh_validation.compilers import angle_tint, naga
from bokeh_validation.errors import Unavailable
from bokeh_validation.shaders.passes import Pass

COPY = Pass("BokehConstantCoC", {"ColorSamp": "color"}, "result", {"BokehConstantCoC": 0.0})
# the page's functions are found by name, and so is JavaScript's own way to make one
ENDLESS = "constructor.constructor('for (;;);')"


@pytest.fixture(params=("webgl2", "webgpu"))
def driver(request) -> drivers.Driver:
    return load(request.param)


def crash() -> None:
    """End the browser from within."""

    async def step() -> None:
        client = await browser.session().page.context.browser.new_browser_cdp_session()
        with suppress(Exception):  # it has gone before it can answer
            await client.send("Browser.crash")

    browser.session().work(step())


def copied(driver: drivers.Driver) -> bool:
    """Whether the driver copies a picture of odd size, no row of which fills 256 bytes."""
    color = np.random.default_rng(1).random((5, 3, 4)).astype(np.float16)
    output = driver.run([COPY], {"color": color}, (3, 5))["result"]
    return np.array_equal(output[..., :3], color[..., :3])


def wgsl(fragment: str, source: str, targets: int = 1) -> naga.CompileResult:
    return angle_tint.tint(naga.Stage(source, "BokehFullScreen_VS"), naga.Stage(source, fragment, targets=targets))


def test_crash(driver):
    crash()
    with pytest.raises(browser.BrowserError, match="^Chromium crashed: "):
        copied(driver)
    assert copied(driver)


def test_hang():
    load("webgl2")
    session = browser.Session(limit=1.0)
    for function in (ENDLESS, "webgl2.describe"):  # the second finds it dead
        with pytest.raises(browser.BrowserError, match="^Chromium hung: stopped after 1 s$"):
            session.call(function)


@pytest.mark.parametrize("end", ["pass", "test_browser.crash()"])
def test_nothing_is_left(end):
    """At the end of Python neither processes nor files."""
    load("webgl2")
    code = f"import test_browser\ntest_browser.browser.session().call('webgl2.describe')\n{end}"
    with tempfile.TemporaryDirectory(prefix="b-", dir="/tmp") as folder:
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "TMPDIR": folder}
        done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, timeout=60)
        assert done.returncode == 0 and done.stderr == "" and os.listdir(folder) == []

        time.sleep(1.0)  # the last of its processes may be ending
        files = [file for file in Path("/proc").glob("[0-9]*/cmdline") if file.exists()]
        assert not any(folder.encode() in file.read_bytes() for file in files)


def test_no_chromium(monkeypatch):
    """It is told what installs it."""
    monkeypatch.delenv(browser.VARIABLE, raising=False)
    monkeypatch.setenv("PATH", "/nonexistent")
    with pytest.raises(Unavailable, match="apt-get install -y --no-install-recommends chromium"):
        browser.Session()


def test_compilers_report():
    """What is wrong where programs are put together; undeclared names are in test_compile.py."""
    load("webgl2")
    vertex = shaders.glsl("BokehFullScreen", "300es").replace("out vec2 BokehUV", "out vec3 BokehUV")
    vertex = vertex.replace("BokehUV = vec2(", "BokehUV = vec3(0.0, ").replace("BokehUV * 2.0", "BokehUV.xy * 2.0")
    filtered = shaders.wgsl().replace("Nearest(DepthSamp, sampleCoords)", "(DepthSamp, ColorSampSampler, sampleCoords)")
    for result, words in (
        (angle_tint.angle(vertex, shaders.glsl("BokehDebug", "300es")), "link: "),
        # a target that the entry does not write
        (wgsl("BokehHexagonFirst_PS", shaders.wgsl(), targets=3), "targets[2]"),
        (wgsl("BokehDepthOfField_PS", filtered), "UnfilterableFloat"),
    ):
        assert not result.ok and words in result.messages
