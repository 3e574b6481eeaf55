"""Read what a sample leaves in a folder: the engine's colour and depth and its results, as the shaders saw them.

capture.json is next to raw little-endian files, whose rows start at v = 0 (the first row in memory):

    {"engine": "three.js 0.187, WebGL 2", "device": "SwiftShader ...", "width": 320, "height": 240,
     "color": "color.f16",            (H, W, 4) float16: what the CoC map reads
     "depth": "depth.f32",            (H, W) float32: metres, or the engine's depth buffer, as "stored" says
     "stored": {"kind": 1, "near": 0.1, "far": 100.0},
                                      how BokehSignedCoCMap reads it; left out, or null, for paper
     "camera": {"aperture_diameter": 0.05, "focal_length": 0.05, "focus_distance": 5.0, "sensor_height": 0.024,
                "max_coc": 0.1},
     "shots": [{"name": "exact-hexagon", "method": "exact", "aperture": "hexagon", "result": "exact-hexagon.f16",
                "use_mrt": true}, ...]}

All keys of a shot except name and result are fields of methods.Settings; fields that are left out have their defaults.
A shot may have its own camera, color, depth and stored, which override the common ones.

"clockwise" is the sample's own setting of the rotation, in degrees. It must rotate the polygon clockwise on the screen,
whichever way v grows there. The sample does not say which way that is: the ground of its scene does, because on the
screen it is near at the bottom and far at the top.

"focus" of a shot has fields of methods.Focus, as [in front of the focus, behind it].

"constants" has the constants of layered that the sample's language fixes, if there are any.

"pull" records the autofocus, for the tests:

    "pull": {"frame": 0.0333, "seconds": 0.2, "from": metres, "points": [[u, v, metres], ...], "distances": [...]}

frame is the duration of a frame and seconds the time constant; points are positions on the screen with the depth found
there ("depths" alone if the sample focuses on positions in the world); from is the focus distance before the first
frame (else the camera's), distances those after each frame.

A shot may have "written": "layered-hexagon.written", a file of all targets that its passes wrote, (h, w, 4) float16
each, in the order of docs/reference/passes.md; a layered shot must. It is then compared pass by pass, each with the
device's own inputs, because a sample cannot be asked to draw a single pass of a frame.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from math import prod
from pathlib import Path

import numpy as np

from bokeh_validation import metrics, plan
from bokeh_validation.drivers.base import precision_of, software_device
from bokeh_validation.frame import methods
from bokeh_validation.numerics.images import Image
from bokeh_validation.numerics.precision import Precision
from bokeh_validation.probes.model import Case
from bokeh_validation.reference import listings, pass_images
from bokeh_validation.shaders.passes import Pass, target_size

_SETTINGS = {item.name for item in fields(methods.Settings)} - {"camera"}


class Broken(Exception):
    """Report an invalid capture. The text says in one line what is wrong with it."""


@dataclass(frozen=True)
class Shot:
    """Hold one result with its inputs.

    case        its depth is in metres
    result      (H, W, 4) float16
    expected    the reference's, with its interval
    comparison  of the result with the reference; its `outside` includes the pixels of all targets
    outside     for a shot with all targets: target -> number of pixels outside its interval, where there are any
    """

    name: str
    case: Case
    result: np.ndarray
    expected: Image
    comparison: metrics.Comparison
    outside: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True)
class Capture:
    """Hold the results of a sample's run."""

    engine: str
    device: str
    shots: list[Shot]


