"""The package for Panda3D: installed by pip as a user does it, and its errors."""

import shutil
import sys

import pytest
from support import needed
from support_pages import assert_picture

from bokeh_validation import paths, process
from bokeh_validation.engines import desktop

SAMPLE = paths.ROOT / "integration/panda3d"
GIT = ("git", "-c", "user.name=x", "-c", "user.email=x")
PIP = ("-I", "-m", "pip", "--disable-pip-version-check", "--no-input")
WRONG = """
from bokeh_panda3d import DepthOfField
for wrong in ({"method": "gather"}, {"sides": 5}, {"preset": "high"}, {"method": "paper", "sides": 4}):
    try:
        DepthOfField.change(None, **wrong)
    except ValueError as error:
        print(error)
"""


@pytest.mark.sample("panda3d")
@pytest.mark.parametrize("form", ["folder", "git"])
def test_installed(form, tmp_path):
    """From a copy of the folder, and by git from a repository that has it: the sample draws its picture by it.

    Into a new environment, where pip finds Panda3D in the sample's, by a .pth file; setuptools is fetched once.
    """
    with needed("panda3d"):
        owner = desktop.python("panda3d")
        wheels = desktop.built(
            "panda3d",
            "setuptools",
            [sys.version],
            lambda target: process.run([owner, *PIP, "download", "-qd", target, "setuptools>=77"], desktop.SECONDS),
        )
    repository, folder, away = (tmp_path / name for name in ("repository", "venv", "away"))
    source = repository / "integration/panda3d"
    shutil.copytree(SAMPLE, source)
    if form == "git":
        for command in (("init", "-q"), ("add", "."), ("commit", "-qm", "x")):
            process.run([*GIT, *command], desktop.SECONDS, repository)
        source = f"git+file://{repository}#subdirectory=integration/panda3d"
    process.run([sys.executable, "-I", "-m", "venv", folder], desktop.SECONDS)
    (packages,) = folder.glob("lib/*/site-packages")
    (packages / "panda3d.pth").write_text(str(next(owner.parents[1].glob("lib/*/site-packages"))))
    process.run([folder / "bin/python", *PIP, "install", "--no-index", "--find-links", wheels, source], desktop.SECONDS)
    away.mkdir()
    for name in ("sample.py", "scene.py"):
        shutil.copy(SAMPLE / name, away)
    process.run([folder / "bin/python", "sample.py", "picture.png"], desktop.SECONDS, away)
    assert_picture(away / "picture.png", SAMPLE / "picture.png")
    said = process.run([folder / "bin/python", "-c", WRONG], desktop.SECONDS, away).splitlines()
    assert len(said) == 4 and all(line.startswith("no passes for method") for line in said)
