"""Windows programs elsewhere than on Windows: a Wine prefix and an X display of our own, both gone afterwards.

A prefix serves one process of the harness at a time, which may then end whatever runs in it: `wineserver -k` before the
first program, for what a killed run left, and after the last. A second harness at the same time takes a second prefix.
The display is Xvfb's, on a number that is free; that of the user is never touched.
"""

import atexit
import os
import select
import shutil
import subprocess
from collections.abc import Callable
from contextlib import ExitStack
from functools import cached_property
from pathlib import Path

from bokeh_validation import paths
from bokeh_validation.compilers.tool import once
from bokeh_validation.errors import Unavailable

PACKAGES = "wine wine64 g++-mingw-w64-x86-64-posix xvfb xauth"
INSTALL = f"apt-get install -y --no-install-recommends {PACKAGES}"

MAX_PREFIXES = 8
PREFIX_S = 120.0  # making a prefix takes 9 to 20 s
KILL_S = 10.0
QUIET = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.DEVNULL)
DISPLAY_S = 20.0

# Xvfb ends when our end of the shell's standard input closes, however we end. It writes its number to descriptor 3 and
# closes that; 4 stays open for as long as it runs, and is the only one: the shell closes its own.
XVFB_SCRIPT = (
    "Xvfb -displayfd 3 -screen 0 640x480x24 -nolisten tcp 3>&1 4>&1 >/dev/null & exec >&-; read -r _; kill $!; wait"
)


class Wine:
    """A prefix and a display that are ours alone until stop(), ready for programs.

    display  what DISPLAY is to be, such as ':7'
    """

    def __init__(self) -> None:
        self._wine, self._server = _needed("wine"), _needed("wineserver")
        self.prefix, self._lock = _own_prefix()
        self.display = ""
        try:
            self.end_programs()
            stamp = self.prefix / "made by bokeh-validation"
            if not stamp.exists():
                self._make_prefix()
                stamp.touch()
            # after the prefix: a Wine server that was started without a display gives no windows
            self._start_display()
        except BaseException:
            self._lock.close()
            raise

    def _make_prefix(self) -> None:
        """A new, empty prefix. One that was not finished is thrown away."""
        shutil.rmtree(self.prefix, ignore_errors=True)
        self.prefix.parent.mkdir(parents=True, exist_ok=True)
        try:
            done = subprocess.run(self.command("wineboot", "-i"), env=self.environment(), timeout=PREFIX_S, **QUIET)
        except subprocess.TimeoutExpired as error:
            raise Unavailable(f"wineboot hung: stopped after {PREFIX_S:g} s") from error
        finally:
            # it returns before the registry is on disk; the server's end writes it
            self.end_programs()
        if done.returncode or not (self.prefix / "system.reg").exists():
            raise Unavailable(f"wineboot made no prefix (exit status {done.returncode}); {INSTALL}")

    def _start_display(self) -> None:
        _needed("Xvfb")
        self._xvfb = subprocess.Popen(
            ["sh", "-c", XVFB_SCRIPT], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
            bufsize=0, start_new_session=True,
        )  # fmt: skip
        # once there is something, the whole line follows
        answered = select.select([self._xvfb.stdout], [], [], DISPLAY_S)[0]
        number = self._xvfb.stdout.readline().decode("ascii", "replace").strip() if answered else ""
        if not number:
            self._end_display()
            raise Unavailable(f"Xvfb gave no display within {DISPLAY_S:g} s; {INSTALL}")
        self.display = f":{number}"

    def _end_display(self) -> None:
        try:
            self._xvfb.communicate(timeout=KILL_S)  # closes standard input
        except subprocess.TimeoutExpired:
            os.killpg(self._xvfb.pid, 9)
            self._xvfb.communicate()

    def environment(self) -> dict[str, str]:
        """Environment of a program: our prefix, our display, and nothing that asks or draws."""
        kept = {k: v for k, v in os.environ.items() if not k.startswith("WINE") and k not in ("DISPLAY", "XAUTHORITY")}
        kept.update(
            WINEPREFIX=str(self.prefix),
            WINEARCH="win64",
            WINEDEBUG="-all",
            # no prompts for Mono and Gecko, no entries in the user's menu
            WINEDLLOVERRIDES="mscoree,mshtml=;winemenubuilder.exe=d",
            LC_ALL="C.UTF-8",
        )
        kept.setdefault("XDG_RUNTIME_DIR", str(paths.ensured(paths.cache_folder())))
        return {**kept, "DISPLAY": self.display} if self.display else kept

    @cached_property
    def device(self) -> str:
        """What draws for Wine's Direct3D, whose own adapter names are those of cards that it imitates.

        It is OpenGL, which a display of Xvfb has from Mesa's software driver alone.
        """
        version = subprocess.run([self._wine, "--version"], env=self.environment(), capture_output=True, text=True)
        return f"llvmpipe on Xvfb, {version.stdout.split()[0].replace('wine-', 'Wine ')}"

    def command(self, *words: str | Path) -> list[str]:
        """Command line that runs an .exe with its arguments."""
        return [self._wine, *map(str, words)]

    def end_programs(self) -> None:
        """End everything that runs in the prefix and wait for it."""
        environment = self.environment()
        for argument in ("-k", "-w"):
            try:
                subprocess.run([self._server, argument], env=environment, timeout=KILL_S, **QUIET)
            except subprocess.TimeoutExpired:
                subprocess.run([self._server, "-k9"], env=environment, timeout=KILL_S, **QUIET)

    def stop(self) -> None:
        """End all programs and the display, and give the prefix back."""
        self.end_programs()
        self._end_display()
        self._lock.close()


def _needed(name: str) -> str:
    path = shutil.which(name)
    if path is None:
        raise Unavailable(f"{name} is not on this machine; {INSTALL}")
    return path


def _own_prefix():
    """(folder, open lock file) of the first prefix that no other process has."""
    import fcntl

    folder = paths.ensured(paths.cache_folder() / "wine")
    for number in range(MAX_PREFIXES):
        lock = open(folder / f"prefix-{number}.lock", "w")
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            lock.close()
            continue
        return folder / f"prefix-{number}", lock
    raise Unavailable(f"{MAX_PREFIXES} other runs have a Wine prefix each: wait for one of them")


# What ends with this process, the last first
_ending = ExitStack()


@once
def get() -> Wine:
    """The prefix of this process, made on first use. Raises Unavailable, the same each time."""
    wine = Wine()
    before_stop(wine.stop)
    return wine


def before_stop(action: Callable[[], None]) -> None:
    """Have stop() call this before what it was told earlier."""
    _ending.callback(action)


@atexit.register
def stop() -> None:
    """Leave nothing of ours running. Called at exit; call it yourself before os._exit()."""
    _ending.close()
