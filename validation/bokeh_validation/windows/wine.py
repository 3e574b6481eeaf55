"""Windows programs elsewhere than on Windows: a Wine prefix and an X display of our own, both gone afterwards.

A prefix serves one process of the harness at a time, which may then end whatever runs in it: `wineserver -k` before the
first program, for what a killed run left, and after the last. A second harness at the same time takes a second prefix.
The display is Xvfb's, on a number that is free; that of the user is never touched.
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
PREFIX_S = 120.0  # making a prefix takes 9 to 20 s
KILL_S = 10.0
QUIET = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.DEVNULL)
# The display lasts until our end of the shell's standard input closes, however we end
DISPLAY = ("xvfb-run", "-a", "sh", "-c", 'echo "$DISPLAY $XAUTHORITY"; read -r _')

# Microsoft's shader compiler, in every prefix in place of Wine's, which does not know shader model 3
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
    """A prefix and a display that are ours alone until stop(), ready for programs.

    environment  of a program: our prefix, our display, and nothing that asks or draws
    work         folder for files of programs, empty at first
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
            # no prompts for Mono and Gecko, no entries in the user's menu, Microsoft's compiler
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
        """Have programs run in a prefix, in which nothing runs yet."""
        self.environment["WINEPREFIX"] = str(prefix)
        self.end_programs()

    def _make_prefix(self, folder: Path) -> None:
        compiler = COMPILER.fetch()
        self._use(folder)
        try:
            subprocess.run(self.command("wineboot", "-i"), env=self.environment, timeout=PREFIX_S, check=True, **QUIET)
        except subprocess.SubprocessError as error:
            raise Unavailable(f"wineboot made no prefix ({error}); {INSTALL}") from error
        # it returns before the registry is on disk; the server's end writes it
        self.end_programs()
        shutil.copy(compiler, folder / "drive_c/windows/system32")

    @property
    def device(self) -> str:
        """What draws for Wine's Direct3D, whose own adapter names are those of cards that it imitates.

        It is OpenGL, which a display of Xvfb has from Mesa's software driver alone.
        """
        said = process.run(self.command("--version"), KILL_S)
        return f"llvmpipe on Xvfb, Wine {re.search(r'^wine-(.*?)( |$)', said, re.MULTILINE)[1]}"

    def command(self, *words: str | Path) -> list[str]:
        """Command line that runs an .exe with its arguments."""
        return [self._wine, *map(str, words)]

    def end_programs(self) -> None:
        """End everything that runs in the prefix and wait for it."""
        for argument in ("-k", "-w"):
            with suppress(subprocess.TimeoutExpired):
                subprocess.run([self._server, argument], env=self.environment, timeout=KILL_S, **QUIET)

    def stop(self) -> None:
        """End all programs and the display, and give the prefix back."""
        self.end_programs()
        self._display.communicate()  # closes standard input
        self._lock.release()


def _own_folder():
    """(folder, lock that is held) of the first prefix that no other process has."""
    folder = paths.ensured(paths.cache_folder() / "wine")
    for number in count():
        lock = FileLock(folder / f"prefix-{number}.lock", blocking=False, thread_local=False)
        with suppress(Timeout):
            lock.acquire()
            return folder / f"prefix-{number}", lock


# What ends with this process
_ending = ExitStack()


@once
def get() -> Wine:
    """The prefix of this process, made on first use. Raises Unavailable, the same each time."""
    wine = Wine()
    _ending.callback(wine.stop)
    return wine


@atexit.register
def stop() -> None:
    """Leave nothing of ours running. Called at exit; call it yourself before os._exit()."""
    _ending.close()
