"""Write files and folders that appear complete or not at all."""

import os
import secrets
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path

from bokeh_validation.errors import UserError


def whole(path: Path, save: Callable[[Path], object]) -> None:
    """Call `save` with a temporary path, then move the finished file to `path`, or to what `path` links to.

    Raises UserError if it cannot be written.
    """
    partial = None
    try:
        check_writable(path)
        target = path.resolve()
        # a random name, so that nobody can put a link there beforehand
        partial = target.with_name(f".{secrets.token_hex(8)}.partial")
        save(partial)
        os.replace(partial, target)
    except UserError:
        raise
    except Exception as error:
        raise UserError(f"{path}: cannot be written ({' '.join(str(error).split())}). Name another place.") from error
    finally:
        if partial is not None:
            partial.unlink(missing_ok=True)


def check_writable(path: Path) -> None:
    """Check before any work is done that `path` can be written. Raises UserError otherwise."""
    folder = path.parent
    try:
        if path.is_dir():
            raise UserError(f"{path}: is a folder. Name a file in it.")
        if not folder.is_dir():
            raise UserError(f"{path}: there is no folder {folder}. Make it first.")
        # writing would replace a device or a pipe by a file
        if path.exists() and not path.is_file():
            raise UserError(f"{path}: is no plain file. Name another place.")
        if not os.access(folder, os.W_OK) or (path.exists() and not os.access(path, os.W_OK)):
            raise UserError(f"{path}: may not be written. Check the permissions, or name another place.")
    except OSError as error:
        raise UserError(f"{path}: cannot be written ({error.strerror}). Name another place.") from error


def new_folder(option: str, folder: Path, fill: Callable[[Path], object]) -> None:
    """Call `fill` with a temporary folder, then copy what it put there to `folder`, which must be new or empty.

    option  the command line's option that named the folder, for messages
    Raises UserError if the folder is not empty or cannot be written.
    """
    check_folder(option, folder.parent)
    if folder.exists() and not (folder.is_dir() and not any(folder.iterdir())):
        raise UserError(f"{option} {folder}: is not empty. Name a folder that is new or empty.")
    with tempfile.TemporaryDirectory(prefix="bokeh-") as parent:
        temporary = Path(parent, "made")
        temporary.mkdir()
        fill(temporary)
        try:
            shutil.copytree(temporary, folder, dirs_exist_ok=True)
        except OSError as error:
            raise UserError(f"{option} {folder}: cannot be written ({error}). Name another place.") from error


def check_folder(option: str, folder: Path | None) -> None:
    """Check that a folder named by an option exists. Raises UserError otherwise."""
    if folder is not None and not folder.is_dir():
        raise UserError(f"{option} {folder}: there is no such folder. Make it first.")
