"""validation/run release: archives that are complete and of one version."""

import json
import posixpath
import re
import shutil
import tomllib

import pytest
from support import called, refused

from bokeh_validation import __version__, paths, release

INTEGRATION = paths.ROOT / "integration"


@pytest.fixture(scope="module")
def released(tmp_path_factory):
    """Name of an archive that the command leaves, without version -> path -> content."""
    folder = tmp_path_factory.mktemp("release")
    done = called("release", "-o", folder / "made")
    assert done.returncode == 0, done.stderr
    found = {}
    for archive in (folder / "made").iterdir():
        assert archive.name in done.stdout
        shutil.unpack_archive(archive, folder / archive.stem, "zip" if archive.suffix == ".zip" else "gztar")
        files = [path for path in (folder / archive.stem).rglob("*") if path.is_file()]
        contents = {path.relative_to(folder / archive.stem).as_posix(): path.read_bytes() for path in files}
        found[archive.name.replace(__version__, "{}")] = contents
    return found


def test_files_are_the_repositorys(released):
    """One archive for each form; each has the licence, and its folder's files as they are."""
    assert list(released) and set(released) == set(release.ARCHIVES)
    for name, files in released.items():
        root, source = release.ARCHIVES[name]
        there = (path for path in (paths.ROOT / source).rglob("*") if path.is_file())
        known = {path for path in there if not set(path.parts) & release.LEFT_OUT}
        packed = {paths.ROOT / source / posixpath.relpath(path, root): content for path, content in files.items()}
        assert all(path.read_bytes() == content for path, content in packed.items()), name
        assert (paths.ROOT / "LICENSE").read_bytes() in files.values(), name
        assert packed.keys() == known if source != "." else packed.keys() < known, name


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
