"""The mutants fit the shaders, cover them, and a run tells those that are caught from those that are not."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from threading import Event, Thread

import pytest
from test_render import run as command

from bokeh_validation import parity, paths, report
from bokeh_validation.errors import UserError
from bokeh_validation.mutants import catalog, children, edits, output, results, runner, soundness
from bokeh_validation.mutants.killers import HOSTILE, PARITY, TINY, on
from bokeh_validation.mutants.model import (
    ALIVE,
    ARGUED,
    BROKEN,
    CAUGHT,
    KINDS,
    UNPROVEN,
    Edit,
    Mutant,
    Result,
    Selection,
)
from bokeh_validation.mutants.workspace import Workspace

BY_NAME = {mutant.name: mutant for mutant in catalog.MUTANTS}


def made(old: str, new: str, *killers: Selection, within: str | None = "BokehCoC", languages=paths.LANGUAGES) -> Mutant:
    """A mutant that is not of the catalog."""
    return Mutant("made here", "sign", (Edit("library", within, old, new),), killers, languages)


# ----------------------------------------------------------------------------------------------------------------------
# the catalog
# ----------------------------------------------------------------------------------------------------------------------


def test_every_edit_fits():
    """Each stands in the shaders as often as it says, and no two mutants are the same."""
    texts = [tuple(sorted(edits.mutated(mutant).items())) for mutant in catalog.MUTANTS]
    assert len(set(texts)) == len(BY_NAME) == len(catalog.MUTANTS)


def test_enough_of_every_kind():
    """As many as there were in 0.1.0, most of them such that the parity check cannot see them, of every kind."""
    assert len(catalog.MUTANTS) >= 199
    assert sum(mutant.everywhere for mutant in catalog.MUTANTS) >= 150
    for language in paths.LANGUAGES:
        assert sum(mutant.languages == (language,) for mutant in catalog.MUTANTS) >= 5
    assert {mutant.kind for mutant in catalog.MUTANTS} == set(KINDS)


@pytest.mark.parametrize("language", paths.LANGUAGES)
def test_every_function_is_changed(language):
    """Each of sections [3] to [13] by a mutant of all languages, so by one that only numbers show."""
    changed = {place for mutant in catalog.MUTANTS if mutant.everywhere for place in mutant.places}
    functions = edits.functions(language)
    assert len(functions) > 60 and functions["BokehLayered"] == 13
    # the helpers of the passes
    assert {"BokehUseViewport", "BokehBegin", "BokehAdaptiveLine", "BokehFirst", "BokehSecond"} <= changed
    assert not [name for name, section in functions.items() if section >= 3 and name not in changed]


def test_every_guard_is_removed():
    """max(..., BOKEH_...) and max(..., 0.0) of the libraries: a mutant takes out or reverses each."""
    text = edits.originals()[parity.LIBRARY["glsl"]]
    guarded = {name for name in edits.functions("glsl") if _has_guard(text, name)}
    assert {"BokehCoC", "BokehMakeOffsets", "BokehExactTarget", "BokehDebugFocus"} <= guarded
    removed = {place for mutant in catalog.MUTANTS if mutant.kind == "guard" for place in mutant.places}
    assert guarded <= removed


def _has_guard(text: str, name: str) -> bool:
    bodies = [text[start:end] for start, end in edits.bodies(text, "library", "glsl", name)]
    return any("max(" in body and name != "BokehCombine" for body in bodies)


def test_killers_are_there():
    """Each names tests of files that exist, and the last resort names none that runs mutants itself."""
    for selection in (*runner.selections(catalog.MUTANTS), runner.remaining()):
        assert selection.files and all(list((paths.VALIDATION / "tests").rglob(name)) for name in selection.files)
    assert "test_mutants.py" not in runner.remaining().files
    assert {"test_drivers.py", "test_parity.py", "test_survivors.py"} <= set(runner.remaining().files)


def test_an_edit_that_does_not_fit_names_its_mutant():
    """The shaders have changed, or the function is gone."""
    for mutant in (made("S2 - S3", "S2"), made("S2", "S3"), made("S2 - focus", "S2", within="BokehNoSuch")):
        with pytest.raises(UserError, match="mutant made here: 'S2.* stands [02] times in .* of hlsl/bokeh.hlsl"):
            edits.mutated(mutant)


def test_an_edit_keeps_to_its_place():
    """The body of the function and of no other; in GLSL's passes the main() of the entry."""
    for language in paths.LANGUAGES:
        before = edits.originals()
        (key,) = edits.mutated(made("S2 - focus", "focus - S2", languages=(language,)))
        after = edits.mutated(made("S2 - focus", "focus - S2", languages=(language,)))[key]
        lines = zip(before[key].splitlines(), after.splitlines(), strict=True)
        changed = [new for old, new in lines if new != old]
        assert len(changed) == 1 and "abs(focus - S2)" in changed[0]
    entry = Mutant("", "pass", (Edit("passes", "BokehDecagonFirst", ", 10)", ", 8)"),), (), ("glsl",))
    (text,) = edits.mutated(entry).values()
    assert text.index(", 8)", text.index("#elif BOKEH_PASS == BOKEH_DECAGON_FIRST\n\n")) < text.index(
        "== BOKEH_DECAGON_SECOND\n"
    )


