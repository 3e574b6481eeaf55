"""The pictures of README and docs/paper.md: those that their commands draw, small, and all of them shown."""

import re
from pathlib import Path

import numpy as np
from PIL import Image
from support import called

from bokeh_validation import paths
from lab import figures, gallery

README = (paths.ROOT / "README.md").read_text(encoding="utf-8")
DOCUMENT = paths.ROOT / "docs" / "paper.md"
PICTURES = paths.ROOT / "docs" / "reproduction"
# Of 255, on average: single pixels at comparisons and last digits are what drivers differ by
MAX_DIFFERENCE = 0.5


def assert_kept(drawn: Path, kept: Path, names: set[str]) -> None:
    """A command drew these pictures, and they are those that are kept."""
    assert {path.name for path in drawn.iterdir()} == names
    for name in names:
        pixels, wanted = (np.asarray(Image.open(folder / name)).astype(int) for folder in (drawn, kept))
        assert pixels.shape == wanted.shape and np.abs(pixels - wanted).mean() < MAX_DIFFERENCE, name


def test_gallery(tmp_path):
    done = called("gallery", "--output", tmp_path)
    assert done.returncode == 0, done.stderr
    assert_kept(
        tmp_path, paths.ROOT / "docs/images", {f"{name}.png" for name in gallery.PICTURES} | {f"{gallery.PULL}.webp"}
    )


def test_pictures_are_those_of_the_document(tmp_path):
    """As they are kept, but for what drivers differ by. Those of Figure 1 need a download, which may fail."""
    done = called("figures", "--output", tmp_path)
    assert done.returncode == 0, done.stderr
    names = {f"figure_{name}.png" for name in ("07", "09", "11", "11_own", "11_wide", "12", "13")}
    if "not drawn, photographs" not in done.stdout:
        names |= {f"figure_01_{letter}.png" for letter in figures.VIEWS}
    assert_kept(tmp_path, PICTURES, names)
    # those that nothing draws any more are shown too, each once
    shown = re.findall(r"\]\(reproduction/(\w+\.png)\)", DOCUMENT.read_text(encoding="utf-8"))
    assert sorted(shown) == sorted(path.name for path in PICTURES.iterdir())


def test_pictures_of_the_readme():
    """Each below 700 kB, with a command under it that the program has; the gallery's are all shown somewhere."""
    shown = re.findall(r"!\[[^\]]*\]\(([^)]+)\)", README)
    for picture in shown:
        assert (paths.ROOT / picture).stat().st_size < 700_000, picture
        after = README.split(f"]({picture})", 1)[1].strip()
        assert re.match(r"(?:!\[[^\]]*\]\([^)]+\)\s*)*\*[^*]*`validation/run \w+", after), picture
    pages = [README, *(page.read_text(encoding="utf-8") for page in (paths.ROOT / "docs").rglob("*.md"))]
    for name in (*(f"{name}.png" for name in gallery.PICTURES), f"{gallery.PULL}.webp"):
        assert any(f"images/{name})" in page for page in pages), name


def test_without_npm(tmp_path, monkeypatch):
    """The other figures are drawn; a line says what is missing for the photographs."""
    monkeypatch.setattr(figures, "FIGURES", (figures.photographs, figures.two_under_max))
    monkeypatch.setenv("BOKEH_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("PATH", str(tmp_path))
    done = called("figures", "--output", tmp_path)
    assert done.returncode == 0 and "not drawn, photographs: npm is not on this machine" in done.stdout
    assert [path.name for path in tmp_path.glob("*.png")] == ["figure_13.png"]
