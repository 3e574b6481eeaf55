"""Run Windows programs on other systems, with a private Wine prefix and X display that end with the process.

A prefix is used by one process of the harness at a time. That process may end everything in it: `wineserver -k` before
the first program, for leftovers of a killed run, and after the last. A second process at the same time uses a second
prefix. The display is Xvfb's, on a free number; the user's display is not used.
"""

import atexit
import os
import re
import shutil
import subprocess
from contextlib import ExitStack, suppress
from itertools import count
from pathlib import Path

from filelock import FileLock, Timeout

from bokeh_validation import locks, needs, paths, process
from bokeh_validation.errors import Unavailable
from bokeh_validation.packages import Package
from bokeh_validation.process import find, once

INSTALL = needs.install("wine")
PREFIX_S = 120.0  # seconds; creating a prefix takes 9 to 20
KILL_S = 10.0
QUIET = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.DEVNULL)
# The display ends when the shell's standard input closes, however this process ends
DISPLAY = ("xvfb-run", "-a", "sh", "-c", 'echo "$DISPLAY $XAUTHORITY"; read -r _')

# Microsoft's shader compiler, which replaces Wine's in every prefix, since that does not support shader model 3
VERSION = "0.5.0"
LIBRARY = "d3dcompiler_47.dll"
COMPILER = Package(
    "fxc",
    "kivy-deps-angle",
    VERSION,
    "d16d68cc45a2a326a3f8f738c649bb00ae5d7c3e58cff70f415fa57bd1d28713",
    ("--only-binary=:all:", "--platform", "win_amd64", "--python-version", "3.11"),
    f"kivy_deps_angle-{VERSION}.data/data/share/angle/bin/{LIBRARY}",
)


class Wine:
    """Own a prefix and a display until stop(), ready for programs.

    environment  for a program: the prefix, the display, and no prompts
    work         folder for the programs' files, empty at first
    """

    def __init__(self) -> None:
        self._wine, self._server = (find(name, INSTALL) for name in ("wine", "wineserver"))
        find("xvfb-run", INSTALL)
        folder, self._lock = _own_folder()
        self._display = subprocess.Popen(
            DISPLAY, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, start_new_session=True
        )
        display, _, authority = self._display.stdout.readline().decode().strip().partition(" ")
        if not display:
            raise Unavailable(f"xvfb-run gave no display; {INSTALL}")
        self.environment = {
            **os.environ,
            "XDG_RUNTIME_DIR": str(paths.cache_folder()),
            "WINEARCH": "win64",
            "WINEDEBUG": "-all",
            # no prompts for Mono and Gecko, no entries in the user's menu, and Microsoft's compiler
            "WINEDLLOVERRIDES": "mscoree,mshtml=;winemenubuilder.exe=d;d3dcompiler_47=n",
            "LC_ALL": "C.UTF-8",
            "DISPLAY": display,
            "XAUTHORITY": authority,
        }
        self.prefix = locks.built_once(str(folder.relative_to(paths.cache_folder())), [VERSION], self._make_prefix)
        self._use(self.prefix)
        self.work = self.prefix / "work"
        shutil.rmtree(self.work, ignore_errors=True)
        self.work.mkdir()

    def _use(self, prefix: Path) -> None:
        """Make programs run in a prefix, and end what is running there."""
        self.environment["WINEPREFIX"] = str(prefix)
        self.end_programs()

    def _make_prefix(self, folder: Path) -> None:
        compiler = COMPILER.fetch()
        self._use(folder)
        try:
            subprocess.run(self.command("wineboot", "-i"), env=self.environment, timeout=PREFIX_S, check=True, **QUIET)
        except subprocess.SubprocessError as error:
            raise Unavailable(f"wineboot made no prefix ({error}); {INSTALL}") from error
        # wineboot returns before the registry is saved; ending the server saves it
        self.end_programs()
        shutil.copy(compiler, folder / "drive_c/windows/system32")

    @property
    def device(self) -> str:
        """Return the device that draws for Wine's Direct3D; Wine's adapter names are those of cards that it imitates.

        Wine draws with OpenGL, which on Xvfb is always Mesa's software driver.
        """
        said = process.run(self.command("--version"), KILL_S)
        return f"llvmpipe on Xvfb, Wine {re.search(r'^wine-(.*?)( |$)', said, re.MULTILINE)[1]}"

    def command(self, *words: str | Path) -> list[str]:
        """Return the command line that runs an .exe with its arguments."""
        return [self._wine, *map(str, words)]

    def end_programs(self) -> None:
        """End everything that runs in the prefix and wait for it."""
        for argument in ("-k", "-w"):
            with suppress(subprocess.TimeoutExpired):
                subprocess.run([self._server, argument], env=self.environment, timeout=KILL_S, **QUIET)

    def stop(self) -> None:
        """End all programs and the display, and release the prefix."""
        self.end_programs()
        self._display.communicate()  # closes standard input
        self._lock.release()


def _own_folder():
    """Return (folder, acquired lock) of the first prefix that no other process uses."""
    folder = paths.ensured(paths.cache_folder() / "wine")
    for number in count():
        lock = FileLock(folder / f"prefix-{number}.lock", blocking=False, thread_local=False)
        with suppress(Timeout):
            lock.acquire()
            return folder / f"prefix-{number}", lock


# Functions to call when this process ends
_ending = ExitStack()


@once
def get() -> Wine:
    """Return the prefix of this process, created on first use. Raises Unavailable, the same error each time."""
    wine = Wine()
    _ending.callback(wine.stop)
    return wine


@atexit.register
def stop() -> None:
    """End everything that this module started. It runs at exit; before os._exit(), call it explicitly."""
    _ending.close()
