"""Run every engine sample on its own colour and depth, and check that results are within the reference's interval."""

import json
import re
import shutil
from math import exp, radians, tan

import numpy as np
import pytest
from PIL import Image
from support import needed
from support_inputs import DRAWN_AGAIN, of_sample, samples

import engines
from bokeh_validation import paths, process
from bokeh_validation.errors import Unavailable
from engines import bevy, cargo, lavapipe, pages, vulkan, wgpu

EXACT = {("exact", "hexagon"), ("exact", "octagon")}
PAPER = {("paper", "hexagon"), ("paper", "octagon")}
WITHOUT_PAPER = ("babylonjs-webgl", "babylonjs-webgpu", "love", "ogre", wgpu.NAME, *vulkan.NAMES)
# Samples that rotate the lines of paper as well; in the others the angles are in the table of passes
ROTATED_PAPER = (
    "threejs-webgl",
    "threejs-webgpu",
    "playcanvas-webgl",
    "playcanvas-webgpu",
    "godot",
    "panda3d",
    "jmonkeyengine",
    bevy.NAME,
)
# Samples with a shot that has near and far scales and limits
FOCUSED = ("godot", "panda3d")
# Samples whose autofocus is not checked here: test_godot.py covers Godot's, and Vulkan's scene is a single image
WITHOUT_PULL = ("godot", *vulkan.NAMES)
# Vertical field of view in degrees and f-stop from which the sample's lens is made
LENSES = {
    **dict.fromkeys(("opengl", "panda3d"), (16.071, 1.4)),
    **dict.fromkeys(("raylib", "love", "ogre", "jmonkeyengine"), (27.0, 0.2)),
    **dict.fromkeys((*pages.NAMES, "godot"), (45.0, 0.07)),
    **dict.fromkeys(("direct3d9", "direct3d11"), (16.071, 1.0)),
    "bevy": (26.991, 0.2),
    **dict.fromkeys((wgpu.NAME, *vulkan.NAMES), (26.991, 0.7003)),
}


# Fraction of a shot's pixels that are within 4 half-float steps of the reference. It was chosen, not derived: the rest
# are pixels beside lights, where a filter weight of another rounding shows.
CLOSE = 0.998


def check_shots(capture):
    """Check that each shot is within its interval, and that hardly a pixel is more than 4 steps off."""
    wrong = {
        shot.name: f"{shot.comparison}, {shot.outside}"
        for shot in capture.shots
        if shot.comparison.outside or shot.comparison.close < CLOSE
    }
    assert capture.shots and not wrong, wrong


def check_rotation(folder, capture, methods):
    """Check that the sample's rotation is clockwise on the screen: check_shots() passes with this direction. With the
    opposite one, pixels leave the interval, and at least 10 % fewer are within 4 steps (20 % on SwiftShader).

    folder   of the capture
    methods  those with a rotated shot
    """
    close = {shot.name: shot.comparison.close for shot in capture.shots}
    data = json.loads((folder / "capture.json").read_text(encoding="utf-8"))
    rotated = [shot | {"clockwise": -shot["clockwise"]} for shot in data["shots"] if shot.get("clockwise")]
    (folder / "opposite.json").write_text(json.dumps(data | {"shots": rotated}), encoding="utf-8")
    for shot in engines.read(folder, "opposite.json").shots:
        assert shot.comparison.outside and shot.comparison.close < close[shot.name] - 0.1, shot.comparison
    assert {shot["method"] for shot in rotated} == methods


def check_focus(folder, capture):
    """Check that a shot has a near and a far scale and limit, and that they act: without them, pixels leave the
    interval.

    folder   of the capture
    """
    data = json.loads((folder / "capture.json").read_text(encoding="utf-8"))
    plain = [{key: value for key, value in shot.items() if key != "focus"} for shot in data["shots"] if "focus" in shot]
    (folder / "plain.json").write_text(json.dumps(data | {"shots": plain}), encoding="utf-8")
    outside = [shot.comparison.outside for shot in engines.read(folder, "plain.json").shots]
    assert outside and min(outside) > 0.1 * capture.shots[-1].result[..., 0].size, outside


