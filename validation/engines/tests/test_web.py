"""Test the npm package of integration/web: installed unchanged, through bundlers and types, with the oldest three.js,
and its classes' promises.

Node.js runs these tests, integration/web/test, in a copy of the repository.
"""

import re
import shutil

import pytest
from support import needed
from support_inputs import inputs
from support_node import assert_passes, files
from test_engines import check_shots

import engines
from bokeh_validation import browser, paths
from engines import pages

WEB = paths.ROOT / "integration/web"
SAMPLES = [paths.ROOT / "integration" / name for name in ("threejs", "babylonjs", "playcanvas")]

pytestmark = [
    pytest.mark.timeout(1500),
    inputs(
        *(str(path.relative_to(paths.ROOT)) for path in (WEB, *SAMPLES)),
        of_code=True,
    ),
]


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """Return a copy of the package next to the samples, with its packages installed in a parent folder."""
    with needed("npm"):
        return pages.copied(WEB, tmp_path_factory.mktemp("web") / "repository", SAMPLES)


# Limits the size of the shaders' text, so it is repeated when that changes
SIZES = pytest.mark.inputs("integration/web/shaders.js")


@pytest.mark.parametrize("file", [pytest.param(name, marks=SIZES if "size" in name else ()) for name in files(WEB)])
def test_by_node(project, file):
    """Check that every test in a file of integration/web/test passes."""
    assert_passes(project, file)


@pytest.mark.parametrize("name", pages.NAMES)
def test_installed(name, tmp_path):
    """Install the packed package into a copy of a sample, which then imports it from node_modules, and check that the
    sample's results are within the reference's intervals.
    """
    engine = name.partition("-")[0]
    local = shutil.ignore_patterns("node_modules")
    sample = shutil.copytree(paths.ROOT / "integration" / engine, tmp_path / "integration" / engine, ignore=local)
    shared = paths.ensured(tmp_path / "integration/web/test")
    shutil.copy(WEB / "test/captures.js", shared)
    with needed(name):
        pages.call_npm(tmp_path, "pack", WEB)
        (archive,) = tmp_path.glob("polygonal-bokeh-*.tgz")
        pages.call_npm(sample, "install", archive)
        for page in sample.glob("*.html"):
            text = page.read_text(encoding="utf-8")
            assert text.count("../web/") == 1
            page.write_text(text.replace("../web/", "./node_modules/polygonal-bokeh/"), encoding="utf-8")
        folder = paths.ensured(tmp_path / "capture")
        pages.run(name, folder, tmp_path)
    check_shots(engines.read(folder))


@pytest.mark.parametrize(("file", "flags"), [("chromium.js", browser.FLAGS), ("three.js", list(pages.CANVAS))])
def test_flags(file, flags):
    """Check that Node.js starts Chromium on the same devices as the browser drivers and the samples."""
    assert re.findall(r"'(--[^']+)'", (WEB / "test" / file).read_text(encoding="utf-8")) == flags
