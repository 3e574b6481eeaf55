"""Test validation/run pictures: it draws the documents' images; all of them are recorded and shown."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from support import called, refused

from bokeh_validation import paths
from bokeh_validation.generate import results
from lab.documents import chart, drawings, frame_graph, gallery, pictures_command

README = (paths.ROOT / "README.md").read_text(encoding="utf-8")
DOCUMENT = paths.ROOT / "docs" / "paper.md"
PICTURES = paths.ROOT / "docs" / "reproduction"
# Of 255, on average: drivers differ in single pixels at comparisons and in last digits
MAX_DIFFERENCE = 0.5
FIGURES = tuple(name for name in drawings.BY_NAME if name.startswith("figure_"))


def assert_kept(drawn: Path, kept: Path, names: set[str]) -> None:
    """Check that a command drew these images, and that they match the stored ones."""
    assert {path.stem for path in drawn.iterdir()} == names
    for path in drawn.iterdir():
        pixels, expected = (np.asarray(Image.open(folder / path.name)).astype(int) for folder in (drawn, kept))
        assert pixels.shape == expected.shape and np.abs(pixels - expected).mean() < MAX_DIFFERENCE, path.name


@pytest.fixture
def asked(request):
    """Return the first of some names; with --all, every one."""
    every = request.config.getoption("--all")
    return lambda first, *others: [first, *(others if every else ())]


def test_gallery(tmp_path, asked):
    """Draw images of the gallery and compare them with the stored ones."""
    names = asked("character_cats_eye", *gallery.PICTURES, "focus_pull", "likeness_street_11_detail")
    done = called("pictures", *names, "--output", tmp_path)
    assert done.returncode == 0, done.stderr
    assert_kept(tmp_path, paths.ROOT / "docs/images", set(names))


def test_pictures_are_those_of_the_document(tmp_path, asked):
    """Draw figures and compare them with the stored ones, apart from differences between drivers.

    The images of Figure 1 need a download, which may fail.
    """
    given = asked("figure_12", *(name for name in FIGURES if name != "figure_12"))
    done = called("pictures", *given, "--output", tmp_path)
    assert done.returncode == 0, done.stderr
    names = {name for name in given if "figure_01" not in name or "not drawn" not in done.stdout}
    assert_kept(tmp_path, PICTURES, names)
    # figures that are no longer drawn are shown too, each once
    shown = re.findall(r"\]\(reproduction/(\w+\.png)\)", DOCUMENT.read_text(encoding="utf-8"))
    assert sorted(shown) == sorted(path.name for path in PICTURES.iterdir())


def test_no_picture_was_altered():
    """Check that every image of docs and integration has its recorded hash, and that all recorded files exist."""
    now = {name: pictures_command.file_hash(path) for name, path in pictures_command.every_picture().items()}
    assert now == {name: record["sha256"] for name, record in pictures_command.recorded().items()}


def test_every_picture_is_drawn_or_kept():
    """Check that the table draws existing files, and that other images of docs are figures kept from version 0.2."""
    names = {path.stem for path in pictures_command.every_picture().values()}
    assert set(drawings.BY_NAME) < names
    by_nobody = {Path(name).stem for name, record in pictures_command.recorded().items() if not record["drawn_with"]}
    kept = {"figure_02", "figure_03", "figure_04", "figure_05", "figure_06", "figure_08", "figure_10"}
    assert by_nobody == kept | {"apertures_exact_6", "picture"}


def test_frame_graph():
    """Check that the stored drawing of the passes is up to date, and has every pass and texture."""
    kept = (paths.ROOT / "docs/images/frame_graph.svg").read_text(encoding="utf-8")
    assert frame_graph.draw() == kept, "draw it: validation/run pictures frame_graph"
    planned = json.loads(frame_graph.FRAME.read_text(encoding="utf-8"))
    for step in planned["passes"]:
        assert f"{step['pass']} {frame_graph.title(step['entry'])}<" in kept
    assert all(f">{texture['name']}</text>" in kept for texture in planned["textures"])


def test_chart():
    """Check that the stored chart is up to date, and has a bar for every measured method."""
    kept = (paths.ROOT / "docs/images/flip_by_method.svg").read_text(encoding="utf-8")
    assert chart.draw() == kept, "draw it: validation/run pictures flip_by_method"
    measured = results.flip_means()
    assert all(f">{label}</text>" in kept for label in measured) and kept.count("<circle") == 5 * len(measured)
    assert max(one["flip"] for row in results.ray_traced().values() for one in row.values()) < chart.MOST


def test_older_than_its_shaders(monkeypatch):
    """Check that a change of a shader's code makes an image outdated, and that a comment does not."""
    before, text = drawings.BY_NAME["focus_pull"].digest(), drawings.shaders.file_text
    monkeypatch.setattr(drawings.shaders, "file_text", lambda *file: text(*file) + "\n// nothing\n")
    assert drawings.BY_NAME["focus_pull"].digest() == before
    fine = pictures_command.older()
    monkeypatch.setattr(drawings.shaders, "file_text", lambda *file: text(*file).replace("0.5", "0.6"))
    assert len(pictures_command.older()) > len(fine)
    assert "focus_pull: older than its shaders" in called("pictures", "--list").stdout


def test_record(tmp_path, monkeypatch):
    """Check that a file in a wrong folder is refused, and that recording an unchanged file changes nothing."""
    refused(called("pictures", "--record", tmp_path / "x.png"), ["--record", "no picture"])
    before = pictures_command.RECORD.read_text()
    copy = tmp_path / "pictures.json"
    copy.write_text(before)
    monkeypatch.setattr(pictures_command, "RECORD", copy)
    called("pictures", "--record", PICTURES / "figure_02.png")
    assert copy.read_text() == before


def test_pictures_of_the_readme():
    """Check that the README's images are below 700 kB with an existing command, and that all drawn images are shown
    somewhere.
    """
    shown = re.findall(r"!\[[^\]]*\]\(([^)]+)\)", README)
    for picture in shown:
        assert (paths.ROOT / picture).stat().st_size < 700_000, picture
        after = README.split(f"]({picture})", 1)[1].strip()
        assert re.match(r"(?:!\[[^\]]*\]\([^)]+\)\s*)*\*[^*]*`validation/run\s\w+", after), picture
    pages = [README, *(page.read_text(encoding="utf-8") for page in (paths.ROOT / "docs").rglob("*.md"))]
    for name in drawings.BY_NAME:
        assert any(re.search(rf"(images|reproduction)/{name}\.\w+\)", page) for page in pages), name


def test_without_npm(tmp_path, monkeypatch):
    """Check that figures are drawn without npm, with a line that says what the photographs need."""
    monkeypatch.setenv("BOKEH_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("PATH", str(tmp_path))
    done = called("pictures", "figure_01_a", "figure_13", "--output", tmp_path)
    assert done.returncode == 0 and "not drawn, figure_01_a, figure_01_b" in done.stdout
    assert "npm is not on this machine" in done.stdout
    assert [path.name for path in tmp_path.glob("*.png")] == ["figure_13.png"]
