"""The browser below webgl2, webgpu, angle and tint: crashes, hangs, mistakes, and that nothing of it is left."""

import os
import subprocess
import sys
import tempfile
import time
from contextlib import suppress
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from support import load

from bokeh_validation import browser, shaders
from bokeh_validation.compile_matrix import angle_tint, naga
from bokeh_validation.errors import Unavailable
from bokeh_validation.shaders.passes import Pass

COPY = Pass("BokehConstantCoC", {"ColorSamp": "color"}, "result", {"BokehConstantCoC": 0.0})


def crash() -> None:
    """End the browser from within."""
    session = browser.session()
    client = session.work(session.page.context.browser.new_browser_cdp_session())
    with suppress(Exception):  # it has gone before it can answer
        session.work(client.send("Browser.crash"))


def wgsl(fragment: str, source: str, targets: int = 1) -> naga.CompileResult:
    return angle_tint.tint(naga.Stage(source, "BokehFullScreen_VS"), naga.Stage(source, fragment, targets=targets))


@pytest.mark.parametrize("name", ["webgl2", "webgpu"])
def test_crash(name):
    """The next call has a new browser. A picture of odd size, no row of which fills 256 bytes, is copied."""
    color = np.arange(60, dtype=np.float16).reshape(5, 3, 4)
    run = partial(load(name).run, [COPY], {"color": color}, (3, 5))
    crash()
    with pytest.raises(browser.BrowserError, match="^Chromium crashed: "):
        run()
    np.testing.assert_array_equal(run()["result"][..., :3], color[..., :3])


def test_hang():
    load("webgl2")
    session = browser.Session(limit=1.0)
    # the page's functions are found by name, and so is JavaScript's own way to make one; the second finds it dead
    for function in ("constructor.constructor('for (;;);')", "webgl2.describe"):
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
        time.sleep(2.0)  # the last of its processes may be ending
        for file in Path("/proc").glob("[0-9]*/cmdline"):
            with suppress(OSError):  # it has ended meanwhile
                assert folder.encode() not in file.read_bytes()


def test_what_installs_chromium(monkeypatch):
    monkeypatch.delenv(browser.VARIABLE, raising=False)
    monkeypatch.setenv("PATH", "/nonexistent")
    with pytest.raises(Unavailable, match="apt-get install -y --no-install-recommends chromium"):
        browser.Session()


def test_compilers_report():
    """What is wrong where programs are put together; undeclared names are in test_compile.py."""
    load("webgl2")
    vertex = shaders.glsl("BokehFullScreen", "300es").replace("out vec2 BokehUV", "out vec3 BokehUV")
    vertex = vertex.replace("BokehUV = vec2(", "BokehUV = vec3(0.0, ").replace("BokehUV * 2.0", "BokehUV.xy * 2.0")
    nearest = "BokehFetchDepth(DepthSamp, BokehToTexture(sampleCoords))"
    filtered = shaders.wgsl().replace(nearest, "BokehFetch(DepthSamp, sampleCoords, BokehLinearClamp).r")
    for result, words in (
        (angle_tint.angle(vertex, shaders.glsl("BokehDebug", "300es")), "link: "),
        # a target that the entry does not write
        (wgsl("BokehHexagonFirst_PS", shaders.wgsl(), targets=3), "targets[2]"),
        (wgsl("BokehDepthOfField_PS", filtered), "UnfilterableFloat"),
    ):
        assert not result.ok and words in result.messages
