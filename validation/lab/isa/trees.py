"""Drivers of a newer system, unpacked into the cache folder and never installed: for `validation/run isa --all`.

apt works with folders of its own there: the machine's own packages and lists stay as they are. The unpacked programs
run through their own loader, those of another processor through qemu, which is unpacked as well.
"""

import shutil
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from bokeh_validation import locks, paths, process
from bokeh_validation.errors import Unavailable

# Debian's stable release of 2025, and the Mesa that it keeps
RELEASE, MESA = "trixie", "25.0.7"
DRIVERS = ("mesa-vulkan-drivers", "mesa-drm-shim", "libvulkan1", "python3-minimal", "python3-cffi")
PACKAGES = {
    "amd64": (*DRIVERS, "qemu-user"),
    "arm64": (*DRIVERS, "libegl1", "libgles2", "libgbm1", "libgl1-mesa-dri"),
}
LIBRARIES = {"amd64": "usr/lib/x86_64-linux-gnu", "arm64": "usr/lib/aarch64-linux-gnu"}
TIMEOUT_S = 540


def tree(architecture: str) -> Path:
    """Folder of the unpacked system of a processor, made on first use. Raises Unavailable."""
    unpack = partial(_unpack, architecture)
    return locks.built_once(f"isa-{RELEASE}/{architecture}", PACKAGES[architecture], unpack) / "root"


def _unpack(architecture: str, folder: Path) -> None:
    if shutil.which("apt-get") is None or shutil.which("dpkg") is None:
        raise Unavailable("unpacks packages of Debian: needs apt-get and dpkg")
    mirror = _output(["apt-get", "indextargets", "--format", "$(REPO_URI)", "Identifier: Packages"]).splitlines()
    mirror = [line for line in mirror if line.rstrip("/").endswith("/debian")]
    if not mirror:
        raise Unavailable("unpacks packages of Debian: none of the machine's package sources is Debian's")
    for part in ("apt/lists/partial", "apt/cache/archives/partial", "root"):
        paths.ensured(folder / part)
    (folder / "apt/status").touch()
    (folder / "apt/sources.list").write_text(f"deb {mirror[0]} {RELEASE} main\n")
    settings = {
        "Dir::State": folder / "apt",
        "Dir::State::status": folder / "apt/status",
        "Dir::Cache": folder / "apt/cache",
        "Dir::Etc::sourcelist": folder / "apt/sources.list",
        "Dir::Etc::sourceparts": "/nonexistent",
        "APT::Architecture": architecture,
        "APT::Architectures": architecture,
        "Acquire::Languages": "none",
        # otherwise root downloads as a user who may not write here
        "APT::Sandbox::User": "root",
    }
    apt = ["apt-get", "-q", *(part for name, value in settings.items() for part in ("-o", f"{name}={value}"))]
    _output([*apt, "update"])
    _output([*apt, "-y", "--no-install-recommends", "--download-only", "install", *PACKAGES[architecture]])
    archives = sorted((folder / "apt/cache/archives").glob("*.deb"))
    if not any(archive.name.startswith(f"mesa-vulkan-drivers_{MESA}-") for archive in archives):
        raise Unavailable(f"{RELEASE} has another Mesa than {MESA} now: its figures would be other ones")
    for archive in archives:
        _output(["dpkg", "-x", str(archive), str(folder / "root")])
    for name in ("lib", "lib64"):
        if (folder / "root/usr" / name).exists():
            (folder / "root" / name).symlink_to(f"usr/{name}")
    shutil.rmtree(folder / "apt")


def _output(command: Sequence[str]) -> str:
    """What a command prints. Raises Unavailable with its last line where it fails."""
    try:
        return process.run(command, TIMEOUT_S)
    except RuntimeError as error:
        raise Unavailable(str(error).splitlines()[-1]) from error