def check_lens(camera, fovy, stop):
    """Check that f follows from the field of view (degrees) and A from the f-stop, as in docs/lens.md."""
    focal_length = camera.sensor_height / (2.0 * tan(0.5 * radians(fovy)))
    assert camera.focal_length == pytest.approx(focal_length, rel=1e-4)
    assert camera.aperture_diameter == pytest.approx(focal_length / stop, rel=1e-4)


def check_pull(folder, metres):
    """Check the autofocus frame by frame: "pull" of capture.json, by docs/lens.md.

    folder  of the capture
    metres  (H, W) depth of the last shot

    The entries of "pull" are:

    depths     of points in the world, or
    points     (u, v, depth that the sample found there): it must lie within the depths of the 3 x 3 pixels around it,
               since a ray need not pass through a pixel's centre
    distances  after each frame of `frame` seconds, from `from` (else the camera's) towards the nearest of the points,
               with the time constant `seconds`; float32
    """
    data = json.loads((folder / "capture.json").read_text(encoding="utf-8"))
    size = metres.shape
    pull = data["pull"]
    depths = pull.get("depths", [])
    for u, v, depth in pull.get("points", []):
        row, column = int(v * size[0]), int(u * size[1])
        around = metres[row - 1 : row + 2, column - 1 : column + 2]
        assert around.min() * 0.9999 < depth < around.max() * 1.0001
        depths.append(depth)
    assert len(depths) > 1 and max(depths) > 1.2 * min(depths)
    distance, expected = pull["from"] if "from" in pull else data["camera"]["focus_distance"], []
    for _ in pull["distances"]:
        k = 1.0 - exp(-pull["frame"] / pull["seconds"])
        distance = 1.0 / (1.0 / distance + k * (1.0 / min(depths) - 1.0 / distance))
        expected.append(distance)
    assert len(expected) >= 10 and abs(expected[-1] / expected[0] - 1.0) > 0.1
    assert pull["distances"] == pytest.approx(expected, rel=1e-5)


# Bevy's first build takes a quarter of an hour
@pytest.mark.timeout(4000)
@pytest.mark.parametrize("name", samples(engines.ENGINES, DRAWN_AGAIN))
def test_sample(name, request, hand_over):
    """Run a sample and check hexagon and octagon by exact and usually paper, and the layered hexagon, which is its
    default.

    It is skipped until something changes (support_inputs.py). A slow sample runs only if it was built before, or with
    --all.
    """
    asked = request.config.getoption("--all") or request.config.getoption("--report")
    if name in engines.SLOW and not asked and not bevy.built():
        pytest.skip(f"{name}: not built here yet; --all builds it")
    outcome, capture = engines.judged(name)
    hand_over(outcome)
    with needed(name):
        for reason in outcome.missing.values():
            raise Unavailable(reason)
    assert capture, [line for run in outcome.runs for line in run.lines(False)]
    folder = paths.cache_folder() / "engines" / name / "capture"
    if name not in WITHOUT_PULL:
        check_pull(folder, capture.shots[-1].case.depth)
    if name in FOCUSED:
        check_focus(folder, capture)
    shown = [(s.case.settings.method, s.case.settings.aperture) for s in capture.shots]
    assert set(shown) >= EXACT | (set() if name in WITHOUT_PAPER else PAPER)
    assert shown[0] == ("layered", "hexagon")
    check_shots(capture)
    check_rotation(folder, capture, {"exact", "paper"} if name in ROTATED_PAPER else {"exact"})
    for shot in capture.shots:
        check_lens(shot.case.settings.camera, *LENSES[name])
        # something is in focus, something is not, and something is brighter than white
        depth, color = shot.case.depth, shot.case.color
        assert depth.max() > 2 * depth.min() and color[..., :3].max() > 4.0
        assert abs(shot.result.astype(float) - color.astype(float))[..., :3].max() > 0.1


MANIFEST = """[package]
name = "game"
edition = "2024"

[dependencies]
bevy = {{ version = "0.20", default-features = false }}
bokeh-bevy = {{ {} = "{}" }}
"""


