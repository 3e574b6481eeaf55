"""Run tests of a web project with Node.js, and report their results to pytest."""

import json
import os
import re
import subprocess
from collections.abc import Iterator, Mapping
from pathlib import Path
from xml.etree import ElementTree

import pytest
from support import needed

from bokeh_validation import browser, paths

LIMIT = 1500.0  # seconds
# Characters that XML excludes
CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f]")


def files(project: Path) -> list[str]:
    """Return the files that `npm test` runs in a project."""
    script = json.loads((project / "package.json").read_bytes())["scripts"]["test"]
    pattern = script.removeprefix("node --test ")
    return sorted(file.relative_to(project).as_posix() for file in project.glob(pattern))


def assert_passes(project: Path, file: str, extra: Mapping[str, str] | None = None) -> None:
    """Run one of these files in a copy of the project; fails with Node.js's message of each failed test.

    extra  additional environment variables
    """
    with needed("Chromium"):
        chromium = browser.executable()
    report = project / f"{file}.xml"
    environment = {
        **os.environ,
        "BOKEH_CHROMIUM": chromium,
        "npm_config_cache": str(paths.cache_folder() / "npm"),
        **(extra or {}),
    }
    done = subprocess.run(
        ["node", "--test", "--test-reporter=junit", f"--test-reporter-destination={report}", file],
        cwd=project, env=environment, timeout=LIMIT, text=True,
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip
    # Node.js copies colours of a terminal into the report, which XML does not allow
    text = CONTROL.sub("", report.read_text(encoding="utf-8")) if report.exists() else ""
    tests = list(_tests(ElementTree.fromstring(text))) if text else []
    failed = [f"{name}: {failure.text}" for name, case in tests if (failure := case.find("failure")) is not None]
    if failed or done.returncode or not tests:
        pytest.fail("\n".join(failed) or f"node --test: exit code {done.returncode}\n{done.stdout}", pytrace=False)


def _tests(element: ElementTree.Element, above: str = "") -> Iterator[tuple[str, ElementTree.Element]]:
    """Yield each test of a report: its name, prefixed by the names of the enclosing tests, and its element."""
    for child in element:
        name = f"{above}{child.get('name')}"
        if child.tag == "testcase":
            yield name, child
        elif child.tag == "testsuite":
            yield from _tests(child, f"{name} > ")
