"""The mutants fit the shaders and change every function; a run tells those that show from those that do not."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest
from test_validate import page_of

from bokeh_validation import paths
from bokeh_validation.errors import UserError
from bokeh_validation.mutants import by_hand, mutant, operators
from bokeh_validation.mutants.mutants_command import all_mutants, chosen

EVERYTHING = all_mutants()
# `validation/run mutants` on one frame with mutants of one function, of which two do not end by themselves
COMMAND = """
import signal, sys, time
from dataclasses import replace
from bokeh_validation import cli
from bokeh_validation.mutants import frames, hunt, mutants_command, operators

def judged(mutant, judges, judged=hunt._judged):
    if mutant.name in ("broken", "endless"):
        signal.alarm(1 if mutant.name == "broken" else 600)
        time.sleep(999)
    return judged(mutant, judges)

some = next(mutant for mutant in operators.mutants() if mutant.place == "BokehLineEnd")
mutants = []
for name in sys.argv.pop(1).split():
    factor = {"caught": "", "refused": " * missing"}.get(name, " * 0.5")
    statement = f"return vec2(cos(angle) / aspectRatio, sin(angle)){factor};"
    texts = {key: text.replace(some.change[1], statement) for key, text in some.texts.items()}
    mutants.append(replace(some, name=name, texts=texts, argued="so" if name == "equivalent" else ""))
hunt._judged, mutants_command.all_mutants = judged, lambda: mutants
frames.all_frames = lambda: {"paper": frames.of_settings(frames.SETTINGS["paper hexagon"])}
sys.argv[1:] = ["mutants", *sys.argv[1:]]
cli.main()
"""


def command(*arguments: str, **more) -> subprocess.Popen:
    """The command above."""
    environment = {**os.environ, "PYTHONPATH": str(paths.VALIDATION)}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "start_new_session": True}
    return subprocess.Popen([sys.executable, "-P", "-c", COMMAND, *arguments], env=environment, **pipes, **more)


def test_every_function_is_changed(monkeypatch):
    """No two mutants are the same, each row of equivalents.txt names one, and one that does not fit is an error."""
    texts = {tuple(item.texts.items()) for item in EVERYTHING}
    assert len(texts) == len({item.name for item in EVERYTHING}) == len(EVERYTHING)
    assert set(operators.functions()) <= {item.place for item in EVERYTHING} and len(operators.functions()) > 140
    statements = {(item.place, item.kind, said) for item in EVERYTHING if item.argued for said in item.change}
    assert set(operators.equivalents()) <= statements and all(operators.equivalents().values())
    monkeypatch.setattr(by_hand, "KINDS", {"porting": ((("hlsl", "bokeh", "CoC", "S2 - S3", "S2"),), ())})
    with pytest.raises(UserError, match="'S2 - S3' is not in BokehCoC of hlsl/bokeh.hlsl"):
        all_mutants()


def test_outcomes(tmp_path):
    """The command ends with 1 where one does not show, or does not end."""
    process = command("caught alive refused equivalent broken", "--json", str(tmp_path / "found.json"))
    said, errors = process.communicate()
    assert (process.returncode, errors) == (1, "")
    found = {item["name"]: item["outcome"] for item in json.loads((tmp_path / "found.json").read_text())["mutants"]}
    assert found == {name: name for name in ("caught", "alive", "refused", "equivalent", "broken")}
    assert said.splitlines()[-1].startswith(
        "1 of 5 mutants caught, 1 equivalent, 1 refused by the compiler, 1 alive, 1 b"
    )


def test_interrupted():
    """The command is gone within seconds, with its processes."""
    # whoever runs this in the background has its children ignore it
    process = command("endless", preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
    time.sleep(12.0)
    process.send_signal(signal.SIGINT)
    assert process.communicate(timeout=20)[1] == "" and process.returncode == 128 + signal.SIGINT
    with pytest.raises(ProcessLookupError):
        os.killpg(process.pid, 0)


def test_report(tmp_path, monkeypatch):
    """What became of each, and whether the shaders have changed since; or how to make it."""
    monkeypatch.setenv("BOKEH_CACHE", str(tmp_path))
    rows = [mutant.row(EVERYTHING[0], mutant.Verdict("equivalent", "", "it is the same"), 1.0)]
    file = paths.ensured(mutant.default_path().parent) / mutant.default_path().name
    file.write_text("{")
    assert "Not run: <code>validation/run mutants</code>" in page_of(tmp_path, [])
    file.write_text(json.dumps({**mutant.as_json(rows, 12.0), "shaders": "others"}))
    page = page_of(tmp_path, [])
    assert all(words in page for words in ("0 of 1 caught</b>, 1 equivalent", ">it is the same<", "have changed since"))


def test_choice():
    """By name, by kind, and some of each kind, always the same."""
    some = chosen(EVERYTHING, None, None, 5)
    assert some == chosen(EVERYTHING, None, None, 5) and {m.kind for m in some} == {m.kind for m in EVERYTHING}
    assert {item.kind for item in chosen(EVERYTHING, None, ["sign", "guard"], None)} == {"sign", "guard"}
    assert chosen(EVERYTHING, [some[0].name], None, None) == some[:1]
    for bad in ((["no-such"], None, None), (None, ["colour"], None), (None, None, 0), ([some[0].name], ["NaN"], None)):
        with pytest.raises(UserError):
            chosen(EVERYTHING, *bad)
