"""validation/run without a command: what it runs and says, how long that takes, and its report."""

import os
import re
import resource
import signal
import subprocess
import sys
import time
from dataclasses import replace
from types import SimpleNamespace

import pytest
from support import called

from bokeh_validation import jobs, paths
from bokeh_validation import probes as patterns
from bokeh_validation.compilers.compile import Compilation
from bokeh_validation.reference.device import Reference
from bokeh_validation.run import report, validate
from bokeh_validation.run.sections import Section, of_probe
from bokeh_validation.shaders.variants import load

LEAKAGE = next(probe for probe in patterns.PROBES if probe.name == "leakage")


class Dark(Reference):
    """A driver with a fault."""

    name = "dark"

    def run(self, *arguments, **named):
        """Half as bright."""
        outputs = super().run(*arguments, **named)
        return {name: (image * 0.5).astype(image.dtype) for name, image in outputs.items()}


def page_of(tmp_path, sections: list[Section]) -> str:
    """The report of some sections."""
    market = Section("market_7", "", "", [], {"": []})
    found = validate.Everything(True, Compilation([], 0.0), sections, [], market, sections[:0])
    report.write(tmp_path / "page.html", found)
    return (tmp_path / "page.html").read_text(encoding="utf-8")


def assert_links_lead_somewhere(page: str) -> None:
    """Every cell of the grid, which comes before any picture."""
    grid = page[page.index('<table class="grid">') : page.index("</table>")]
    links = re.findall(r'href="#([^"]+)"', grid)
    assert links and set(links) <= set(re.findall(r'id="([^"]+)"', page))
    assert "<img" not in page[: page.index("</table>")]


@pytest.mark.timeout(1200)
def test_brief(tmp_path):
    """Says how long it takes and what it leaves out; every language is drawn; within two minutes on two cores, as CPU
    time, which other tests on the machine do not change."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = called("--output", tmp_path / "page.html")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert done.returncode == 0, done.stdout + done.stderr
    lines = done.stdout.splitlines()
    assert "2 minutes" in lines[0] and "--full" in lines[-1] and "d3d11" in lines[-1]
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert_links_lead_somewhere(page)
    for name in validate.BRIEF_DRIVERS:
        assert f'href="#leakage.{name}"' in page
    # with eight drivers instead of three, and scenes, it is to stay below 8 MB
    assert len(page) < 2e6
    assert after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime < 2 * 120


def test_every_entry_and_language_is_compiled_in_brief():
    """By its main compilers."""
    programs = [program for program in load(quick=True, main=True) if program.variant in validate.BRIEF_VARIANTS]
    assert {program.language for program in programs} == set(paths.LANGUAGES)
    for variant in validate.BRIEF_VARIANTS:
        entries = {program.entry for program in programs if program.variant == variant}
        assert entries == {program.entry for program in load()}


def test_report_shows_what_differs(tmp_path):
    """A picture that is wrong in full and with its distance, the others small; a cell for each."""
    section = of_probe([patterns.run(LEAKAGE, driver) for driver in (Reference(), Dark())])
    good, bad = section.runs
    assert good.ok and not bad.ok and any("FAILED" in line for line in bad.lines(False)) and not section.ok
    for panels in section.strips.values():
        wanted, same, other = panels
        assert same.small and not same.difference and len(same.picture) < len(wanted.picture)
        assert other.picture.startswith("data:image/png") and other.difference and not other.small
    page = page_of(tmp_path, [section, replace(section, name="other", runs=[good])])
    assert_links_lead_somewhere(page)
    assert '<td class="bad"><a href="#leakage.dark">FAILED</a>' in page and '<td class="na">not run' in page


def test_what_is_missing(tmp_path, monkeypatch):
    """A driver that is not there is told with its reason; under CI that is a failure."""
    monkeypatch.setattr(validate, "_load", lambda name, _: f"no {name} here")
    section = validate.probe("leakage", ("egl",), None, True)
    assert section.missing == {"egl": "no egl here"} and not section.runs
    assert "egl was not run: no egl here" in page_of(tmp_path, [section])
    found = SimpleNamespace(drawn=[section], engines=[], compilation=Compilation([], 0.0), missing=section.missing)
    monkeypatch.delenv("CI", raising=False)
    assert validate.Everything.ok.fget(found)
    monkeypatch.setenv("CI", "1")
    assert not validate.Everything.ok.fget(found)


def test_jobs_keep_their_order():
    """Results come in the order of the jobs, whichever ends first; an error ends all."""
    assert jobs.run([(time.sleep, (0.5,)), (abs, (-2,)), (abs, (-3,))], lambda _: None) == [None, 2, 3]
    with pytest.raises(TypeError):
        jobs.run([(abs, ("text",)), (time.sleep, (60,))], lambda _: None)


def test_interrupted():
    """The command and its processes are gone within seconds."""
    process = subprocess.Popen(
        [sys.executable, "-P", "-m", "bokeh_validation"],
        env={**os.environ, "PYTHONPATH": str(paths.VALIDATION)},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    time.sleep(6)
    process.send_signal(signal.SIGTERM)
    assert process.communicate(timeout=20)[1] == "" and process.returncode == 130
