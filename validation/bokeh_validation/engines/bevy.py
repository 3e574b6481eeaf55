"""integration/bevy: built by Cargo from a copy in the cache folder, run without a window on lavapipe.

The first build compiles Bevy: about 15 minutes on two cores and 1.5 GB. Later ones take seconds.
"""

import filecmp
import os
import re
import shutil
from pathlib import Path

from bokeh_validation import needs, paths, process
from bokeh_validation.engines import lavapipe
from bokeh_validation.errors import Unavailable

SAMPLE = paths.ROOT / "integration/bevy"
EXAMPLE = "scene"
# What Bevy 0.19 asks for
RUST = (1, 95)
INSTALL_RUST = f"install Rust {RUST[0]}.{RUST[1]} or later with cargo: {needs.install('cargo')}"
BUILD_S = 3600.0
RUN_S = 300.0  # takes 10 to 30 s on two cores
VERSION_S = 60.0


def run(name: str, folder: Path) -> None:
    """Leave the capture of the sample in `folder`. Raises errors.Unavailable, RuntimeError."""
    icd = lavapipe.description()
    build(copied(), "--example", EXAMPLE)
    extra = {"VK_ICD_FILENAMES": str(icd), "BEVY_ASSET_ROOT": str(folder)}
    process.run([_program(), folder], RUN_S, folder, extra)


def build(project: Path, *arguments: str) -> None:
    """Cargo builds a project that uses the crate, all in one folder. Raises errors.Unavailable, RuntimeError."""
    # downloads go to the user's place for them, if there is one; all else to the cache folder
    downloads = Path(os.environ.get("CARGO_HOME") or Path.home() / ".cargo")
    downloads = downloads if downloads.is_dir() else paths.ensured(_home() / "cargo")
    extra = {"CARGO_TARGET_DIR": str(_home() / "target"), "CARGO_HOME": str(downloads), "CARGO_TERM_COLOR": "never"}
    # the crate's own profile, so that Bevy is built once
    extra |= {"CARGO_PROFILE_DEV_DEBUG": "0", "CARGO_INCREMENTAL": "0"}
    process.run([_cargo(), "build", "--quiet", *arguments], BUILD_S, project, extra)


def built() -> bool:
    """Whether there has been a build here, so that the next takes seconds."""
    return _program().exists()


def _home() -> Path:
    return paths.cache_folder() / "engines" / "bevy"


def _program() -> Path:
    return _home() / "target/debug/examples" / EXAMPLE


def copied() -> Path:
    """The crate's folder, alone; Cargo.lock stays in it."""
    target, own = _home() / "source/integration/bevy", shutil.ignore_patterns("target", "Cargo.lock")
    shutil.copytree(SAMPLE, target, ignore=own, copy_function=_copy_changed, dirs_exist_ok=True)
    return target


def _copy_changed(source: str, target: str) -> None:
    """What is the same keeps its time: Cargo goes by it."""
    if not os.path.exists(target) or not filecmp.cmp(source, target, shallow=False):
        shutil.copyfile(source, target)


def _cargo() -> Path:
    """Cargo, with a compiler that is new enough."""
    places = (os.environ.get("PATH", ""), str(Path.home() / ".cargo/bin"))
    cargo = shutil.which("cargo", path=os.pathsep.join(places))
    answer = process.run([cargo, "--version"], VERSION_S) if cargo else "no cargo"
    version = re.search(r"cargo (\d+)\.(\d+)", answer)
    if version is None or (int(version[1]), int(version[2])) < RUST:
        raise Unavailable(f"{answer.strip()}; {INSTALL_RUST}")
    return Path(cargo)
