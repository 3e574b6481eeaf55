"""Archives for those who install the package: the work behind `validation/run release`."""

import os
import shutil
from pathlib import Path
from typing import Annotated

import typer

from bokeh_validation import terminal
from bokeh_validation.errors import UserError
from bokeh_validation.release import archives, forms


def release(
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="A folder that is new or empty.")],
) -> None:
    """Make the archives that users install: npm, Cargo, wheel, UPM, plug-ins, and one of the shaders alone."""
    check_new(output)
    made = {name: archives.packed(name, files) for name, files in forms.archives().items()}
    partial = output.with_name(f".{output.name}.{os.getpid()}.partial")
    try:
        partial.mkdir()
        for name, content in made.items():
            (partial / name).write_bytes(content)
        if output.exists():
            output.rmdir()
        partial.rename(output)
    except OSError as error:
        raise UserError(f"--output {output}: cannot be written ({error.strerror}). Name another place.") from error
    finally:
        shutil.rmtree(partial, ignore_errors=True)
    for name, content in sorted(made.items()):
        terminal.tell(f"{name:45}{len(content) / 1e3:8.0f} kB")


def check_new(folder: Path) -> None:
    """Refuse a place where something is, or where no folder can be made. Raises UserError."""
    named = f"--output {folder}"
    if folder.is_symlink() or (folder.exists() and not folder.is_dir()):
        raise UserError(f"{named}: is a file. Name a folder that is new or empty.")
    if not folder.parent.is_dir():
        raise UserError(f"{named}: there is no folder {folder.parent}. Make it first.")
    if not os.access(folder.parent, os.W_OK):
        raise UserError(f"{named}: cannot be written. Check the permissions, or name another place.")
    if folder.exists() and any(folder.iterdir()):
        raise UserError(f"{named}: is not empty. Name a folder that is new or empty.")
