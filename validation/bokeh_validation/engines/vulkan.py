"""integration/vulkan: built with g++, run on lavapipe under the validation layers, its shaders from GLSL and from HLSL.

It draws no scene: it is handed a ray-traced one, as colour and depth buffer.
"""

import json
import os
import shlex
import sys
from dataclasses import asdict
from pathlib import Path

import numpy as np

from bokeh_validation import locks, needs, paths, pictures, process
from bokeh_validation.compilers import dxc
from bokeh_validation.engines import lavapipe
from bokeh_validation.errors import Unavailable
from bokeh_validation.reference import listings
from bokeh_validation.truth import ray_traced

SAMPLE = paths.ROOT / "integration/vulkan"
NAMES = ("vulkan-glsl", "vulkan-hlsl")
BUILD = "g++ -std=c++20 -O1 -Wall sample.cpp -lvulkan"  # in its folder; ' -o PROGRAM' is added. 10 s of one core
INSTALL = needs.install("vulkan-sdk")
LAYERS = Path("/usr/share/vulkan/explicit_layer.d/VkLayer_khronos_validation.json")
CHECKS = {
    "VK_INSTANCE_LAYERS": "VK_LAYER_KHRONOS_validation",
    "VK_LAYER_ENABLES": "VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT",
}
SECONDS = 120.0  # takes 5
SCENE, EVERY, STORED = ray_traced.MARKET, 2, {"kind": 1, "near": 0.5, "far": 400.0}


def run(name: str, folder: Path) -> None:
    """Leave the capture of a sample, and picture.png, in `folder`.

    Raises errors.Unavailable, RuntimeError, also where the validation layers say anything.
    """
    if not LAYERS.exists():
        raise Unavailable(f"no validation layers; {INSTALL}")
    language, capture = name.removeprefix("vulkan-"), _scene(folder)
    commands = f"{_dxc()}:{os.environ['PATH']}" if language == "hlsl" else os.environ["PATH"]
    environment = {"VK_ICD_FILENAMES": str(lavapipe.description()), "PATH": commands, **CHECKS}
    for shot in capture["shots"]:
        said = process.run([_program(), language, shot["name"], folder], SECONDS, SAMPLE, environment).splitlines()
        if len(said) != 1:  # of the device
            raise RuntimeError("\n".join(said))
    (folder / "capture.json").write_text(json.dumps({"engine": name, "device": said[0], **capture}), encoding="utf-8")
    shape = (capture["height"], capture["width"], 4)
    drawn = [np.fromfile(folder / file, np.float16).reshape(shape) for file in ("color.f16", "layered-hexagon.f16")]
    pictures.write_png(folder / "picture.png", pictures.filmic(np.concatenate(drawn, axis=1)))


def _scene(folder: Path) -> dict:
    """What the sample reads, in the folder, and the capture but for its engine and device."""
    scene = ray_traced.picture(SCENE)
    color, metres = (np.ascontiguousarray(pixels[::EVERY, ::EVERY]) for pixels in (scene.color, scene.depth))
    (folder / "color.f16").write_bytes(color.tobytes())
    depth = listings.stored_depth(metres.astype(np.float64), **STORED)
    (folder / "depth.f32").write_bytes(depth.astype(np.float32).tobytes())
    (height, width), camera = metres.shape, asdict(SCENE.camera)
    lens = [camera[key] for key in ("aperture_diameter", "focal_length", "focus_distance", "max_coc")]
    numbers = [width, height, *lens, STORED["near"], STORED["far"]]
    (folder / "camera.txt").write_text(" ".join(map(str, numbers)))
    shots = [
        {"name": name, "method": method, "aperture": aperture, "result": f"{name}.f16", "written": f"{name}.written"}
        for name in ("layered-hexagon", "layered-octagon", "exact-hexagon", "exact-octagon")
        for method, aperture in [name.split("-")]
    ]
    sources = {"color": "color.f16", "depth": "depth.f32", "stored": STORED}
    return {"width": width, "height": height, "camera": camera, "shots": shots, **sources}


def _program() -> Path:
    """Built if a source has changed."""
    sources = [*sorted(SAMPLE.glob("*.[hc]*")), paths.ROOT / "integration/parameters/BokehParameters.h"]

    def build(folder: Path) -> None:
        process.find("g++", INSTALL)
        process.run(["sh", "-c", f"{BUILD} -o {shlex.quote(str(folder / 'sample'))}"], SECONDS, SAMPLE)

    return locks.built_once("engines/vulkan/program", [BUILD, *sources], build) / "sample"


def _dxc() -> Path:
    """A folder with a command `dxc`, which Debian lacks. Raises Unavailable."""
    dxc.fetch()
    code = "import sys; from bokeh_validation.compilers import dxc; sys.exit(dxc.command(sys.argv[1:]))"
    script = f"#!/bin/sh\nPYTHONPATH={shlex.quote(str(paths.VALIDATION))} exec {sys.executable} -P -c '{code}' \"$@\"\n"

    def build(folder: Path) -> None:
        (folder / "dxc").write_text(script, encoding="utf-8")
        (folder / "dxc").chmod(0o755)

    return locks.built_once("engines/vulkan/dxc", [script], build)