def test_an_edit_goes_over_line_breaks():
    """They are at another place in each language."""
    call = made("settings.imageHeight, settings.spacing)", "1.0)", within="BokehExactFirst")
    broken = {
        key: text.replace("imageHeight, settings", "imageHeight,\n        settings")
        for key, text in edits.originals().items()
    }
    for texts in (None, broken):
        assert all("abs(centerPixel.a), 1.0)" in text for text in edits.mutated(call, texts).values())


def test_spelling():
    assert edits.spelled("vec4(float(i), int(j))", "hlsl") == "float4(float(i), int(j))"
    assert edits.spelled("vec4(float(i), int(j))", "wgsl") == "vec4f(f32(i), i32(j))"
    assert edits.spelled("BokehAngle + BokehAngleB", "wgsl", "passes") == (
        "bokehParameters.BokehAngle + bokehParameters.BokehAngleB"
    )
    assert edits.spelled("BokehAngle", "hlsl", "passes") == edits.spelled("BokehAngle", "wgsl") == "BokehAngle"


# ----------------------------------------------------------------------------------------------------------------------
# running
# ----------------------------------------------------------------------------------------------------------------------


def test_a_run():
    """Caught: one of all languages, one of each, one by the last resort. The others are what they are made to be."""
    harmless = made("metres, 35 mm film", "metres, 36 mm film", HOSTILE, within=None)
    broken = made("S2 - focus", "S2 - S7", HOSTILE, languages=("wgsl",))
    argued = replace(harmless, argument="a comment")
    nothing = made("S2 - focus", "focus - S2", on("nodriver", "test_drivers.py"))
    caught = [BY_NAME[name] for name in ("coc-sign", "hlsl-upside-down", "glsl-upside-down", "wgsl-offsets")]
    late = replace(BY_NAME["coc-sign"], killers=(PARITY,))
    done = runner.run([*caught, harmless, broken, nothing, argued, late], last=TINY)
    assert [result.outcome for result in done.results] == [CAUGHT] * 4 + [ALIVE, BROKEN, UNPROVEN, ARGUED, CAUGHT]
    assert done.results[8].test.startswith("test_drivers.py::test_depth_of_a_tenth_of_a_millimetre")
    assert not done.ok and [result.parity for result in done.results[:4]] == [False, False, False, True]
    assert done.results[0].test.startswith("test_inputs.py::test_camera_at_its_limits[")
    assert done.results[3].test == "test_parity.py::test_the_checkout_passes"
    assert "S7" in done.results[5].detail and "no test was run" in done.results[6].detail
    printed = list(output.lines(done, 1.0))
    assert printed[-1] == "5 of 9 mutants caught, 1 argued (1 s)"
    assert sum(line.startswith("made here (") for line in printed) == 4


