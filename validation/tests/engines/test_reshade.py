"""ReShade's effect, by the FX compiler of vkBasalt, on the screen of a Vulkan program; colour and depth are known."""

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

EFFECT = paths.ROOT / "integration/reshade/PolygonalBokeh.fx"
# The picture is a part of market_7, as large as vkcube's window, which is so far from the screen's corner
PART, CORNER = (slice(30, 510), slice(160, 800)), 100
FAR_PLANE, HIGHLIGHTS, FOCUS, MOST = 100.0, 0.9, 2.5, 0.1
# Compiling takes 5 s, and a frame of lavapipe 0.3 s
LIMIT_S = 120


def expanded(shown):
    """Linear light of what a game shows, 0 .. 1, (H, W, 3); the effect's formula in float64."""
    light = np.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4)
    return light / (1.0 - HIGHLIGHTS * light.max(axis=-1, keepdims=True))


def compressed(light):
    """The other way round."""
    light = light / (1.0 + HIGHLIGHTS * light.max(axis=-1, keepdims=True))
    return np.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1.0 / 2.4) - 0.055)


def screen(folder: Path) -> np.ndarray:
    """Where vkcube's window is on the screen of Xvfb, whose memory is a file in XWD's format."""
    data = (folder / "Xvfb_screen0").read_bytes()
    head = np.frombuffer(data[:100], ">u4")
    width, height, start, line = head[4], head[5], head[0] + 12 * head[19], head[12]
    rows = np.frombuffer(data, np.uint8, line * height, start).reshape(height, line)
    rgb = rows[:, : 4 * width].reshape(height, width, 4)[..., 2::-1]
    return rgb[CORNER : CORNER + 480, CORNER : CORNER + 640]


def drawn(folder: Path) -> np.ndarray:
    """What vkcube's window shows with the effect in `folder`, once it changes no more."""
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


@of_sample("reshade")
@pytest.mark.parametrize(
    ("technique", "cursor"), [("PolygonalBokeh", False), ("PolygonalBokehExact", False), ("PolygonalBokehExact", True)]
)
def test_picture(technique, cursor, tmp_path):
    """As the same frame of the harness, through the same curve, at the distance that autofocus finds.

    cursor  focus where the cursor is: vkBasalt knows no other place of it than the first pixel

    Both are rounded to 8 bits; the harness's result is a half float before, 2^-11 of its value, which the curve makes
    at most 0.13 of a step of the 8 bits: they differ by one step at most, but where a comparison goes the other way.
    """
    scene = ray_traced.picture(ray_traced.MARKET)
    color = np.rint(255.0 * compressed(scene.color[PART][..., :3].astype(float))).astype(np.uint8)
    code = np.rint(np.clip(scene.depth[PART] / FAR_PLANE, 0.0, 1.0) * 65535.0).astype(int)
    # what the middle of the screen shows, or the pixel under the cursor: farther than the middle, which is at 2.4 m
    place = (slice(8), slice(8)) if cursor else (slice(236, 244), slice(316, 324))
    focus = 6.0 if cursor else FOCUS
    code[place] = round(focus / FAR_PLANE * 65535.0)
    Image.fromarray(color).save(tmp_path / "color.png")
    Image.fromarray(np.dstack([code // 256, code % 256, code * 0]).astype(np.uint8)).save(tmp_path / "depth.png")
    for path in (
        Path(__file__).parent / "ReShade.fxh",
        *(paths.shader("hlsl", name) for name in ("bokeh", "bokeh_layers")),
    ):
        shutil.copy(path, tmp_path)
    text = (
        EFFECT.read_text(encoding="ascii").replace("ui_max = 2000.0;", "").replace("> = 1000.0;", f"> = {FAR_PLANE};")
    )
    # f/1.4, as in the guide's picture
    text = re.sub(r"(uniform float BokehScale <.*?> = )10\.0;", r"\g<1>2.0;", text, flags=re.DOTALL)
    if cursor:
        text = re.sub(r"(uniform int FocusMode <.*?> = )1;", r"\g<1>2;", text, flags=re.DOTALL)
    # vkBasalt runs every technique
    text = re.sub(rf"technique (?!{technique} )\w+ .*?\n\}}\n", "", text, flags=re.DOTALL)
    (tmp_path / "effect.fx").write_text(text, encoding="ascii")
    shown = drawn(tmp_path)
    camera = methods.Camera(0.05 / 1.4, 0.05, focus, 0.024, MOST)
    settings = methods.Settings("layered" if technique == "PolygonalBokeh" else "exact", "hexagon", camera=camera)
    plan = methods.plan(settings, (640, 480))
    light = np.dstack([expanded(color / 255.0), np.ones((480, 640))]).astype(np.float16)
    depth = np.maximum(code / 65535.0 * FAR_PLANE, 0.01).astype(np.float32)
    result = load("osmesa").run(plan.passes, {"color": light, "depth": depth, **plan.tables}, (640, 480))["result"]
    wanted = np.rint(255.0 * np.clip(compressed(result[..., :3].astype(float)), 0.0, 1.0))
    off = np.abs(shown - wanted).max(axis=-1)
    if technique == "PolygonalBokeh":
        Image.fromarray(shown.astype(np.uint8)).save(tmp_path / "picture.png", optimize=True)
        assert_picture(tmp_path / "picture.png", EFFECT.parent / "picture.png")
    assert (off <= 1.0).mean() >= 0.998 and np.abs(wanted - color).mean() > 3.0, np.bincount(off.astype(int).ravel())
