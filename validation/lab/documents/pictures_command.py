"""Draw the documents' images and record them in docs/data/pictures.json: the command `validation/run pictures`.

A record has the hash of the file, which a test checks, and a digest of the shaders and inputs that it was drawn with.
If that digest has changed, the image is out of date.
"""

import hashlib
import json
from pathlib import Path
from typing import Annotated

import typer

from bokeh_validation import drivers, files, paths, terminal
from bokeh_validation.errors import Unavailable, UserError
from lab import captioned
from lab.documents.drawings import BY_NAME, DRAWINGS, Animation, Drawing

RECORD = paths.ROOT / "docs/data/pictures.json"
KINDS = (".png", ".webp")


def every_picture() -> dict[str, Path]:
    """Return path below the repository's root -> file, for all images of the documents and guides."""
    folders = paths.ROOT / "docs", paths.ROOT / "integration"
    images = sorted(path for folder in folders for path in folder.rglob("*") if path.suffix in KINDS)
    # folders of a package manager belong to no guide
    drawings = sorted((paths.ROOT / "docs").rglob("*.svg"))
    return {
        str(path.relative_to(paths.ROOT)): path for path in [*images, *drawings] if "node_modules" not in path.parts
    }


def file_hash(path: Path) -> str:
    """Return the hash of a file's content."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def recorded() -> dict[str, dict]:
    """Return path -> {"sha256": hash of the file, "drawn_with": digest of shaders and inputs, null if no command draws
    it}.
    """
    return json.loads(RECORD.read_text(encoding="ascii"))


def older() -> list[str]:
    """Return the images that were drawn with other shaders or inputs."""
    digests = {name: drawing.digest() for name, drawing in BY_NAME.items()}
    return [
        path
        for path, record in recorded().items()
        if record["drawn_with"] and record["drawn_with"] != digests.get(Path(path).stem)
    ]


def record(*changed: Path) -> None:
    """Record these files in their current state."""
    records = recorded() if RECORD.exists() else {}
    for path in changed:
        name = str(path.relative_to(paths.ROOT))
        drawing = BY_NAME.get(path.stem)
        records[name] = {"sha256": file_hash(path), "drawn_with": drawing.digest() if drawing else None}
    text = json.dumps(dict(sorted(records.items())), indent=1) + "\n"
    files.whole(RECORD, lambda partial: partial.write_text(text, encoding="ascii"))


def write(drawing: Drawing, drawn: dict, wanted: list[str], folder: Path | None) -> list[Path]:
    """Write the wanted images of a drawing into a folder, or to their folder in docs; returns the files."""
    written, target_folder = [], folder or paths.ROOT / drawing.folder
    for name in (name for name in drawing.names if name in wanted):
        if isinstance(drawn[name], Animation):
            written.append(captioned.write_animation(target_folder, name, *drawn[name]))
        elif isinstance(drawn[name], str):
            written.append(target_folder / f"{name}.svg")
            files.whole(written[-1], lambda target, text=drawn[name]: target.write_text(text, encoding="utf-8"))
        else:
            written.append(captioned.write_document(target_folder, name, drawn[name]))
    return written


def draw_pictures(
    names: Annotated[list[str] | None, typer.Argument(metavar="[NAME]...", help="Default: all.")] = None,
    folder: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FOLDER", help="Folder to write to. Default: the places in docs."),
    ] = None,
    driver: terminal.OneDriver = None,
    adapter: terminal.Adapter = None,
    state: Annotated[
        bool, typer.Option("--list", help="Draw nothing; list all names and which are older than the shaders.")
    ] = False,
    keep: Annotated[
        Path | None, typer.Option("--record", metavar="FILE", help="Draw nothing; record a file as it is now.")
    ] = None,
) -> None:
    """Draw the pictures of the documents."""
    existing = every_picture()
    if keep is not None:
        if keep.resolve() not in existing.values():
            raise UserError(f"--record {keep}: no picture of docs or integration. Name a PNG or WebP there.")
        return record(keep.resolve())
    if state:
        stale = {Path(path).stem for path in older()}
        return terminal.tell(*(f"{name}{': older than its shaders' * (name in stale)}" for name in BY_NAME))
    chosen_names = terminal.chosen("NAME", names, BY_NAME)
    files.check_folder("--output", folder)
    active_driver = drivers.pick(driver, adapter)
    for drawing in (candidate for candidate in DRAWINGS if set(candidate.names) & set(chosen_names)):
        try:
            written = write(drawing, drawing.draw(active_driver), chosen_names, folder)
        except Unavailable as error:
            terminal.tell(f"not drawn, {', '.join(drawing.names)}: {error}")
            continue
        if folder is None:
            record(*written)
        terminal.tell(*(f"{path}, by {active_driver.name} ({active_driver.adapter})" for path in written))
