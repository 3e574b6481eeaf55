"""Tests of a web project, which Node.js runs: their results, taken into those of pytest."""

import os
import subprocess
from collections.abc import Mapping
from pathlib import Path
from xml.etree import ElementTree

import pytest
from support import needed

from bokeh_validation import browser, paths

LIMIT = 1500.0  # seconds


def assert_npm_test(project: Path, extra: Mapping[str, str] | None = None) -> None:
    """Run `npm test` in a copy of a project; fail with what Node.js says of each test that failed.

    extra   more environment
    """
    with needed("Chromium"):
        chromium = browser.executable()
    report = project / "report.xml"
    environment = {
        **os.environ,
        "NODE_OPTIONS": f"--test-reporter=junit --test-reporter-destination={report}",
        "BOKEH_CHROMIUM": chromium,
        "npm_config_cache": str(paths.cache_folder() / "npm"),
        **(extra or {}),
    }
    done = subprocess.run(
        ["npm", "test"], cwd=project, env=environment, timeout=LIMIT, text=True,
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip
    tests = list(ElementTree.parse(report).iter("testcase")) if report.exists() else []
    failed = [f"{case.get('name')}: {failure.text}" for case in tests if (failure := case.find("failure")) is not None]
    if failed or done.returncode or not tests:
        pytest.fail("\n".join(failed) or f"npm test: exit code {done.returncode}\n{done.stdout}", pytrace=False)
