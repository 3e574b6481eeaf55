"""What a sample leaves in a folder: the engine's colour and depth, and its results, as the shaders saw them.

capture.json beside raw little-endian files, rows from v = 0 (the first row in memory) on:

    {"engine": "three.js 0.187, WebGL 2", "device": "SwiftShader ...", "width": 320, "height": 240,
     "color": "color.f16",            (H, W, 4) float16: what CoCMap reads
     "depth": "depth.f32",            (H, W) float32: metres, what the CoC map and the paper's passes read
     "camera": {"aperture_diameter": 0.05, "focal_length": 0.05, "focus_distance": 5.0, "sensor_height": 0.024,
                "max_coc": 0.1},
     "shots": [{"name": "exact-hexagon", "method": "exact", "aperture": "hexagon", "result": "exact-hexagon.f16",
                "spacing": 1.0, "max_samples": 33, "targets": true}, ...]}

Keys of a shot beside name and result are fields of methods.Settings; what is left out has its default there. Each shot
may have a camera, color and depth of its own in place of the common ones.
"""

import json
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from bokeh_validation import methods, metrics
from bokeh_validation.patterns.model import Case, expected
from bokeh_validation.reference.images import Image

# Devices whose texture filter is float32-exact and whose sin and cos are too; all others are judged as GPUs.
SOFTWARE = ("llvmpipe", "softpipe")
_SETTINGS = {field.name for field in fields(methods.Settings)} - {"camera"}


class Broken(Exception):
    """A capture that is not one: what is wrong, in one line."""


@dataclass(frozen=True)
class Shot:
    """One result, with what went in.

    result    (H, W, 4) float16
    expected  the reference's, with its interval, and how far the result is from it
    rounding  how the engine's targets round, 'nearest' or 'zero': the one that fits, since engines do not say
    """

    name: str
    case: Case
    result: np.ndarray
    expected: Image
    comparison: metrics.Comparison
    rounding: str


@dataclass(frozen=True)
class Capture:
    """A sample's run."""

    engine: str
    device: str
    shots: list[Shot]

    @property
    def ok(self) -> bool:
        """All of them."""
        return bool(self.shots) and all(shot.comparison.ok for shot in self.shots)


def read(folder: Path) -> Capture:
    """Read a folder and compare every shot with the reference. Raises Broken."""
    try:
        data = json.loads((folder / "capture.json").read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise Broken(f"{folder / 'capture.json'}: {error}") from error
    try:
        shots = [_shot(folder, data, {**data, **shot}) for shot in data["shots"]]
        return Capture(data["engine"], data["device"], shots)
    except KeyError as error:
        raise Broken(f"{folder / 'capture.json'}: no {error}") from error


def _shot(folder: Path, data: dict, shot: dict) -> Shot:
    size = (int(shot["width"]), int(shot["height"]))
    color = _pixels(folder / shot["color"], np.float16, (*size[::-1], 4))
    depth = _pixels(folder / shot["depth"], np.float32, size[::-1])
    result = _pixels(folder / shot["result"], np.float16, (*size[::-1], 4))
    chosen = {key: value for key, value in shot.items() if key in _SETTINGS}
    settings = methods.Settings(**chosen, camera=methods.Camera(**shot["camera"]))
    case = Case(f"{data['engine']}: {shot['name']}", settings, color, depth, tone_map=True)
    software = any(word in data["device"].lower() for word in SOFTWARE)
    found = {}
    # Mesa's targets cut off, the others that are here round to nearest: the likely one first
    for rounding in ("zero", "nearest") if software else ("nearest", "zero"):
        wanted = expected(case, software, rounding)["result"]
        # by the interval alone: a scene of hard edges leaves more comparisons open than the bounds in steps allow for
        found[rounding] = (metrics.compare(result, wanted, False), wanted)
        if found[rounding][0].outside == 0:
            break
    nearer = min(found, key=lambda name: (found[name][0].outside, -found[name][0].close))
    comparison, wanted = found[nearer]
    return Shot(shot["name"], case, result, wanted, comparison, nearer)


def _pixels(path: Path, dtype: type, shape: tuple[int, ...]) -> np.ndarray:
    try:
        values = np.fromfile(path, dtype)
    except OSError as error:
        raise Broken(f"{path}: {error.strerror}") from error
    if values.size != np.prod(shape):
        raise Broken(f"{path}: {values.size} values, {np.prod(shape)} were announced")
    pixels = values.reshape(shape)
    if not np.isfinite(pixels).all():
        raise Broken(f"{path}: NaN or infinite values")
    return pixels
