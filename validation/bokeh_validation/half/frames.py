"""Whole passes in NumPy from the shaders' own GLSL, on a real image in the corner of a 4K frame."""

from collections.abc import Mapping, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np

from bokeh_validation import exr, metrics, paths
from bokeh_validation.frame import methods
from bokeh_validation.half.interpreter import ALL_FLOAT, Choice, Evaluator
from bokeh_validation.reference import images, sampling
from bokeh_validation.shaders.passes import SLOTS, Pass

RESULTS = ("BokehResult", "BokehResultB", "BokehResultC", "BokehResultD")
SCENE = "street_11"
# Lamps and sky behind a near edge. The lamps are 42 as stored, 16800 at this exposure: four exceed a half float.
LEFT, TOP = 376, 128
EXPOSURE = 400.0
FRAME = (3840, 2160)
# wide enough for a CoC of up to 0.09, nearly MaxCoC
CAMERA = methods.Camera(aperture_diameter=0.1)
SIZE = (160, 120)

METHODS = {
    "paper": methods.Settings("paper", "hexagon", camera=CAMERA),
    "paper, adaptive": methods.Settings("paper", "star", spacing=1.0, max_samples=17, jitter=0.5, camera=CAMERA),
    "exact": methods.Settings("exact", "hexagon", spacing=1.0, max_samples=17, jitter=0.5, camera=CAMERA),
    "exact, one target": methods.Settings("exact", "octagon", targets=False, samples=4, camera=CAMERA),
    "naive": methods.Settings("naive", "hexagon", samples=5, camera=CAMERA),
    "naive-grid": methods.Settings("naive-grid", "square", samples=4, camera=CAMERA),
}

# of every filtered read in its order: (N, 2) texels from the image's corner, and (N,) for which pixels it was made
Places = list[tuple[np.ndarray, np.ndarray]]


class Outcome(NamedTuple):
    """A method with some variables half, against all of them float.

    psnr   tone-mapped, dB; lost pixels are taken for the largest half float
    moved  largest displacement of a sample, pixels of the frame
    lost   share of the pixels that are not finite
    """

    psnr: float
    moved: float
    lost: float


def outcome(
    method: str,
    choice: Choice = ALL_FLOAT,
    exposure: float = EXPOSURE,
    storage: str = "half",
    wanted: str | None = "half",
) -> Outcome:
    """One of METHODS with a choice of half variables and of targets, against float32 with the targets `wanted`."""
    truth, before = _method(method, exposure, wanted)
    result, after = _run(method, exposure, choice, storage)
    finite = np.isfinite(result)
    shown = np.where(finite, result, np.finfo(np.float16).max)
    psnr = metrics.psnr(shown / exposure, truth / exposure)
    return Outcome(psnr, _moved(before, after), float(1.0 - finite.all(axis=-1).mean()))


@cache
def _method(method: str, exposure: float, storage: str | None) -> tuple[np.ndarray, Places]:
    return _run(method, exposure, ALL_FLOAT, storage)


def _run(method: str, exposure: float, choice: Choice, storage: str | None):
    scene = exr.read(paths.SCENES / f"{SCENE}_pin.exr")
    part = slice(TOP, TOP + SIZE[1]), slice(LEFT, LEFT + SIZE[0])
    color = scene.color[part] * np.float32([exposure, exposure, exposure, 1.0])
    plan = methods.plan(METHODS[method], FRAME)
    textures = {"color": color, "depth": scene.depth[part], **plan.tables}
    return run(plan.passes, textures, SIZE, np.float32, choice, storage, frame=FRAME)


def _moved(before: Places, after: Places) -> float:
    """Largest distance between the same sample of both, where both have it; infinite where it went nowhere."""
    worst = 0.0
    for (a, in_a), (b, in_b) in zip(before, after, strict=False):
        distance = np.abs(a - b)[in_a & in_b].max(initial=0.0)
        worst = max(worst, float(distance) if np.isfinite(distance) else np.inf)
    return worst


def run(
    passes: Sequence[Pass],
    textures: Mapping[str, np.ndarray],
    size: tuple[int, int],
    wide: type,
    choice: Choice = ALL_FLOAT,
    storage: str | None = None,
    rounding: str = "nearest",
    frame: tuple[int, int] | None = None,
) -> tuple[np.ndarray, Places]:
    """The result of passes and the places that they read.

    `storage` as of stored(); None keeps what the shader wrote. The image lies in the last corner of `frame`, whose
    uv it has.
    """
    # three axes and float64, as sampling.py takes them
    live = {name: np.atleast_3d(pixels).astype(np.float64) for name, pixels in textures.items()}
    (width, height), (columns, rows) = size, frame or size
    origin, extent = np.array([columns - width, rows - height]), np.array([columns, rows])
    y, x = np.mgrid[0:height, 0:width]
    # the rasteriser makes uv in float32; the shader may take it as half
    uv = ((np.stack([x.ravel(), y.ravel()], axis=1) + 0.5 + origin) / extent).astype(wide)
    places: Places = []

    def fetch(kind: str, texture: str, at, mask) -> np.ndarray:
        image = live[texture]
        if kind == "BokehFetchTable":
            return image[0, np.minimum(np.atleast_1d(at).ravel(), image.shape[1] - 1)]
        place = np.asarray(at, np.float64) * extent - origin
        if kind == "BokehFetch":
            places.append((place.astype(np.float32), np.broadcast_to(np.asarray(mask).ravel(), len(place))))
        # what is not finite reads the first texel, as any place would do
        x, y = np.where(np.isfinite(place), place, 0.0).T
        if kind == "BokehFetchNearest":
            return image.reshape(-1, image.shape[2])[sampling.nearest_index(x, y, image.shape[1::-1])]
        return sampling.bilinear(image, x, y)

    for item in passes:
        bound = {f"Bokeh{slot}": item.inputs.get(slot, "nothing") for slot in SLOTS}
        given = {**item.constants, **item.given(), "BokehUV": uv, **bound}
        written = Evaluator(wide, choice, given, fetch).main(item.entry)
        for name, target in zip(item.outputs, RESULTS, strict=False):
            pixels = np.broadcast_to(written[target].astype(np.float64), (height * width, 4))
            live[name] = stored(pixels.reshape(height, width, 4), storage, rounding)
    return live["result"], places


def stored(written: np.ndarray, storage: str | None, rounding: str = "nearest") -> np.ndarray:
    """What a target keeps of (H, W, 4): 'half', 'r11g11b10' or 'rgba8', as float64; None: all of it."""
    if storage is None:
        return written
    if storage == "rgba8":
        return np.rint(np.clip(written, 0.0, 1.0) * 255.0) / 255.0
    with np.errstate(over="ignore"):
        result = images.rounded(written, np.float16, rounding).astype(np.float64)
    if storage == "r11g11b10":
        # no sign, 5 bits of exponent as a half float, 6, 6 and 5 of mantissa; the CoC is kept apart
        for channel, bits in enumerate((6, 6, 5)):
            mantissa, exponent = np.frexp(np.maximum(result[..., channel], 0.0))
            result[..., channel] = np.ldexp(np.rint(mantissa * 2 ** (bits + 1)) / 2 ** (bits + 1), exponent)
    return result
