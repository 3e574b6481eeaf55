"""The command `validation/run release`: archives of files that are in the repository.

Only Unity's .meta files are made for them.
"""

import hashlib
import json
import shutil
import tempfile
from pathlib import Path
from typing import Annotated

import typer

from bokeh_validation import __version__, paths, terminal
from bokeh_validation.files import new_folder

INTEGRATION = paths.ROOT / "integration"
# Path in an archive -> a file or folder of the repository, or the text itself. All paths begin with the same folder.
Files = dict[str, Path | str]


def release(
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="A folder that is new or empty.")],
) -> None:
    """Make the archives that users install: npm, UPM, plug-in, add-on, and one of the shaders alone."""
    new_folder("--output", output, _pack_all)
    for path in sorted(output.iterdir()):
        terminal.tell(f"{path.name:45}{path.stat().st_size / 1e3:8.0f} kB")


def _pack_all(folder: Path) -> None:
    for name, named in archives().items():
        pack(folder / name, named)


def pack(archive: Path, files: Files) -> None:
    """Write a .zip or .tgz."""
    with tempfile.TemporaryDirectory(prefix="bokeh-") as folder:
        for place, source in files.items():
            target = Path(folder, place)
            target.parent.mkdir(parents=True, exist_ok=True)
            if isinstance(source, str):
                target.write_text(source, encoding="utf-8")
            elif source.is_dir():
                shutil.copytree(source, target, dirs_exist_ok=True)
            else:
                shutil.copyfile(source, target)
        (root,) = Path(folder).iterdir()
        kind = {".zip": "zip", ".tgz": "gztar"}[archive.suffix]
        shutil.move(shutil.make_archive(str(archive), kind, folder, root.name), archive)


def archives() -> dict[str, Files]:
    """Name of each archive -> what is in it."""
    shaders = f"polygonal-bokeh-shaders-{__version__}"
    names = [*paths.LANGUAGES, "docs", "integration/parameters", *(path.name for path in paths.ROOT.glob("*.md"))]
    made = {f"{shaders}.zip": {f"{shaders}/{name}": paths.ROOT / name for name in (*names, "LICENSE")}}
    for engine, root in (("unreal", "BokehDepthOfField"), ("godot", "addons/polygon_bokeh")):
        files = _with_guide(root, engine) | {root: INTEGRATION / engine / root}
        if engine == "unreal":
            # it includes only files that end in .ush or .usf
            for stem in ("bokeh", "bokeh_paper"):
                files[f"{root}/Shaders/{stem}.ush"] = paths.shader("hlsl", stem)
        made[f"{engine}-{Path(root).name}-{__version__}.zip"] = files
    return made | dict([unity(), npm()])


def npm() -> tuple[str, Files]:
    """The package of integration/web: all but what npm leaves in the folder."""
    folder = INTEGRATION / "web"
    own = [path for path in folder.iterdir() if path.name not in ("node_modules", "package-lock.json")]
    return f"polygonal-bokeh-{__version__}.tgz", {f"package/{path.name}": path for path in own}


def unity() -> tuple[str, Files]:
    """A UPM package. Unity ignores files and folders in it that have no .meta."""
    folder = INTEGRATION / "unity"
    name = json.loads((folder / "package.json").read_bytes())["name"]
    places = {".cs": "Runtime/", ".asmdef": "Runtime/", ".shader": "Shaders/", ".json": ""}
    own = [path for path in folder.iterdir() if path.suffix in places]
    files = _with_guide("package", "unity") | {f"package/{places[path.suffix]}{path.name}": path for path in own}
    for stem in ("bokeh", "bokeh_paper"):
        files[f"package/Shaders/{stem}.hlsl"] = paths.shader("hlsl", stem)
    for path in ("package/Runtime", "package/Shaders", *list(files)):
        # by name and place, so that it is the same in the next version: scenes and profiles refer to it
        guid = hashlib.md5(path.replace("package", name, 1).encode()).hexdigest()
        of_folder = "" if path in files else "folderAsset: yes\n"
        files[f"{path}.meta"] = f"fileFormatVersion: 2\nguid: {guid}\n{of_folder}"
    return f"{name}-{__version__}.tgz", files


def _with_guide(root: str, engine: str) -> Files:
    """The licence and an engine's guide."""
    return {f"{root}/LICENSE": paths.ROOT / "LICENSE", f"{root}/README.md": INTEGRATION / engine / "README.md"}
