"""The npm package of integration/web: installed as it stands, through bundlers and types, by the oldest three.js, and
what its classes promise. Node.js runs these tests, in a copy of the repository: integration/web/test has them.
"""

import re

import pytest
from support import needed
from support_inputs import inputs
from support_node import assert_passes, files

from bokeh_validation import browser, paths
from bokeh_validation.engines import pages

WEB = paths.ROOT / "integration/web"
SAMPLES = [paths.ROOT / "integration" / name for name in ("threejs", "babylonjs", "playcanvas")]

pytestmark = [
    pytest.mark.timeout(1500),
    inputs(*(str(path.relative_to(paths.ROOT)) for path in (WEB, *SAMPLES)), "validation/tests/support_node.py"),
]


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """A copy of the package beside the samples, with its packages in a folder above."""
    with needed("npm"):
        return pages.copied(WEB, tmp_path_factory.mktemp("web") / "repository", SAMPLES)


@pytest.mark.parametrize("file", files(WEB))
def test_by_node(project, file):
    """Every test of a file of integration/web/test passes."""
    assert_passes(project, file)


@pytest.mark.parametrize(("file", "flags"), [("chromium.js", browser.FLAGS), ("three.js", list(pages.CANVAS))])
def test_flags(file, flags):
    """Node.js starts Chromium on the same devices as the browser drivers and the samples."""
    assert re.findall(r"'(--[^']+)'", (WEB / "test" / file).read_text(encoding="utf-8")) == flags
