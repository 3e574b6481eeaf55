"""Check docs/publishing.md: one version in every manifest, the licence in every installed folder, and the archives."""

import json
import re
import shlex
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from datetime import date

import pytest
from support import needed
from support_inputs import of_sample

from bokeh_validation import __version__, generate, paths
from bokeh_validation.errors import UserError
from bokeh_validation.generate import manifests
from engines import cargo, pages

ROOT = paths.ROOT
INTEGRATION = ROOT / "integration"
# Folders that git ignores
NOT_OURS = ("node_modules", "target", "dist", "__pycache__")
PAGE = (paths.ROOT / "docs/publishing.md").read_text(encoding="utf-8")


def test_version():
    """Check that every manifest and shader has the version that validation/run --version prints."""
    crates = ("bevy", "wgpu")
    found = {
        name: tomllib.loads((INTEGRATION / name / "Cargo.toml").read_text())["package"]["version"] for name in crates
    }
    project = tomllib.loads((INTEGRATION / "panda3d/pyproject.toml").read_text(encoding="utf-8"))["project"]
    found["panda3d"] = project["version"]
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


def test_changelog():
    """Check that the first heading of CHANGELOG.md has this version, and either "not released yet", or a date that is
    also in CITATION.cff.
    """
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    version, state = re.search(r"^## (\S+), (.*)$", changes, re.MULTILINE).groups()
    assert version == __version__
    if state != "not released yet":
        assert date.fromisoformat(state).isoformat() == state
        assert f"\ndate-released: {state}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "place",
    ["web/LICENSE", "bevy/LICENSE", "wgpu/LICENSE", "panda3d/LICENSE", "unity/LICENSE.md",
     "unreal/BokehDepthOfField/LICENSE", "godot/addons/polygon_bokeh/LICENSE"],
)  # fmt: skip
def test_licence(place):
    """Check that a folder which is installed by itself contains the licence."""
    assert (INTEGRATION / place).read_bytes() == (paths.ROOT / "LICENSE").read_bytes()


@pytest.mark.parametrize("line", re.findall(r"^python3 (-m zipfile .*)$", PAGE, re.MULTILINE))
def test_archives(line, tmp_path):
    """Check that the page's commands pack files unchanged, without the parent folders of the files that are installed,
    and with the licence.
    """
    arguments = shlex.split(line)
    archive, sources = tmp_path / arguments[3], arguments[4:]
    done = subprocess.run([sys.executable, *arguments[:3], archive, *sources], cwd=paths.ROOT, capture_output=True)
    assert done.returncode == 0, done.stderr
    packed = {name: zipfile.ZipFile(archive).read(name) for name in zipfile.ZipFile(archive).namelist()}
    source_paths = [paths.ROOT / source for source in sources]
    files = {
        path: source_path
        for source_path in source_paths
        for path in (source_path.rglob("*") if source_path.is_dir() else [source_path])
        if path.is_file()
    }
    expected = {
        path.relative_to(source_path.parent).as_posix(): path.read_bytes() for path, source_path in files.items()
    }
    assert {name: content for name, content in packed.items() if not name.endswith("/")} == expected
    assert (paths.ROOT / "LICENSE").read_bytes() in packed.values()


def test_reshade_archive(tmp_path):
    """Check that the archive has one folder, Shaders, with the effect and all that it includes except ReShade's own
    header.
    """
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


@of_sample("wgpu", of_code=True)
@pytest.mark.parametrize("name", ["wgpu", "bevy"])
def test_crate_archive(name, tmp_path):
    """Check that a crate's archive has its sources, its licence and what its README shows, and no template."""
    ignored = shutil.ignore_patterns("target", "Cargo.lock")
    crate = shutil.copytree(INTEGRATION / name, tmp_path / name, ignore=ignored)
    with needed(name):
        listed = set(cargo.build(name, crate, "--list", "--allow-dirty", "--offline", command="package").split())
        if name == "wgpu":
            # also builds the crate from the archive; Bevy's would take minutes
            cargo.build(name, crate, "--allow-dirty", "--offline", command="package")
    files = {path.relative_to(crate).as_posix() for path in crate.rglob("*") if path.is_file()}
    assert {"Cargo.toml", "LICENSE", "README.md", "picture.png", "src/lib.rs", "src/bokeh.wgsl"} <= listed
    # Cargo adds the manifest as it was, the lock file and the commit; .gitignore is only there in a git checkout
    added = {"Cargo.toml.orig", "Cargo.lock", ".cargo_vcs_info.json", ".gitignore"}
    assert listed - added == {file for file in files if not file.endswith(".jinja")} - added


