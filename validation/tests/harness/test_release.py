"""validation/run release: archives that are complete and of one version."""

import json
import posixpath
import re
import shutil
import tomllib

import pytest
from support import called, refused

from bokeh_validation import __version__, paths

INTEGRATION = paths.ROOT / "integration"
NAMES = (
    "com.polygonal-bokeh.urp-{}.tgz", "godot-polygon_bokeh-{}.zip", "polygonal-bokeh-{}.tgz",
    "polygonal-bokeh-shaders-{}.zip", "unreal-BokehDepthOfField-{}.zip",
)  # fmt: skip


@pytest.fixture(scope="module")
def released(tmp_path_factory):
    """Name of an archive that the command leaves -> path -> content."""
    folder = tmp_path_factory.mktemp("release")
    done = called("release", "-o", folder / "made")
    assert done.returncode == 0, done.stderr
    found = {}
    for archive in (folder / "made").iterdir():
        assert archive.name in done.stdout
        shutil.unpack_archive(archive, folder / archive.stem, "zip" if archive.suffix == ".zip" else "gztar")
        files = [path for path in (folder / archive.stem).rglob("*") if path.is_file()]
        found[archive.name] = {path.relative_to(folder / archive.stem).as_posix(): path.read_bytes() for path in files}
    return found


def test_names(released):
    """One archive for each form."""
    assert sorted(released) == [name.format(__version__) for name in NAMES]


def test_files_are_the_repositorys(released):
    """Every archive has the licence and the library. Its files are the repository's, but for those that are made."""
    folders = [paths.ROOT / name for name in ("integration", "docs", *paths.LANGUAGES)]
    sources = [path for folder in folders for path in folder.rglob("*") if path.is_file()]
    own = {path.read_bytes() for path in [*sources, *paths.ROOT.glob("*.md"), paths.ROOT / "LICENSE"]}
    libraries = {paths.shader(language).read_bytes() for language in paths.LANGUAGES}
    for name, files in released.items():
        assert (paths.ROOT / "LICENSE").read_bytes() in files.values(), name
        made = {posixpath.basename(path) for path, content in files.items() if content not in own}
        assert all(base.endswith(".meta") for base in made), (name, made)
        ported = any("gdshaderinc" in path or path.endswith("shaders.js") for path in files)
        assert libraries & set(files.values()) or ported, name


def test_unity_metas(released):
    """A .meta for every file and folder of the UPM package, no GUID twice; else Unity leaves the file out."""
    files = released[f"com.polygonal-bokeh.urp-{__version__}.tgz"]
    assets = {path for path in files if not path.endswith(".meta")}
    assets |= {posixpath.dirname(path) for path in assets} - {"package"}
    assert {path.removesuffix(".meta") for path in files if path.endswith(".meta")} == assets
    guids = [re.search(r"^guid: ([0-9a-f]{32})$", files[f"{path}.meta"].decode(), re.MULTILINE)[1] for path in assets]
    assert len(set(guids)) == len(guids)


def test_version():
    """One version: that of validation/run --version, in every manifest, lock file and shader."""
    found = {"bevy": tomllib.loads((INTEGRATION / "bevy/Cargo.toml").read_text())["package"]["version"]}
    for path in (INTEGRATION / "web/package.json", INTEGRATION / "unity/package.json"):
        found[str(path)] = json.loads(path.read_text(encoding="utf-8"))["version"]
    for path in INTEGRATION.glob("*/*/*.uplugin"):
        found[str(path)] = json.loads(path.read_text(encoding="utf-8"))["VersionName"]
    for path in INTEGRATION.glob("*/addons/*/plugin.cfg"):
        found[str(path)] = re.search(r'^version="(.*)"$', path.read_text(encoding="utf-8"), re.MULTILINE)[1]
    for language in paths.LANGUAGES:
        for path in (paths.ROOT / language).iterdir():
            found[str(path)] = re.search(r"Version (\S+)\.( |$)", path.read_text(encoding="ascii"), re.MULTILINE)[1]
    assert len(found) >= 3 + 2 + 3 * 3
    assert set(found.values()) == {__version__}, found


def test_refused(tmp_path):
    """A folder where something is: nothing is changed."""
    (tmp_path / "one").write_text("precious")
    refused(called("release", "-o", tmp_path), [f"--output {tmp_path}", "is not empty"])
    assert [path.read_text() for path in tmp_path.iterdir()] == ["precious"]
