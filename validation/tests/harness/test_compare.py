"""Test validation/run compare: a correct engine passes with either kind of target, and each mistake is named."""

import json
from dataclasses import replace
from unittest.mock import patch

import numpy as np
import OpenEXR
import pytest
from support import called, load, refused
from support_cases import noise_case

from bokeh_validation import exr
from bokeh_validation.frame.methods import Camera, Settings
from bokeh_validation.probes.model import Case
from bokeh_validation.reference.listings import stored_depth
from bokeh_validation.shaders.passes import Pass

CAMERA = Camera(0.1, 0.05, 4.0, max_coc=0.3)
SETTINGS = Settings("exact", "hexagon", rotation=20.0, camera=CAMERA)
LENS = ("--aperture-diameter", 0.1, "--focus-distance", 4, "--max-coc", 0.3)
GIVEN = ("--method", "exact", "--rotation", 20, *LENS, "--driver", "egl")
NEAR, FAR = 0.5, 200.0


def drawn(case: Case, storage: str = "half", coc=None) -> np.ndarray:
    """Draw a case like an engine; `coc` is a change of its signed CoC map."""
    driver, (first, *others), textures = load("egl"), case.plan.passes, case.textures()
    textures["coc"] = driver.run([first], textures, case.size, storage, keep=("coc",))["coc"]
    if coc is not None:
        textures["coc"][..., 3] = coc(textures["coc"][..., 3])
    return driver.run(others, textures, case.size, storage)["result"]


def metres_read_as(kind: int, held: int, depth: np.ndarray) -> np.ndarray:
    """Return the metres that the shaders compute, reading as `kind` a depth buffer that holds `held`."""
    parameters = {"BokehDepthKind": float(kind), "BokehNear": NEAR, "BokehFar": FAR}
    textures = {"depth": stored_depth(depth.astype(np.float64), held, NEAR, FAR).astype(np.float32)}
    item = Pass("BokehLinearDepth", {"DepthSamp": "depth"}, "result", parameters)
    return load("egl").run([item], textures, depth.shape[::-1], "float")["result"][..., 0].copy()


def gamma(image: np.ndarray) -> np.ndarray:
    """Apply an approximate sRGB curve, as many engines do."""
    return np.concatenate([image[..., :3].astype(np.float32) ** (1 / 2.2), image[..., 3:]], axis=-1).astype(image.dtype)


def with_depth(case: Case, kind: int, held: int) -> np.ndarray:
    """Draw a case like an engine that misreads its depth buffer."""
    return drawn(replace(case, depth=metres_read_as(kind, held, case.depth)))


def with_lens(case: Case, **changes: float) -> Case:
    """Return the scene through another lens."""
    return replace(case, settings=replace(SETTINGS, camera=replace(CAMERA, **changes)))


def unfiltered(case: Case) -> np.ndarray:
    """Draw a case with a nearest filter on the sampler."""
    driver, plan = load("egl"), case.plan
    with patch.dict(driver.samplers, {True: driver.samplers[False]}):
        return driver.run(plan.passes, case.textures(), case.size)["result"]


MISTAKES = {
    "upside down: v is flipped": lambda case: drawn(case)[::-1].copy(),
    "the depth is upside down": lambda case: drawn(replace(case, depth=case.depth[::-1].copy())),
    "the result is sRGB": lambda case: gamma(drawn(case)),
    "the colour that was blurred is sRGB": lambda case: drawn(replace(case, color=gamma(case.color))),
    "the CoC's sign is wrong": lambda case: drawn(case, coc=np.negative),
    "the CoC has no sign": lambda case: drawn(case, coc=np.abs),
    "reversed depth, but was read as window": lambda case: with_depth(case, 1, 2),
    "infinite depth, but was read as window": lambda case: with_depth(case, 1, 3),
    "window depth, but was read as metres": lambda case: with_depth(case, 0, 1),
    "the rotation's sign": lambda case: drawn(replace(case, settings=replace(SETTINGS, rotation=-20.0))),
    "the method is layered": lambda case: drawn(replace(case, settings=replace(SETTINGS, method="layered"))),
    "shape is octagon": lambda case: drawn(replace(case, settings=replace(SETTINGS, aperture="octagon"))),
    "the focal length is 0.07 m": lambda case: drawn(with_lens(case, focal_length=0.07)),
    "BokehSensorHeight is the sensor's width": lambda case: drawn(with_lens(case, sensor_height=0.036)),
    "read without a linear filter": lambda case: unfiltered(case),
    "preset is LOW": lambda case: drawn(replace(case, settings=replace(SETTINGS, samples=5, spacing=2.0))),
    "preset is ULTRA": lambda case: drawn(replace(case, settings=replace(SETTINGS, method="layered", preset="ultra"))),
}