def test_unity_archive(tmp_path):
    """Check that the archive for Unity has every file of the package's folder, the sample and .meta files included."""
    with needed("npm"):
        pages.call_npm(tmp_path, "pack", INTEGRATION / "unity")
    (archive,) = tmp_path.glob(f"com.polygonal-bokeh.urp-{__version__}.tgz")
    with tarfile.open(archive) as packed:
        names = {member.name.removeprefix("package/") for member in packed.getmembers() if member.isfile()}
    folder = INTEGRATION / "unity"
    assert names == {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    assert any(name.startswith("Samples~/") for name in names)


def parsed(name: str, text: str) -> dict:
    """Return the fields of a manifest of integration/, parsed in its store's format."""
    if name.endswith((".json", ".uplugin")):
        return json.loads(text)
    if name.endswith(".toml"):
        read = tomllib.loads(text)
        return read.get("package") or read["project"]
    return dict(re.findall(r'^(\w+)="(.*)"$', text, re.MULTILINE))


UPLUGIN = "unreal/BokehDepthOfField/BokehDepthOfField.uplugin"
CRATE = {"name", "version", "edition", "description", "license", "readme", "keywords", "categories"}
# Manifest below integration/ -> the fields that its store requires or shows, without addresses; and the addresses
STORES = {
    "web/package.json": (
        {"name", "version", "description", "keywords", "license", "author", "exports", "files"},
        {"repository", "homepage", "bugs"},
    ),
    "bevy/Cargo.toml": (CRATE, {"repository"}),
    "wgpu/Cargo.toml": (CRATE, {"repository"}),
    "panda3d/pyproject.toml": (
        {"name", "version", "description", "readme", "requires-python", "license", "license-files", "authors",
         "keywords", "classifiers"},
        {"urls"},
    ),
    "unity/package.json": (
        {"name", "version", "displayName", "description", "unity", "license", "author", "keywords", "samples"},
        {"documentationUrl", "changelogUrl", "licensesUrl", "repository"},
    ),
    UPLUGIN: (
        {"FileVersion", "Version", "VersionName", "EngineVersion", "FriendlyName", "Description", "Category",
         "CreatedBy", "Modules"},
        {"CreatedByURL", "DocsURL", "SupportURL"},
    ),
    "godot/addons/polygon_bokeh/plugin.cfg": ({"name", "description", "author", "version", "script"}, set()),
}  # fmt: skip


@pytest.mark.parametrize("name", STORES)
def test_fields(name):
    """Check that the fields which a store requires or shows are present and not empty."""
    found = parsed(name, (INTEGRATION / name).read_text(encoding="utf-8"))
    assert {field for field in STORES[name][0] if not found.get(field)} == set()
    author = found.get("author") or found.get("CreatedBy") or found.get("authors")
    if author:
        assert "the authors of the polygonal bokeh shader package" in json.dumps(author).lower()
    assert found.get("license", "MIT") == "MIT"


def test_rules_of_the_stores():
    """Check for what registries refuse: long or many keywords, unknown categories, malformed names,
    missing platforms.
    """
    for name in ("bevy/Cargo.toml", "wgpu/Cargo.toml"):
        found = parsed(name, (INTEGRATION / name).read_text(encoding="utf-8"))
        assert len(found["keywords"]) <= 5 and len(found["categories"]) <= 5
        assert all(re.fullmatch(r"[a-z0-9][\w+-]{0,19}", word) for word in found["keywords"])
        assert set(found["categories"]) <= {"graphics", "rendering", "game-development"}
    unity = json.loads((INTEGRATION / "unity/package.json").read_text(encoding="utf-8"))
    assert re.fullmatch(r"[a-z0-9-]+(\.[a-z0-9-]+){2,}", unity["name"]) and re.fullmatch(r"\d{4}\.\d", unity["unity"])
    plugin = json.loads((INTEGRATION / UPLUGIN).read_text(encoding="utf-8"))
    assert re.fullmatch(r"5\.\d\.0", plugin["EngineVersion"])
    assert all(module["PlatformAllowList"] for module in plugin["Modules"])
    sources = [
        path for path in (INTEGRATION / UPLUGIN).parent.rglob("*") if path.suffix in (".h", ".cpp", ".cs", ".usf")
    ]
    assert len(sources) >= 8
    for path in sources:
        assert "// Copyright (c) 2026 the authors of the polygonal bokeh shader package\n" in path.read_text(), path


def test_reshade_entry():
    """Check that the entry for ReShade's list has all of its keys, and names the effect in the archive."""
    (entry,) = re.findall(r"^```ini\n\[NN\]\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    actual = dict(line.split("=", 1) for line in entry.splitlines())
    expected = "PackageName PackageDescription InstallPath TextureInstallPath DownloadUrl RepositoryUrl EffectFiles"
    assert list(actual) == expected.split() and all(actual.values())
    effects = [path.name for path in (INTEGRATION / "reshade/Shaders").glob("*.fx")]
    assert actual["EffectFiles"].split(",") == effects
    assert actual["InstallPath"].startswith(r".\reshade-shaders\Shaders")


ADDRESS = "https://example.com/owner/polygonal-bokeh"


def test_repository(monkeypatch, tmp_path):
    """Check that the option writes the addresses to every manifest, and absolute links to every README that a store
    shows, replacing the addresses of an earlier call.
    """
    for given in (f"{ADDRESS}-before/", f"{ADDRESS}.git"):
        texts = manifests.with_repository(given)
        for name, text in texts.items():
            (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / name).write_text(text, encoding="utf-8")
        monkeypatch.setattr(manifests.paths, "ROOT", tmp_path)
    assert f"repository-code: {ADDRESS}\n" in texts.pop("CITATION.cff")
    for folder, packed in manifests.READMES.items():
        links = re.findall(r"\]\(([^)\s]+)\)", texts.pop(f"{folder}/README.md"))
        away = [link for link in links if link not in packed and not link.startswith("#")]
        assert away, folder
        for link in away:
            address, _, name = link.partition(f"/v{__version__}/")
            assert address in (f"{ADDRESS}/blob", f"{ADDRESS}/raw"), link
            assert (ROOT / name.partition("#")[0]).is_file(), link
            assert (address.endswith("raw")) == name.endswith(".png"), link
    assert set(texts) == {f"integration/{name}" for name, (_, addresses) in STORES.items() if addresses}
    for name, text in texts.items():
        fields, addresses = STORES[name.removeprefix("integration/")]
        found = parsed(name, text)
        assert fields | addresses <= set(found), name
        for field in addresses:
            said = json.dumps(found[field])
            assert ADDRESS in said and "-before" not in said and ".git.git" not in said, (name, field)


@pytest.mark.parametrize("address", ["", "example.com/owner/name", "https://example.com", "https://a b/c", "git@a:b/c"])
def test_repository_refused(address):
    """Refuse anything that is not the address of a repository's page."""
    with pytest.raises(UserError, match="not an address"):
        manifests.with_repository(address)


def test_names_of_archives():
    """Check that archive names on the page begin with the packages' names."""
    for name, archive in {
        "panda3d/pyproject.toml": "polygonal_bokeh_panda3d-$V-py3-none-any.whl",
        "web/package.json": "polygonal-bokeh-$V.tgz",
        "unity/package.json": "com.polygonal-bokeh.urp-$V.tgz",
        "wgpu/Cargo.toml": "polygonal-bokeh-$V.crate",
        "bevy/Cargo.toml": "bokeh-bevy-$V.crate",
    }.items():
        found = parsed(name, (INTEGRATION / name).read_text(encoding="utf-8"))["name"]
        assert archive in PAGE and archive.partition("-$V")[0].replace("_", "-") == found


def test_hand_written_lines(monkeypatch):
    """Check that at most 15,000 lines of integration/ are written by hand.

    These are the lines of text files that are not blank. Left out are the live page (demo), guides (.md), licences,
    npm's lock files, files that `validation/run generate` writes, and in other files the regions that it writes.
    Templates count, because they are written by hand; so do samples and tests.
    """
    text_of, left_out = generate._text, {*generate.godot_shaders()}
    # every file is out of date then, except those of which only regions are generated, or which are made by _text()
    monkeypatch.setattr(generate, "_text", lambda name: f"{text_of(name)} ")
    left_out, count = left_out.union(generate.out_of_date()), 0
    for path in INTEGRATION.rglob("*"):
        is_other = path.suffix in (".md", ".png") or path.name in ("LICENSE", "package-lock.json") or not path.is_file()
        name = path.relative_to(ROOT)
        if not is_other and name.as_posix() not in left_out and not {"demo", *NOT_OURS} & set(name.parts):
            text = generate.REGION.sub("", path.read_text(encoding="utf-8"))
            count += sum(bool(line.strip()) for line in text.splitlines())
    assert 10_000 < count <= 15_000, count
