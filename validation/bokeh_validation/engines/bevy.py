"""integration/bevy: built by Cargo from a copy in the cache folder, run without a window on lavapipe.

The first build compiles Bevy: about 15 minutes on two cores and 1.5 GB. Later ones take seconds.
"""

import os
import re
import shutil
from pathlib import Path

from bokeh_validation import locks, paths, process
from bokeh_validation.engines import capture
from bokeh_validation.errors import Unavailable

SAMPLE = paths.ROOT / "integration/bevy"
EXAMPLE = "scene"
# What Bevy 0.19 asks for
RUST = (1, 95)
INSTALL_RUST = f"install Rust {RUST[0]}.{RUST[1]} or later with cargo: https://rustup.rs"
BUILD_S = 3600.0
RUN_S = 300.0  # takes 10 to 30 s on two cores
VERSION_S = 60.0


def run(name: str, folder: Path) -> None:
    """Leave the capture of the sample in `folder`. Raises errors.Unavailable, RuntimeError, capture.Broken."""
    extra = {"VK_ICD_FILENAMES": _vulkan_driver(), "BEVY_ASSET_ROOT": str(folder)}
    stamp = _home() / "passed"
    stamp.unlink(missing_ok=True)
    seen = locks.digest(sources())
    call_cargo(_copied(), "build", "--quiet", "--example", EXAMPLE)
    process.run([_home() / "target/debug/examples" / EXAMPLE, folder], RUN_S, folder, extra)
    if capture.read(folder).ok:
        stamp.write_text(seen, encoding="ascii")


def call_cargo(folder: Path, *command: str) -> str:
    """Run Cargo in a folder; what it says. Raises errors.Unavailable, RuntimeError.

    Everything that is built goes to the cache folder; downloads too, unless the user has a place for them.
    """
    downloads = Path(os.environ.get("CARGO_HOME") or Path.home() / ".cargo")
    downloads = downloads if downloads.is_dir() else paths.ensured(_home() / "cargo")
    building = {"CARGO_TARGET_DIR": str(_home() / "target"), "CARGO_HOME": str(downloads), "CARGO_TERM_COLOR": "never"}
    return process.run([_cargo(), *command], BUILD_S, folder, building)


def changed() -> bool:
    """Whether the sample or a file of wgsl/ is another than in the last run that was within the reference's interval.

    False where there was none yet: the first build takes a quarter of an hour, and is to be asked for.
    """
    try:
        return (_home() / "passed").read_text(encoding="ascii") != locks.digest(sources())
    except OSError:
        return False


def sources() -> list[Path]:
    """The files that the sample is built from: the crate's and the package's."""
    crate = [SAMPLE / "Cargo.toml", *SAMPLE.rglob("*.rs")]
    own = sorted(path for path in crate if "target" not in path.relative_to(SAMPLE).parts)
    return own + [paths.ROOT / "wgsl" / f"{name}.wgsl" for name in ("bokeh", "bokeh_layers", "bokeh_passes")]


def _home() -> Path:
    return paths.cache_folder() / "engines" / "bevy"


def _copied() -> Path:
    """The crate's copy, with wgsl/ where its includes look. What is the same keeps its time: Cargo goes by it."""
    root = _home() / "source"
    copies = {root / path.relative_to(paths.ROOT): path.read_bytes() for path in sources()}
    for copy, content in copies.items():
        if not copy.exists() or copy.read_bytes() != content:
            paths.ensured(copy.parent)
            copy.write_bytes(content)
    # a source file that is gone must not be built; Cargo.lock stays
    for old in root.rglob("*.rs"):
        if old not in copies:
            old.unlink()
    return root / SAMPLE.relative_to(paths.ROOT)


def _cargo() -> Path:
    """Cargo, with a compiler that is new enough and a linker."""
    places = (os.environ.get("PATH", ""), str(Path.home() / ".cargo/bin"))
    cargo = shutil.which("cargo", path=os.pathsep.join(places))
    if cargo is None:
        raise Unavailable(INSTALL_RUST)
    answer = process.run([cargo, "--version"], VERSION_S)
    version = re.search(r"cargo (\d+)\.(\d+)", answer)
    if version is None or (int(version[1]), int(version[2])) < RUST:
        raise Unavailable(f"{answer.strip()} is too old for Bevy; {INSTALL_RUST}")
    if shutil.which("cc") is None:
        raise Unavailable("no linker; apt-get install -y gcc libc6-dev")
    return Path(cargo)


def _vulkan_driver() -> str:
    """What $VK_ICD_FILENAMES names, else Mesa's software driver."""
    named = os.environ.get("VK_ICD_FILENAMES")
    drivers = sorted(Path("/usr/share/vulkan/icd.d").glob("lvp_icd*.json"))
    if not named and not drivers:
        raise Unavailable("no Vulkan driver; apt-get install -y mesa-vulkan-drivers libvulkan1")
    return named or str(drivers[0])
