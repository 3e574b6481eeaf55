"""A copy of the checkout, so that the tests can run on other shaders than the checkout's."""

import os
import re
import shutil
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from threading import Event
from xml.etree import ElementTree

from bokeh_validation import paths
from bokeh_validation.mutants import children
from bokeh_validation.mutants.model import Selection

# What the tests read but no mutant changes is not copied. The package itself must be: it finds the shaders by where
# it is.
LINKED = ("docs", "integration", "README.md", "CHANGELOG.md", "LICENSE", ".ci")
LINKED_VALIDATION = ("scenes", "stubs")
# A test that takes longer hangs; so do all of them together
TEST_S, SELECTION_S = 120, 1800
# Exit codes of pytest; with any other it did not come to its end
PASSED, FAILED, NO_TESTS = 0, 1, 5
# How the message of a failed assertion begins, in contrast to that of any other exception, a time-out among them
ASSERTION = re.compile(r"assert|AssertionError|Failed: (?!Timeout)")


@dataclass(frozen=True)
class Session:
    """What a selection of the tests said, up to the first that failed.

    passed     how many passed
    test       node id of the one that failed, or ''
    assertion  whether that was an assertion and not an error
    """

    passed: int
    test: str = ""
    assertion: bool = False
    message: str = ""
    seconds: float = 0.0

    @property
    def ok(self) -> bool:
        """Tests were run and none failed."""
        return self.passed > 0 and not self.test and not self.message


class Workspace:
    """One copy in a folder of its own, to be removed by whoever named it. Not for several threads at once.

    A context manager: at the end of the block Python's compiled files are removed, where they are kept elsewhere.

    stop   set by another thread to end the session that runs; there are no others then
    """

    def __init__(self, folder: Path, stop: Event | None = None):
        self.root = folder.resolve()
        self.stop = stop or Event()
        self.validation = self.root / "validation"
        ignored = shutil.ignore_patterns("__pycache__", "*.pyc", *LINKED_VALIDATION)
        shutil.copytree(paths.VALIDATION, self.validation, ignore=ignored)
        for language in paths.LANGUAGES:
            shutil.copytree(paths.ROOT / language, self.root / language)
        for name in LINKED:
            if (paths.ROOT / name).exists():
                (self.root / name).symlink_to(paths.ROOT / name)
        for name in LINKED_VALIDATION:
            (self.validation / name).symlink_to(paths.VALIDATION / name)

    def __enter__(self) -> "Workspace":
        return self

    def __exit__(self, *_) -> None:
        if sys.pycache_prefix:
            compiled = Path(sys.pycache_prefix) / self.root.relative_to(self.root.anchor)
            shutil.rmtree(compiled, ignore_errors=True)

    @contextmanager
    def changed(self, texts: Mapping[str, str]) -> Iterator[None]:
        """With other text in these files, path from the top -> text, until the end of the block."""
        before = {key: (self.root / key).read_bytes() for key in texts}
        try:
            for key, text in texts.items():
                (self.root / key).write_bytes(text.encode("ascii"))
            yield
        finally:
            for key, content in before.items():
                (self.root / key).write_bytes(content)

    def test(self, selection: Selection) -> Session:
        """Run tests on the copy until one fails. Raises Stopped."""
        report = self.root / "junit.xml"
        said = self.root / "said.txt"
        report.unlink(missing_ok=True)
        command = [
            *(sys.executable, "-P", "-m", "pytest", "-c", str(self.validation / "pytest.ini")),
            *("--rootdir", str(self.validation), "-p", "no:cacheprovider", "-n", "0", "-x", "--tb=short"),
            *("--timeout", str(TEST_S), "--junitxml", str(report)),
            *(("-k", selection.keywords) if selection.keywords else ()),
            *(str(path) for name in selection.files for path in (self.validation / "tests").rglob(name)),
        ]
        started = time.monotonic()
        try:
            code = children.run(command, SELECTION_S, self.stop, said, self.root, self._environment())
        except TimeoutError as error:
            return Session(0, message=str(error), seconds=time.monotonic() - started)
        last = said.read_text(errors="replace").strip().splitlines()[-1:] or ["no message"]
        return _session(report, code, last[0], time.monotonic() - started)

    def _environment(self) -> dict[str, str]:
        # tests that run in a process of the test suite must not take themselves for one of its workers
        kept = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")}
        # what is left by one that is killed goes with the copy
        temporary = paths.ensured(self.root / "tmp")
        return {**kept, "PYTHONPATH": str(self.validation), "TMPDIR": str(temporary)}


def _session(report: Path, code: int, last: str, seconds: float) -> Session:
    """What the report says, if pytest's exit code says the same; else an error, with the last line that it printed."""
    passed, failed = 0, None
    for case in _cases(report):
        bad = [child for child in case if child.tag in ("failure", "error")]
        if bad:
            failed = case, bad[0].tag, " ".join(bad[0].get("message", "").split())
            break
        passed += case.find("skipped") is None
    if code == FAILED and failed:
        case, tag, said = failed
        return Session(passed, _node(case), tag == "failure" and bool(ASSERTION.match(said)), said, seconds)
    if failed or code not in (PASSED, NO_TESTS) or (code == NO_TESTS and passed):
        said = failed[2] if failed else last
        return Session(passed, message=f"pytest ended with {code}: {said}", seconds=seconds)
    return Session(passed, seconds=seconds, message="" if passed else "no test was run")


def _cases(report: Path) -> list[ElementTree.Element]:
    """Those of a report; none where it was not written to its end."""
    try:
        return list(ElementTree.parse(report).iter("testcase"))
    except (FileNotFoundError, ElementTree.ParseError):
        return []


def _node(case: ElementTree.Element) -> str:
    """tests.test_compile.TestMatrix, test_accepted -> test_compile.py::TestMatrix::test_accepted"""
    _, _, place = case.get("classname", "").partition("tests.")
    file, *classes = place.split(".")
    return "::".join((f"{file}.py", *classes, case.get("name", "")))
