"""validation/run release: archives that are complete, the same each time, and of one version."""

import io
import json
import posixpath
import re
import tarfile
import tomllib
import zipfile

import pytest
from support import called, refused

from bokeh_validation import __version__, paths
from bokeh_validation.release import archives, forms

INTEGRATION = paths.ROOT / "integration"
NAMES = (
    "bokeh-babylonjs-{}.tgz", "bokeh-bevy-{}.crate", "bokeh-playcanvas-{}.tgz", "bokeh-threejs-{}.tgz",
    "bokeh_panda3d-{}-py3-none-any.whl", "com.polygonal-bokeh.urp-{}.tgz", "polygonal-bokeh-shaders-{}.zip",
    "unreal-BokehDepthOfField-{}.zip",
)  # fmt: skip
ADDONS = [f"godot-{path.name}-{{}}.zip" for path in INTEGRATION.glob("godot/addons/*")]


@pytest.fixture(scope="module")
def released(tmp_path_factory):
    """What the command leaves."""
    folder = tmp_path_factory.mktemp("release") / "made"
    done = called("release", "-o", folder)
    assert done.returncode == 0, done.stderr
    assert all(path.name in done.stdout for path in folder.iterdir())
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def unpacked(name: str, archive: bytes) -> dict[str, bytes]:
    """Path -> content of an archive."""
    if name.endswith((".zip", ".whl")):
        with zipfile.ZipFile(io.BytesIO(archive)) as reader:
            return {path: reader.read(path) for path in reader.namelist()}
    with tarfile.open(fileobj=io.BytesIO(archive), mode="r:gz") as reader:
        return {member.name: reader.extractfile(member).read() for member in reader}


def contents(released) -> dict[str, dict[str, bytes]]:
    return {name: unpacked(name, archive) for name, archive in released.items()}


def test_names(released):
    """One archive for each form."""
    assert sorted(released) == sorted(name.format(__version__) for name in (*NAMES, *ADDONS))


def test_reproducible(released, monkeypatch):
    """At another time, with the files in another order: the same to the byte."""
    monkeypatch.setattr("time.time", lambda: 2e9)
    for name, files in forms.archives().items():
        shuffled = dict(reversed(files.items()))
        assert archives.packed(name, shuffled) == released[name], name


def test_shaders_and_licence(released):
    """Every archive has the licence, and its shaders are those of the repository; Godot's have a test of their own."""
    licence = (paths.ROOT / "LICENSE").read_bytes()
    for name, files in contents(released).items():
        assert licence in files.values(), name
        found = {posixpath.basename(path): content for path, content in files.items()}
        shaders = {
            base: content for base, content in found.items() if re.fullmatch(r"bokeh\w*\.(hlsl|glsl|wgsl|ush)", base)
        }
        for base, content in shaders.items():
            stem, _, suffix = base.partition(".")
            language = suffix.replace("ush", "hlsl")
            assert content == (paths.ROOT / language / f"{stem}.{language}").read_bytes(), f"{name}: {base}"
        assert shaders or found.keys() & {"glsl.js", "bokeh.gdshaderinc"}, name


def test_nothing_else_is_changed(released):
    """All other files are the sample's, but for a guide's links, the crate's paths, and what only a package has."""
    folders = [paths.ROOT / name for name in ("integration", "docs", *paths.LANGUAGES)]
    sources = [path for folder in folders for path in folder.rglob("*") if path.is_file()]
    own = {path.read_bytes() for path in [*sources, paths.ROOT / "LICENSE"]}
    made = r"glsl\.js|wgsl\.js|.*\.md|.*\.meta|METADATA|WHEEL|RECORD|lib\.rs"
    for name, files in contents(released).items():
        new = [path for path, content in files.items() if content not in own]
        assert all(re.fullmatch(made, posixpath.basename(path)) for path in new), (name, new)
    crate = contents(released)[f"bokeh-bevy-{__version__}.crate"][f"bokeh-bevy-{__version__}/src/lib.rs"].decode()
    sample = (INTEGRATION / "bevy/src/lib.rs").read_text(encoding="utf-8")
    assert crate.replace('"../wgsl/', '"../../../wgsl/') == sample and crate.count('"../wgsl/') == 3


def test_links(released):
    """Links of the documents lead to files of the archive."""
    for name, files in contents(released).items():
        for path, content in files.items():
            if path.endswith(".md"):
                text = re.sub(r"^ *```.*?^ *```", "", content.decode(), flags=re.MULTILINE | re.DOTALL)
                for target in re.findall(r"\]\(([^)#]+)[^)]*\)", text):
                    there = posixpath.normpath(posixpath.join(posixpath.dirname(path), target))
                    assert ":" in target or there in files, f"{name}: {path}: {target}"


def test_unity_metas(released):
    """A .meta for every file and folder of the UPM package, no GUID twice; else Unity leaves the file out."""
    files = contents(released)[f"com.polygonal-bokeh.urp-{__version__}.tgz"]
    assets = {path for path in files if not path.endswith(".meta")}
    assets |= {posixpath.dirname(path) for path in assets} - {"package"}
    assert {path.removesuffix(".meta") for path in files if path.endswith(".meta")} == assets
    guids = [re.search(r"^guid: ([0-9a-f]{32})$", files[f"{path}.meta"].decode(), re.MULTILINE)[1] for path in assets]
    assert len(set(guids)) == len(guids)


def test_version():
    """One version: that of validation/run --version, in every manifest, lock file and shader."""
    found = {"bevy": tomllib.loads((INTEGRATION / "bevy/Cargo.toml").read_text())["package"]["version"]}
    for path in INTEGRATION.glob("*/package*.json"):
        data = json.loads(path.read_text(encoding="utf-8"))
        found[str(path)] = data["version"]
        if path.name == "package-lock.json":
            found[f"{path}, root"] = data["packages"][""]["version"]
    for path in INTEGRATION.glob("*/*/*.uplugin"):
        found[str(path)] = json.loads(path.read_text(encoding="utf-8"))["VersionName"]
    for path in INTEGRATION.glob("*/addons/*/plugin.cfg"):
        found[str(path)] = re.search(r'^version="(.*)"$', path.read_text(encoding="utf-8"), re.MULTILINE)[1]
    for language in paths.LANGUAGES:
        for path in (paths.ROOT / language).iterdir():
            found[str(path)] = re.search(r"Version (\S+)\.( |$)", path.read_text(encoding="ascii"), re.MULTILINE)[1]
    assert len(found) >= 9 + 2 + 1 + 3 * 3
    assert set(found.values()) == {__version__}, found


def test_refused(tmp_path):
    """A folder where something is: nothing is changed."""
    (tmp_path / "one").write_text("precious")
    refused(called("release", "-o", tmp_path), [f"--output {tmp_path}", "is not empty"])
    assert [path.read_text() for path in tmp_path.iterdir()] == ["precious"]
