"""integration/jmonkeyengine: its table of passes, its versions, its picture."""

import re

from support import needed
from support_pages import assert_picture

from bokeh_validation import paths
from bokeh_validation.engines import jmonkeyengine

SAMPLE = jmonkeyengine.SAMPLE


def test_versions():
    """The guide, the table of integration/README.md and jars.txt have the same."""
    (version,) = {jar.version for jar in jmonkeyengine.pinned() if jar.group == "org.jmonkeyengine"}
    guide = (SAMPLE / "README.md").read_text(encoding="utf-8")
    assert set(re.findall(r"org\.jmonkeyengine:\S+?:([\w.-]+\w)", guide)) == {version}
    table = (paths.ROOT / "integration/README.md").read_text(encoding="utf-8")
    (shown,) = re.findall(r"^\| \[.*\(jmonkeyengine/README.md\) \| ([\d.]+) ", table, re.MULTILINE)
    assert f"{version}-".startswith(f"{shown}-")


def test_picture(tmp_path):
    """The sample draws the picture of the guide."""
    drawn = tmp_path / "picture.png"
    with needed("jmonkeyengine"):
        jmonkeyengine.run_class("Sample", drawn)
    assert_picture(drawn, SAMPLE / "picture.png")
