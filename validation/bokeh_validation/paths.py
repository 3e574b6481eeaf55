"""Locate the checkout and the one folder outside it that the harness writes to."""

import os
from pathlib import Path

from bokeh_validation.errors import UserError

ROOT = Path(__file__).resolve().parents[2]
VALIDATION = ROOT / "validation"
SCENES = VALIDATION / "scenes"
LANGUAGES = ("hlsl", "glsl", "wgsl")


def cache_folder() -> Path:
    """Return the folder for downloads, the virtual environment and reports: $BOKEH_CACHE, else below the user's cache
    folder.
    """
    from_environment = os.environ.get("BOKEH_CACHE")
    if from_environment:
        return Path(from_environment)
    base = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return Path(base) / "bokeh-validation"


def ensured(folder: Path) -> Path:
    """Create the folder if necessary and return it."""
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def shaders() -> Path:
    """Return the folder that holds hlsl/, glsl/ and wgsl/: $BOKEH_SHADERS, else the checkout.

    The engines' samples always use the checkout's shaders. Raises UserError if a folder is missing.
    """
    folder = Path(os.environ.get("BOKEH_SHADERS") or ROOT)
    missing = [language for language in LANGUAGES if not (folder / language).is_dir()]
    if missing:
        raise UserError(f"BOKEH_SHADERS={folder}: there is no {missing[0]}/ in it.")
    return folder


# The files of a language, in the order in which they are concatenated
STEMS = ("bokeh", "bokeh_paper", "bokeh_layers", "bokeh_lens", "bokeh_passes")


def shader(language: str, stem: str = "bokeh") -> Path:
    """Return the path of a shader file; `stem` is one of STEMS."""
    return shaders() / language / f"{stem}.{language}"