@of_sample("bevy", of_code=True)
@pytest.mark.timeout(4000)
@pytest.mark.parametrize("way", ["path", "git"])
def test_bevy_dependency(way, request):
    """Build an empty project with the guide's program and a copy of the crate's folder alone. In the same project, the
    sample's capture must be within the reference's intervals.
    """
    if not request.config.getoption("--all"):
        pytest.skip("--all builds it")
    with needed("bevy"):
        crate = cargo.copied(bevy.NAME)
        # always the same path, by which Cargo recognises what it has built
        project, place = crate.parent / f"by-{way}", str(crate)
        shutil.rmtree(project, ignore_errors=True)
        if way == "git":
            repository = shutil.copytree(crate, project / "repository")
            for words in ("init -q", "add .", "-c user.name=a -c user.email=a@b.c commit -qm crate"):
                process.run(["git", *words.split()], 60.0, repository)
            place = repository.as_uri()
        (project / "src").mkdir(parents=True)
        shutil.copyfile(crate / "examples/game.rs", project / "src/main.rs")
        for lock in crate.glob("Cargo.lock"):
            shutil.copyfile(lock, project / "Cargo.lock")
        (project / "Cargo.toml").write_text(MANIFEST.format(way, place), encoding="utf-8")
        shutil.copytree(crate / "examples" / bevy.EXAMPLE, project / "src/bin" / bevy.EXAMPLE)
        cargo.build(bevy.NAME, project)
        folder = paths.ensured(project / "capture")
        bevy.capture(cargo.program(bevy.NAME, bevy.EXAMPLE, folder="."), folder)
        check_shots(engines.read(folder))


@of_sample(wgpu.NAME, of_code=True)
@pytest.mark.timeout(1200)
def test_wgpu_crate():
    """Run the crate's own tests, and build its documentation without warnings."""
    with needed(wgpu.NAME):
        extra, crate = wgpu.environment(), cargo.copied(wgpu.NAME)
        said = cargo.build(wgpu.NAME, crate, command="test", extra=extra)
        assert said.count("test result: ok.") >= 3 and "FAILED" not in said
        cargo.build(wgpu.NAME, crate, "--no-deps", command="doc", extra={"RUSTDOCFLAGS": "-D warnings"})


@of_sample(wgpu.NAME, of_code=True)
@pytest.mark.timeout(1200)
def test_wgpu_program(tmp_path):
    """Build an empty project with the guide's commands and its program, at most 25 lines, and check the image that it
    writes. In the same project, the sample's capture must be within the reference's intervals.
    """
    with needed(wgpu.NAME):
        crate = cargo.copied(wgpu.NAME)
        guide = (crate / "README.md").read_text(encoding="utf-8")
        (dependencies,) = re.findall(r"`cargo (add wgpu.*)`", guide)
        program = re.search(r"```rust\n(use .*?)```", guide, re.DOTALL)[1]
        assert len(program.splitlines()) <= 25
        (tmp_path / "src/bin").mkdir(parents=True)
        (tmp_path / "src/main.rs").write_text(program, encoding="utf-8")
        shutil.copyfile(crate / "examples/capture.rs", tmp_path / "src/bin/capture.rs")
        settings = '[package]\nname = "lamps"\nedition = "2024"\ndefault-run = "lamps"\n'
        (tmp_path / "Cargo.toml").write_text(settings, encoding="utf-8")
        for words in (f"add polygonal-bokeh --path {crate}", dependencies):
            command, *arguments = words.split()
            cargo.build(wgpu.NAME, tmp_path, *arguments, command=command)
        cargo.build(wgpu.NAME, tmp_path, command="run", extra=wgpu.environment())
        folder = paths.ensured(tmp_path / "capture")
        lavapipe.write_scene(folder)
        capture = ("--bin", wgpu.EXAMPLE, str(folder))
        cargo.build(wgpu.NAME, tmp_path, *capture, command="run", extra=wgpu.environment())
        check_shots(engines.read(folder))
        with Image.open(tmp_path / "lamps.png") as picture:
            pixels = np.asarray(picture.convert("RGB")).astype(int)
    bright = pixels.max(axis=2) > 120
    # each lamp is in its own column of 120 pixels; the fourth is in focus with 3 x 3 pixels, the first is the widest
    areas = [int(bright[:, 120 * i : 120 * (i + 1)].sum()) for i in range(8)]
    assert areas[3] == 9 and min(areas) == 9 and max(areas) == areas[0] > 1000, areas
