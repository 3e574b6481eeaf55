"""Run ReShade's effect with vkBasalt's FX compiler on the screen of a Vulkan program; colour and depth are known."""

import os
import re
import shutil
import signal
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from support import load, needed
from support_inputs import of_sample
from support_pages import assert_picture

from bokeh_validation import needs, paths
from bokeh_validation.errors import Unavailable
from bokeh_validation.frame import methods
from bokeh_validation.process import find
from bokeh_validation.truth import ray_traced

GUIDE = paths.ROOT / "integration/reshade"
# Contents of the archive of docs/publishing.md
SHADERS = GUIDE / "Shaders"
# The image is a part of market_7 as large as vkcube's window; CORNER is the window's distance from the screen's corner
PART, CORNER = (slice(30, 510), slice(160, 800)), 100
FAR_PLANE, HIGHLIGHTS, FOCUS, MOST = 100.0, 0.9, 2.5, 0.1
# Compiling takes 5 s, a frame on lavapipe 0.3 s
LIMIT_S = 120


def expanded(shown):
    """Return the linear light of a game's display values, 0 to 1, (H, W, 3), by the effect's formula in float64."""
    light = np.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4)
    return light / (1.0 - HIGHLIGHTS * light.max(axis=-1, keepdims=True))


def compressed(light):
    """Return the display values of linear light: the inverse of expanded()."""
    light = light / (1.0 + HIGHLIGHTS * light.max(axis=-1, keepdims=True))
    return np.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1.0 / 2.4) - 0.055)


def screen(folder: Path) -> np.ndarray:
    """Return the part of Xvfb's screen with vkcube's window, (H, W, 3); the screen's memory is a file in
    XWD's format.
    """
    data = (folder / "Xvfb_screen0").read_bytes()
    head = np.frombuffer(data[:100], ">u4")
    width, height, start, line = head[4], head[5], head[0] + 12 * head[19], head[12]
    rows = np.frombuffer(data, np.uint8, line * height, start).reshape(height, line)
    rgb = rows[:, : 4 * width].reshape(height, width, 4)[..., 2::-1]
    return rgb[CORNER : CORNER + 480, CORNER : CORNER + 640]


def drawn(folder: Path) -> np.ndarray:
    """Return what vkcube's window shows with the effect in `folder`, once the image no longer changes."""
    log, config = folder / "log", folder / "vkBasalt.conf"
    config.write_text(f"effects = bokeh\nbokeh = {folder}/effect.fx\nreshadeTexturePath = {folder}\n"
                      f"reshadeIncludePath = {folder}\ndepthCapture = off\n")  # fmt: skip
    with needed("vkBasalt"):
        if not Path("/usr/share/vulkan/implicit_layer.d/vkBasalt.json").exists():
            raise Unavailable(f"vkBasalt is not on this machine; {needs.install('reshade')}")
        (driver,) = sorted(Path("/usr/share/vulkan/icd.d").glob("lvp_icd*.json"))[:1]
        server = [find("xvfb-run", needs.install("reshade")), "-a", "-s", f"-screen 0 800x600x24 -fbdir {folder}"]
        program = [find("vkcube", needs.install("reshade")), "--c", "1000000", "--width", "640", "--height", "480"]
    layer = {"ENABLE_VKBASALT": "1", "VKBASALT_CONFIG_FILE": config, "VKBASALT_LOG_FILE": log}
    layer |= {"VKBASALT_LOG_LEVEL": "error", "VK_ICD_FILENAMES": driver}
    running = subprocess.Popen([*server, *program], env={**os.environ, **layer}, start_new_session=True)
    try:
        before, end = None, time.monotonic() + LIMIT_S
        while time.monotonic() < end:
            time.sleep(2.0)
            assert running.poll() is None and not (log.exists() and log.read_text()), log.read_text()
            now = screen(folder) if (folder / "Xvfb_screen0").exists() else np.zeros(1)
            if now.any() and before is not None and np.array_equal(before, now):
                return now.astype(int)
            before = now
        pytest.fail(f"no picture after {LIMIT_S} s")
    finally:
        os.killpg(running.pid, signal.SIGTERM)
        running.wait()


@pytest.fixture(scope="module")
def picture():
    """Return what the game shows, 8 bits, and its depth in metres / FAR_PLANE, 16 bits: a part of market_7."""
    scene = ray_traced.picture(ray_traced.MARKET)
    color = np.rint(255.0 * compressed(scene.color[PART][..., :3].astype(float))).astype(np.uint8)
    return color, np.rint(np.clip(scene.depth[PART] / FAR_PLANE, 0.0, 1.0) * 65535.0).astype(int)


