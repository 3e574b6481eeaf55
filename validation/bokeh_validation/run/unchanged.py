"""Skip a test whose inputs have not changed since it last passed here (pytest). It runs with --all, and if its file
is named on the command line.

`@pytest.mark.inputs(path, ...)` names everything that the test's outcome depends on: files and folders, relative to
the repository's root. Several marks add up. `@pytest.mark.inputs(path, ..., leave_out=(pattern, ...))` leaves out some
files of the folders, by patterns for their paths.
"""

from fnmatch import fnmatch
from functools import cache

import pytest

from bokeh_validation import locks, paths

# Suffixes of files that running leaves behind, which are not inputs
LEFT_BEHIND = (".pyc",)


@cache
def digest_of(name: str, leave_out: tuple[str, ...] = ()) -> str:
    """Return a digest of a file, or of all files of a folder by their paths and contents.

    name       path below the repository's root
    leave_out  patterns of paths below the root; files that match one are no inputs
    """
    root = paths.ROOT / name
    if not root.exists():
        raise ValueError(f"pytest.mark.inputs: there is no {name}")
    files = [root] if root.is_file() else [path for path in root.rglob("*") if path.is_file()]
    named_files = sorted((path.relative_to(paths.ROOT).as_posix(), path) for path in files)
    return locks.digest(
        part
        for name, path in named_files
        if path.suffix not in LEFT_BEHIND and not any(fnmatch(name, pattern) for pattern in leave_out)
        for part in (name, path)
    )


def _state(item: pytest.Item) -> str | None:
    """Return a digest of a test's inputs, or None if it declares none."""
    marks = [(mark.args, mark.kwargs.get("leave_out", ())) for mark in item.iter_markers("inputs")]
    found = sorted({(name, leave_out) for names, leave_out in marks for name in names})
    return locks.digest(digest_of(name, leave_out) for name, leave_out in found) if found else None


def _key(item: pytest.Item) -> str:
    return f"unchanged/{item.nodeid}"


def _of_report(config: pytest.Config) -> bool:
    """Return whether validation/run started the tests: then none is skipped, since the command needs their results,
    and none is recorded, since a brief run shows less.
    """
    return bool(config.getoption("--report", None))


def pytest_configure(config):
    """Register the mark."""
    config.addinivalue_line(
        "markers", "inputs(*paths, leave_out=()): skipped while these are what they were when it passed"
    )


def pytest_collection_modifyitems(config, items):
    """Skip unchanged tests, unless everything or a certain file is asked for."""
    asked = config.getoption("--all") or _of_report(config) or any(".py" in argument for argument in config.args)
    for item in [] if asked else items:
        state = _state(item)
        if state is not None and config.cache.get(_key(item), "") == state:
            item.add_marker(pytest.mark.skip("nothing has changed since it passed; --all runs it, or its file's name"))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item, call):
    """Record the digest of a test's inputs when it passes."""
    report = yield
    if call.when == "call" and report.passed and not _of_report(item.config) and (state := _state(item)) is not None:
        item.config.cache.set(_key(item), state)
    return report