def saved(folder, case: Case, result: np.ndarray, dtype=np.float16) -> list:
    """Write a case and its result as files, and return the arguments for compare."""
    channels = {name: np.ascontiguousarray(case.color[..., i].astype(dtype)) for i, name in enumerate("RGB")}
    with OpenEXR.File({"type": OpenEXR.scanlineimage}, {**channels, "Z": case.depth}) as file:
        file.write(str(folder / "in.exr"))
    exr.write(folder / "result.exr", result)
    return ["compare", folder / "in.exr", folder / "result.exr"]


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_named(name, tmp_path):
    """Check that compare names the mistake with its advice."""
    case = noise_case((96, 64), SETTINGS)
    files = saved(tmp_path, case, MISTAKES[name](case))
    method = ("--method", "layered") if name == "preset is ULTRA" else ()
    done = called(*files, *GIVEN, *method, "--near", NEAR, "--far", FAR)
    assert done.returncode == 1, done.stdout + done.stderr
    lines = [line for line in done.stdout.splitlines() if line.startswith("likeliest mistake: ")]
    # reading window as reversed and the other way round give the same depth; nothing else ties
    assert len(lines) == 1 + ("window" in name and "reversed" in name)
    assert sum(name in line for line in lines) == 1, lines
    assert all(line.endswith(".") and line.count(". ") >= 1 for line in lines)


def test_what_the_engine_sets(tmp_path):
    """Check that compare does not suggest what is set already, and reports a parameter that differs."""
    case = noise_case((96, 64), SETTINGS)
    files = saved(tmp_path, case, with_depth(case, 1, 2))
    sets = "--set BokehDepthKind=1 --set BokehNear=0.5 --set BokehFar=200 --set BokehSqueeze=2".split()
    done = called(*files, *GIVEN, *sets)
    (line,) = [line for line in done.stdout.splitlines() if line.startswith("likeliest mistake: ")]
    assert "If BokehDepthKind is 1 (window) now, set it to 2 (reversed)" in line
    assert "BokehSqueeze is 2 in your engine and 1 here" in done.stdout
    refused(called(*files, "--set", "BokehSqueze=1"), ["--set BokehSqueze=1", "no parameter"])
    refused(called(*files, "--set", "BokehSqueeze=wide"), ["--set BokehSqueeze=wide", "no number"])


def test_settings_of_a_plan(tmp_path):
    """Check that settings come from plan's file, that options change them, and that a file without settings is
    refused.
    """
    case, plan = noise_case((96, 64), SETTINGS), tmp_path / "plan.json"
    plan.write_text(called("plan", *GIVEN[:-2], "--set", "BokehDepthKind=2").stdout)
    assert json.loads(plan.read_text())["parameters"]["BokehDepthKind"] == 2
    files = saved(tmp_path, case, drawn(case))
    done = called(*files, "--plan", plan, "--driver", "egl")
    assert done.returncode == 0 and "the same" in done.stdout, done.stdout
    assert called(*files, "--plan", plan, "--driver", "egl", "--squeeze", "0.5").returncode == 1
    for content in ("", "[]", "{}", '{"settings": {"method": 1}}', '{"settings": {"aperture": "circle"}}'):
        plan.write_text(content)
        refused(called(*files, "--plan", plan), ["--plan", "validation/run plan"])
    refused(called(*files, "--plan", tmp_path / "none.json"), ["none.json", "No such file"])


@pytest.mark.parametrize("storage", ["half", "float"])
@pytest.mark.parametrize("dtype", [np.float16, np.float32])
def test_a_right_engine_passes(dtype, storage, tmp_path):
    """Check that a correct result passes for every format of file and targets, and on a device that rounds
    differently.
    """
    case = noise_case((96, 64), SETTINGS)
    case = replace(case, color=(case.color.astype(np.float32) * np.float32(1.0001)).astype(dtype))
    other = load("webgl2").run(case.plan.passes, case.textures(), case.size, storage)["result"]
    for result in (other, drawn(case, storage)):
        done = called(*saved(tmp_path, case, result.astype(np.float32), dtype), *GIVEN)
        assert done.returncode == 0 and "the same" in done.stdout, done.stdout + done.stderr
    assert f"nearest to {storage} targets" in done.stdout


def test_sizes(tmp_path):
    """Check that a result of another size is refused."""
    case = noise_case((96, 64), SETTINGS)
    done = called(*saved(tmp_path, case, drawn(case)[:32].copy()), *GIVEN)
    assert done.returncode == 2 and "(96, 32) pixels, the input has (96, 64)" in done.stderr
