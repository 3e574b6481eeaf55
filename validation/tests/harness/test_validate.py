"""Test validation/run without a command: what it runs and prints, and its report."""

import os
import re
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest
import typer
from support import HANG

from bokeh_validation import paths, probes
from bokeh_validation.compile_matrix import Compilation
from bokeh_validation.drivers.computed import Reference
from bokeh_validation.probes import outcomes
from bokeh_validation.probes.outcomes import Outcome, Run, of_driver
from bokeh_validation.run import session, validate

LEAKAGE = next(probe for probe in probes.PROBES if probe.name == "leakage")
LEAKAGE_OK = Outcome("leakage", "", runs=[Run("egl", {})])


class Dark(Reference):
    """Simulate a faulty driver that draws at half the brightness."""

    name = "dark"

    def run(self, *arguments, **named):  # noqa: D102
        outputs = super().run(*arguments, **named)
        return {name: (image * 0.5).astype(image.dtype) for name, image in outputs.items()}


def page_of(tmp_path, shown: list[Outcome]) -> str:
    """Return the report of some sections."""
    market = Outcome("market_7", "", strips={"": []})
    validate.write_report(tmp_path / "page.html", validate.Everything(True, Compilation([]), shown, market, []))
    return (tmp_path / "page.html").read_text(encoding="utf-8")


def test_brief(tmp_path, monkeypatch, capsys):
    """Run one probe, language and compiler variant: it prints its duration, what it leaves out, and the result."""
    monkeypatch.setattr(validate, "BRIEF_DRIVERS", ("osmesa",))
    monkeypatch.setattr(probes, "PROBES", (LEAKAGE,))
    monkeypatch.setattr(validate, "BRIEF_VARIANTS", ("glsl-330",))
    with pytest.raises(typer.Exit) as end:
        validate.validate(False, None, tmp_path / "page.html", ())
    lines = capsys.readouterr().out.splitlines()
    assert end.value.exit_code == 0, lines
    assert "a minute" in lines[0] and "--full" in lines[-1]
    assert lines[-3].startswith("All ok: 1 probes on osmesa, ") and lines[-2].endswith("page.html")
    assert [line for line in lines if "not run: drivers" in line and "webgl2" in line and "--full" in line]
    assert not any("missing" in line for line in lines)
    assert len([line for line in lines if re.fullmatch(r"market_7, .*: \d+\.\d dB against the truth", line)]) == 4
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert '<a href="#leakage">' in page and '<h3 id="leakage" class="ok">' in page and len(page) < 2e6


def test_report_shows_what_differs(tmp_path):
    """Check that the report shows a wrong image next to the reference's, with the distance, and a cell for each
    driver.
    """
    (section,) = outcomes.merged(of_driver(LEAKAGE, driver) for driver in (Reference(), Dark()))
    good, bad = section.runs
    assert good.ok and not bad.ok and any("FAILED" in line for line in bad.lines(False)) and not section.ok
    for expected, other in section.strips.values():
        assert (expected.caption, other.caption) == ("reference", "dark") and not expected.difference
        assert other.picture.startswith("data:image/png") and other.difference
    page = page_of(tmp_path, [section, replace(section, name="other", runs=[good])])
    assert '<td class="bad">FAILED' in page and '<td class="missing">not run' in page
    assert '<p class="verdict bad">FAILED: leakage' in page
    assert re.search('<p class="bad">dark: .* FAILED', page)


def test_missing_driver(tmp_path, monkeypatch):
    """Check that a missing driver is reported with its reason, and is a failure under CI."""
    monkeypatch.setattr(outcomes, "driver_or_reason", lambda name, _: f"no {name} here")
    section = outcomes.of_probe(LEAKAGE, "egl")
    assert section.missing == {"egl": "no egl here"} and not section.runs
    assert '<p class="missing">egl: no egl here</p>' in page_of(tmp_path, [section])
    results = validate.Everything(False, Compilation([]), [section], section, [])
    monkeypatch.delenv("CI", raising=False)
    assert results.ok
    monkeypatch.setenv("CI", "1")
    assert not results.ok


def test_an_error_is_no_success(tmp_path):
    """Check that a test that failed is reported even if the result that it handed over is right."""
    errors = session.unexplained({"a[b]": LEAKAGE_OK}, {"a[b]": "no lens", "c[d]": "no driver"})
    assert errors == {"b": "no lens", "d": "no driver"}
    found = validate.Everything(True, Compilation([]), [LEAKAGE_OK], None, [], errors)
    assert not found.ok and found.verdict.startswith("FAILED: b, d")
    validate.write_report(tmp_path / "page.html", found)
    assert '<p class="bad">b: no lens</p>' in (tmp_path / "page.html").read_text(encoding="utf-8")


def has_worked(pid: str) -> bool:
    """Return whether a process has used a second of processor time: a worker has then read its first instruction."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return int(fields[11]) + int(fields[12]) >= os.sysconf("SC_CLK_TCK")


def test_interrupted():
    """Check that after an interruption the command and its two worker processes are gone.

    It comes when both have begun to work: before that, Python reports the missing instruction with a stack trace.
    """
    command = [sys.executable, "-P", "-m", "bokeh_validation"]
    environment = {**os.environ, "PYTHONPATH": str(paths.VALIDATION)}
    streams = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE, "text": True}
    process = subprocess.Popen(command, env=environment, start_new_session=True, **streams)
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    while process.poll() is None and sum(map(has_worked, children.read_text().split())) < 2:
        time.sleep(0.1)
    process.send_signal(signal.SIGTERM)
    assert process.communicate(timeout=HANG)[1] == "error: stopped\n" and process.returncode == 130
