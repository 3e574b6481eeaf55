"""Install what a command needs, from the table in needs.py: Debian packages (as root) and Python packages.

    python3 -S -P -m bokeh_validation.setup VALIDATION/run ARGUMENT...

setup.sh calls it with the system's Python, so it uses only the standard library. When done it restarts the script with
BOKEH_SET_UP, the path of the virtual environment's Python. It prints nothing if everything is installed. The
environment gets extras as commands need them: most need only core, and the 54 MB of web are for commands that start a
browser.
"""

import hashlib
import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from bokeh_validation import needs, paths

LOCKS = {
    extra: paths.VALIDATION / name
    for extra, name in (
        ("core", "requirements.txt"),
        ("lab", "requirements-lab.txt"),
        ("web", "requirements-web.txt"),
    )
}
# options of pip: it repeats a failed download twice, and gives up quickly without a network
PATIENCE = ("--retries", "2", "--timeout", "15")
UNREACHABLE = re.compile(r"Retrying \(|ConnectionError|ConnectTimeout|ReadTimeout|name resolution")


class SetUpFailed(Exception):
    """Report in one line what could not be set up, and why."""


def say(text: str) -> None:
    """Print to standard error; standard output belongs to the program."""
    print(f"set-up: {text}", file=sys.stderr, flush=True)


