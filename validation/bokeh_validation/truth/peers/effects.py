"""The effects, and the page in headless Chromium in which all of them draw the same scene, on WebGL 2 and on WebGPU."""

import base64
import json
import math
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bokeh_validation import browser, paths
from bokeh_validation.engines import pages
from bokeh_validation.errors import Unavailable
from bokeh_validation.truth.peers import crate

Parameters = dict[str, float | bool]
PAGE = Path(__file__).parent / "page"
# scene, or ONE_LIGHT -> effect -> the parameters that it is drawn with
FOUND = Path(__file__).parent / "found.json"
ONE_LIGHT = "one light"
LIMIT = 240.0


class Effect(NamedTuple):
    """One of page/peers.js.

    package  of npm, or the crate
    numbers  parameters that a search makes larger and smaller
    options  other parameters, and the values that a search tries; the first is the effect's own or the strongest blur
    """

    title: str
    package: str
    numbers: tuple[str, ...]
    options: dict[str, tuple] = {}


EFFECTS = {
    "BokehPass": Effect("three.js BokehPass", "three", ("aperture", "maxblur")),
    "DepthOfFieldNode": Effect("three.js DepthOfFieldNode", "three", ("focalLength", "bokehScale")),
    "DepthOfFieldEffect": Effect(
        "pmndrs DepthOfFieldEffect", "postprocessing", ("focusRange", "bokehScale"), {"resolutionScale": (0.5, 1.0)}
    ),
    "Babylon": Effect("Babylon.js DepthOfFieldEffect", "@babylonjs/core", ("fStop",), {"blurLevel": (2, 1, 0)}),
    "CameraFrame": Effect(
        "PlayCanvas CameraFrame", "playcanvas", ("focusRange", "blurRadius"),
        {"nearBlur": (True, False), "blurRings": (4,), "blurRingPoints": (5,), "highQuality": (True,)},
    ),
    "BevyBokeh": Effect("Bevy bokeh", crate.NAME, ("scale", "maxDiameter")),
    "BevyGaussian": Effect("Bevy Gaussian", crate.NAME, ("scale", "maxDiameter")),
}  # fmt: skip


def parameters() -> dict[str, dict[str, Parameters]]:
    """The contents of found.json."""
    return json.loads(FOUND.read_text(encoding="ascii"))


def installed() -> Path:
    """node_modules with three.js and postprocessing. Raises Unavailable, RuntimeError."""
    return pages.installed(Path(__file__).parent)


def versions(modules: Iterable[Path], effects: Iterable[str]) -> dict[str, str]:
    """Package -> version, of those that effects are in, as they are installed in one of some node_modules."""
    packages = {EFFECTS[effect].package for effect in effects} - {crate.NAME}
    files = {name: [folder / name / "package.json" for folder in modules] for name in packages}
    texts = {name: next(file for file in some if file.is_file()).read_bytes() for name, some in files.items()}
    return {crate.NAME: crate.VERSION} | {name: json.loads(text)["version"] for name, text in texts.items()}


class Page:
    """A page in which the effects draw a scene; a context. Bevy's are missing where there is no cargo."""

    def __init__(self):
        """Raises Unavailable."""
        engines = [paths.ROOT / "integration" / engine for engine in ("babylonjs", "playcanvas")]
        modules = [installed(), *map(pages.installed, engines)]
        self.versions = versions(modules, EFFECTS)
        places = [("browser/", browser.PAGE), ("", PAGE), *(("", folder) for folder in modules)]
        with suppress(Unavailable):
            places.insert(0, (f"{crate.NAME}/", crate.source()))
        self.session = browser.Session(places=places, limit=LIMIT)

    def __enter__(self) -> "Page":
        return self

    def __exit__(self, *_) -> None:
        self.session.close()

    def load(self, color: np.ndarray, depth: np.ndarray, camera) -> None:
        """Hand over linear HDR colour (H, W, >= 3) and depth in metres (H, W), seen by a camera."""
        height, width = depth.shape
        rgba = np.ones((height, width, 4), np.float16)
        rgba[..., :3] = color[..., :3]
        scene = {"width": width, "height": height, "color": _packed(rgba), "depth": _packed(depth.astype(np.float32))}
        scene |= {"near": 0.5 * float(depth.min()), "far": 1.01 * float(depth.max())}
        lens = {"aperture": camera.aperture_diameter, "focal": camera.focal_length, "focus": camera.focus_distance}
        scene["camera"] = lens | {"sensor": camera.sensor_height}
        self.session.call("load", scene | {"fovy": 2 * math.atan(0.5 * camera.sensor_height / camera.focal_length)})
        self.shape = (height, width, 4)

    def documented(self, effect: str) -> Parameters:
        """What an effect's documentation asks for, for the scene's lens."""
        options = {name: values[0] for name, values in EFFECTS[effect].options.items()}
        return {**self.session.call("mapped", effect), **options}

    def draw(self, effect: str, parameters: Parameters) -> np.ndarray:
        """What an effect makes of the scene, (H, W, 4)."""
        drawn = self.session.call("draw", {"name": effect, "parameters": parameters})
        kind = np.float16 if drawn["half"] else np.float32
        return np.frombuffer(base64.b64decode(drawn["data"]), kind).reshape(self.shape)

    def draws(self, effect: str, parameters: Parameters) -> list[dict]:
        """The draws of a frame, for counted.fetches()."""
        return self.session.call("draws", {"name": effect, "parameters": parameters})


def _packed(pixels: np.ndarray) -> str:
    return base64.b64encode(np.ascontiguousarray(pixels).tobytes()).decode("ascii")
