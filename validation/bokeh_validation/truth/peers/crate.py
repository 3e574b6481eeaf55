"""Bevy's crate with its depth of field, for the WGSL in it: brought by cargo, never compiled."""

import os
import shutil
from functools import cache
from pathlib import Path

from bokeh_validation import locks, paths, process
from bokeh_validation.errors import Unavailable

NAME, VERSION = "bevy_post_process", "0.19.1"
SECONDS = 300.0
# only what this system would need is fetched: cargo has no way to leave out what a crate depends on
TARGET = "x86_64-unknown-linux-gnu"
MANIFEST = f"""[package]
name = "shaders"
version = "0.0.0"
edition = "2024"
[lib]
path = "empty.rs"
[dependencies]
{NAME} = {{ version = "={VERSION}", default-features = false }}
"""


@cache
@locks.held("crate")
def source() -> Path:
    """Its folder. Raises Unavailable, RuntimeError."""
    cargo = shutil.which("cargo") or shutil.which("cargo", path=str(Path.home() / ".cargo/bin"))
    if cargo is None:
        raise Unavailable("cargo is not on this machine; https://rustup.rs")
    folder = paths.ensured(paths.cache_folder() / "engines" / "peers" / f"crate-{VERSION}")
    (folder / "Cargo.toml").write_text(MANIFEST, encoding="ascii")
    (folder / "empty.rs").touch()
    process.run([cargo, "fetch", "--quiet", "--target", TARGET], SECONDS, folder)
    home = Path(os.environ.get("CARGO_HOME") or Path.home() / ".cargo")
    return next(home.glob(f"registry/src/*/{NAME}-{VERSION}"))
