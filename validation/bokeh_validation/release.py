"""The command `validation/run release`: archives of folders as they stand in the repository."""

import shutil
import tempfile
from pathlib import Path
from typing import Annotated

import typer

from bokeh_validation import __version__, paths, terminal
from bokeh_validation.files import new_folder

# Name of an archive without version -> folder in it, folder of the repository
ARCHIVES = {
    "polygonal-bokeh-{}.tgz": ("package", "integration/web"),
    "com.polygonal-bokeh.urp-{}.tgz": ("package", "integration/unity"),
    "unreal-BokehDepthOfField-{}.zip": ("BokehDepthOfField", "integration/unreal/BokehDepthOfField"),
    "godot-polygon_bokeh-{}.zip": ("addons/polygon_bokeh", "integration/godot/addons/polygon_bokeh"),
    "polygonal-bokeh-shaders-{}.zip": ("polygonal-bokeh-shaders", "."),
}
# Of a folder only these
KEPT = {
    paths.ROOT: {*paths.LANGUAGES, "docs", "integration", "LICENSE", "README.md", "CHANGELOG.md", "CONTRIBUTING.md"},
    paths.ROOT / "integration": {"parameters", "frames", "stereo"},
}
# Left by npm and Python
LEFT_OUT = {"node_modules", "package-lock.json", "__pycache__"}


def release(
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="A folder that is new or empty.")],
) -> None:
    """Zip what users install: npm, UPM, plug-in, add-on, and the shaders alone."""
    new_folder("--output", output, _pack_all)
    for path in sorted(output.iterdir()):
        terminal.tell(f"{path.name:45}{path.stat().st_size / 1e3:8.0f} kB")


def _pack_all(folder: Path) -> None:
    for name, (root, source) in ARCHIVES.items():
        archive = folder / name.format(__version__)
        with tempfile.TemporaryDirectory(prefix="bokeh-") as temporary:
            shutil.copytree(paths.ROOT / source, Path(temporary, root), ignore=_left_out)
            kind = {".zip": "zip", ".tgz": "gztar"}[archive.suffix]
            shutil.move(shutil.make_archive(str(archive), kind, temporary, root.split("/")[0]), archive)


def _left_out(folder: str, names: list[str]) -> set[str]:
    return set(names) - KEPT.get(Path(folder).resolve(), set(names)) | LEFT_OUT & set(names)
