"""Test validation/run check: it finds what an edit of a shader broke, and runs nothing else."""

import shutil
import subprocess

import pytest
from support import called, load

from bokeh_validation import check, paths, shaders


@pytest.fixture
def edit(tmp_path, monkeypatch):
    """Return a function that edits a shader file, in all or some languages, of a separate checkout."""
    for language in paths.LANGUAGES:
        shutil.copytree(paths.ROOT / language, tmp_path / language)
    for command in ("init -q", "add .", "-c user.name=a -c user.email=b commit -qm before"):
        subprocess.run(["git", *command.split()], cwd=tmp_path, check=True)
    monkeypatch.setenv("BOKEH_SHADERS", str(tmp_path))

    def replaced(file: str, old: str, new: str, languages=paths.LANGUAGES) -> None:
        for language in languages:
            path = tmp_path / language / f"{file}.{language}"
            path.write_text(path.read_text(encoding="ascii").replace(old, new, 1), encoding="ascii")
        shaders.text.cache_clear()

    shaders.text.cache_clear()
    yield replaced
    shaders.text.cache_clear()


def said(code: int) -> str:
    """Return what check prints; it must end with this exit code."""
    assert all(map(load, check.DRIVERS.values()))
    done = called("check")
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout


def test_a_comment_draws_nothing(edit, monkeypatch):
    """Check that unchanged shaders, and a changed comment, draw nothing."""
    assert said(0) == "no shader differs from the last commit: nothing to check\n"
    edit("bokeh", "// Listing 1: puts a CoC", "// Listing 1: put a CoC")
    monkeypatch.setattr(check.drivers, "load", None)
    text = said(0)
    assert text.startswith("changed: no function\n0 problems") and "on no driver" in text


def test_mistakes(edit):
    """Check that mistakes are found.

    If the same mistake is in all languages, no driver draws what the last commit drew. If a mistake is in one language,
    behind a constant, its result is outside the interval of the current GLSL too, and parity reports it.
    """
    edit("bokeh", "CoC = -CoC;", "CoC = CoC;")
    edit("bokeh_layers", "sum *= BokehEdgeArea", "sum += BokehEdgeArea", ["hlsl"])
    text = said(1)
    assert text.startswith("changed: BokehLayerLine, BokehSignedCoC\nhlsl and glsl: not the same\n")
    for name in ("egl", "dxc", "wgpu"):
        assert f"{name}, by the last commit: BokehSignedCoCMap writes " in text
    assert text.count("SignedCoCMap writes") == 3 and "dxc: BokehHexagonLayerSecond writes " in text
    assert all(
        line.startswith(("dxc: ", "dxc, by the last commit: ")) for line in text.splitlines() if "Second writes" in line
    )


def test_a_mistake_that_few_frames_show(edit):
    """Check that a program is drawn in all its frames: only one of BokehLinearDepth's has logarithmic depth."""
    edit("bokeh", "exp2(value * log2(farPlane + 1.0)) - 1.0", "exp2(value * log2(farPlane + 1.0)) + 1.0", ["wgsl"])
    text = said(1)
    assert text.startswith("changed: BokehLinearDepth\nhlsl and wgsl: not the same\n")
    assert "wgpu: BokehLinearDepth writes " in text and "and on wgpu\n" in text


def test_a_compiler_refuses(edit, tmp_path):
    """Check that a compiler's error is reported, and that check refuses to run outside git."""
    edit("bokeh", "CoC = -CoC;", "CoC = -CoD;")
    text = said(1)
    assert all(f"{language} BokehSignedCoCMap: " in text for language in paths.LANGUAGES) and "on no driver" in text
    shutil.rmtree(tmp_path / ".git")
    done = called("check")
    assert done.returncode == 2 and "no git checkout" in done.stderr and not done.stdout


def test_a_checkout_of_somebody_else(monkeypatch):
    """Check that a checkout of another user can be read, which git refuses by default."""
    monkeypatch.setenv("GIT_TEST_ASSUME_DIFFERENT_OWNER", "1")
    assert "BokehComposite" in check._committed("glsl/bokeh_layers.glsl")
