"""Test the browser behind webgl2, webgpu, angle and tint: crashes, hangs, errors, and that nothing is left of it."""

import os
import subprocess
import sys
import tempfile
from contextlib import suppress
from functools import partial

import numpy as np
import pytest
from support import HANG, assert_ended, load

from bokeh_validation import browser, shaders
from bokeh_validation.compile_matrix import angle_tint, naga
from bokeh_validation.errors import Unavailable
from bokeh_validation.shaders.passes import Pass

COPY = Pass("BokehConstantCoC", {"ColorSamp": "color"}, "result", {"BokehConstantCoC": 0.0})


def crash() -> None:
    """Crash the browser from inside."""
    session = browser.session()
    client = session.work(session.page.context.browser.new_browser_cdp_session())
    with suppress(Exception):  # it is gone before it can answer
        session.work(client.send("Browser.crash"))


def wgsl(fragment: str, source: str, targets: int = 1) -> naga.CompileResult:
    """Compile an entry point of a WGSL text with Tint."""
    return angle_tint.tint(naga.Stage(source, "BokehFullScreen_VS"), naga.Stage(source, fragment, targets=targets))


@pytest.mark.parametrize("name", ["webgl2", "webgpu"])
def test_crash(name):
    """Check that the call after a crash uses a new browser, and copies an image of odd size whose rows do not fill 256
    bytes.
    """
    color = np.arange(60, dtype=np.float16).reshape(5, 3, 4)
    run = partial(load(name).run, [COPY], {"color": color}, (3, 5))
    crash()
    with pytest.raises(browser.BrowserError, match="^Chromium crashed: "):
        run()
    np.testing.assert_array_equal(run()["result"][..., :3], color[..., :3])


def test_hang():
    """Check that a hanging page is stopped, and that later calls say so."""
    load("webgl2")
    session = browser.Session(limit=1.0)
    # functions are looked up by name, so JavaScript's own function constructor is found too; the second call finds the
    # session dead
    for function in ("constructor.constructor('for (;;);')", "webgl2.describe"):
        with pytest.raises(browser.BrowserError, match="^Chromium hung: stopped after 1 s$"):
            session.call(function)


@pytest.mark.parametrize("end", ["pass", "test_browser.crash()"])
def test_nothing_is_left(end):
    """Check that neither processes nor files are left when Python ends."""
    load("webgl2")
    code = f"import test_browser\ntest_browser.browser.session().call('webgl2.describe')\n{end}"
    with tempfile.TemporaryDirectory(prefix="b-", dir="/tmp") as folder:
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "TMPDIR": folder}
        done = subprocess.run(
            [sys.executable, "-c", code], env=environment, capture_output=True, text=True, timeout=HANG
        )
        assert done.returncode == 0 and done.stderr == "" and os.listdir(folder) == []
        assert_ended("cmdline", folder)


def test_what_installs_chromium(monkeypatch):
    """Check that the message without Chromium says how to install it."""
    monkeypatch.delenv(browser.VARIABLE, raising=False)
    monkeypatch.setenv("PATH", "/nonexistent")
    with pytest.raises(Unavailable, match="apt-get install -y --no-install-recommends chromium"):
        browser.Session()


def test_compilers_report():
    """Check errors that appear when programs are linked; test_compile.py covers undeclared names."""
    load("webgl2")
    vertex = shaders.glsl("BokehFullScreen", "300es").replace("out vec2 BokehUV", "out vec3 BokehUV")
    vertex = vertex.replace("BokehUV = vec2(", "BokehUV = vec3(0.0, ").replace("BokehUV * 2.0", "BokehUV.xy * 2.0")
    nearest = "BokehFetchDepth(DepthSamp, BokehToTexture(sampleCoords)).x"
    filtered = shaders.wgsl().replace(nearest, "BokehFetch(DepthSamp, sampleCoords, BokehLinearClamp).r")
    for result, words in (
        (angle_tint.angle(vertex, shaders.glsl("BokehDebug", "300es")), "link: "),
        # a target that the entry does not write
        (wgsl("BokehHexagonFirst_PS", shaders.wgsl(), targets=3), "targets[2]"),
        (wgsl("BokehDepthOfField_PS", filtered), "UnfilterableFloat"),
    ):
        assert not result.ok and words in result.messages