def read(folder: Path, file: str = "capture.json") -> Capture:
    """Read a folder and compare every shot with the reference; `file` describes them. Raises Broken."""
    try:
        data = json.loads((folder / file).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise Broken(f"{folder / file}: {error}") from error
    try:
        shots = [_shot(folder, data, {**data, **shot}) for shot in data["shots"]]
        return Capture(data["engine"], data["device"], shots)
    except KeyError as error:
        raise Broken(f"{folder / file}: no {error}") from error


def _shot(folder: Path, data: dict, shot: dict) -> Shot:
    size = (int(shot["width"]), int(shot["height"]))
    shape = (*size[::-1], 4)
    color = _pixels(folder / shot["color"], np.float16, shape)
    depth = _pixels(folder / shot["depth"], np.float32, shape[:2])
    stored = {"kind": 0, "near": 0.0, "far": 0.0} | (shot.get("stored") or {})
    metres = listings.linear_depth(depth.astype(np.float64), **stored).astype(np.float32)
    given_settings = {key: value for key, value in shot.items() if key in _SETTINGS}
    if "clockwise" in shot:
        given_settings["rotation"] = shot["clockwise"] if _v_grows_downwards(folder, metres) else -shot["clockwise"]
    if "focus" in shot:
        given_settings["focus"] = methods.Focus(**{key: tuple(pair) for key, pair in shot["focus"].items()})
    settings = methods.Settings(**given_settings, camera=methods.Camera(**shot["camera"]))
    case = Case(f"{data['engine']}: {shot['name']}", settings, color, metres)
    result = _pixels(folder / shot["result"], np.float16, shape)
    outputs = _written(folder / shot["written"], case) if settings.method == "layered" or "written" in shot else {}
    outputs["result"] = result
    textures = case.textures() | {"depth": depth}
    passes = [_of_buffer(render_pass, **stored) for render_pass in case.plan.passes]
    # Engines do not say how their targets round, so the rounding that fits is used. Mesa's targets truncate, all
    # others here round to nearest; the likely one is tried first.
    roundings = ("zero", "nearest") if software_device(data["device"]) == "Mesa" else ("nearest", "zero")
    precision = replace(precision_of(data["device"]), constants=tuple(data.get("constants", {}).items()))
    attempts = []
    for rounding in roundings:
        attempts.append(_compared(shot["name"], case, passes, textures, outputs, precision, rounding))
        if attempts[-1].comparison.outside == 0:
            break
    return min(attempts, key=lambda attempt: (attempt.comparison.outside, -attempt.comparison.close))


def _v_grows_downwards(folder: Path, metres: np.ndarray) -> bool:
    """Return whether the first rows are at the top of the screen, where the ground is farther away. Raises Broken.

    metres  (H, W), v = 0 first
    """
    third = len(metres) // 3
    first, last = (np.median(1.0 / rows) for rows in (metres[:third], metres[-third:]))
    if max(first, last) < 2.0 * min(first, last):
        raise Broken(f"{folder / 'capture.json'}: the depth does not show where the ground is")
    return bool(last > first)


def _of_buffer(render_pass: Pass, kind: int, near: float, far: float) -> Pass:
    """Return a pass with the parameters that describe the depth buffer, if it reads that."""
    if render_pass.entry != plan.SIGNED_MAP:
        return render_pass
    buffer_parameters = {"BokehDepthKind": float(kind), "BokehNear": near, "BokehFar": far}
    return replace(render_pass, parameters={**render_pass.parameters, **buffer_parameters})


def _compared(
    name: str,
    case: Case,
    passes: Sequence[Pass],
    textures: Mapping[str, np.ndarray],
    outputs: Mapping[str, np.ndarray],
    precision: Precision,
    rounding: str,
) -> Shot:
    # compared pass by pass, from the device's own inputs, where they are known
    device_targets = outputs if len(outputs) > 1 else None
    reference = pass_images.images(passes, textures, case.size, "half", precision, rounding, given=device_targets)
    # only the interval applies: in a scene with hard edges more comparisons are open than the bounds in steps allow
    comparisons = {key: metrics.compare(pixels, reference[key], False) for key, pixels in outputs.items()}
    outside = {key: comparison.outside for key, comparison in comparisons.items() if comparison.outside}
    total = replace(comparisons["result"], outside=sum(outside.values()))
    return Shot(name, case, outputs["result"], reference["result"], total, outside)


def _written(path: Path, case: Case) -> dict[str, np.ndarray]:
    """Read name -> pixels of all targets of a shot. Raises Broken."""
    shapes = {
        target: (*target_size(render_pass.scale, case.size)[::-1], 4)
        for render_pass in case.plan.passes
        for target in render_pass.outputs
    }
    ends = np.cumsum([prod(shape) for shape in shapes.values()])
    pieces = np.split(_pixels(path, np.float16, (ends[-1],)), ends[:-1])
    return {name: piece.reshape(shape) for (name, shape), piece in zip(shapes.items(), pieces, strict=True)}


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