def test_a_mutant_that_is_not_the_same_everywhere_proves_nothing():
    """One that says it is of all languages but that the parity check sees. A line that is too long is none of that."""
    longer = made("abs(S2 - focus)", "abs(S2 - focus) + 0.0 * (S2 + focus + S2 + focus + S2 + focus + S2 + focus + S2)")
    assert not soundness.seen_by_parity(edits.mutated(longer))
    bits = made("abs(S2 - focus)", "abs(S2 - focus) * float(1 | 1)")
    texts = edits.mutated(bits)
    assert soundness.seen_by_parity(texts)
    assert "not the same in all languages" in soundness.refusal(bits, texts, True)
    assert not soundness.refusal(bits, texts, False)


@pytest.fixture
def workspace(tmp_path):
    """A copy of the checkout."""
    with Workspace(tmp_path / "copy") as made:
        yield made


def test_an_error_is_no_catch(workspace):
    """Nor a time-out, nor a test that was skipped: only a failed assertion is."""
    (workspace.validation / "tests" / "test_made.py").write_text(
        "import time, pytest\n"
        "class TestA:\n    def test_a(self):\n        raise KeyError('x')\n"
        "@pytest.mark.timeout(1)\ndef test_b():\n    time.sleep(9)\n"
        "def test_c():\n    pytest.skip('not here')\n"
    )
    seen = {name: workspace.test(Selection(("test_made.py",), f"test_{name}")) for name in "abc"}
    assert not any(session.assertion or session.ok for session in seen.values())
    assert seen["a"].test == "test_made.py::TestA::test_a" and "KeyError" in seen["a"].message
    assert seen["b"].test == "test_made.py::test_b" and "Timeout" in seen["b"].message
    assert seen["c"].message == "no test was run"


# What becomes of a session of one passed test where pytest ends with this
ENDS = {
    "0": "",
    "1": "pytest ended with 1: ",
    "2": "pytest ended with 2: ",
    "3": "pytest ended with 3: ",
    "4": "pytest ended with 4: ",
    "5": "pytest ended with 5: ",
    "-9": "pytest ended with -9: ",
}


def passing(workspace: Workspace, more: str = "") -> Path:
    """A test that passes, and what else is in its conftest.py; the test's file."""
    (workspace.validation / "tests" / "conftest.py").write_text(more)
    made = workspace.validation / "tests" / "test_made.py"
    made.write_text("def test_made():\n    pass\n")
    return made


@pytest.mark.parametrize("code", ENDS)
def test_an_exit_code_counts(code, workspace):
    """Only 0 is a session without a failure, whatever the report says."""
    end = "os.kill(os.getpid(), 9)" if code == "-9" else f"session.exitstatus = {code}"
    hook = f"@pytest.hookimpl(trylast=True)\ndef pytest_sessionfinish(session):\n    {end}\n"
    passing(workspace, f"import os, pytest\n{hook}")
    session = workspace.test(Selection(("test_made.py",)))
    assert session.message.startswith(ENDS[code]) and bool(session.message) == (code != "0")
    assert session.ok == (code == "0") and not session.assertion and not session.test


def test_a_failure_needs_its_exit_code(workspace):
    """Interrupted after an assertion failed: an error. So is a file that cannot be imported, with what is wrong."""
    made = passing(workspace, "def pytest_sessionfinish(session):\n    session.exitstatus = 2\n")
    made.write_text("def test_made():\n    assert 1 == 2\n")
    session = workspace.test(Selection(("test_made.py",)))
    assert "pytest ended with 2: " in session.message and "1 == 2" in session.message and not session.assertion
    passing(workspace).write_text("import nothing_of_this_name\n")
    session = workspace.test(Selection(("test_made.py",)))
    assert not session.ok and not session.assertion and session.message


