"""Files that appear complete or not at all."""

import os
from collections.abc import Callable
from pathlib import Path

from bokeh_validation.errors import UserError


def whole(path: Path, save: Callable[[Path], object]) -> None:
    """Call `save` with a temporary path beside `path`, then put it in its place."""
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
    try:
        check_writable(path)
        save(partial)
        os.replace(partial, path)
    except UserError:
        raise
    except Exception as error:
        raise UserError(f"{path}: cannot be written ({' '.join(str(error).split())}). Name another place.") from error
    finally:
        partial.unlink(missing_ok=True)


def check_writable(path: Path) -> None:
    """Refuse a place that cannot be written before any work is done."""
    folder = path.parent
    if path.is_dir():
        raise UserError(f"{path}: is a folder. Name a file in it.")
    if not folder.is_dir():
        raise UserError(f"{path}: there is no folder {folder}. Make it first.")
    if not os.access(folder, os.W_OK) or (path.exists() and not os.access(path, os.W_OK)):
        raise UserError(f"{path}: may not be written. Check the permissions, or name another place.")


def check_folder(option: str, folder: Path | None) -> None:
    """Refuse a folder that an option names and that is not there."""
    if folder is not None and not folder.is_dir():
        raise UserError(f"{option} {folder}: there is no such folder. Make it first.")
