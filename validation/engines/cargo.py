"""Build crates of integration/ with Cargo, from copies in the cache folder."""

import filecmp
import os
import re
import shutil
from collections.abc import Mapping
from pathlib import Path

from bokeh_validation import locks, needs, paths, process
from bokeh_validation.errors import Unavailable

# Minimum version that Bevy 0.20 requires
RUST = (1, 97, 1)
VERSION = ".".join(map(str, RUST))
INSTALL_RUST = f"install Rust {VERSION} or later: {needs.install('cargo')}, or rustup toolchain install {VERSION}"
BUILD_S = 3600.0
VERSION_S = 60.0
TOOLCHAIN_S = 900.0  # seconds; it takes half a minute


def build(
    name: str, project: Path, *arguments: str, command: str = "build", extra: Mapping[str, str] | None = None
) -> str:
    """Run a Cargo command on a project that uses a sample's crate; all of them share one target folder per sample.

    name     of the sample
    project  folder of the project
    extra    additional environment variables
    Returns Cargo's output. Raises errors.Unavailable, RuntimeError.
    """
    # downloads go to the user's Cargo folder if there is one; everything else goes to the cache folder
    downloads = Path(os.environ.get("CARGO_HOME") or Path.home() / ".cargo")
    downloads = downloads if downloads.is_dir() else paths.ensured(_home(name) / "cargo")
    variables = {"CARGO_TARGET_DIR": str(_home(name) / "target"), "CARGO_HOME": str(downloads)}
    # the same settings for every build, so that dependencies are built once
    variables |= {"CARGO_PROFILE_DEV_DEBUG": "0", "CARGO_INCREMENTAL": "0", "CARGO_TERM_COLOR": "never"}
    cargo, toolchain = _cargo()
    return process.run(
        [*cargo, command, "--quiet", *arguments], BUILD_S, project, {**variables, **toolchain, **(extra or {})}
    )


def program(name: str, example: str, folder: str = "examples") -> Path:
    """Return the path of a crate's built example, or with the folder "." of a program of the same name."""
    return _home(name) / "target/debug" / folder / example


def copied(name: str) -> Path:
    """Copy a crate's folder to the cache folder and return the copy; a Cargo.lock there is kept."""
    target = _home(name) / "source/integration" / name
    own = shutil.ignore_patterns("target", "Cargo.lock")
    shutil.copytree(
        paths.ROOT / "integration" / name, target, ignore=own, copy_function=_copy_changed, dirs_exist_ok=True
    )
    return target


def _home(name: str) -> Path:
    return paths.cache_folder() / "engines" / name


def _copy_changed(source: str, target: str) -> None:
    """Copy a file unless it is unchanged: Cargo rebuilds by modification times."""
    if not os.path.exists(target) or not filecmp.cmp(source, target, shallow=False):
        shutil.copyfile(source, target)


def _cargo() -> tuple[list[str], dict[str, str]]:
    """Return the command of a recent enough Cargo, and environment variables for it. Raises errors.Unavailable.

    If the user's Cargo is older and there is rustup, rustup installs a toolchain into the cache folder.
    """
    places = os.pathsep.join((os.environ.get("PATH", ""), str(Path.home() / ".cargo/bin")))
    cargo, rustup = (shutil.which(name, path=places) for name in ("cargo", "rustup"))
    answer = process.run([cargo, "--version"], VERSION_S) if cargo else "no cargo"
    version = re.search(r"cargo (\d+)\.(\d+)\.(\d+)", answer)
    if version and tuple(map(int, version.groups())) >= RUST:
        return [cargo], {}
    if not rustup:
        raise Unavailable(f"{answer.strip()}; {INSTALL_RUST}")

    def install(folder: Path) -> None:
        words = ["toolchain", "install", VERSION, "--profile", "minimal", "--no-self-update"]
        process.run([rustup, *words], TOOLCHAIN_S, folder, {"RUSTUP_HOME": str(folder)})

    try:
        home = locks.built_once("engines/rust", [VERSION], install)
    except RuntimeError as error:
        raise Unavailable(f"{answer.strip()}, and rustup cannot fetch another ({error}); {INSTALL_RUST}") from error
    return [rustup, "run", VERSION, "cargo"], {"RUSTUP_HOME": str(home)}
