"""Crates of integration/, built by Cargo from a copy in the cache folder."""

import filecmp
import os
import re
import shutil
from collections.abc import Mapping
from pathlib import Path

from bokeh_validation import needs, paths, process
from bokeh_validation.errors import Unavailable

# What Bevy 0.19 asks for
RUST = (1, 95)
INSTALL_RUST = f"install Rust {RUST[0]}.{RUST[1]} or later with cargo: {needs.install('cargo')}"
BUILD_S = 3600.0
VERSION_S = 60.0


def build(
    name: str, project: Path, *arguments: str, command: str = "build", extra: Mapping[str, str] | None = None
) -> str:
    """Run a command of Cargo on a project that uses the crate of a sample; all such share a folder of what is built.

    `extra` adds to the environment. What it said comes back. Raises errors.Unavailable, RuntimeError.
    """
    # downloads go to the user's place for them, if there is one; all else to the cache folder
    downloads = Path(os.environ.get("CARGO_HOME") or Path.home() / ".cargo")
    downloads = downloads if downloads.is_dir() else paths.ensured(_home(name) / "cargo")
    own = {"CARGO_TARGET_DIR": str(_home(name) / "target"), "CARGO_HOME": str(downloads)}
    # the crate's own profile, so that its dependencies are built once
    own |= {"CARGO_PROFILE_DEV_DEBUG": "0", "CARGO_INCREMENTAL": "0", "CARGO_TERM_COLOR": "never"}
    return process.run([_cargo(), command, "--quiet", *arguments], BUILD_S, project, {**own, **(extra or {})})


def program(name: str, example: str) -> Path:
    """Where an example of a crate is built to."""
    return _home(name) / "target/debug/examples" / example


def copied(name: str) -> Path:
    """The crate's folder, alone; Cargo.lock stays in it."""
    target = _home(name) / "source/integration" / name
    own = shutil.ignore_patterns("target", "Cargo.lock")
    shutil.copytree(
        paths.ROOT / "integration" / name, target, ignore=own, copy_function=_copy_changed, dirs_exist_ok=True
    )
    return target


def _home(name: str) -> Path:
    return paths.cache_folder() / "engines" / name


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
