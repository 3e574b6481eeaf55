"""Draw a scene with other effects in one page of headless Chromium, on WebGL 2 and WebGPU."""

import json
import math
import os
import shutil
from functools import cache
from pathlib import Path

import numpy as np

from bokeh_validation import browser, locks, paths, process
from bokeh_validation.drivers.base import Image
from bokeh_validation.drivers.web import packed, unpacked
from bokeh_validation.errors import Unavailable
from bokeh_validation.frame.methods import Camera
from engines import pages

Parameters = dict[str, float | bool]
PAGE = Path(__file__).parent / "page"
# Folders that pin the packages: three.js and postprocessing, then the others
FOLDERS = (Path(__file__).parent, *(paths.ROOT / "integration" / engine for engine in ("babylonjs", "playcanvas")))
WEB = paths.ROOT / "integration" / "web"  # this package's passes, as npm installs them
LIMIT = 240.0

# Bevy's crate, for its WGSL: downloaded by cargo, never compiled
CRATE, CRATE_VERSION = "bevy_post_process", "0.19.1"
# limits the download to what this system needs; cargo cannot skip a crate's dependencies
TARGET = "x86_64-unknown-linux-gnu"
MANIFEST = f"""[package]
name = "shaders"
version = "0.0.0"
edition = "2024"
[lib]
path = "empty.rs"
[dependencies]
{CRATE} = {{ version = "={CRATE_VERSION}", default-features = false }}
"""

# name in page/peers.js -> title, package, parameters that a search scales
EFFECTS = {
    "BokehPass": ("three.js BokehPass", "three", ("aperture", "maxblur")),
    "DepthOfFieldNode": ("three.js DepthOfFieldNode", "three", ("focalLength", "bokehScale")),
    "DepthOfFieldEffect": ("pmndrs DepthOfFieldEffect", "postprocessing", ("focusRange", "bokehScale")),
    "Babylon": ("Babylon.js DepthOfFieldEffect", "@babylonjs/core", ("fStop",)),
    "CameraFrame": ("PlayCanvas CameraFrame", "playcanvas", ("focusRange", "blurRadius")),
    "BevyBokeh": ("Bevy bokeh", CRATE, ("scale", "maxDiameter")),
    "BevyGaussian": ("Bevy Gaussian", CRATE, ("scale", "maxDiameter")),
}
# Other parameters that a search tries, with their values
OPTIONS = {"resolutionScale": (0.5, 1.0), "blurLevel": (2, 1, 0), "nearBlur": (True, False)}
# Scene, or ONE_LIGHT -> effect -> the best parameters found, see docs/results.md
FOUND: dict[str, dict[str, Parameters]] = json.loads(Path(__file__).with_name("found.json").read_text(encoding="ascii"))
ONE_LIGHT = "one light"


def title(name: str) -> str:
    """Return an effect's title with the version of its package."""
    text, package, _ = EFFECTS[name]
    if package == CRATE:
        return f"{text} {CRATE_VERSION}"
    manifests = [json.loads((folder / "package.json").read_bytes()) for folder in FOLDERS]
    pins = [manifest.get(kind, {}) for manifest in manifests for kind in ("dependencies", "devDependencies")]
    return f"{text} {next(pin[package] for pin in pins if package in pin)}"


