"""integration/jmonkeyengine: its table of passes, its versions, its picture."""

from support import needed
from support_pages import assert_picture

from bokeh_validation.engines import jmonkeyengine

SAMPLE = jmonkeyengine.SAMPLE


def test_picture(tmp_path):
    """The sample draws the picture of the guide."""
    drawn = tmp_path / "picture.png"
    with needed("jmonkeyengine"):
        jmonkeyengine.run_class("Sample", drawn)
    assert_picture(drawn, SAMPLE / "picture.png")