@contextmanager
def turn(name: str) -> Iterator[None]:
    """Hold a lock so that only one set-up runs at a time. A second one waits, then finds the work done.

    The lock is released when its process ends.
    """
    import fcntl  # without fcntl (Windows), users install pyproject.toml's extras themselves

    with open(paths.cache_folder() / name, "w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


# ---- Debian's packages ----


def missing(packages: Sequence[str]) -> list[str]:
    """Return the packages that are not installed, or none on systems other than Debian and Ubuntu."""
    if not packages or not (shutil.which("dpkg-query") and shutil.which("apt-get")):
        return []
    query = ["dpkg-query", "-W", "-f", "${Package} ${db:Status-Status}\n", *packages]
    lines = subprocess.run(query, capture_output=True, text=True).stdout.splitlines()
    return [name for name in packages if f"{name} installed" not in lines]


def _release() -> dict[str, str]:
    with suppress(OSError):
        import platform

        return platform.freedesktop_os_release()
    return {}


def _absent_file() -> Path:
    """Return the file that lists packages which this release does not offer, as found by earlier runs."""
    release = _release()
    return paths.cache_folder() / f"not-in-{release.get('ID', 'this')}-{release.get('VERSION_ID', 'release')}"


def wanted(packages: Sequence[str]) -> list[str]:
    """Return the missing packages without those known to be unobtainable, so that apt is not asked for
    them each time.
    """
    absent = _absent_file().read_text().split() if _absent_file().exists() else []
    # Ubuntu's chromium is a snap, which a container cannot install; npm from another source comes with its own node
    absent += ["chromium"] if _release().get("ID") != "debian" else []
    absent += ["npm"] if shutil.which("npm") else []
    return [name for name in missing(packages) if name not in absent]


def install_packages(packages: Sequence[str]) -> None:
    """Install missing packages as root, otherwise print the command that does. A failure is reported
    later as missing.
    """
    if not (names := wanted(packages)):
        return
    if os.geteuid() != 0:
        say(f"missing system packages; run: sudo {needs.APT} {' '.join(names)}")
        return
    with turn("apt.lock"):
        if names := wanted(packages):
            _Apt().install(names)


class _Apt:
    """Run apt-get, with its output in a log."""

    def __init__(self) -> None:
        self.log = paths.cache_folder() / "apt.log"
        self.log.write_text("")
        self.updated = False

    def _run(self, *words: str) -> bool:
        environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
        with open(self.log, "a") as log:
            return subprocess.run(["apt-get", *words], stdout=log, stderr=log, env=environment).returncode == 0

    def _update(self) -> None:
        say("updating the package lists")
        self.updated = self._run("update")

    @staticmethod
    def _said(*words: str) -> str:
        return subprocess.run(words, capture_output=True, text=True, env={**os.environ, "LC_ALL": "C"}).stdout

    def _offered(self, names: Sequence[str]) -> list[str]:
        """Return the packages that the package lists offer."""
        available, name = [], ""
        for line in self._said("apt-cache", "policy", *names).splitlines():
            if not line.startswith(" "):
                name = line.partition(":")[0]
            elif line.strip().startswith("Candidate:") and "(none)" not in line:
                available.append(name)
        return available

    def install(self, names: Sequence[str]) -> None:
        offered = self._offered(names)
        if len(offered) < len(names):
            self._update()
            offered = self._offered(names)
        for name in (name for name in names if name not in offered):
            say(f"{name} is not to be had here; what needs it will be reported as missing")
            if self.updated:  # if the update failed, the package may exist all the same
                with open(_absent_file(), "a") as file:
                    file.write(f"{name}\n")
        if not offered:
            return
        options = ("install", "-y", "--no-install-recommends", *offered)
        simulation = self._said("apt-get", "--assume-no", *(option for option in options if option != "-y"))
        sizes = re.findall(r"Need to get (.*) of archives|operation, (.*) of additional", simulation)
        size_texts = [
            size
            for pair, word in zip(sizes, ("to fetch", "on disk"), strict=False)
            for size in (f"{''.join(pair)} {word}",)
        ]
        say(f"installing {' '.join(offered)} ({', '.join(size_texts)})")
        install = ("-o", "DPkg::Lock::Timeout=300", *options)
        if self._run(*install):
            return
        if not self.updated:  # outdated package lists name files that no longer exist
            self._update()
            if self.updated and self._run(*install):
                return
        say(f"apt-get install failed (see {self.log}); what needs the packages will be reported as missing")


# ---- Python's ----


def environment() -> Path:
    """Return the folder of the virtual environment, named by a hash of the lock files and the Python version."""
    hashed = hashlib.sha256(b"".join(lock.read_bytes() for lock in LOCKS.values()))
    hashed.update(sys.version.encode() + sys.base_prefix.encode())
    return paths.cache_folder().absolute() / f"venv-{hashed.hexdigest()[:16]}"


def _complete(target: Path, extra: str) -> Path:
    """Return the file written last when an extra is complete; if it is missing, the installation is repeated."""
    return target / f"complete-{extra}"


def install_extras(extras: Sequence[str]) -> Path:
    """Install extras of pyproject.toml into the environment and return its Python. Raises SetUpFailed."""
    target = environment()
    python = target / "bin" / "python"
    if all(_complete(target, extra).exists() for extra in extras):
        return python
    with turn("lock"):
        if not _complete(target, "core").exists():
            _make(target)
        for extra in extras:
            if not _complete(target, extra).exists():
                need = needs.NEEDS[extra]
                say(f"fetching {need.what} (about {need.megabytes} MB), once, into {target}")
                _pip(python, LOCKS[extra])
                _complete(target, extra).touch()
    return python


def _make(target: Path) -> None:
    shutil.rmtree(target, ignore_errors=True)
    finished = subprocess.run([sys.executable, "-m", "venv", str(target)], capture_output=True, text=True)
    if finished.returncode:
        raise SetUpFailed(
            f"{sys.executable} cannot make virtual environments: {_last(finished.stdout + finished.stderr)}"
        )


def _last(text: str) -> str:
    return (text.strip().splitlines() or ["no message"])[-1]


def _pip(python: Path, lock: Path) -> None:
    """Install what a lock file pins and print each package's name as it is collected. Raises SetUpFailed."""
    command = [python, "-I", "-m", "pip", "install", "--progress-bar", "off", "--disable-pip-version-check"]
    command += ["--no-input", *PATIENCE, "--require-hashes", "-r", lock]
    log = paths.cache_folder() / "pip.log"
    # in its own session, so that it can be ended together with this process
    options = {"stdin": subprocess.DEVNULL, "stderr": subprocess.STDOUT, "start_new_session": True}
    process = subprocess.Popen(list(map(str, command)), stdout=subprocess.PIPE, text=True, errors="replace", **options)
    printed = []
    try:
        for line in process.stdout:
            printed.append(line)
            if match := re.match(r"Collecting ([^ ]*)", line):
                say(f"  {match[1]}")
        process.wait()
    except BaseException:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        raise
    log.write_text("".join(printed))
    if process.returncode:
        reason = (
            "the package index cannot be reached" if UNREACHABLE.search("".join(printed)) else _last("".join(printed))
        )
        raise SetUpFailed(f"the Python packages could not be installed: {reason}; see {log}")


# ---- both ----


def set_up(script: str, arguments: Sequence[str]) -> Path:
    """Install what a script, 'run' or 'test', needs for these arguments; returns the Python to run it with.

    Raises SetUpFailed.
    """
    with suppress(OSError):
        paths.ensured(paths.cache_folder())
    if not os.access(paths.cache_folder(), os.W_OK):
        raise SetUpFailed(f"cannot write to the cache folder {paths.cache_folder()}; set BOKEH_CACHE")
    names = needs.COMMANDS["test"] if script == "test" else needs.of(arguments)
    install_packages(needs.packages(names))
    return install_extras(needs.extras(names))


def _stop(*_) -> None:
    raise KeyboardInterrupt


def main() -> None:
    """Set up, then restart the script; a failure prints one line and exits with code 2, an interruption with 130."""
    signal.signal(signal.SIGTERM, _stop)
    script, *arguments = sys.argv[1:]
    try:
        python = set_up(Path(script).name, arguments)
    except SetUpFailed as failure:
        print(f"error: {failure}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        print("error: stopped", file=sys.stderr)
        sys.exit(130)
    os.execve(script, [script, *arguments], {**os.environ, "BOKEH_SET_UP": str(python)})


if __name__ == "__main__":
    main()
