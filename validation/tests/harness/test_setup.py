"""Test the table of what commands need; set-up installs from it and reports a failure in one line."""

import ast
import fcntl
import hashlib
import json
import os
import re
import signal
import subprocess
import sys
import time
import tomllib
import zipfile
from contextlib import suppress
from pathlib import Path

import pytest
from support import HANG

from bokeh_validation import cli, needs, paths, setup

CONTRIBUTING = (paths.ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
PROJECT = tomllib.loads((paths.VALIDATION / "pyproject.toml").read_text(encoding="utf-8"))["project"]
EXTRAS = PROJECT["optional-dependencies"]
# no server listens there
NO_INDEX = {"PIP_INDEX_URL": "http://127.0.0.1:9/simple", "PIP_RETRIES": "0"}


def test_every_command_is_in_the_table():
    """Check that the table has every command."""
    assert set(needs.COMMANDS) - {"", "test"} == set(cli.COMMANDS)


def test_every_need_is_known():
    """Check that commands name only known needs, and that set-up installs every other row except those listed here."""
    used = {name for names in (*needs.COMMANDS.values(), *needs.WORDS.values()) for name in names}
    assert used <= set(needs.NEEDS)
    assert set(needs.NEEDS) - used == {"glslang", "window", "cargo"}


def test_extras():
    """Check that pyproject.toml, the table and the locks have the same extras; locks pin every package of an extra
    with hashes.
    """
    assert set(EXTRAS) == set(setup.LOCKS) == {need.extra for need in needs.NEEDS.values() if need.extra}
    for extra, lock in setup.LOCKS.items():
        text = lock.read_text(encoding="ascii")
        pinned = re.findall(r"^([a-z][\w.-]*)==(?=.*\\\n +--hash=sha256:)", text, re.MULTILINE)
        assert len(pinned) == len(re.findall(r"^\w.*==", text, re.MULTILINE)) and "://" not in text
        assert {re.match(r"[\w-]+", one)[0].lower() for one in EXTRAS[extra]} <= set(pinned)


def test_entry_point():
    """Check that the installed command calls cli.main()."""
    module, _, function = PROJECT["scripts"]["bokeh-validation"].partition(":")
    assert getattr(sys.modules[module], function) is cli.main


def test_documents():
    """Compare CONTRIBUTING.md's downloads of every command with the sums of the table's rows, and what they are said to
    come with; check that an apt-get line of a guide installs packages of one row.
    """
    rows = re.findall(r"^\| `validation/(run|test) ?(.*?)` \|.*\| (\d+) MB(.*?) \|$", CONTRIBUTING, re.MULTILINE)
    rows += re.findall(r"^\| `validation/(run) (generate)` \|.* (\d+) MB()", CONTRIBUTING, re.MULTILINE)
    assert {f"{script} {words}".strip() for script, words, *_ in rows} == {
        *("run", "run parity", "run generate", "run check", "run --full", "test")
    }
    for script, words, size, said in rows:
        names = needs.COMMANDS["test"] if script == "test" else needs.of(words.split())
        assert int(size) == sum(needs.NEEDS[name].megabytes for name in names), (script, words)
        described = str({name: needs.NEEDS[name] for name in (*names, "cargo")}).lower()
        assert all(word.lower() in described for word in re.findall(r"[A-ZÖ]\w\w+|npm|cargo", said)), said
    guides = [*paths.ROOT.glob("integration/**/README.md"), *paths.ROOT.glob("docs/**/*.md")]
    text = "\n".join(path.read_text(encoding="utf-8") for path in guides)
    lines = re.findall(r"`apt-get install -y ([^`]*)`|^apt-get install -y (.*)$", text, re.MULTILINE)
    assert len(lines) >= 5
    for line in lines:
        assert any(set("".join(line).split()) <= set(need.packages) for need in needs.NEEDS.values()), line


# Need -> ends of paths of files that its packages bring and that the code opens or runs (pkg-config only depends on
# another package)
FILES = {
    "opengl": "libOSMesa.so.8 dri/swrast_dri.so libEGL.so.1 libGL.so.1",
    "vulkan": "libvulkan_lvp.so libvulkan.so.1 libatomic.so.1",
    "spirv-cross": "bin/spirv-cross",
    "wine": "bin/wine-stable wine/wine64 bin/x86_64-w64-mingw32-g++-posix bin/xvfb-run bin/xauth",
    "chromium": "bin/chromium",
    "npm": "bin/npm",
    "mono": "bin/mcs",
    "love": "bin/love-11.4",
    "java": "jvm/default-java java/ivy.jar",
    "ogre": "bin/g++ doc/pkg-config pkgconfig/OGRE.pc",
    "vulkan-sdk": "bin/g++ vulkan/vulkan.h bin/glslangValidator VkLayer_khronos_validation.json",
    "reshade": "implicit_layer.d/vkBasalt.json bin/vkcube bin/xvfb-run bin/xauth libvulkan_lvp.so",
    "glslang": "bin/glslangValidator bin/spirv-val",
    "window": "bin/xvfb-run bin/xauth libGL.so.1 dri/swrast_dri.so",
}


@pytest.mark.parametrize("name", FILES)
def test_packages_bring_what_is_used(name):
    """Check that a need's packages have its files, so that taking one out of the table is noticed even on a machine
    where it is installed.
    """
    assert set(FILES) == {name for name, need in needs.NEEDS.items() if need.packages}
    listed = subprocess.run(["dpkg-query", "-L", *needs.NEEDS[name].packages], capture_output=True, text=True)
    if listed.returncode or setup._release().get("VERSION_CODENAME") != "bookworm":
        pytest.skip("not all of its packages are installed here, or not as on Debian 12")
    for file in FILES[name].split():
        assert any(line.endswith(f"/{file}") for line in listed.stdout.splitlines()), file


def test_of():
    """Check that words of a command line can add needs, and that the version needs no Debian package."""
    assert needs.packages(needs.of(["--version"])) == () == needs.packages(needs.of(["parity"]))
    assert "wine" in needs.of(["render", "--driver=d3d9"]) and "wine" not in needs.of(["render"])
    assert {"chromium", "web"} <= set(needs.of(["check", "--driver", "webgl2"]))
    assert set(needs.EVERYTHING) <= set(needs.of(["--full"]))


def test_install():
    """Check the text that says how to install a need."""
    assert needs.install("npm") == "apt-get install -y --no-install-recommends npm (https://nodejs.org)"
    assert "validation[web]" in needs.install("web")


def texts(node: ast.AST) -> set[str]:
    """Return the strings in a piece of code."""
    constants = (one.value for one in ast.walk(node) if isinstance(one, ast.Constant))
    return {text for text in constants if isinstance(text, str)}


def test_messages_come_from_the_table():
    """Check that no other module spells out an apt-get command, and that pip is never called without hashes."""
    for folder in ("bokeh_validation", "engines", "lab"):
        for file in (file for file in (paths.VALIDATION / folder).rglob("*.py") if "tests" not in file.parts):
            module = ast.parse(file.read_text("utf-8"))
            found = [text for text in texts(module) if "apt-get install" in text]
            assert not found or file.name in ("needs.py", "setup.py"), file
            assert all("--require-hashes" in text for text in texts(module) if text.startswith("pip ")), file
            for function in (node for node in ast.walk(module) if isinstance(node, ast.FunctionDef)):
                if "pip" in texts(function) and texts(function) & {"install", "download"}:
                    assert "--require-hashes" in texts(function), (file, function.name)


def test_core_imports_nothing_of_one_system():
    """Check that modules which exist only on Unix are imported inside functions, so that the core
    imports on Windows.
    """
    for file in (paths.VALIDATION / "bokeh_validation").rglob("*.py"):
        for node in ast.parse(file.read_text(encoding="utf-8")).body:
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            assert not {"fcntl", "pwd", "grp", "resource", "termios"} & set(names), file


@pytest.fixture
def machine(tmp_path, monkeypatch):
    """Provide an empty cache folder, and stand-ins for apt-get and dpkg that log their command lines."""
    monkeypatch.setenv("BOKEH_CACHE", str(tmp_path / "cache"))
    paths.ensured(tmp_path / "cache")
    programs = paths.ensured(tmp_path / "programs")
    scripts = {
        "dpkg-query": "exit 1",
        "apt-get": f'echo "$*" >>{tmp_path}/calls; echo "Need to get 5 MB of archives."',
        "apt-cache": 'shift; for name; do [ $name = gone ] || printf "%s:\\n  Candidate: 1\\n" $name; done',
    }
    for name, script in scripts.items():
        (programs / name).write_text(f"#!/bin/sh\n{script}\n")
        (programs / name).chmod(0o755)
    monkeypatch.setenv("PATH", f"{programs}:/usr/bin:/bin")
    return tmp_path


def test_packages_as_root(machine, monkeypatch, capsys):
    """Check that an unobtainable package is reported once and remembered."""
    monkeypatch.setattr(os, "geteuid", lambda: 0)
    setup.install_packages(["one", "gone"])
    said = capsys.readouterr().err
    assert "gone is not to be had" in said and "installing one (5 MB to fetch)" in said
    assert "install -y --no-install-recommends one" in (machine / "calls").read_text()
    assert setup.wanted(["one", "gone"]) == ["one"]


def test_packages_as_user(machine, monkeypatch, capsys):
    """Check that without root the apt-get command is printed and not run."""
    monkeypatch.setattr(os, "geteuid", lambda: 1000)
    setup.install_packages(["one", "two"])
    assert capsys.readouterr().err.splitlines() == [f"set-up: missing system packages; run: sudo {needs.APT} one two"]
    assert not (machine / "calls").exists()


def test_no_network(tmp_path):
    """Check that a failed download gives one line and exit code 2, and leaves no environment that is
    marked complete.
    """
    environment = {**os.environ, **NO_INDEX, "BOKEH_CACHE": str(tmp_path)}
    environment.pop("BOKEH_SET_UP", None)
    done = subprocess.run([paths.VALIDATION / "run", "parity"], env=environment, capture_output=True, text=True)
    progress, *errors = done.stderr.splitlines()
    assert done.returncode == 2 and done.stdout == "" and progress.startswith("set-up: fetching")
    assert len(errors) == 1 and errors[0].startswith("error: the Python packages could not be installed: the package")
    assert not list(tmp_path.glob("venv-*/complete-*"))


def has_open(pid: int, path: Path) -> bool:
    """Return whether a process has opened this file."""
    with suppress(FileNotFoundError):  # closed while we looked
        return any(map(path.samefile, Path(f"/proc/{pid}/fd").iterdir()))
    return False


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interrupted(number, tmp_path):
    """Check that an interrupted set-up says so in one line and exits with 130: here, while it waits for another one."""
    environment = {**os.environ, "BOKEH_CACHE": str(tmp_path)}
    environment.pop("BOKEH_SET_UP", None)
    # a background shell makes its children ignore the signal
    foreground = {"preexec_fn": lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)}
    with open(tmp_path / "lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        process = subprocess.Popen(
            [paths.VALIDATION / "run", "parity"], env=environment, stderr=subprocess.PIPE, text=True, **foreground
        )
        # set-up waits when it has opened the file
        while process.poll() is None and not has_open(process.pid, Path(lock.name)):
            time.sleep(0.02)
        process.send_signal(number)
        assert process.communicate(timeout=HANG)[1] == "error: stopped\n" and process.returncode == 130


