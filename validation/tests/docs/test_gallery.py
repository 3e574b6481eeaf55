"""The pictures of the README and its gallery: made by the commands that are named under them, and small."""

import re

import numpy as np
from PIL import Image
from support import called

from bokeh_validation import paths
from bokeh_validation.truth import gallery

README = (paths.ROOT / "README.md").read_text(encoding="utf-8")
MAX_DIFFERENCE = 0.5  # of 255 on average, as other devices round


def test_gallery(tmp_path):
    """The pictures that are kept are what the command draws."""
    done = called("gallery", "--output", tmp_path)
    assert done.returncode == 0, done.stderr
    drawn_files = [path.name for path in tmp_path.iterdir()]
    assert {name.partition(".")[0] for name in drawn_files} == set(gallery.PICTURES)
    for name in drawn_files:
        drawn, kept = (
            np.asarray(Image.open(folder / name)).astype(int) for folder in (tmp_path, paths.ROOT / "docs/images")
        )
        assert drawn.shape == kept.shape and np.abs(drawn - kept).mean() < MAX_DIFFERENCE, name


def test_pictures_of_the_readme():
    """Each below 700 kB, with a command under it that the program has; the gallery's are all shown."""
    shown = re.findall(r"!\[[^\]]*\]\(([^)]+)\)", README)
    assert {f"docs/images/{name}.png" for name in gallery.PICTURES} - set(shown) == {"docs/images/character_color.png"}
    assert "](images/character_color.png)" in (paths.ROOT / "docs/character.md").read_text(encoding="utf-8")
    for picture in shown:
        assert (paths.ROOT / picture).stat().st_size < 700_000, picture
        after = README.split(f"]({picture})", 1)[1].strip()
        assert re.match(r"(?:!\[[^\]]*\]\([^)]+\)\s*)*\*[^*]*`validation/run \w+", after), picture


def test_no_such_folder(tmp_path):
    """One line, exit code 2."""
    done = called("gallery", "--output", tmp_path / "none")
    assert done.returncode == 2 and len(done.stderr.splitlines()) == 1
