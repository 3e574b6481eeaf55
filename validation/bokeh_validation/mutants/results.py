"""The last complete run as a file in the cache folder, which the report shows."""

import datetime
import hashlib
import json
from dataclasses import asdict
from pathlib import Path

from bokeh_validation import files, paths
from bokeh_validation.mutants.edits import originals
from bokeh_validation.mutants.model import Result


def default_path() -> Path:
    """Beside the report."""
    return paths.cache_folder() / "report" / "mutants.json"


def digest() -> str:
    """Tells whether results are of the shaders that are here."""
    return hashlib.sha256("".join(originals().values()).encode()).hexdigest()


def as_json(results: list[Result], seconds: float) -> dict:
    """Everything of a run."""
    return {
        "date": datetime.datetime.now().astimezone().strftime("%Y-%m-%d %H:%M %Z"),
        "seconds": round(seconds, 1),
        "shaders": digest(),
        "mutants": [asdict(result) for result in results],
    }


def write(path: Path, results: list[Result], seconds: float) -> None:
    """Write the file, whole or not at all."""
    text = json.dumps(as_json(results, seconds), indent=1)
    files.whole(path, lambda partial: partial.write_text(text + "\n", encoding="utf-8"))


def read(path: Path | None = None) -> dict | None:
    """What was written, `mutants` as Result, `current`: whether it is of these shaders. None where there is none.

    A file that cannot be read is none: it is made again by a run.
    """
    try:
        found = json.loads((path or default_path()).read_text(encoding="utf-8"))
        mutants = [_result(one) for one in found["mutants"]]
        return {**found, "mutants": mutants, "current": found["shaders"] == digest()}
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _result(kept: dict) -> Result:
    return Result(**{**kept, "languages": tuple(kept["languages"]), "places": tuple(kept["places"])})
