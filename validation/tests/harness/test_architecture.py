"""Keep the code manageable: short files and functions, imports in one direction only."""

import ast
import subprocess
import sys
from collections import Counter
from graphlib import TopologicalSorter

import pytest

from bokeh_validation import paths

FILE_LINES, FUNCTION_LINES = 400, 60
PACKAGE, *OTHERS = (paths.VALIDATION / name for name in ("bokeh_validation", "engines", "lab"))
TESTS = paths.VALIDATION / "tests"
CODE = (".py", ".cpp", ".c", ".h", ".js", ".html", ".glsl", ".hlsl", ".wgsl")
SOURCES = [file for folder in (PACKAGE, *OTHERS, TESTS) for file in sorted(folder.rglob("*")) if file.suffix in CODE]


def name_of(file) -> str:
    """Return the module name of a file, such as bokeh_validation.drivers.gl."""
    return ".".join(file.relative_to(paths.VALIDATION).with_suffix("").parts).removesuffix(".__init__")


FILES = [file for folder in (PACKAGE, *OTHERS) for file in folder.rglob("*.py")]
MODULES = {name_of(file): file for file in FILES if file.parent.name != "tests"}


def imported(name: str) -> set[str]:
    """Return the package's modules that one imports, inside functions too."""
    found = set()
    for node in ast.walk(ast.parse(MODULES[name].read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                full = f"{node.module}.{alias.name}"
                found.add(full if full in MODULES else node.module)
    return found & set(MODULES)


@pytest.mark.parametrize("file", SOURCES, ids=lambda file: str(file.relative_to(paths.VALIDATION)))
def test_lengths(file):
    """Check the length of a file, and of the bodies of its functions."""
    text = file.read_text(encoding="utf-8")
    assert text.count("\n") <= FILE_LINES
    for node in ast.walk(ast.parse(text)) if file.suffix == ".py" else ():
        if isinstance(node, ast.FunctionDef):
            assert node.end_lineno - node.body[0].lineno < FUNCTION_LINES, node.name


def folder(name: str) -> str:
    """Return the folder of a module; a module of the package's top folder is its own."""
    return ".".join(name.split(".")[: 2 if name.startswith("bokeh_validation.") else 1])


def test_no_circle_of_folders():
    """Check that folders do not import each other in a circle, imports inside functions included; CycleError names
    one.
    """
    left: dict[str, set[str]] = {}
    for name, file in MODULES.items():
        needs = left.setdefault(folder(name), set())
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module:
                full = (f"{node.module}.{alias.name}" for alias in node.names)
                needs |= {folder(one if one in MODULES else node.module) for one in full}
    # modules next to the folders have levels of their own
    folders = {name for name in left if MODULES[name].stem == "__init__"} - {"bokeh_validation"}
    TopologicalSorter({name: left[name] & folders - {name} for name in folders}).prepare()


def test_no_cycle():
    """Check that modules do not import each other in a circle; CycleError names one."""
    TopologicalSorter({name: imported(name) - {name} for name in MODULES}).prepare()


# The layers from the bottom up: a module imports nothing from a later line
LEVELS = [
    line.split()
    for line in """
errors paths needs setup files locks process packages terminal shaders numerics
exr metrics pictures frame reference windows browser compilers
options drivers
plan generate compile_matrix probes
render compare check truth doctor
run cli __main__
engines
lab
""".strip().splitlines()
]


def level(name: str) -> int:
    """Return the index in LEVELS of the longest name that matches the module or its package."""
    bare = name.removeprefix("bokeh_validation.")
    fits = [
        (len(known), index)
        for index, names in enumerate(LEVELS)
        for known in names
        if f"{bare}.".startswith(f"{known}.")
    ]
    return max(fits)[1]


@pytest.mark.parametrize("name", [name for name in sorted(MODULES) if name != "bokeh_validation"])
def test_imports_go_down(name):
    """Check that a module imports nothing from a higher level."""
    higher = [other for other in imported(name) if other != "bokeh_validation" and level(other) > level(name)]
    assert not higher


def test_one_name_a_module():
    """Check that no two modules share a name, so that a name is unambiguous."""
    names = Counter(name.rpartition(".")[2] for name in MODULES)
    assert [name for name, count in names.items() if count > 1] == []


@pytest.mark.parametrize("command", [["check"], ["format", "--check"]], ids=["check", "format"])
def test_ruff(command):
    """Run ruff with ruff.toml."""
    ruff = [sys.executable, "-m", "ruff", *command, "--no-cache", "--config", "ruff.toml", "."]
    done = subprocess.run(ruff, cwd=paths.VALIDATION, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
