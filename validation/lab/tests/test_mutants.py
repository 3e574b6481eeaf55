"""Test that mutants fit the shaders and change every function, and that a run distinguishes their outcomes."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest
from support import HANG

from bokeh_validation import paths
from bokeh_validation.errors import UserError
from lab.mutants import by_hand, operators
from lab.mutants.mutants_command import all_mutants

EVERYTHING = all_mutants()
NAMES = "caught alive refused equivalent broken"
# Runs `validation/run mutants` on one frame with mutants of one function, two of which hang
COMMAND = """
import os, signal, sys, time
from dataclasses import replace
from bokeh_validation import cli
from lab.mutants import run_mutants, mutants_command, operators
from bokeh_validation.probes import cases, coverage_frames

def judged(mutant, judges, judged=run_mutants._judged):
    if mutant.name in ("broken", "endless"):
        open(os.environ.get("BEGUN", os.devnull), "w").close()
        signal.alarm(1 if mutant.name == "broken" else 600)
        time.sleep(999)
    return judged(mutant, judges)

some = next(mutant for mutant in operators.mutants() if mutant.place == "BokehLineEnd")
mutants = []
for name in sys.argv.pop(1).split():
    factor = {"caught": "", "refused": " * missing"}.get(name, " * 0.5")
    statement = f"return vec2(cos(angle) / aspectRatio, sin(angle)){factor};"
    texts = {key: text.replace(some.change, statement) for key, text in some.texts.items()}
    mutants.append(replace(some, name=name, texts=texts, argued="so" if name == "equivalent" else ""))
run_mutants._judged, mutants_command.all_mutants = judged, lambda: mutants
coverage_frames.all_frames = lambda: {"paper": coverage_frames.of_settings(cases.PAPER)}
sys.argv[1:] = ["mutants", *sys.argv[1:]]
cli.main()
"""


def command(*arguments: str, **more) -> subprocess.Popen:
    """Start the command above."""
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "start_new_session": True}
    return subprocess.Popen([sys.executable, "-c", COMMAND, *arguments], cwd=paths.VALIDATION, **pipes, **more)


def test_every_function_is_changed(monkeypatch):
    """Check that no two mutants are equal, each row of equivalents.txt names one, and one that does not fit is an
    error.
    """
    texts = {tuple(item.texts.items()) for item in EVERYTHING}
    assert len(texts) == len({item.name for item in EVERYTHING}) == len(EVERYTHING)
    functions = {name for _, name, *_ in operators.bodies()}
    assert functions <= {item.place for item in EVERYTHING} and len(functions) > 140
    assert set(operators.equivalents()) <= {(item.place, item.change) for item in EVERYTHING}
    assert all(operators.equivalents().values())
    monkeypatch.setattr(by_hand, "MISTAKES", (("dxc", "bokeh", "SignedCoC", "S2 - S3", "S2"),))
    with pytest.raises(UserError, match="'S2 - S3' is not in BokehSignedCoC of hlsl/bokeh.hlsl"):
        all_mutants()


def test_outcomes(tmp_path):
    """Check the outcomes, and that the command ends with 1 if a mutant does not show or does not end."""
    process = command(NAMES, "--json", str(tmp_path / "found.json"))
    said, errors = process.communicate()
    assert (process.returncode, errors) == (1, "")
    assert "5 mutants: 1 caught, 1 equivalent, 1 refused, 1 alive, 1 broken" in said
    found = json.loads((tmp_path / "found.json").read_text())
    assert {row["name"] for row in found["mutants"] if row["name"] == row["outcome"]} == set(NAMES.split())


def test_interrupted(tmp_path):
    """Check that an interrupted command ends with its processes."""
    begun = tmp_path / "begun"
    # a background shell makes its children ignore the signal
    foreground = {"preexec_fn": lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)}
    process = command("endless", env={**os.environ, "BEGUN": str(begun)}, **foreground)
    while not begun.exists() and process.poll() is None:
        time.sleep(0.1)
    process.send_signal(signal.SIGINT)
    assert process.communicate(timeout=HANG)[1] == "error: stopped\n" and process.returncode == 128 + signal.SIGINT
    with pytest.raises(ProcessLookupError):
        os.killpg(process.pid, 0)
