"""Whole passes as a driver runs them, on emulated numbers; and a small image standing in a large frame."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bokeh_validation.drivers.base import Textures
from bokeh_validation.half.evaluate import Choice, Evaluator
from bokeh_validation.half.numbers import Rounded
from bokeh_validation.passes import SLOTS, Pass
from bokeh_validation.reference import images, sampling

RESULTS = ("BokehResult", "BokehResultB", "BokehResultC", "BokehResultD")


@dataclass(frozen=True)
class Window:
    """Where the image that is computed lies in the frame that uv counts.

    frame   (width, height) of the frame, pixels
    origin  (column, row) of the image's first pixel in it
    """

    frame: tuple[int, int]
    origin: tuple[int, int] = (0, 0)


@dataclass(frozen=True)
class Place:
    """Where one filtered read went.

    texels  (N, 2) float32, from the image's corner
    counts  (N,): for which pixels it was made
    """

    texels: np.ndarray
    counts: np.ndarray


class Emulator:
    """Passes in NumPy from the shaders' own GLSL.

    numbers  precision of the two types
    choice   what is half
    window   the image's place in the frame; None: it is the frame
    places   of the filtered reads, by the first output of their pass, in their order
    """

    def __init__(self, numbers: Rounded, choice: Choice, window: Window | None = None):
        self.numbers, self.choice, self.window = numbers, choice, window
        self.places: dict[str, list[Place]] = {}

    def run(
        self,
        passes: Sequence[Pass],
        textures: Textures,
        size: tuple[int, int],
        storage: str | None = None,
        keep: Iterable[str] = ("result",),
        rounding: str = "nearest",
    ) -> dict[str, np.ndarray]:
        """As drivers.base.Driver.run; `storage` is one of STORED, None keeps what the shader wrote."""
        # three axes and float64, as sampling.py takes them
        live = {name: np.atleast_3d(pixels).astype(np.float64) for name, pixels in textures.items()}
        for item in passes:
            for name, written in zip(item.outputs, self._pass(item, live, size), strict=True):
                live[name] = stored(written, storage, rounding)
        return {name: live[name] for name in keep}

    def _pass(self, item: Pass, live: Mapping[str, np.ndarray], size: tuple[int, int]) -> list[np.ndarray]:
        width, height = size
        window = self.window or Window(size)
        y, x = np.mgrid[0:height, 0:width]
        # the rasteriser makes uv in float32; the shader may take it as half
        uv = np.stack([x.ravel(), y.ravel()], axis=1) + 0.5 + np.array(window.origin)
        uv = (uv / np.array(window.frame)).astype(self.numbers.types["float"])
        bound = {f"Bokeh{slot}": item.inputs.get(slot, "nothing") for slot in SLOTS}
        places = self.places[item.outputs[0]] = []

        def fetch(kind: str, texture: str, at, mask) -> np.ndarray:
            image = live[texture]
            if kind == "BokehFetchTable":
                return image[0, np.minimum(np.atleast_1d(at).ravel(), image.shape[1] - 1)]
            place = self.numbers.values(at) * np.array(window.frame) - np.array(window.origin)
            if kind == "BokehFetch":
                counts = np.broadcast_to(np.asarray(mask).ravel(), len(place))
                places.append(Place(place.astype(np.float32), counts))
            return _read(image, place, kind == "BokehFetchNearest")

        constants = {**item.constants, **item.given(), "BokehUV": uv, **bound}
        written = Evaluator(self.numbers, self.choice, constants, fetch).main(item.entry)
        shape = (height, width, 4)
        return [
            np.broadcast_to(self.numbers.values(written[name]), (height * width, 4)).reshape(shape)
            for name in RESULTS[: len(item.outputs)]
        ]


def _read(image: np.ndarray, place: np.ndarray, nearest: bool) -> np.ndarray:
    """Texels (N, channels) at places (N, 2); what is not finite reads the first texel, as any place would do."""
    x, y = np.where(np.isfinite(place), place, 0.0).T
    if nearest:
        return image.reshape(-1, image.shape[2])[sampling.nearest_index(x, y, image.shape[1::-1])]
    return sampling.bilinear(image, x, y)


def stored(written: np.ndarray, storage: str | None, rounding: str = "nearest") -> np.ndarray:
    """What a target keeps of (H, W, 4), as float64."""
    if storage is None:
        return written
    return STORED[storage](written, rounding)


def _half(written: np.ndarray, rounding: str) -> np.ndarray:
    with np.errstate(over="ignore"):
        return images.rounded(written, np.float16, rounding).astype(np.float64)


def _small_floats(written: np.ndarray, rounding: str) -> np.ndarray:
    """R11G11B10F: no sign, 5 bits of exponent as a half float, 6, 6 and 5 of mantissa; here the CoC is kept apart."""
    result = _half(written, rounding)
    for channel, bits in enumerate((6, 6, 5)):
        mantissa, exponent = np.frexp(np.maximum(result[..., channel], 0.0))
        result[..., channel] = np.ldexp(np.rint(mantissa * 2 ** (bits + 1)) / 2 ** (bits + 1), exponent)
    return result


def _bytes(written: np.ndarray, rounding: str) -> np.ndarray:
    """RGBA8."""
    del rounding
    return np.rint(np.clip(written, 0.0, 1.0) * 255.0) / 255.0


STORED = {"half": _half, "r11g11b10": _small_floats, "rgba8": _bytes}
