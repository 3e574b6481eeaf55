"""integration/threejs: the guide quotes what runs, and what it says of depth, focus and debug views is so."""

import base64
import os
import re

import guides
import numpy as np
import pytest

from bokeh_validation.engines import threejs
from bokeh_validation.errors import Unavailable

README = threejs.FOLDER / "README.md"
FILES = [threejs.FOLDER / name for name in ("webgl.js", "webgpu.js", "PolygonBokehPass.js", "PolygonBokehNode.js")]
SIZE = (240, 320)


@pytest.fixture(scope="module", params=threejs.KINDS.values())
def kind(request) -> str:
    return request.param


@pytest.fixture(scope="module")
def sample(kind):
    try:
        with threejs.opened(kind) as opened:
            yield opened
    except Unavailable as error:
        if os.environ.get("CI"):
            pytest.fail(str(error))
        pytest.skip(str(error))


def test_guide():
    """Headings, links, picture; every block is in a file that runs."""
    guides.assert_guide(threejs.FOLDER)
    guides.assert_quoted(README, FILES)


@pytest.mark.parametrize("sort", ["WebGLRenderer", "WebGPURenderer"])
def test_pasting_is_short(sort):
    """At most two files to copy and 30 lines to write, and as many as the guide says."""
    text = README.read_text(encoding="utf-8")
    section = re.search(rf"^### {sort}$(.*?)^##", text, re.MULTILINE | re.DOTALL)[1]
    copied = re.findall(r"^\d\. \[", section, re.MULTILINE)
    shown = "".join(re.findall(r"^```js\n(.*?)^```", section, re.MULTILINE | re.DOTALL))
    lines = [line for line in shown.splitlines() if line.strip() and not line.strip().startswith("//")]
    assert len(copied) == 2 and len(lines) <= 30
    assert f"{len(lines)} lines" in section, len(lines)


def test_click_and_key(sample, kind):
    """The first call, while the page is as the sample made it: a click focuses, a key shows the circle of confusion."""
    said = sample.call("interaction", kind)
    assert 4.5 < said["before"] < 5.5
    # the box is 0.9 m wide, and its front was hit
    assert said["box"] - 0.7 < said["after"] < said["box"] - 0.3
    assert said["mode"] == 2


def test_depth_of_every_camera(sample, kind):
    """Perspective and orthographic, usual and reversed: what the passes read is what a ray meets."""
    for case in sample.call("depths", kind):
        drawn, met = np.array(case["drawn"]), np.array(case["met"])
        assert len(drawn) > 500
        # the rest is at outlines, where the ray may pass by
        assert (abs(drawn - met) < 1e-3 * met).mean() > 0.98, case["name"]


def test_debug_views(sample, kind):
    """Depth, circle of confusion, near and far field, as section [9] has them."""
    said = sample.call("views", kind)
    half = {mode: _pixels(data, np.float16) for mode, data in said["views"].items()}
    depth = _pixels(said["depth"], np.float32)
    coc = _pixels(said["coc"], np.float16)[..., 3]
    focus = said["focus"]
    assert np.allclose(half["1"][..., 0], depth / (depth + focus), atol=2e-3)
    assert np.allclose(half["2"][..., 0], coc / said["maxCoC"], atol=2e-3)
    blurred = coc > 0.005
    near = depth < focus
    assert (half["3"][..., 0] > half["3"][..., 2])[blurred & near].all() and (blurred & near).any()
    assert (half["3"][..., 2] > half["3"][..., 0])[blurred & ~near].all() and (blurred & ~near).any()


def _pixels(data: str, dtype: type) -> np.ndarray:
    values = np.frombuffer(base64.b64decode(data), dtype)
    return values.reshape(*SIZE, 4) if dtype is np.float16 else values.reshape(SIZE)