def test_interrupted_pip(tmp_path, monkeypatch):
    """Check that an interruption ends pip and the programs that pip has started."""
    started, pip = [], tmp_path / "python"
    pip.write_text("#!/bin/sh\nsleep 300 &\necho Collecting $!:$$\nwait\n")
    pip.chmod(0o755)

    def interrupted(text):
        started.extend(text.split(":"))
        raise KeyboardInterrupt

    monkeypatch.setattr(setup, "say", interrupted)
    with pytest.raises(KeyboardInterrupt):
        setup._pip(pip, tmp_path / "lock.txt")
    states = [Path(f"/proc/{int(pid)}/stat") for pid in started]
    deadline = time.monotonic() + 20
    # a program that has ended stays a zombie (Z) until its parent looks
    while running := [path for path in states if path.exists() and path.read_text().split()[2] != "Z"]:
        assert time.monotonic() < deadline, running
        time.sleep(0.02)
    assert len(states) == 2


def test_npm_locks():
    """Check that lock files pin every npm package with a hash, also the photographs that `pictures` draws."""
    locks = [
        lock
        for pattern in ("integration/*", "validation/*", "validation/lab/*")
        for lock in paths.ROOT.glob(f"{pattern}/package-lock.json")
    ]
    assert paths.VALIDATION / "lab/documents/package-lock.json" in locks
    for lock in locks:
        packages = json.loads(lock.read_bytes())["packages"]
        assert all("integrity" in package for name, package in packages.items() if name), lock


