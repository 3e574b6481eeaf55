"""Read and write OpenEXR: colour and depth in, colour and CoC out. Every refusal is a UserError of one line."""

import contextlib
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenEXR

from bokeh_validation import files
from bokeh_validation.errors import UserError

# Limit on width x height x channels: four channels of the largest texture of common devices. The library unpacks every
# channel of the file, asked for or not.
MAX_VALUES = 4 * 16384 * 16384


@dataclass(frozen=True)
class Scene:
    """Hold an image with its depth.

    color  (H, W, 4), float16 if R, G and B are half floats in the file, else float32; alpha is 1
    depth  (H, W) float32, metres along the view axis; 1 if no depth was asked for
    """

    color: np.ndarray
    depth: np.ndarray

    @property
    def size(self) -> tuple[int, int]:
        """Return (width, height) in pixels."""
        return self.color.shape[1], self.color.shape[0]

    @property
    def storage(self) -> str:
        """Return the target format that keeps the file's precision: 'half' or 'float'."""
        return "half" if self.color.dtype == np.float16 else "float"


def read(path: Path, depth_channel: str | None = "Z", layer: str | None = None) -> Scene:
    """Read R, G, B and a depth channel of an EXR file.

    depth_channel  name of the channel in metres; None reads no depth
    layer          reads LAYER.R, LAYER.G and LAYER.B instead

    Raises UserError if the file is missing, broken, deep, empty, cropped or too large, if it lacks a channel, or if it
    has NaN or infinite colour or NaN depth. Infinite depth is allowed: it is sky.
    """
    try:
        return _scene(path, depth_channel, layer)
    except UserError as error:
        raise UserError(f"{path}: {error}") from error
    except Exception as error:
        # an error of the library, too little memory for the pixels, or a channel's name that is not valid text
        reason = _printable(f"{type(error).__name__}: {error}".replace(f"{path}: ", ""))
        raise UserError(f"{path}: cannot be read as OpenEXR ({reason}). Save it again as OpenEXR.") from error


def _scene(path: Path, depth_channel: str | None, layer: str | None) -> Scene:
    # opening a pipe would wait for its writer
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
    # the library omits parts that it cannot decode
    if len(parts) != len(headers):
        raise ValueError("not all of its pixels can be decoded")
    planes = [_plane(parts[index], name, is_depth=k == 3) for k, (index, name) in enumerate(places)]
    opaque = np.ones_like(planes[0])
    return Scene(np.stack([*planes[:3], opaque], axis=-1), [*planes, opaque][3].astype(np.float32))


def _parts(path: Path, header_only: bool) -> list[OpenEXR.Part]:
    """Return all parts of the file, and discard what the library prints: the errors that it raises say the same.

    It prints from C to file descriptor 2, and through Python's standard output.
    """
    stderr_copy = os.dup(2)
    with open(os.devnull, "w") as nowhere, contextlib.redirect_stdout(nowhere):
        os.dup2(nowhere.fileno(), 2)
        try:
            return OpenEXR.File(str(path), separate_channels=True, header_only=header_only).parts
        finally:
            os.dup2(stderr_copy, 2)
            os.close(stderr_copy)


def _place(parts: list[OpenEXR.Part], name: str, what: str, advice: str) -> tuple[int, str]:
    """Return the index of the part and the channel that `name` means: CHANNEL, if only one part has it, or
    PART.CHANNEL.

    what, advice  the kind of channel and what to do, for the message
    Raises UserError if no part or several parts have it.
    """
    places: dict[str, list[tuple[int, str]]] = {}
    for index, part in enumerate(parts):
        for channel in part.header["channels"]:
            for spelling in dict.fromkeys((channel.name, f"{part.name()}.{channel.name}".removeprefix("."))):
                places.setdefault(spelling, []).append((index, channel.name))
    if len(places.get(name, ())) == 1:
        return places[name][0]
    problem = "several parts have" if name in places else "no"
    raise UserError(f"{problem} {what} {name!r} (it has {_printable(' '.join(places))}). {advice}")


def _plane(part: OpenEXR.Part, name: str, is_depth: bool) -> np.ndarray:
    """Return the channel, (H, W) half or float. Raises UserError unless it covers the whole image and holds valid
    numbers.

    A cropped image is refused because the circle of confusion is a fraction of the full image height.
    """
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
    """Return text from a file or the library in a form that fits on one line: bounded length, no control characters."""
    return "".join(c if c.isprintable() else "?" for c in text[:500])


def write(path: Path, pixels: np.ndarray) -> None:
    """Write (H, W, 4) float16 or float32 as R G B A, ZIP-compressed; the file appears complete or not at all."""
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    file = OpenEXR.File(header, {"RGBA": np.ascontiguousarray(pixels)})
    files.whole(path, lambda partial: file.write(str(partial)))
