"""OpenEXR in and out: colour and depth in, colour and CoC out. Every refusal is a UserError of one line."""

import contextlib
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenEXR

from bokeh_validation import files
from bokeh_validation.errors import UserError

# Four channels of the largest texture of common devices: the library unpacks every channel of the file.
MAX_VALUES = 4 * 16384 * 16384


@dataclass(frozen=True)
class Scene:
    """An image with depth.

    color     (H, W, 4), float16 where R, G and B are half floats in the file, else float32; alpha is 1
    depth     (H, W) float32, metres along the view axis; 1 where none was asked for
    """

    color: np.ndarray
    depth: np.ndarray

    @property
    def size(self) -> tuple[int, int]:
        """(width, height)"""
        return self.color.shape[1], self.color.shape[0]

    @property
    def storage(self) -> str:
        """Target format that keeps what the file has: 'half' or 'float'."""
        return "half" if self.color.dtype == np.float16 else "float"


def read(path: Path, depth_channel: str | None = "Z", layer: str | None = None) -> Scene:
    """Read R, G, B, or LAYER.R, LAYER.G, LAYER.B, and a depth channel; `depth_channel=None` reads no depth.

    Raises UserError for a missing, broken, deep or empty file, one that is cropped or too large, missing channels, and
    for values that no scene has: NaN or infinite colour, NaN depth. Infinite depth is a sky.
    """
    try:
        return _scene(path, depth_channel, layer)
    except UserError as error:
        raise UserError(f"{path}: {error}") from error
    except Exception as error:
        # what the library throws, more pixels than there is room for, a channel's name that is no text
        reason = _printable(f"{type(error).__name__}: {error}".replace(f"{path}: ", ""))
        raise UserError(f"{path}: cannot be read as OpenEXR ({reason}). Save it again as OpenEXR.") from error


def _scene(path: Path, depth_channel: str | None, layer: str | None) -> Scene:
    # a pipe would wait for its writer
    if not os.path.isfile(path):
        raise UserError("no such file, or a folder, a pipe or a device. Name an EXR file.")
    headers = _parts(path, header_only=True)
    for part in headers:
        low, high = part.header["dataWindow"]
        width, height = (int(last) - int(first) + 1 for first, last in zip(low, high, strict=True))
        if min(width, height) <= 0 or width * height * len(part.header["channels"]) > MAX_VALUES:
            raise UserError(f"{width} x {height} pixels are none, or too many with all channels. Crop or scale it.")
        if part.header["type"] in (OpenEXR.deepscanline, OpenEXR.deeptile):
            raise UserError("is a deep image, with many samples in a pixel. Save it flattened.")
    prefix = f"{layer}." if layer else ""
    places = [_place(headers, prefix + letter, "channel", "Name its layer or part with --layer.") for letter in "RGB"]
    if depth_channel is not None:
        places.append(_place(headers, depth_channel, "depth channel", "Name one with --depth-channel, or give --coc."))
    parts = _parts(path, header_only=False)
    # the library leaves out parts that it cannot decode
    if len(parts) != len(headers):
        raise ValueError("not all of its pixels can be decoded")
    planes = [_plane(parts[index], name, is_depth=k == 3) for k, (index, name) in enumerate(places)]
    opaque = np.ones_like(planes[0])
    return Scene(np.stack([*planes[:3], opaque], axis=-1), [*planes, opaque][3].astype(np.float32))


def _parts(path: Path, header_only: bool) -> list[OpenEXR.Part]:
    """All parts. What the library prints, in C to descriptor 2 and through Python, is dropped: an error says it too."""
    kept = os.dup(2)
    with open(os.devnull, "w") as nowhere, contextlib.redirect_stdout(nowhere):
        os.dup2(nowhere.fileno(), 2)
        try:
            return OpenEXR.File(str(path), separate_channels=True, header_only=header_only).parts
        finally:
            os.dup2(kept, 2)
            os.close(kept)


def _place(parts: list[OpenEXR.Part], name: str, what: str, advice: str) -> tuple[int, str]:
    """The part and the channel in it that NAME means, if only one part has such a channel, or PART.NAME."""
    places: dict[str, list[tuple[int, str]]] = {}
    for index, part in enumerate(parts):
        for channel in part.header["channels"]:
            for known in dict.fromkeys((channel.name, f"{part.name()}.{channel.name}".removeprefix("."))):
                places.setdefault(known, []).append((index, channel.name))
    if len(places.get(name, ())) == 1:
        return places[name][0]
    problem = "several parts have" if name in places else "no"
    raise UserError(f"{problem} {what} {name!r} (it has {_printable(' '.join(places))}). {advice}")


def _plane(part: OpenEXR.Part, name: str, is_depth: bool) -> np.ndarray:
    """(H, W) half or float, of the whole picture: the circle of confusion is a fraction of its height."""
    pixels = part.channels[name].pixels
    data, display = (np.array(part.header[window]) for window in ("dataWindow", "displayWindow"))
    if not np.array_equal(data, display) or pixels.shape != tuple(data[1] - data[0] + 1)[::-1]:
        windows = f"{pixels.shape[1]} x {pixels.shape[0]} pixels, data window {data.tolist()}"
        advice = "Save the whole picture, without overscan or subsampling."
        raise UserError(f"channel {name!r} is not its display window {display.tolist()} ({windows}). {advice}")
    if pixels.dtype == np.uint32:
        raise UserError(f"channel {name!r} holds whole numbers (uint), which are no light or metres. Save it as float.")
    bad = np.isnan(pixels) if is_depth else ~np.isfinite(pixels)
    if bad.any():
        row, column = np.unravel_index(bad.argmax(), bad.shape)
        problem = (
            "are NaN. The sky may be infinite" if is_depth else "are NaN or infinite. Clean it before it is blurred"
        )
        raise UserError(f"channel {name!r}: {bad.sum()} pixels, the first at column {column}, row {row}, {problem}.")
    return pixels


def _printable(text: str) -> str:
    """Text from a file or the library as part of one line, of bounded length."""
    return "".join(c if c.isprintable() else "?" for c in text[:500])


def write(path: Path, pixels: np.ndarray) -> None:
    """Write (H, W, 4) float16 or float32 as R G B A, ZIP-compressed; the file appears complete or not at all."""
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    file = OpenEXR.File(header, {"RGBA": np.ascontiguousarray(pixels)})
    files.whole(path, lambda partial: file.write(str(partial)))
