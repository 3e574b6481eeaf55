"""Which Chromium there is, and how it is started."""

import os
import shutil

from bokeh_validation.errors import Unavailable

VARIABLE = "BOKEH_CHROMIUM"
# Debian's name, Ubuntu's (there a snap, which works as well), and Google's own packages
NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
INSTALL = (
    "apt-get install -y --no-install-recommends chromium (Ubuntu, where that is a snap: install google-chrome, "
    f"or set {VARIABLE} to a Chromium)"
)
OLDEST = 140  # the first with Uint8Array.fromBase64

# The browser serves one page from memory: it has nothing to ask of any network.
QUIET = (
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-domain-reliability",
    "--disable-sync",
    "--disable-breakpad",
    "--disable-quic",
    "--no-first-run",
    "--no-pings",
    "--metrics-recording-only",
    "--host-resolver-rules=MAP * ~NOTFOUND",
)
# a software device may take long over one draw, and that is no reason to stop it: session.py has the time limits
PATIENT = ("--disable-gpu-watchdog", "--disable-background-timer-throttling")
# the software device that comes with Chromium
SOFTWARE = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--use-webgpu-adapter=swiftshader")
# whatever GPU the machine has; Chromium's list of drivers that it does not trust is about web pages
HARDWARE = ("--ignore-gpu-blocklist", "--use-angle=vulkan", "--enable-features=Vulkan")


def find() -> str:
    """Path of Chromium. Raises Unavailable."""
    named = os.environ.get(VARIABLE)
    for name in (named,) if named else NAMES:
        path = shutil.which(name)
        if path:
            return path
    if named:
        raise Unavailable(f"{VARIABLE} names no program: {named}")
    raise Unavailable(f"Chromium is not on this machine; {INSTALL}")


def flags(hardware: bool) -> list[str]:
    """Command line: with the machine's GPU, or with the software device."""
    return [*QUIET, *PATIENT, "--enable-unsafe-webgpu", *(HARDWARE if hardware else SOFTWARE)]


def sandboxed() -> bool:
    """Whether Chromium's sandbox is on: it refuses to start with it as root."""
    return not hasattr(os, "geteuid") or os.geteuid() != 0