def test_folder_that_cannot_be_written():
    """Check the message for a cache folder that cannot be written."""
    environment = {**os.environ, "BOKEH_CACHE": "/dev/null/x"}
    done = subprocess.run([paths.VALIDATION / "run", "parity"], env=environment, capture_output=True, text=True)
    assert done.returncode == 2 and done.stderr.splitlines() == [
        "error: cannot write to the cache folder /dev/null/x; set BOKEH_CACHE"
    ]


def test_what_is_not_as_pinned_is_refused(tmp_path, monkeypatch):
    """Check that a package with a wrong or missing hash makes set-up fail without installing anything or asking an
    index.
    """
    wheel = tmp_path / "bokeh_trial-1.0-py3-none-any.whl"
    with zipfile.ZipFile(wheel, "w") as file:
        info = "bokeh_trial-1.0.dist-info"
        file.writestr(f"{info}/METADATA", "Metadata-Version: 2.1\nName: bokeh-trial\nVersion: 1.0\n")
        file.writestr(f"{info}/WHEEL", "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n")
        file.writestr(f"{info}/RECORD", "")
    right = hashlib.sha256(wheel.read_bytes()).hexdigest()
    python, lock = Path(sys.executable), tmp_path / "lock.txt"
    monkeypatch.setattr(paths, "cache_folder", lambda: tmp_path)
    monkeypatch.setenv("PIP_TARGET", str(tmp_path / "target"))
    for variable, value in NO_INDEX.items():
        monkeypatch.setenv(variable, value)
    for line in (f"{wheel.as_uri()} --hash=sha256:{'0' * 64}", wheel.as_uri()):
        lock.write_text(f"bokeh-trial @ {line}\n")
        with pytest.raises(setup.SetUpFailed, match="could not be installed"):
            setup._pip(python, lock)
        assert not (tmp_path / "target").exists()
    lock.write_text(f"bokeh-trial @ {wheel.as_uri()} --hash=sha256:{right}\n")
    setup._pip(python, lock)
    assert (tmp_path / "target").is_dir()
