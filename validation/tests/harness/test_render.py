"""Test validation/run render as a user runs it: results, formats, and one line for every kind of bad input."""

import json
import os
import shlex
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from support import HANG, called, load, refused
from support_cases import noise_case, result
from support_inputs import inputs

from bokeh_validation import exr, options, paths, plan
from bokeh_validation.drivers.computed import Reference
from bokeh_validation.errors import UserError
from bokeh_validation.frame import aperture_shapes, methods
from bokeh_validation.frame.methods import Settings
from bokeh_validation.truth import ray_traced

ENVIRONMENT = {**os.environ, "PYTHONPATH": str(paths.VALIDATION), "XDG_RUNTIME_DIR": os.environ.get("TMPDIR", "/tmp")}
STREET = paths.SCENES / "street_11_pin.exr"
CAMERA = ["--aperture-diameter", "0.05", "--focal-length", "0.05", "--focus-distance", "5", "--max-coc", "0.15"]


def run(*arguments: object, cwd: Path | None = None) -> subprocess.CompletedProcess:
    """Run the command line in its own process."""
    command = [sys.executable, "-m", "bokeh_validation", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=HANG, cwd=cwd, env=ENVIRONMENT)


def test_street_in_a_folder_with_spaces(tmp_path):
    """Run the README's command: half floats stay half, alpha is the CoC, and the result matches the reference."""
    folder = tmp_path / "a folder with spaces"
    folder.mkdir()
    source = folder / "in put.exr"
    source.write_bytes(STREET.read_bytes())
    done = run(
        "render",
        source,
        "-o",
        "out put.exr",
        *CAMERA,
        "--method",
        "exact",
        "--png",
        "pic ture.png",
        "--driver",
        "egl",
        cwd=folder,
    )
    assert done.returncode == 0, done.stderr
    assert sorted(p.name for p in folder.iterdir()) == ["in put.exr", "out put.exr", "pic ture.png"]
    with OpenEXR.File(str(folder / "out put.exr"), separate_channels=True) as file:
        channels = {name: np.asarray(c.pixels) for name, c in file.channels().items()}
    assert sorted(channels) == list("ABGR") and all(c.dtype == np.float16 for c in channels.values())
    case = ray_traced.scene_case(ray_traced.STREET, "exact", "hexagon")
    expected = Reference().run(case.plan.passes, case.textures(), case.size)["result"].astype(float)
    for index, name, least in ((1, "G", 0.002), (3, "A", 1e-5)):
        np.testing.assert_allclose(channels[name].astype(float), expected[..., index], rtol=0.02, atol=least)


def test_float_stays_float_and_constant_coc_needs_no_depth(tmp_path):
    """Check that float input gives float output, and that --coc needs no depth channel."""
    source = str(tmp_path / "in.exr")
    OpenEXR.File({"type": OpenEXR.scanlineimage}, {name: np.ones((6, 8), np.float32) for name in "RGB"}).write(source)
    done = run("render", source, "-o", tmp_path / "out.exr", "--coc", "0.1", "--driver", "egl")
    assert done.returncode == 0, done.stderr
    assert exr.read(tmp_path / "out.exr", None).storage == "float"


def test_every_option_reaches_the_settings():
    """Check that each option of the command line has the same effect on the passes as its field of the settings."""
    for option in options.TABLE:
        base = Settings(option.methods[0], "octagon", camera=methods.Camera(0.2))
        settings = option.put(base, VALUES[option.name])
        given = ["--method", settings.method, "--aperture", settings.aperture, *option.told(settings).split()]
        if option.name not in ("aperture-diameter", "coc"):
            given += ["--aperture-diameter", "0.2"]  # otherwise the f-stop sets it
        elif option.name == "coc":
            settings = replace(settings, camera=options.DEFAULT.camera)
        done = called("plan", *given, "--size", "64x48")
        assert json.loads(done.stdout) == json.loads(json.dumps(plan.frame(settings, (64, 48)))), option.name


