"""The mutants fit the shaders and change every function; a run tells those that are caught from those that are not."""

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest
from test_validate import page_of

from bokeh_validation import paths, shaders
from bokeh_validation.errors import UserError
from bokeh_validation.mutants import hunt, outcomes
from bokeh_validation.mutants.mutant import KINDS, mutated
from bokeh_validation.mutants.mutants_command import MUTANTS, chosen
from bokeh_validation.mutants.outcomes import ALIVE, ARGUED, CAUGHT, Result

# The command with mutants and tests of this file's own
MADE = """
import re
import sys
from pathlib import Path
from bokeh_validation import cli
from bokeh_validation.mutants import hunt, mutants_command
from bokeh_validation.mutants.mutant import Mutant

def made(name, killer, new="focus - S2", languages=("glsl",), **more):
    edits = (("S2 - focus", new),)
    return Mutant(name, "sign", "library", "CoC", edits, (f"test_made.py::{killer}",), languages, **more)

hunt.NOT_LAST = re.compile("::test_(?!last)")
hunt.TESTS, hunt.TEST_S = Path(sys.argv.pop(1)), float(sys.argv.pop(1))
mutants_command.MUTANTS = eval(sys.argv.pop(1))
sys.argv[1:] = ["mutants", *sys.argv[1:]]
cli.main()
"""
TESTS = """
import subprocess
from pathlib import Path
from bokeh_validation import shaders

def has(text):
    return text in shaders.text("glsl")
def test_notices():
    assert has("abs(S2 - focus)")
def test_passes():
    pass
def test_last():
    assert not has("abs(S2 - f)")
def test_error():
    if not has("abs(S2 - focus)"):
        raise KeyError("x")
def test_hangs():
    if not has("abs(S2 - focus)"):
        Path(__file__).with_name("begun").touch()
        subprocess.run(["sleep", "98765"])
def test_always():
    assert False
"""


def command(folder: Path, made: str, seconds: float = 30.0, **more) -> subprocess.Popen:
    """`validation/run mutants` with these mutants on the tests above."""
    tests = paths.ensured(folder / "tests")
    (tests / "test_made.py").write_text(TESTS)
    return subprocess.Popen(
        [sys.executable, "-P", "-c", MADE, str(tests), str(seconds), made, *more.pop("options", ())],
        env={**os.environ, "PYTHONPATH": str(paths.VALIDATION), "TMPDIR": str(paths.ensured(folder / "tmp"))},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        **more,
    )


def test_every_edit_fits():
    """Each stands in the shaders as often as it says, and no two mutants are the same."""
    texts = [tuple(sorted(mutated(mutant).items())) for mutant in MUTANTS]
    assert len(set(texts)) == len({mutant.name for mutant in MUTANTS}) == len(MUTANTS)


def test_every_function_is_changed():
    """Each of sections [3] to [13], by a mutant of all languages, so by one that only numbers show."""
    text = paths.library("glsl").read_text(encoding="ascii") + paths.layers("glsl").read_text(encoding="ascii")
    sections = [section for number, section in shaders.sections(text).items() if number >= 3]
    functions = {function["name"] for section in sections for function in shaders.FUNCTION.finditer(section)}
    assert len(functions) > 60
    assert not functions - {mutant.place for mutant in MUTANTS if mutant.everywhere}


def test_an_edit_that_does_not_fit_is_an_error():
    """The shaders have changed, or the function is gone."""
    mutant = next(one for one in MUTANTS if one.name == "coc-sign")
    for wrong in (
        replace(mutant, edits=(("S2 - S3", "S2"),)),
        replace(mutant, edits=(("S2", "S3"),)),
        replace(mutant, within="NoSuch"),
    ):
        with pytest.raises(UserError, match="mutant coc-sign: .* stands [02] times in .* of hlsl/bokeh.hlsl"):
            mutated(wrong)


def test_killers_are_there():
    """Each names a test of a file; that its parameters are there too is for the run to see."""
    for killer in {killer for mutant in MUTANTS for killer in mutant.killers}:
        file, name = killer.partition("[")[0].split("::")
        assert f"\ndef {name}(" in (hunt.TESTS / file).read_text(encoding="utf-8"), killer