def effect(folder: Path, technique: str, values: dict[str, str], color: np.ndarray, code: np.ndarray) -> None:
    """Write everything that vkBasalt needs to a folder: the effect with a single technique and these values of its
    uniforms.
    """
    Image.fromarray(color).save(folder / "color.png")
    Image.fromarray(np.dstack([code // 256, code % 256, code * 0]).astype(np.uint8)).save(folder / "depth.png")
    for path in (Path(__file__).parent / "ReShade.fxh", *SHADERS.glob("*.hlsl")):
        shutil.copy(path, folder)
    text = (SHADERS / "PolygonalBokeh.fx").read_text(encoding="ascii")
    # f/1.4, as in the guide's image
    for name, value in {"MetresToFarPlane": f"{FAR_PLANE}", "BokehScale": "2.0", **values}.items():
        pattern = rf"(uniform \w+ {name} <(?:(?!\n>).)*\n> = )[^;]*;"
        text, count = re.subn(pattern, rf"\g<1>{value};", text, flags=re.DOTALL)
        assert count == 1, name
    # only one technique is kept, since vkBasalt runs all of them
    text = re.sub(rf"technique (?!{technique} )\w+ .*?\n\}}\n", "", text, flags=re.DOTALL)
    (folder / "effect.fx").write_text(text, encoding="ascii")


# Name -> settings of the effect, focus distance, pixel at which autofocus reads it, focus controls of the harness
CASES = {
    "middle": ({}, FOCUS, (316, 236), None),
    # vkBasalt always places the cursor at the first pixel
    "cursor": ({"FocusMode": "2"}, 6.0, (0, 0), None),
    "point": ({"FocusMode": "3", "FocusPoint": "float2(0.25, 0.75)"}, 1.5, (156, 356), None),
    "limits": (
        {"LargestBlurNear": "0.5", "LargestBlurFar": "2.0"}, FOCUS, (316, 236), methods.Focus(limits=(0.005, 0.02)),
    ),
    "scales": (
        {"NearScale": "0.5", "FarScale": "0.25"}, FOCUS, (316, 236),
        methods.Focus(scale=(0.5, 0.25), limits=(MOST, MOST)),
    ),
}  # fmt: skip


@of_sample("reshade")
@pytest.mark.parametrize(
    ("technique", "case"),
    [("PolygonalBokeh", "middle"), ("PolygonalBokeh", "limits"), *(("PolygonalBokehExact", case) for case in CASES)],
)
def test_picture(technique, case, picture, tmp_path):
    """Compare with the harness's frame through the same curve, at the distance that autofocus finds.

    Both are rounded to 8 bits. The harness's result is first rounded to a half float, 2^-11 of its value, which the
    curve reduces to at most 0.13 of an 8-bit step. So they differ by at most one step, except where a comparison goes
    the other way.
    """
    values, focus, (x, y), controls = CASES[case]
    color, code = picture[0], picture[1].copy()
    code[y : y + 8, x : x + 8] = round(focus / FAR_PLANE * 65535.0)
    effect(tmp_path, technique, values, color, code)
    shown = drawn(tmp_path)
    camera = methods.Camera(0.05 / 1.4, 0.05, focus, 0.024, max(controls.limits) if controls else MOST)
    method = "layered" if technique == "PolygonalBokeh" else "exact"
    plan = methods.plan(methods.Settings(method, "hexagon", camera=camera, focus=controls), (640, 480))
    light = np.dstack([expanded(color / 255.0), np.ones((480, 640))]).astype(np.float16)
    depth = np.maximum(code / 65535.0 * FAR_PLANE, 0.01).astype(np.float32)
    result = load("osmesa").run(plan.passes, {"color": light, "depth": depth, **plan.tables}, (640, 480))["result"]
    expected = np.rint(255.0 * np.clip(compressed(result[..., :3].astype(float)), 0.0, 1.0))
    off = np.abs(shown - expected).max(axis=-1)
    if (technique, case) == ("PolygonalBokeh", "middle"):
        Image.fromarray(shown.astype(np.uint8)).save(tmp_path / "picture.png", optimize=True)
        assert_picture(tmp_path / "picture.png", GUIDE / "picture.png")
    assert (off <= 1.0).mean() >= 0.998, np.bincount(off.astype(int).ravel())
    assert np.abs(expected - color).mean() > (1.0 if controls else 3.0)


@of_sample("reshade")
def test_overlay(picture, tmp_path):
    """Check the focus overlay: the sharp image in grey with one of three tints by CoC, and a white focus point."""
    color, code = picture[0], picture[1].copy()
    code[356:364, 156:164] = round(FOCUS / FAR_PLANE * 65535.0)
    values = {"ShowFocus": "true", "FocusMode": "3", "FocusPoint": "float2(0.25, 0.75)", "LargestBlurNear": "0.0"}
    effect(tmp_path, "PolygonalBokehExact", values, color, code)
    shown = drawn(tmp_path)
    depth = np.maximum(code / 65535.0 * FAR_PLANE, 0.01)
    # thin lens of 50 mm at f/1.4 on a sensor 24 mm high; diameter in pixels of 480 rows
    pixels = 480.0 / 0.024 * 0.05 / 1.4 * 0.05 / (FOCUS - 0.05) * (depth - FOCUS) / depth
    kinds = [pixels > 1.0, pixels <= 1.0]
    tints = np.select([kind[..., None] for kind in kinds], [np.array([0.1, 0.4, 1.0]), np.array([0.0, 0.8, 0.2])])
    expected = 127.5 * ((color / 255.0 @ [0.3, 0.6, 0.1])[..., None] + tints)
    expected[356:364, 156:164] = 255.0
    off = np.abs(shown - expected).max(axis=-1)
    # rounding of the distance moves the border between two colours by a pixel here and there
    assert (off <= 1.0).mean() >= 0.998, np.bincount(off.astype(int).ravel())
    assert min(kind.mean() for kind in kinds) > 0.05


@of_sample("reshade")
def test_overlay_near(picture, tmp_path):
    """Check that what is blurred in front of the focus is orange: here everything nearer than 26 m."""
    color, code = picture
    values = {"ShowFocus": "true", "FocusMode": "0", "FocusDistance": "100.0", "LargestBlurFar": "0.0"}
    effect(tmp_path, "PolygonalBokehExact", values, color, code)
    shown = drawn(tmp_path)
    grey = color / 255.0 @ [0.3, 0.6, 0.1]
    assert np.abs(shown - 127.5 * (grey[..., None] + [1.0, 0.5, 0.0])).max(axis=-1)[code < 15000].max() <= 1.0