def processes_with(text: str) -> list[str]:
    """Command lines of the processes, and their environments, that have this text; a zombie has neither."""
    found = []
    for process in Path("/proc").iterdir():
        if process.name.isdigit() and int(process.name) != os.getpid():
            try:
                line = (process / "cmdline").read_bytes()
                if text.encode() in line + (process / "environ").read_bytes():
                    found.append(line.replace(b"\0", b" ").decode(errors="replace"))
            except (FileNotFoundError, ProcessLookupError, PermissionError):
                pass
    return found


def waited(condition: Callable[[], object], seconds: float) -> bool:
    """Whether it holds within so many seconds."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.05)
    return True


# A test that does not hear an interruption, and has started a program
DEAF = """
import signal, subprocess, sys, time
from pathlib import Path
def test_made():
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(99)"])
    Path(__file__).with_name("begun").touch()
    child.wait()
"""


def test_a_session_out_of_time_takes_its_children_along(workspace, monkeypatch):
    """Also where pytest does not listen."""
    monkeypatch.setattr("bokeh_validation.mutants.workspace.SELECTION_S", 5)
    monkeypatch.setattr(children, "ASKED_S", 0.5)
    passing(workspace).write_text(DEAF)
    session = workspace.test(Selection(("test_made.py",)))
    assert session.message == "no end within 5 s" and 5 < session.seconds < 10 and not session.ok
    assert (workspace.validation / "tests" / "begun").exists()
    assert waited(lambda: not processes_with(str(workspace.root)), 5)


def test_stopped(tmp_path, monkeypatch):
    """Set while a session runs: it ends with its children, and no other begins."""
    monkeypatch.setattr(children, "ASKED_S", 0.5)
    stop, ended = Event(), []

    def test() -> None:
        try:
            workspace.test(Selection(("test_made.py",)))
        except children.Stopped:
            ended.append(time.monotonic())

    with Workspace(tmp_path / "copy", stop) as workspace:
        passing(workspace).write_text(DEAF)
        thread = Thread(target=test)
        thread.start()
        assert waited((workspace.validation / "tests" / "begun").exists, 60)
        began = time.monotonic()
        stop.set()
        thread.join(60)
        assert ended and ended[0] - began < 5 and waited(lambda: not processes_with(str(workspace.root)), 5)
        with pytest.raises(children.Stopped):
            workspace.test(Selection(("test_made.py",)))


# The command, with a mutant that three selections of half a minute each are to catch
SLOW = """
import sys
from dataclasses import replace
from bokeh_validation import cli
from bokeh_validation.mutants import catalog, model, runner, workspace

TEST = '''
import time
from pathlib import Path
def test_slow():
    Path(__file__).with_name("begun").touch()
    time.sleep(30)
'''

class Slow(workspace.Workspace):
    def __init__(self, *arguments):
        super().__init__(*arguments)
        (self.validation / "tests" / "test_slow.py").write_text(TEST)

runner.Workspace = Slow
killers = tuple(model.Selection(("test_slow.py",), word) for word in ("slow", "test", "test_slow"))
chosen = [replace(catalog.MUTANTS[0], killers=killers)]
catalog.chosen = lambda *_: chosen
sys.argv = ["run", "mutants"]
cli.main()
"""


@pytest.mark.parametrize("name", ("SIGINT", "SIGTERM"))
def test_interrupted(name, tmp_path):
    """The command is gone within seconds, not half a minute, with its copies and its pytests."""
    process = subprocess.Popen(
        [sys.executable, "-P", "-c", SLOW],
        env={**os.environ, "PYTHONPATH": str(paths.VALIDATION), "TMPDIR": str(tmp_path)},
        stderr=subprocess.PIPE,
        text=True,
        # whoever runs this in the background has its children ignore it
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    copies = f"{tmp_path}/bokeh-mutants-"
    try:
        sleeping = "bokeh-mutants-*/*/validation/tests/begun"
        assert waited(lambda: len(list(tmp_path.glob(sleeping))) == runner.WORKERS, 60)
        assert processes_with(copies) and process.poll() is None
        process.send_signal(getattr(signal, name))
        _, said = process.communicate(timeout=2 * children.ASKED_S)
    finally:
        process.kill()
        process.wait()
    # as Typer ends any command that is interrupted: what a shell says of one that SIGINT has ended, and not a word
    assert (process.returncode, said) == (128 + signal.SIGINT, "")
    assert not list(tmp_path.iterdir()) and waited(lambda: not processes_with(copies), 5)


def test_shaders_are_put_back(workspace):
    """Also where something goes wrong in between; the checkout's own are never touched."""
    key = parity.LIBRARY["wgsl"]
    before = (workspace.root / key).read_bytes()
    with pytest.raises(KeyError), workspace.changed({key: "// nothing\n"}):
        assert (workspace.root / key).read_text() == "// nothing\n"
        assert (paths.ROOT / key).read_bytes() == before
        raise KeyError
    assert (workspace.root / key).read_bytes() == before == (paths.ROOT / key).read_bytes()


