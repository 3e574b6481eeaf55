"""The forms that users install: which files go into which archive. No file of an archive is kept in two places.

The shaders are put in here, and a guide without the links that lead out of the archive. All else is as it is in
integration/, but for the path in a Rust file.
"""

import base64
import hashlib
import json
import posixpath
import re
from collections.abc import Container
from pathlib import Path

from bokeh_validation import __version__, paths

INTEGRATION = paths.ROOT / "integration"
FENCE = re.compile(r"(^ *```.*?^ *```$)", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)#\s]*)(#[^)]*)?\)")

Files = dict[str, bytes]


def archives() -> dict[str, Files]:
    """Name of each archive -> path -> content."""
    made = [npm("threejs"), npm("babylonjs"), npm("playcanvas"), crate(), wheel(), unity(), unreal(), shaders()]
    return dict(made + [godot(addon) for addon in sorted(INTEGRATION.glob("godot/addons/*"))])


def npm(engine: str) -> tuple[str, Files]:
    """What `files` of package.json lists, of the engine's folder or of the one above, which all have in common; glsl.js
    and wgsl.js have the text in them that the sample's fetch."""
    manifest = INTEGRATION / engine / "package.json"
    named = json.loads(manifest.read_bytes())
    files = {"package.json": manifest.read_bytes()}
    for name in named["files"]:
        language = name.removesuffix(".js")
        of_library = language in paths.LANGUAGES
        place = next(folder / name for folder in (manifest.parent, INTEGRATION) if (folder / name).exists())
        files[name] = _module(language) if of_library else place.read_bytes()
    return f"{named['name']}-{__version__}.tgz", _rooted("package", files, engine)


def crate() -> tuple[str, Files]:
    """What Cargo unpacks, without what it adds; without the example, which is the sample."""
    folder, name = INTEGRATION / "bevy", f"bokeh-bevy-{__version__}"
    files = {"Cargo.toml": (folder / "Cargo.toml").read_bytes()} | _tree(folder, "src") | _shaders("wgsl", "wgsl/")
    source = files["src/lib.rs"]
    files["src/lib.rs"] = source.replace(b'"../../../wgsl/', b'"../wgsl/')
    return f"{name}.crate", _rooted(name, files, "bevy")


def wheel() -> tuple[str, Files]:
    """A wheel by hand: it needs no building, and is the same each time."""
    engine, name = "panda3d", "bokeh_panda3d"
    info = f"{name}-{__version__}.dist-info/"
    (locked,) = re.findall(r"^panda3d==(\S+)", (INTEGRATION / engine / "requirements.txt").read_text(), re.MULTILINE)
    files = _tree(INTEGRATION / engine, name, "*.py") | _shaders("glsl", f"{name}/glsl/")
    metadata = (
        f"Metadata-Version: 2.1\nName: bokeh-panda3d\nVersion: {__version__}\n"
        "Summary: Depth of field with polygonal bokeh for Panda3D\nLicense: MIT\nLicense-File: LICENSE\n"
        f"Requires-Python: >=3.11\nRequires-Dist: panda3d~={locked}\nDescription-Content-Type: text/markdown\n\n"
    )
    files[f"{info}LICENSE"] = (paths.ROOT / "LICENSE").read_bytes()
    files[f"{info}METADATA"] = metadata.encode() + _guide(INTEGRATION / engine / "README.md", ())
    files[f"{info}WHEEL"] = b"Wheel-Version: 1.0\nGenerator: bokeh\nRoot-Is-Purelib: true\nTag: py3-none-any\n"
    rows = [f"{path},sha256={_digest(content)},{len(content)}" for path, content in sorted(files.items())]
    files[f"{info}RECORD"] = "\n".join([*rows, f"{info}RECORD,,", ""]).encode()
    return f"{name}-{__version__}-py3-none-any.whl", files


def _digest(content: bytes) -> str:
    """As RECORD of a wheel has it."""
    return base64.urlsafe_b64encode(hashlib.sha256(content).digest()).decode().rstrip("=")


# What reads a file in Unity, by its suffix; all else is DefaultImporter's
IMPORTERS = {
    ".cs": "MonoImporter",
    ".asmdef": "AssemblyDefinitionImporter",
    ".shader": "ShaderImporter",
    ".hlsl": "ShaderIncludeImporter",
    ".json": "PackageManifestImporter",
    ".md": "TextScriptImporter",
}


