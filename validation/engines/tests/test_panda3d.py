"""Install the package for Panda3D with pip, as a user does."""

import shutil
import sys
import zipfile
from pathlib import Path

import pytest
from support import needed
from support_inputs import of_sample
from support_pages import assert_picture
from test_engines import check_shots

import engines
from bokeh_validation import __version__, paths, process
from engines import desktop

SAMPLE = paths.ROOT / "integration/panda3d"
PIP = ("-I", "-m", "pip", "--disable-pip-version-check", "--no-input")
COMMIT = "git init -q && git add . && git -c user.name=x -c user.email=x commit -qm x"
WRONG = "from bokeh_panda3d import DepthOfField as D; D.change(None, sides=5)"


def setuptools() -> Path:
    """Return a folder with the wheel of setuptools, downloaded once. Raises errors.Unavailable."""
    fetch = [desktop.python("panda3d"), *PIP, "download", "-q", "setuptools>=77"]
    return desktop.built("panda3d", "setuptools", fetch, lambda target: process.run(fetch, 99, target))


@of_sample("panda3d", of_code=True)
def test_wheel(tmp_path):
    """Check that the wheel has the package's modules and the licence, and nothing of the sample."""
    with needed("panda3d"):
        wheels, python = setuptools(), desktop.python("panda3d")
    source = shutil.copytree(SAMPLE, tmp_path / "source")
    words = ["wheel", "-q", "--no-deps", "--no-index", "--find-links", wheels, "-w", tmp_path, source]
    process.run([python, *PIP, *words], desktop.SECONDS)
    (wheel,) = tmp_path.glob(f"polygonal_bokeh_panda3d-{__version__}-*.whl")
    with zipfile.ZipFile(wheel) as packed:
        names = packed.namelist()
        (metadata,) = [packed.read(name).decode() for name in names if name.endswith("/METADATA")]
    modules = {path.relative_to(SAMPLE).as_posix() for path in (SAMPLE / "bokeh_panda3d").glob("*.py")}
    assert {name for name in names if ".dist-info/" not in name} == modules
    assert any(name.endswith("/LICENSE") for name in names)
    assert metadata.endswith((SAMPLE / "README.md").read_text(encoding="utf-8"))


@of_sample("panda3d", of_code=True)
@pytest.mark.parametrize("form", ["folder", "git"])
def test_installed(form, tmp_path):
    """Install the package from a folder, and with git from a repository, and let the sample draw its image with it, and
    a capture, which must be within the reference's intervals.

    It is installed into a new environment, where pip finds Panda3D through a .pth file; setuptools is downloaded once.
    """
    with needed("panda3d"):
        owner = desktop.python("panda3d")
        wheels = setuptools()
    repository, folder, away = (tmp_path / name for name in ("repository", "venv", "away"))
    shutil.copytree(SAMPLE, source := repository / "integration/panda3d")
    if form == "git":
        process.run(["sh", "-c", COMMIT], desktop.SECONDS, repository)
        source = f"git+file://{repository}#subdirectory=integration/panda3d"
    process.run([sys.executable, "-I", "-m", "venv", folder], desktop.SECONDS)
    packages, theirs = (next(place.glob("lib/*/site-packages")) for place in (folder, owner.parents[1]))
    (packages / "panda3d.pth").write_text(str(theirs))
    python = folder / "bin/python"
    process.run([python, *PIP, "install", "--no-index", "--find-links", wheels, source], desktop.SECONDS)
    shutil.copytree(SAMPLE, away, ignore=shutil.ignore_patterns("bokeh_panda3d"))
    # the capture imports a module of that folder
    shutil.copytree(SAMPLE.parent / "opengl", tmp_path / "opengl")
    process.run([python, "sample.py", "drawn.png"], desktop.SECONDS, away)
    assert_picture(away / "drawn.png", SAMPLE / "picture.png")
    process.run([python, "capture.py", paths.ensured(away / "capture")], desktop.SECONDS, away)
    check_shots(engines.read(away / "capture"))
    with pytest.raises(RuntimeError, match="ValueError: method 'layered', sides 5, preset 'MEDIUM' is not valid"):
        process.run([python, "-c", WRONG], desktop.SECONDS, away)