def documented(camera: Camera, shape: tuple[int, int]) -> dict[str, Parameters]:
    """Return the parameters that each effect's documentation asks for with a lens, where a search begins.

    shape  (H, W) of the image
    """
    (height, width), focus, focal = shape, camera.focus_distance, camera.focal_length
    scale = focal * camera.aperture_diameter / camera.sensor_height
    radius = 0.5 * scale / (focus - focal)  # of the circle of confusion at infinity, fraction of the image height
    # the slope matches the lens at the focus, the limit matches it at infinity; 1 is 0.4 image widths
    maxblur = radius * height / (0.4 * width)
    # distance from the focus at which smoothstep is 1, metres: half of the far blur is where the lens has it
    reach = 2 * focus
    lens = {"focusDistance": 1000 * focus, "focalLength": 1000 * focal, "lensSize": 1000 * focal}
    quality = {"nearBlur": True, "blurRings": 4, "blurRingPoints": 5, "highQuality": True}
    bevy = {"focalDistance": focus, "focalLength": focal, "scale": scale, "maxDiameter": 64.0, "maxDepth": 1000000}
    pixels = {"focusDistance": focus, "bokehScale": radius * height}
    return {
        "BokehPass": {"focus": focus, "aperture": maxblur / focus, "maxblur": maxblur},
        "DepthOfFieldNode": pixels | {"focalLength": reach},
        "DepthOfFieldEffect": pixels | {"focusRange": reach, "resolutionScale": 0.5},
        "Babylon": lens | {"fStop": focal / camera.aperture_diameter, "blurLevel": 2},
        # its pixels refer to an image of 540 rows
        "CameraFrame": {"focusDistance": focus, "focusRange": reach, "blurRadius": radius * 540} | quality,
        "BevyBokeh": bevy,
        "BevyGaussian": bevy,
    }


@cache
@locks.held("crate")
def crate() -> Path:
    """Return the folder of Bevy's crate, downloaded on first use. Raises Unavailable, RuntimeError."""
    cargo = shutil.which("cargo") or shutil.which("cargo", path=str(Path.home() / ".cargo/bin"))
    if cargo is None:
        raise Unavailable("cargo, for Bevy's effects; https://rustup.rs, or name others by --effect")
    folder = paths.ensured(paths.cache_folder() / "engines" / "peers" / f"crate-{CRATE_VERSION}")
    (folder / "Cargo.toml").write_text(MANIFEST, encoding="ascii")
    (folder / "empty.rs").touch()
    process.run([cargo, "fetch", "--quiet", "--target", TARGET], LIMIT, folder)
    home = Path(os.environ.get("CARGO_HOME") or Path.home() / ".cargo")
    return next(home.glob(f"registry/src/*/{CRATE}-{CRATE_VERSION}"))


class Page(browser.Session):
    """Open a page in which effects draw a scene; a context manager."""

    def __init__(self, effects: list[str]):
        """Open the page with these effects. Raises Unavailable."""
        own = [("browser/", browser.PAGE), ("polygonal-bokeh/", WEB), ("", PAGE)]
        places = [*own, *(("", pages.installed(folder)) for folder in FOLDERS)]
        if any(EFFECTS[name][1] == CRATE for name in effects):
            places.insert(0, (f"{CRATE}/", crate()))
        super().__init__(places=places, limit=LIMIT)

    def load(self, color: np.ndarray, depth: np.ndarray, camera: Camera) -> None:
        """Set the scene: linear HDR colour (H, W, >= 3) and depth in metres (H, W), seen by a camera."""
        rgba = np.ones((*depth.shape, 4), np.float16)
        rgba[..., :3] = color[..., :3]
        scene = {"color": packed(Image.of("", rgba)), "depth": packed(Image.of("", depth.astype(np.float32)))}
        scene |= {"near": 0.5 * float(depth.min()), "far": 1.01 * float(depth.max())}
        self.call("load", scene | {"fovy": 2 * math.atan(0.5 * camera.sensor_height / camera.focal_length)})

    def draw(self, effect: str, parameters: Parameters) -> np.ndarray:
        """Draw the scene with an effect, (H, W, 4) float32."""
        return unpacked(self.call("draw", {"name": effect, "parameters": parameters}), "float")

    def time(self, effect: str, parameters: Parameters) -> tuple[float, float]:
        """Return the milliseconds of a frame without the effect, and of one with it; WebGL 2 only."""
        without, drawn = self.call("time", {"name": effect, "parameters": parameters})
        return without, drawn

    def device(self, effect: str) -> str:
        """Return the name of the device that draws an effect; WebGL 2 only."""
        return self.call("device", effect)
