"""The command `validation/run pictures`, and docs/data/pictures.json: what is recorded of every picture.

A record has the hash of the file, which a test holds, and the digest of what it was drawn with: where that is another
now, the picture is older than the shaders or the input that it shows.
"""

import hashlib
import json
from pathlib import Path
from typing import Annotated

import typer

from bokeh_validation import files, paths, pictures, terminal
from bokeh_validation.errors import Unavailable, UserError
from lab.documents.drawings import BY_NAME, DRAWINGS, Animation, Drawing

RECORD = paths.ROOT / "docs/data/pictures.json"
KINDS = (".png", ".webp")


def every_picture() -> dict[str, Path]:
    """Path below the repository's root -> file, of all pictures of the documents and the guides."""
    folders = paths.ROOT / "docs", paths.ROOT / "integration"
    found = sorted(path for folder in folders for path in folder.rglob("*") if path.suffix in KINDS)
    # what a package manager installed there is no guide's
    drawings = sorted((paths.ROOT / "docs").rglob("*.svg"))
    return {str(path.relative_to(paths.ROOT)): path for path in [*found, *drawings] if "node_modules" not in path.parts}


def file_hash(path: Path) -> str:
    """Of its content."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def recorded() -> dict[str, dict]:
    """Path -> {"sha256": hash of the file, "drawn_with": digest of shaders and inputs, null: not by a command}."""
    return json.loads(RECORD.read_text(encoding="ascii"))


def older() -> list[str]:
    """Pictures that were drawn with other shaders, or from other inputs."""
    digests = {name: drawing.digest() for name, drawing in BY_NAME.items()}
    return [
        path
        for path, record in recorded().items()
        if record["drawn_with"] and record["drawn_with"] != digests.get(Path(path).stem)
    ]


def record(*changed: Path) -> None:
    """Put these files, as they are, into the record."""
    known = recorded() if RECORD.exists() else {}
    for path in changed:
        name = str(path.relative_to(paths.ROOT))
        drawing = BY_NAME.get(path.stem)
        known[name] = {"sha256": file_hash(path), "drawn_with": drawing.digest() if drawing else None}
    text = json.dumps(dict(sorted(known.items())), indent=1) + "\n"
    files.whole(RECORD, lambda partial: partial.write_text(text, encoding="ascii"))


def write(drawing: Drawing, drawn: dict, wanted: list[str], folder: Path | None) -> list[Path]:
    """Write the pictures of a drawing that are wanted, into a folder or to their places; returns the files."""
    found, place = [], folder or paths.ROOT / drawing.folder
    for name in (name for name in drawing.names if name in wanted):
        if isinstance(drawn[name], Animation):
            found.append(pictures.write_animation(place, name, *drawn[name]))
        elif isinstance(drawn[name], str):
            found.append(place / f"{name}.svg")
            files.whole(found[-1], lambda target, text=drawn[name]: target.write_text(text, encoding="utf-8"))
        else:
            found.append(pictures.write_document(place, name, drawn[name]))
    return found


def draw_pictures(
    names: Annotated[list[str] | None, typer.Argument(metavar="[NAME]...", help="Default: all.")] = None,
    folder: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FOLDER", help="Else to their places in docs.")
    ] = None,
    driver: terminal.OneDriver = None,
    adapter: terminal.Adapter = None,
    state: Annotated[
        bool, typer.Option("--list", help="Draw nothing: all names, and which are older than the shaders.")
    ] = False,
    keep: Annotated[
        Path | None, typer.Option("--record", metavar="FILE", help="Draw nothing: record a file as it is now.")
    ] = None,
) -> None:
    """Draw the pictures of the documents."""
    known = every_picture()
    if keep is not None:
        if keep.resolve() not in known.values():
            raise UserError(f"--record {keep}: no picture of docs or integration. Name a PNG or WebP there.")
        return record(keep.resolve())
    if state:
        stale = {Path(path).stem for path in older()}
        return terminal.tell(*(f"{name}{': older than its shaders' * (name in stale)}" for name in BY_NAME))
    wanted = terminal.chosen("NAME", names, BY_NAME)
    files.check_folder("--output", folder)
    used = terminal.pick_driver(driver, adapter)
    for drawing in (one for one in DRAWINGS if set(one.names) & set(wanted)):
        try:
            written = write(drawing, drawing.draw(used), wanted, folder)
        except Unavailable as error:
            terminal.tell(f"not drawn, {', '.join(drawing.names)}: {error}")
            continue
        if folder is None:
            record(*written)
        terminal.tell(*(f"{path}, by {used.name} ({used.adapter})" for path in written))
