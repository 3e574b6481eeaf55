"""docs/publishing.md: one version in every manifest, the licence in every folder that is installed, archives."""

import json
import re
import shlex
import subprocess
import sys
import tomllib
import zipfile

import pytest

from bokeh_validation import __version__, paths

INTEGRATION = paths.ROOT / "integration"
PAGE = (paths.ROOT / "docs/publishing.md").read_text(encoding="utf-8")


def test_version():
    """One version: that of validation/run --version, in every manifest and shader."""
    crates = ("bevy", "wgpu")
    found = {
        name: tomllib.loads((INTEGRATION / name / "Cargo.toml").read_text())["package"]["version"] for name in crates
    }
    citation = (paths.ROOT / "CITATION.cff").read_text(encoding="utf-8")
    found["CITATION.cff"] = re.search(r"^version: (.*)$", citation, re.MULTILINE)[1]
    for path in (INTEGRATION / "web/package.json", INTEGRATION / "unity/package.json"):
        found[str(path)] = json.loads(path.read_text(encoding="utf-8"))["version"]
    for path in INTEGRATION.glob("*/*/*.uplugin"):
        found[str(path)] = json.loads(path.read_text(encoding="utf-8"))["VersionName"]
    for path in INTEGRATION.glob("*/addons/*/plugin.cfg"):
        found[str(path)] = re.search(r'^version="(.*)"$', path.read_text(encoding="utf-8"), re.MULTILINE)[1]
    for language in paths.LANGUAGES:
        for path in (paths.ROOT / language).glob(f"*.{language}"):
            found[str(path)] = re.search(r"Version (\S+)\.( |$)", path.read_text(encoding="ascii"), re.MULTILINE)[1]
    assert len(found) >= 3 + 2 + 3 * 3
    assert set(found.values()) == {__version__}, found


@pytest.mark.parametrize(
    "place",
    ["web/LICENSE", "bevy/LICENSE", "wgpu/LICENSE", "panda3d/LICENSE", "unity/LICENSE.md",
     "unreal/BokehDepthOfField/LICENSE", "godot/addons/polygon_bokeh/LICENSE"],
)  # fmt: skip
def test_licence(place):
    """A folder that is installed by itself has the licence in it."""
    assert (INTEGRATION / place).read_bytes() == (paths.ROOT / "LICENSE").read_bytes()


@pytest.mark.parametrize("line", re.findall(r"^python3 (-m zipfile .*)$", PAGE, re.MULTILINE))
def test_archives(line, tmp_path):
    """The page's commands pack files as they are, without folders above what is installed, and with the licence."""
    arguments = shlex.split(line)
    archive, sources = tmp_path / arguments[3], arguments[4:]
    done = subprocess.run([sys.executable, *arguments[:3], archive, *sources], cwd=paths.ROOT, capture_output=True)
    assert done.returncode == 0, done.stderr
    packed = {name: zipfile.ZipFile(archive).read(name) for name in zipfile.ZipFile(archive).namelist()}
    wanted = [paths.ROOT / source for source in sources]
    files = {path: one for one in wanted for path in (one.rglob("*") if one.is_dir() else [one]) if path.is_file()}
    expected = {path.relative_to(one.parent).as_posix(): path.read_bytes() for path, one in files.items()}
    assert {name: content for name, content in packed.items() if not name.endswith("/")} == expected
    assert (paths.ROOT / "LICENSE").read_bytes() in packed.values()


def test_reshade_archive(tmp_path):
    """The archive has one folder, Shaders, and in it the effect with all that it includes but ReShade's header."""
    (line,) = [line for line in re.findall(r"^python3 (-m zipfile .*)$", PAGE, re.MULTILINE) if "reshade" in line]
    arguments = shlex.split(line)
    archive = tmp_path / "archive.zip"
    subprocess.run([sys.executable, *arguments[:3], archive, *arguments[4:]], cwd=paths.ROOT, check=True)
    with zipfile.ZipFile(archive) as packed:
        names = {name for name in packed.namelist() if not name.endswith("/")}
        effect = packed.read("Shaders/PolygonalBokeh.fx").decode("ascii")
    included = set(re.findall(r'^#include "(.*)"$', effect, re.MULTILINE)) - {"ReShade.fxh"}
    assert names == {"LICENSE", "Shaders/PolygonalBokeh.fx", *(f"Shaders/{name}" for name in included)}
    assert len(included) == 2
