"""validation/run figures as a user calls it: the pictures of docs/reproduction.md, and what it says without npm."""

import re

import numpy as np
import pytest
from PIL import Image
from support import called

from bokeh_validation import figures, paths

DOCUMENT = paths.ROOT / "docs" / "reproduction.md"
PICTURES = paths.ROOT / "docs" / "reproduction"
# Of 255, on average: single pixels at comparisons and last digits are what drivers differ by
MAX_DIFFERENCE = 0.5


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """The folder of a complete run, and what it printed."""
    folder = tmp_path_factory.mktemp("figures")
    done = called("figures", "--output", folder)
    assert done.returncode == 0, done.stderr
    return folder, done.stdout


def test_pictures_are_those_of_the_document(run):
    """As they are kept, but for what drivers differ by. Those of Figure 1 need a download, which may fail."""
    folder, printed = run
    names = {path.name for path in folder.iterdir()}
    expected = {"figure_07.png", "figure_09.png", "figure_11.png", "figure_11_own.png", "figure_11_wide.png"}
    expected |= {"figure_12.png", "figure_13.png"}
    if "not drawn, photographs" not in printed:
        expected |= {f"figure_01_{letter}.png" for letter in figures.VIEWS}
    assert names == expected
    for name in names:
        pixels, kept = (np.asarray(Image.open(place / name)).astype(int) for place in (folder, PICTURES))
        assert pixels.shape == kept.shape and np.abs(pixels - kept).mean() < MAX_DIFFERENCE, name


def test_all_pictures_are_shown():
    """The document shows every picture of its folder once, those that nothing draws any more too."""
    shown = re.findall(r"\]\(reproduction/(\w+\.png)\)", DOCUMENT.read_text(encoding="utf-8"))
    assert sorted(shown) == sorted(path.name for path in PICTURES.iterdir())


def test_without_npm(tmp_path, monkeypatch):
    """The other figures are drawn; a line says what is missing for the photographs."""
    monkeypatch.setattr(figures, "FIGURES", (figures.photographs, figures.two_under_max))
    monkeypatch.setenv("BOKEH_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("PATH", str(tmp_path))
    done = called("figures", "--output", tmp_path)
    assert done.returncode == 0 and "not drawn, photographs: npm is not on this machine" in done.stdout
    assert [path.name for path in tmp_path.glob("*.png")] == ["figure_13.png"]


def test_perspective_looks_where_it_says():
    """A bright spot in the panorama is in the middle of a view at it; the view's right is the panorama's right."""
    panorama, (yaw, pitch) = np.zeros((256, 512, 3)), (40.0, 25.0)
    row, column = round((0.5 - pitch / 180) * 256), round((0.5 + yaw / 360) * 512)
    panorama[row - 2 : row + 3, column - 2 : column + 3] = 1.0
    seen = figures.perspective(panorama, figures.View("spot", "hexagon", yaw, pitch, 60.0), (200, 150))[..., 0]
    y, x = np.mgrid[0:150, 0:200]
    assert abs((seen * x).sum() / seen.sum() - 99.5) < 3 and abs((seen * y).sum() / seen.sum() - 74.5) < 3
    ramp = np.linspace(0, 1, 512)[None, :, None] + np.linspace(0, 8, 256)[:, None, None]
    seen = figures.perspective(ramp, figures.View("ramp", "hexagon", 0.0, 0.0, 60.0), (200, 150))[..., 0]
    assert seen[75, 150] > seen[75, 50] and seen[120, 100] > seen[30, 100]