# ----------------------------------------------------------------------------------------------------------------------
# results, report, command
# ----------------------------------------------------------------------------------------------------------------------

RESULTS = [
    Result("a", "sign", ("glsl",), ("BokehCoC",), "a <b> -> c", CAUGHT, False, "test_drivers.py::test_x", "1 < 2", 1.5),
    Result("b", "axis", paths.LANGUAGES, ("BokehCoC",), "d -> e", ALIVE, False),
    Result("c", "axis", paths.LANGUAGES, ("BokehCoC",), "f -> g", ARGUED, False, detail="it is the same"),
]


def test_results_come_back(tmp_path):
    """What was written, with a note where the shaders are not those any more; nothing where the file is damaged."""
    path = tmp_path / "mutants.json"
    assert results.read(path) is None
    results.write(path, RESULTS, 12.0)
    found = results.read(path)
    assert found["mutants"] == RESULTS and found["current"]
    changed = json.loads(path.read_text()) | {"shaders": "others"}
    path.write_text(json.dumps(changed))
    assert not results.read(path)["current"]
    for damaged in ("", "{", "[]", '{"mutants": [{}]}'):
        path.write_text(damaged)
        assert results.read(path) is None


def test_report(tmp_path, monkeypatch):
    """A table of what became of each, or how to make it."""
    monkeypatch.setenv("BOKEH_CACHE", str(tmp_path))
    # what this machine has takes long to find out
    monkeypatch.setattr(report.doctor, "findings", list)
    page = tmp_path / "page.html"
    report.write(page, None, [], [], {})
    assert "Not run: <code>validation/run mutants</code>" in page.read_text()
    paths.ensured(results.default_path().parent)
    results.write(results.default_path(), RESULTS, 12.0)
    report.write(page, None, [], [], {})
    text = page.read_text()
    assert "1 of 3 caught</b>, 1 argued" in text and '<td title="it is the same">it is the same' in text
    assert "test_drivers.py::test_x" in text and "a &lt;b&gt; -&gt; c" in text
    assert "The shaders have changed since" not in text


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--only", "no-such"], ["no-such", "coc-sign"]),
        (["--kind", "colour"], ["colour", "off-by-one"]),
        (["--sample", "0"], ["--sample 0", "at least 1"]),
        (["--only", "coc-sign", "--kind", "axis"], ["coc-sign", "axis"]),
    ],
)
def test_bad_options(options, words):
    """One line and exit code 2."""
    done = command("mutants", *options)
    assert done.returncode == 2 and done.stderr.count("\n") == 1
    assert all(word in done.stderr for word in words)


def test_choice():
    """By name, by kind, and at random without repeats."""
    assert catalog.chosen() == list(catalog.MUTANTS)
    assert [mutant.name for mutant in catalog.chosen(["coc-sign", "grid-row"])] == ["coc-sign", "grid-row"]
    assert {mutant.kind for mutant in catalog.chosen(kinds=["angle", "aspect"])} == {"angle", "aspect"}
    assert len({mutant.name for mutant in catalog.chosen(sample=12)}) == 12
    assert len(catalog.chosen(kinds=["angle"], sample=1000)) == len(catalog.chosen(kinds=["angle"]))
