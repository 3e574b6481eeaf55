"""validation/run render as a user calls it: results, formats, and one line for every kind of bad input."""

import os
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from support import called, refused

from bokeh_validation import exr, paths
from bokeh_validation.frame import methods
from bokeh_validation.reference.device import Reference
from bokeh_validation.truth import ray_traced

STREET = paths.SCENES / "street_11_pin.exr"
CAMERA = ["--aperture-diameter", "0.05", "--focal-length", "0.05", "--focus-distance", "5", "--max-coc", "0.15"]


def run(*arguments: object, cwd: Path | None = None) -> subprocess.CompletedProcess:
    """The command line in a process of its own."""
    environment = {
        **os.environ,
        "PYTHONPATH": str(paths.VALIDATION),
        "XDG_RUNTIME_DIR": os.environ.get("TMPDIR", "/tmp"),
    }
    command = [sys.executable, "-m", "bokeh_validation", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, cwd=cwd, env=environment)


def save(path: Path, channels: dict[str, np.ndarray]) -> Path:
    """A small EXR with these channels."""
    with OpenEXR.File({"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}, channels) as file:
        file.write(str(path))
    return path


def small(dtype=np.float16, size=(6, 8)) -> dict[str, np.ndarray]:
    """R G B and Z."""
    random = np.random.default_rng(2)
    return {**{c: random.random(size).astype(dtype) for c in "RGB"}, "Z": np.full(size, 9, np.float32)}


def test_street_in_a_folder_with_spaces(tmp_path):
    """The README's command: half stays half, alpha is the CoC, the picture is the reference's."""
    folder = tmp_path / "a folder with spaces"
    folder.mkdir()
    source = folder / "in put.exr"
    source.write_bytes(STREET.read_bytes())
    done = run("render", source, "-o", "out put.exr", *CAMERA, "--png", "pic ture.png", "--driver", "egl", cwd=folder)
    assert done.returncode == 0, done.stderr
    assert sorted(p.name for p in folder.iterdir()) == ["in put.exr", "out put.exr", "pic ture.png"]
    with OpenEXR.File(str(folder / "out put.exr"), separate_channels=True) as file:
        channels = {name: np.asarray(c.pixels) for name, c in file.channels().items()}
    assert sorted(channels) == list("ABGR") and all(c.dtype == np.float16 for c in channels.values())
    case = ray_traced.scene_case(ray_traced.STREET, "exact", "hexagon")
    wanted = Reference().run(case.plan.passes, case.textures(), case.size)["result"]
    np.testing.assert_allclose(channels["G"].astype(float), wanted[..., 1].astype(float), rtol=0.02, atol=0.002)
    np.testing.assert_allclose(channels["A"].astype(float), wanted[..., 3].astype(float), rtol=0.02, atol=1e-5)


def test_float_stays_float_and_constant_coc_needs_no_depth(tmp_path):
    """Float in, float out; --coc without a depth channel."""
    source = save(tmp_path / "in.exr", {c: p for c, p in small(np.float32).items() if c != "Z"})
    done = run("render", source, "-o", tmp_path / "out.exr", "--coc", "0.1", "--driver", "osmesa")
    assert done.returncode == 0, done.stderr
    with OpenEXR.File(str(tmp_path / "out.exr"), separate_channels=True) as file:
        assert all(np.asarray(c.pixels).dtype == np.float32 for c in file.channels().values())


def test_every_option_reaches_the_shader(tmp_path):
    """Each option changes the result, on a driver, and as the reference says."""
    whole = exr.read(STREET)
    # the middle shows every option as the whole does
    rows, columns = slice(160, 320), slice(220, 420)
    channels = {name: np.ascontiguousarray(whole.color[rows, columns, i]) for i, name in enumerate("RGB")}
    target = tmp_path / "out.exr"
    source = save(tmp_path / "in.exr", {**channels, "Z": np.ascontiguousarray(whole.depth[rows, columns])})
    scene = exr.read(source)
    # a larger aperture than the scene's own: with that, the leakage test never bites
    base = methods.Camera(0.15, 0.05, 5.0, 0.024, 0.15)
    changes = {
        "--method naive": methods.Settings("naive", "hexagon", camera=base),
        "--method paper": methods.Settings("paper", "hexagon", camera=base),
        "--method paper --aperture star": methods.Settings("paper", "star", camera=base),
        "--method paper --aperture pentagon": methods.Settings("paper", "pentagon", camera=base),
        "--method paper --no-coc-blur": methods.Settings("paper", "hexagon", camera=base, blur_coc=False),
        "--method paper --spacing 2": methods.Settings("paper", "hexagon", camera=base, spacing=2.0),
        "--aperture decagon": methods.Settings("exact", "decagon", camera=base),
        "--samples 5": methods.Settings("exact", "hexagon", 5, camera=base),
        "--rotation 20": methods.Settings("exact", "hexagon", 7, 20.0, base),
        "--no-leak-fix": methods.Settings("exact", "hexagon", camera=base, leak_fix=False),
        "--sensor-height 0.05": methods.Settings("exact", "hexagon", camera=methods.Camera(0.15, 0.05, 5, 0.05, 0.15)),
        "--coc 0.03": methods.Settings("exact", "hexagon", camera=base, coc=0.03),
        "--squeeze 0.5": methods.Settings("exact", "hexagon", camera=base, squeeze=0.5),
        "--spacing 1": methods.Settings("exact", "hexagon", camera=base, spacing=1.0),
        "--spacing 1 --max-samples 4": methods.Settings("exact", "hexagon", camera=base, spacing=1.0, max_samples=4),
        "--spacing 1 --max-samples 4 --jitter 1 --frame 3": methods.Settings(
            "exact", "hexagon", camera=base, spacing=1.0, max_samples=4, jitter=1.0, frame=3
        ),
    }
    plain = methods.plan(methods.Settings("exact", "hexagon", camera=base), scene.size)
    textures = {"color": scene.color, "depth": scene.depth}
    before = Reference().run(plain.passes, textures, scene.size)["result"].astype(float)
    for option, settings in changes.items():
        done = called(
            "render", source, "-o", tmp_path / "out.exr", *CAMERA, "--aperture-diameter", 0.15, *option.split()
        )
        assert done.returncode == 0, done.stderr
        got = exr.read(target, None).color[..., :3].astype(float)
        plan = methods.plan(settings, scene.size)
        wanted = Reference().run(plan.passes, {**textures, **plan.tables}, scene.size)["result"][..., :3].astype(float)
        far = np.abs(got - wanted) > 0.02 * wanted + 0.01
        assert far.mean() < 1e-3, option
        assert (np.abs(before[..., :3] - wanted) > 0.02 * wanted + 0.01).mean() > 1e-3, option


def bad_files(folder: Path) -> dict[str, Path]:
    """Files that must be refused."""
    files = {"missing": folder / "missing.exr", "text": folder / "text.exr", "folder": folder}
    files["text"].write_text("not an image")
    files["no depth"] = save(folder / "nodepth.exr", {c: p for c, p in small().items() if c != "Z"})
    files["no blue"] = save(folder / "noblue.exr", {c: p for c, p in small().items() if c != "B"})
    for name, value in (("nan", np.nan), ("inf", np.inf)):
        channels = small()
        channels["G"][2, 3] = value
        files[name] = save(folder / f"{name}.exr", channels)
    channels = small()
    channels["Z"][1, 1] = np.nan
    files["nan depth"] = save(folder / "nandepth.exr", channels)
    whole = STREET.read_bytes()
    files["truncated"] = folder / "truncated.exr"
    files["truncated"].write_bytes(whole[: len(whole) // 3])
    files["empty"] = folder / "empty.exr"
    files["empty"].write_bytes(b"")
    files["zero size"] = zero_size(folder / "zero.exr", whole)
    return files


def zero_size(path: Path, whole: bytes) -> Path:
    """The header of a real file with a data window of no pixels."""
    name = b"dataWindow\0box2i\0" + (16).to_bytes(4, "little")
    at = whole.index(name) + len(name)
    corner = np.array([0, 0, -1, -1], "<i4").tobytes()
    path.write_bytes(whole[:at] + corner + whole[at + 16 :])
    return path


FILE_CASES = {
    "missing": ["missing.exr", "no such file"],
    "text": ["text.exr", "cannot be read as OpenEXR"],
    "folder": ["is a folder"],
    "no depth": ["nodepth.exr", "no depth channel 'Z'", "B G R", "--depth-channel", "--coc"],
    "no blue": ["noblue.exr", "no channel 'B'"],
    "nan": ["nan.exr", "channel G", "column 3, row 2"],
    "inf": ["inf.exr", "channel G", "column 3, row 2"],
    "nan depth": ["nandepth.exr", "channel Z", "column 1, row 1"],
    "truncated": ["truncated.exr", "cannot be read"],
    "empty": ["empty.exr", "cannot be read"],
    "zero size": ["zero.exr"],
}


@pytest.mark.parametrize("kind", FILE_CASES)
def test_bad_file(kind, tmp_path):
    """One line that says what, where and what to do; exit code 2; no output."""
    refused(called("render", bad_files(tmp_path)[kind], "-o", tmp_path / "out.exr"), FILE_CASES[kind])
    assert not list(tmp_path.glob("*out.exr*")) and not list(tmp_path.glob(".*"))


@pytest.mark.parametrize("target", ["/no/such/folder/out.exr", "/proc/out.exr", "."])
def test_unwritable_output(target, tmp_path):
    """Refused before any work, or without leaving anything."""
    refused(run("render", STREET, "-o", target, cwd=tmp_path), [target if target != "." else "folder"])
    assert not list(tmp_path.iterdir())


def test_usage_errors():
    """No arguments, no output, an unknown command."""
    refused(called("render"), ["IN.exr"])
    refused(called("render", STREET), ["--output"])
    refused(called("bogus"), ["bogus"])


def test_closed_output():
    """`>&-`: the refusal is one line still."""
    command = f"exec {shlex.quote(sys.executable)} -m bokeh_validation render nothing.exr -o out.exr >&-"
    environment = {**os.environ, "PYTHONPATH": str(paths.VALIDATION)}
    done = subprocess.run(["bash", "-c", command], stderr=subprocess.PIPE, text=True, env=environment)
    refused(subprocess.CompletedProcess(command, done.returncode, "", done.stderr), ["nothing.exr: no such file"])
