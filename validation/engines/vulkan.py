"""Build integration/vulkan with g++ and run it on lavapipe under the validation layers, with shaders from GLSL and
from HLSL.

It has no scene: it reads a ray-traced one as colour and depth buffer.
"""

import json
import os
import shlex
import sys
from pathlib import Path

import numpy as np

from bokeh_validation import locks, needs, paths, process
from bokeh_validation.compilers import dxc
from bokeh_validation.errors import Unavailable
from engines import lavapipe

SAMPLE = paths.ROOT / "integration/vulkan"
NAMES = ("vulkan-glsl", "vulkan-hlsl")
BUILD = "g++ -std=c++20 -O1 -Wall sample.cpp -lvulkan"  # in its folder; ' -o PROGRAM' is appended. 10 s of one core
INSTALL = needs.install("vulkan-sdk")
LAYERS = Path("/usr/share/vulkan/explicit_layer.d/VkLayer_khronos_validation.json")
CHECKS = {
    "VK_INSTANCE_LAYERS": "VK_LAYER_KHRONOS_validation",
    "VK_LAYER_ENABLES": "VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT",
}
SECONDS = 120.0  # it takes 5
SHOTS = [
    {"name": name, "method": method, "aperture": aperture, "result": f"{name}.f16", "written": f"{name}.written"}
    for name in ("layered-hexagon", "layered-octagon", "exact-hexagon", "exact-octagon")
    for method, aperture in [name.split("-")]
]
# Drawn first, since the sample names its files as without a rotation
ROTATED = {"name": "rotated", "method": "exact", "aperture": "octagon", "result": "rotated.f16", "clockwise": 10.0}


def run(name: str, folder: Path) -> None:
    """Run a sample, which writes its capture and picture.png to `folder`.

    Raises errors.Unavailable, and RuntimeError, also if the validation layers report anything.
    """
    if not LAYERS.exists():
        raise Unavailable(f"no validation layers; {INSTALL}")
    language, scene = name.removeprefix("vulkan-"), lavapipe.write_scene(folder)
    commands = f"{_dxc()}:{os.environ['PATH']}" if language == "hlsl" else os.environ["PATH"]
    environment = {"VK_ICD_FILENAMES": str(lavapipe.description()), "PATH": commands, **CHECKS}
    device = ""
    for shot in [ROTATED, *SHOTS]:
        words = [language, f"{shot['method']}-{shot['aperture']}", folder, str(shot.get("clockwise", 0))]
        said = process.run([_program(), *words], SECONDS, SAMPLE, environment).splitlines()
        if len(said) != 1:  # the only line is the device
            raise RuntimeError("\n".join(said))
        device = said[0]
        if shot is ROTATED:
            (folder / f"{words[1]}.f16").rename(folder / shot["result"])
    capture = {"engine": name, "device": device, "shots": [*SHOTS, ROTATED], **scene}
    (folder / "capture.json").write_text(json.dumps(capture), encoding="utf-8")
    shape = (scene["height"], scene["width"], 4)
    files = ("color.f16", "layered-hexagon.f16")
    lavapipe.write_picture(folder, [np.fromfile(folder / file, np.float16).reshape(shape) for file in files])


def _program() -> Path:
    """Return the sample's program, rebuilt if a source has changed."""
    sources = [*sorted(SAMPLE.glob("*.[hc]*")), paths.ROOT / "integration/parameters/BokehParameters.h"]

    def build(folder: Path) -> None:
        process.find("g++", INSTALL)
        process.run(["sh", "-c", f"{BUILD} -o {shlex.quote(str(folder / 'sample'))}"], SECONDS, SAMPLE)

    return locks.built_once("engines/vulkan/program", [BUILD, *sources], build) / "sample"


def _dxc() -> Path:
    """Return a folder with a command `dxc`, which Debian does not package. Raises Unavailable."""
    dxc.fetch()
    code = "import sys; from bokeh_validation.compilers import dxc; sys.exit(dxc.command(sys.argv[1:]))"
    script = f"#!/bin/sh\nPYTHONPATH={shlex.quote(str(paths.VALIDATION))} exec {sys.executable} -P -c '{code}' \"$@\"\n"

    def build(folder: Path) -> None:
        (folder / "dxc").write_text(script, encoding="utf-8")
        (folder / "dxc").chmod(0o755)

    return locks.built_once("engines/vulkan/dxc", [script], build)