@pytest.mark.parametrize(
    ("given", "diameter"),
    [("", 0.05 / 2.8 * 10), ("--f-stop 1.4 --bokeh-scale 20", 0.05 / 1.4 * 20), ("--bokeh-scale 0", 0.0),
     ("--focal-length 0.07", 0.07 / 2.8 * 10), ("--aperture-diameter 0.1 --focal-length 0.07", 0.1)],
)  # fmt: skip
def test_the_lens_is_that_of_the_integrations(given, diameter):
    """Check the default lens: f/2.8 and a bokeh scale of 10; the aperture follows the focal length."""
    done = called("plan", *given.split(), "--size", "64x48")
    assert json.loads(done.stdout)["parameters"]["BokehApertureDiameter"] == pytest.approx(diameter)


VALUES = {
    "method": "paper", "aperture": "decagon", "preset": "ultra", "samples": 5, "spacing": 2.5, "jitter": 0.7,
    "rotation": 20.0, "squeeze": 0.5, "cats-eye": 0.6, "roundness": 0.3, "lateral": 0.03, "mrt": False,
    "aperture-diameter": 0.08, "focal-length": 0.06, "focus-distance": 3.0, "sensor-height": 0.03, "max-coc": 0.7,
    "coc": 0.08,
}  # fmt: skip
WIDE = methods.Camera(0.5, 0.05, 4.0, max_coc=0.6)
BASES = [
    *(Settings(name, "octagon", camera=WIDE) for name in aperture_shapes.METHODS),
    *(Settings(name, "hexagon", 9, spacing=2.0, jitter=1.0, camera=WIDE) for name in ("exact", "paper")),
    Settings("paper", "pentagon", 9, camera=WIDE),
    Settings("layered", "hexagon", jitter=1.0, camera=WIDE),
    *(Settings(name, "square", coc=0.6, preset="low", camera=WIDE) for name in aperture_shapes.METHODS),
]


@inputs("validation/tests/harness/test_render.py", of_code=True)
@pytest.mark.parametrize("base", BASES, ids=lambda base: f"{base.method} {base.aperture} {base.jitter:g}")
def test_an_option_has_an_effect_or_is_refused(base):
    """Check that each option changes the image or the list of passes, or is refused."""
    # a constant CoC makes one layer; only a wide one has samples far enough apart for jitter
    driver, size = load("egl"), (192, 144) if base.coc else (64, 48)

    def drawn(settings: Settings) -> tuple:
        case = noise_case(size, settings)
        return [render_pass.entry for render_pass in case.plan.passes], result(driver, case).tobytes()

    before, idle = drawn(base), []
    for option in options.TABLE[1:]:
        changed = option.put(base, VALUES[option.name])
        try:
            options.check(changed, [option])
        except UserError:
            continue
        if drawn(changed) == before:
            idle.append(option.name)
    # a larger --max-coc only makes room for a larger --coc
    assert set(idle) <= ({"max-coc"} if base.coc else set())


@pytest.mark.parametrize("size", [0, 9000], ids=["empty", "truncated"])
def test_bad_file(size, tmp_path):
    """Check that a broken file gives one line and no output, not even a partial one; test_exr.py has other refusals."""
    source = tmp_path / "bad.exr"
    source.write_bytes(STREET.read_bytes()[:size])
    refused(called("render", source, "-o", tmp_path / "out.exr"), ["bad.exr: cannot be read as OpenEXR"])
    assert list(tmp_path.iterdir()) == [source]


@pytest.mark.parametrize("target", ["/no/such/folder/out.exr", "/proc/out.exr", "."])
def test_unwritable_output(target, tmp_path):
    """Check that an unwritable output is refused before any work, or leaves nothing behind."""
    refused(run("render", STREET, "-o", target, cwd=tmp_path), [target if target != "." else "folder"])
    assert not list(tmp_path.iterdir())


def test_usage_errors():
    """Check calls without arguments, without an output, and with an unknown command."""
    refused(called("render"), ["IN.exr"])
    refused(called("render", STREET), ["--output"])
    refused(called("bogus"), ["bogus"])


def test_closed_output():
    """Check that a refusal is still one line with standard output closed (`>&-`)."""
    command = f"exec {shlex.quote(sys.executable)} -m bokeh_validation render nothing.exr -o out.exr >&-"
    done = subprocess.run(["bash", "-c", command], stderr=subprocess.PIPE, text=True, env=ENVIRONMENT)
    refused(subprocess.CompletedProcess(command, done.returncode, "", done.stderr), ["nothing.exr: no such file"])
