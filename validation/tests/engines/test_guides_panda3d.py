"""integration/panda3d: its guide against the files that the sample runs, and its picture drawn again."""

import os
import re

import guides
import pytest

from bokeh_validation import paths
from bokeh_validation.engines import opengl, panda3d, process
from bokeh_validation.errors import Unavailable

FOLDER = paths.ROOT / "integration/panda3d"
README = FOLDER / "README.md"
SOURCES = sorted(FOLDER.glob("*.py"))


def test_guide():
    """Headings, links and picture; every block is a piece of a file that runs; the version is the locked one."""
    guides.assert_guide(FOLDER)
    guides.assert_quoted(README, SOURCES)
    (version,) = re.findall(r"^panda3d==(\S+)", panda3d.REQUIREMENTS.read_text(encoding="utf-8"), re.MULTILINE)
    assert set(re.findall(r"panda3d==(\d[\d.]*\d)", README.read_text(encoding="utf-8"))) == {version}


def test_package_files():
    """The package's own files from where they are, and no copy of them."""
    text = (FOLDER / "depth_of_field.py").read_text(encoding="utf-8")
    assert set(re.findall(r'"(\w+\.glsl)"', text)) == {paths.library("glsl").name, paths.passes("glsl").name}
    assert not list(FOLDER.rglob("*.glsl"))


def test_picture(tmp_path):
    """The sample draws the picture of the guide, but for what another device rounds otherwise."""
    try:
        opengl.require()
        python = panda3d.python()
    except Unavailable as error:
        if os.environ.get("CI"):
            pytest.fail(str(error))
        pytest.skip(str(error))
    process.run([python, FOLDER / "sample.py", tmp_path / "picture.png"], panda3d.SECONDS)
    guides.assert_same_picture(tmp_path / "picture.png", FOLDER / "picture.png")
