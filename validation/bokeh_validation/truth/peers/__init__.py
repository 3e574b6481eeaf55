"""Other depth-of-field effects on the scenes with a truth, in headless Chromium on WebGL 2."""

import base64
import json
import math
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from bokeh_validation import browser, paths
from bokeh_validation.engines import pages
from bokeh_validation.truth.peers import crate
from bokeh_validation.truth.peers.effects import EFFECTS, Parameters

PAGE = Path(__file__).parent / "page"
LIMIT = 240.0


def installed() -> Path:
    """node_modules with three.js and postprocessing. Raises Unavailable, RuntimeError."""
    return pages.installed(Path(__file__).parent)


def versions(modules: Iterable[Path], effects: Iterable[str]) -> dict[str, str]:
    """Package -> version, of those that effects are in, as they are installed in one of some node_modules."""
    found = {crate.NAME: crate.VERSION}
    for package in {EFFECTS[effect].package for effect in effects} - {crate.NAME}:
        file = next(folder / package / "package.json" for folder in modules if (folder / package).is_dir())
        found[package] = json.loads(file.read_text(encoding="utf-8"))["version"]
    return found


class Peers:
    """A page in which all peers draw the same scene."""

    def __init__(self):
        """Raises Unavailable."""
        self.modules = [
            installed(),
            *(pages.installed(paths.ROOT / "integration" / engine) for engine in ("babylonjs", "playcanvas")),
        ]
        self.said: list[str] = []
        self.session = browser.Session(open_page=self._open)

    def _open(self, chromium):
        page = chromium.new_page()
        page.route("**/*", self._serve)
        page.on("console", lambda message: self.said.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: self.said.append(error.message))
        page.goto(browser.ADDRESS)
        page.wait_for_function("window.bokeh !== undefined")
        return page

    def _serve(self, route) -> None:
        name = browser.asked(route) or "index.html"
        places = [PAGE / name, *(folder / name for folder in self.modules)]
        if name.startswith(crate.NAME):
            places = [crate.source() / name.removeprefix(f"{crate.NAME}/")]
        if name.startswith("browser/"):
            places = [browser.PAGE / name.removeprefix("browser/")]
        browser.answer(route, next((file for file in places if file.is_file()), places[0]))

    def load(self, color: np.ndarray, depth: np.ndarray, camera) -> None:
        """Hand over linear HDR colour (H, W, >= 3) and depth in metres (H, W), seen by a camera."""
        height, width = depth.shape
        rgba = np.ones((height, width, 4), np.float16)
        rgba[..., :3] = color[..., :3]
        given = {"width": width, "height": height, "color": _packed(rgba), "depth": _packed(depth.astype(np.float32))}
        given |= {"near": 0.5 * float(depth.min()), "far": 1.01 * float(depth.max())}
        lens = {"aperture": camera.aperture_diameter, "focal": camera.focal_length, "focus": camera.focus_distance}
        given["camera"] = lens | {"sensor": camera.sensor_height}
        self._call("load", given | {"fovy": 2 * math.atan(0.5 * camera.sensor_height / camera.focal_length)})
        self.shape = (height, width, 4)

    def grid(self, name: str) -> list[Parameters]:
        """What is tried of an effect on the scene, what its documentation asks for first."""
        return list(EFFECTS[name].grid(self.documented(name)))

    def documented(self, name: str) -> Parameters:
        """What an effect's documentation asks for, for the scene's lens."""
        return self._call("mapped", name)

    def draw(self, name: str, parameters: dict) -> np.ndarray:
        """What a peer makes of the scene, (H, W, 4)."""
        found = self._call("draw", {"name": name, "parameters": parameters})
        kind = np.float16 if found["half"] else np.float32
        return np.frombuffer(base64.b64decode(found["data"]), kind).reshape(self.shape)

    def draws(self, name: str, parameters: dict) -> list[dict]:
        """The draws of a frame, for counted.fetches()."""
        return self._call("draws", {"name": name, "parameters": parameters})

    def add(self, name: str, job: dict) -> None:
        """Passes of ours, as drivers.web has them, to be timed beside the effects."""
        self._call("add", {"name": name, "job": job})

    def time(self, asked: dict[str, dict], rounds: int) -> list[list[float]]:
        """Milliseconds of a frame of each, drawn in turn; asked: name -> parameters."""
        listed = [{"name": name, "parameters": parameters} for name, parameters in asked.items()]
        return self._call("time", {"peers": listed, "rounds": rounds})

    def versions(self) -> dict[str, str]:
        """Of the effects' packages."""
        return versions(self.modules, EFFECTS)

    def close(self) -> None:
        """End the browser."""
        self.session.close()

    def _call(self, function: str, argument: object):
        try:
            return self.session.call(function, argument, LIMIT)
        except RuntimeError as error:
            raise RuntimeError("\n".join([str(error), *self.said[:4]])) from error


def _packed(pixels: np.ndarray) -> str:
    return base64.b64encode(np.ascontiguousarray(pixels).tobytes()).decode("ascii")