def test_outcomes(tmp_path):
    """Only a failed assertion of a test that passes without the change is a catch; one that is alive ends with 1."""
    made = """[
        made("caught", "test_notices"), made("also", "test_notices", languages=("hlsl", "glsl", "wgsl")),
        made("late", "test_passes", "S2 - f"), made("alive", "test_passes"),
        made("argued", "test_passes", argument="so"), made("error", "test_error"), made("hangs", "test_hangs"),
        made("always", "test_always"),
        made("unlike", "test_notices", "float(1 | 1)", languages=("hlsl", "glsl", "wgsl")),
    ]"""
    done = command(tmp_path, made, 5.0, options=["--json", str(tmp_path / "found.json")])
    said, errors = done.communicate()
    assert (done.returncode, errors) == (1, "")
    assert said.splitlines()[-1].startswith("3 of 9 mutants caught, 1 argued, 1 alive, 4 broken")
    found = {one["name"]: one for one in json.loads((tmp_path / "found.json").read_text())["mutants"]}
    for name, outcome, words in (
        ("caught", "caught", "assert"),
        ("also", "caught", "assert"),
        ("late", "caught", "assert"),
        ("alive", "alive", "2 tests passed"),
        ("argued", "argued", "so"),
        ("error", "broken", "KeyError"),
        ("hangs", "broken", "no end within 5"),
        ("always", "broken", "without the change"),
        ("unlike", "broken", "parity"),
    ):
        assert found[name]["outcome"] == outcome and words in found[name]["detail"], found[name]
    assert not list((tmp_path / "tmp").glob("bokeh-*"))


def test_a_renamed_killer_is_an_error(tmp_path):
    """Whichever mutants are asked for."""
    done = command(tmp_path, '[made("a", "test_notices"), made("b", "test_gone")]', options=["--only", "a"])
    assert "there is no test test_made.py::test_gone" in done.communicate()[1] and done.returncode == 2


@pytest.mark.parametrize("name", ("SIGINT", "SIGTERM"))
def test_interrupted(name, tmp_path):
    """The command is gone within seconds, with its folders and its processes."""
    process = command(
        tmp_path,
        '[made("a", "test_hangs")]',
        # whoever runs this in the background has its children ignore it
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    try:
        end = time.monotonic() + 60
        while not (tmp_path / "tests" / "begun").exists() and time.monotonic() < end:
            time.sleep(0.05)
        process.send_signal(getattr(signal, name))
        _, said = process.communicate(timeout=10)
    finally:
        process.kill()
        process.wait()
    # as Typer ends any command that is interrupted
    assert (process.returncode, said) == (128 + signal.SIGINT, "")
    assert not list((tmp_path / "tmp").iterdir()) and not processes_with(str(tmp_path))


def processes_with(text: str) -> list[bytes]:
    """Environments of the processes that have this text; a zombie has none."""
    found = []
    for process in Path("/proc").iterdir():
        if process.name.isdigit() and int(process.name) != os.getpid():
            try:
                found.append((process / "environ").read_bytes())
            except OSError:
                pass
    return [one for one in found if text.encode() in one]


def test_report(tmp_path, monkeypatch):
    """A table of what became of each, with a note where the shaders have changed, or how to make it."""
    monkeypatch.setenv("BOKEH_CACHE", str(tmp_path))
    results = [
        Result("a", "sign", ("glsl",), "BokehCoC", "a <b> -> c", CAUGHT, False, "test_drivers.py::test_x", "1 < 2"),
        Result("b", "axis", paths.LANGUAGES, "BokehCoC", "d -> e", ALIVE),
        Result("c", "axis", paths.LANGUAGES, "BokehCoC", "f -> g", ARGUED, detail="it is the same"),
    ]
    kept = outcomes.default_path()
    found = outcomes.as_json(results, 12.0)
    paths.ensured(kept.parent)
    for text, words in {
        "{": ["Not run: <code>validation/run mutants</code>"],
        json.dumps(found): ["1 of 3 caught</b>, 1 argued", ">it is the same<", "test_x", "a &lt;b&gt; -&gt; c"],
        json.dumps({**found, "shaders": "others"}): ["The shaders have changed since"],
    }.items():
        kept.write_text(text)
        page = page_of(tmp_path, [])
        assert all(word in page for word in words), words


def test_choice():
    """By name, by kind, and some of each kind, always the same."""
    assert chosen(None, None, None) == list(MUTANTS)
    assert {mutant.name for mutant in chosen(["coc-sign", "grid-row"], None, None)} == {"coc-sign", "grid-row"}
    assert {mutant.kind for mutant in chosen(None, ["angle", "aspect"], None)} == {"angle", "aspect"}
    some = chosen(None, None, 5)
    assert len({mutant.name for mutant in some}) == 5 * len(KINDS) and some == chosen(None, None, 5)
    for bad in ((["no-such"], None, None), (None, ["colour"], None), (None, None, 0), (["coc-sign"], ["axis"], None)):
        with pytest.raises(UserError):
            chosen(*bad)