def unity() -> tuple[str, Files]:
    """A UPM package. Unity ignores files in it that have no .meta."""
    folder = INTEGRATION / "unity"
    manifest = (folder / "package.json").read_bytes()
    name = json.loads(manifest)["name"]
    files = {"package.json": manifest, "Shaders/bokeh.hlsl": _shaders("hlsl")["bokeh.hlsl"]}
    for pattern, place in (("*.cs", "Runtime"), ("*.asmdef", "Runtime"), ("*.shader", "Shaders")):
        files |= {f"{place}/{path.name}": path.read_bytes() for path in folder.glob(pattern)}
    files = _rooted("package", files, "unity")
    inner = [path.removeprefix("package/") for path in files]
    for path in {*inner, *(posixpath.dirname(path) for path in inner)} - {""}:
        # by name and place, so that it is the same in the next version: scenes and profiles refer to it
        guid = hashlib.md5(f"{name}/{path}".encode()).hexdigest()
        kind = IMPORTERS.get(posixpath.splitext(path)[1], "DefaultImporter")
        head = "" if path in inner else "folderAsset: yes\n"
        meta = f"fileFormatVersion: 2\nguid: {guid}\n{head}{kind}:\n  externalObjects: {{}}\n  userData: \n"
        files[f"package/{path}.meta"] = meta.encode()
    return f"{name}-{__version__}.tgz", files


def unreal() -> tuple[str, Files]:
    """The plug-in's folder. The engine includes only files that end in .ush or .usf."""
    files = _tree(INTEGRATION / "unreal/BokehDepthOfField", ".")
    files["Shaders/bokeh.ush"] = _shaders("hlsl")["bokeh.hlsl"]
    return f"unreal-BokehDepthOfField-{__version__}.zip", _rooted("BokehDepthOfField", files, "unreal")


def godot(addon: Path) -> tuple[str, Files]:
    """An add-on's folder, as it is put into a project."""
    files = _rooted(f"addons/{addon.name}", _tree(addon, "."), "godot")
    return f"godot-{addon.name}-{__version__}.zip", files


def shaders() -> tuple[str, Files]:
    """For those who copy: all three languages, the parameter block for theirs, and the documents."""
    files = {}
    for language in paths.LANGUAGES:
        files |= _shaders(language, f"{language}/")
    files |= _tree(paths.ROOT, "docs") | _tree(paths.ROOT, "integration/parameters")
    documents = [*paths.ROOT.glob("*.md"), *(paths.ROOT / "docs").rglob("*.md")]
    texts = {path.relative_to(paths.ROOT).as_posix(): path for path in documents}
    inside = {*files, *texts}
    files |= {name: _guide(path, inside, posixpath.dirname(name)) for name, path in texts.items()}
    name = f"polygonal-bokeh-shaders-{__version__}"
    return f"{name}.zip", _rooted(name, files)


def _rooted(root: str, files: Files, engine: str = "") -> Files:
    """Below a folder, with the licence and an engine's guide."""
    files = {**files, "LICENSE": (paths.ROOT / "LICENSE").read_bytes()}
    if engine:
        files["README.md"] = _guide(INTEGRATION / engine / "README.md", files)
    return {f"{root}/{path}": content for path, content in files.items()}


def _tree(folder: Path, below: str, pattern: str = "*") -> Files:
    """Path -> content of the files of a folder's folder; nothing that is only made by running."""
    found = [path for path in (folder / below).rglob(pattern) if path.is_file() and path.parent.name != "__pycache__"]
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in found}


def _shaders(language: str, place: str = "") -> Files:
    return {f"{place}{path.name}": path.read_bytes() for path in (paths.ROOT / language).glob(f"*.{language}")}


def _module(language: str) -> bytes:
    """The library as an ES module: `library`, a line of the text a line."""
    texts = _shaders(language)
    text = (texts[f"bokeh.{language}"] + texts[f"bokeh_layers.{language}"]).decode("ascii")
    lines = ",\n".join(json.dumps(line) for line in text.split("\n"))
    head = f"// SPDX-License-Identifier: MIT\n// bokeh.{language} and bokeh_layers.{language} as one text\n\n"
    return f"{head}export const library = [\n{lines},\n].join('\\n');\n".encode("ascii")


def _guide(document: Path, inside: Container[str], place: str = "") -> bytes:
    """A document for the folder `place` of an archive, with the links that lead to files in it; of others the words."""

    def link(match: re.Match) -> str:
        image, words, target, _ = match.groups()
        local = posixpath.normpath(posixpath.join(place, target)) if target else ""
        kept = not target or ":" in target or local in inside
        return match[0] if kept else f"*{words}*" if image else words

    parts = FENCE.split(document.read_text(encoding="utf-8"))
    return "".join(part if index % 2 else LINK.sub(link, part) for index, part in enumerate(parts)).encode()
