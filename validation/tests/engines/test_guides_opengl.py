"""integration/opengl: its guide against the files that the sample runs, its lines counted, its picture drawn again."""

import os
import re
import sys

import guides
import pytest

from bokeh_validation import paths
from bokeh_validation.engines import opengl, process
from bokeh_validation.errors import Unavailable

FOLDER = paths.ROOT / "integration/opengl"
README = FOLDER / "README.md"
SOURCES = sorted(FOLDER.glob("*.py"))


def test_guide():
    """Headings, links and picture; every block is a piece of a file that runs."""
    guides.assert_guide(FOLDER)
    guides.assert_quoted(README, SOURCES)


def test_lines():
    """Three files and at most 50 lines, as many as the guide says: all that it shows, and that is the whole effect."""
    shown = [block.text for block in guides.blocks(guides.section(README, "What you write"))]
    written = [line for text in shown for line in guides.code_lines(text, "#")]
    effect = guides.code_lines((FOLDER / "depth_of_field.py").read_text(encoding="utf-8"), "#")
    assert written[: len(effect)] == effect
    stated = re.search(r"\*\*Three files copied, (\d+) lines written\*\*", README.read_text(encoding="utf-8"))
    assert len(written) == int(stated[1]) <= 50
    # the other lines are the sample's, which has no more of the effect before its first picture
    sample = (FOLDER / "sample.py").read_text(encoding="utf-8")
    frame = sample[sample.index("passes, result = ") : sample.index("hexagon = renderer.picture(result)")]
    assert written[-3:] == guides.code_lines(frame)


def test_package_files():
    """The package's own files from where they are, and no copy of them."""
    text = (FOLDER / "depth_of_field.py").read_text(encoding="utf-8")
    files = [paths.library("glsl"), paths.layers("glsl"), paths.passes("glsl")]
    assert re.findall(r'"(\w+\.glsl)"', text) == [file.name for file in files]
    assert not list(FOLDER.rglob("*.glsl"))


def test_picture(tmp_path):
    """The sample draws the picture of the guide, but for what another device rounds otherwise."""
    try:
        opengl.require()
    except Unavailable as error:
        if os.environ.get("CI"):
            pytest.fail(str(error))
        pytest.skip(str(error))
    process.run([sys.executable, FOLDER / "sample.py", tmp_path / "picture.png"], opengl.SECONDS)
    guides.assert_same_picture(tmp_path / "picture.png", FOLDER / "picture.png")
