"""OpenEXR in and out: colour and depth in, colour and CoC out. Every refusal is a UserError of one line."""

import contextlib
import ctypes
import io
import os
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenEXR

from bokeh_validation import exr_header, exr_layers, files
from bokeh_validation.errors import UserError
from bokeh_validation.exr_header import Channel, Part, Window, printable


@dataclass(frozen=True)
class Scene:
    """An image with depth. It covers the display window: the circle of confusion is a fraction of that one's height.

    color     (H, W, 4), float16 where R, G and B are half floats in the file, else float32; alpha is 1
    depth     (H, W) float32, metres along the view axis; None where none was asked for
    display   the display window, W x H pixels
    data      the part of it that the file has pixels for; outside of it the nearest of them stand in
    """

    color: np.ndarray
    depth: np.ndarray | None
    display: Window
    data: Window

    @property
    def size(self) -> tuple[int, int]:
        """(width, height)"""
        return self.color.shape[1], self.color.shape[0]

    @property
    def storage(self) -> str:
        """Target format that keeps what the file has: 'half' or 'float'."""
        return "half" if self.color.dtype == np.float16 else "float"

    def with_data(self, pixels: np.ndarray) -> np.ndarray:
        """Those of (H, W, ...) pixels that the file has data for, as a view."""
        return pixels[_slices(self.data, self.display)]


def read(path: Path, depth_channel: str | None = "Z", layer: str | None = None) -> Scene:
    """Read R, G, B and a depth channel; `depth_channel=None` reads no depth, `layer` names the layer or part.

    Raises UserError for a missing or broken file, one that is too large (exr_header.MAX_PIXELS, MAX_BYTES), missing or
    ambiguous channels, an empty image, and for values that no scene has: NaN or infinite colour, NaN depth. Infinite
    depth is a sky and is let pass.
    """
    try:
        return _scene(path, depth_channel, layer)
    except MemoryError as error:
        raise UserError(f"{path}: there is not enough memory for its pixels. Crop or scale it.") from error


def _scene(path: Path, depth_channel: str | None, layer: str | None) -> Scene:
    parts, channels = exr_header.read(path)
    chosen = exr_layers.pick(path, parts, channels, layer, depth_channel)
    part = parts[chosen[0].part]
    display, data = part.display, part.data.within(part.display)
    if data.width <= 0 or data.height <= 0:
        raise UserError(
            f"{path}: the data window ({part.data}) lies outside of the display window ({display}). "
            "Save it with pixels in the display window."
        )
    # overscan is cut off; what lies there is no part of the image, whatever it holds
    planes = [plane[_slices(data, part.data)] for plane in _planes(path, parts, chosen)]
    clean = "NaN or infinite", "Clean it, for example by clamping, before it is blurred."
    deep = "NaN", "Give every pixel a depth in metres; the sky may be infinite."
    for k, (entry, plane) in enumerate(zip(chosen, planes, strict=True)):
        _refuse(path, entry, ~np.isfinite(plane) if k < 3 else np.isnan(plane), data, *(clean if k < 3 else deep))
    half = all(plane.dtype == np.float16 for plane in planes[:3])
    color = np.ones((display.height, display.width, 4), np.float16 if half else np.float32)
    for k in range(3):
        color[..., k] = _extended(planes[k], data, display)
    depth = _extended(planes[3].astype(np.float32), data, display) if planes[3:] else None
    return Scene(color, depth, display, data)


def _slices(inner: Window, outer: Window) -> tuple[slice, slice]:
    """Rows and columns of `inner` in an array that covers `outer`."""
    top, left = inner.top - outer.top, inner.left - outer.left
    return slice(top, top + inner.height), slice(left, left + inner.width)


def _extended(plane: np.ndarray, data: Window, display: Window) -> np.ndarray:
    """The plane over the display window, its border repeated outwards, as clamp addressing does at the border."""
    if data == display:
        return plane
    rows, columns = _slices(data, display)
    around = (rows.start, display.height - rows.stop), (columns.start, display.width - columns.stop)
    return np.pad(plane, around, mode="edge")


def _planes(path: Path, parts: list[Part], chosen: list[Channel]) -> list[np.ndarray]:
    """(H, W) pixels of channels."""
    said: list[str] = []
    try:
        with _overheard(said), OpenEXR.File(str(path), separate_channels=True) as file:
            # the library leaves out the parts that it could not read
            if len(file.parts) != len(parts):
                raise ValueError("not all of its pixels can be decoded")
            planes = [np.asarray(file.channels(entry.part)[entry.name].pixels) for entry in chosen]
    except MemoryError:
        raise
    except Exception as error:
        # the library's own words come before those of the call that then finds nothing
        said.append(str(error))
        if any("MemoryError" in line or "bad_alloc" in line for line in said):
            raise MemoryError from error
        reason = printable(said[0].removeprefix(f"{path}: "))
        raise UserError(f"{path}: cannot be read as OpenEXR ({reason}). Save it again.") from error
    for entry, plane in zip(chosen, planes, strict=True):
        window = parts[entry.part].data
        if plane.shape != (window.height, window.width):
            raise UserError(f"{path}: channel {printable(entry.full)} is not of its window's size. Save it again.")
    return planes


@contextlib.contextmanager
def _overheard(said: list[str]):
    """Collect what the library prints on its own, in C to descriptors 1 and 2 and in Python: a refusal is one line."""
    python_text = io.StringIO()
    # fflush() of the C library that the process has; on Windows each extension may have its own
    flush = (lambda stream: None) if sys.platform == "win32" else ctypes.CDLL(None).fflush
    with tempfile.TemporaryFile() as c_text:
        kept = {descriptor: os.dup(descriptor) for descriptor in (1, 2)}
        flush(None)
        for descriptor in kept:
            os.dup2(c_text.fileno(), descriptor)
        try:
            with contextlib.redirect_stdout(python_text):
                yield
        finally:
            flush(None)
            for descriptor, copy in kept.items():
                os.dup2(copy, descriptor)
                os.close(copy)
            c_text.seek(0)
            text = c_text.read().decode(errors="replace") + python_text.getvalue()
            said += [line for line in text.splitlines() if line.strip()]


def _refuse(path: Path, entry: Channel, bad: np.ndarray, window: Window, what: str, advice: str) -> None:
    """Where any pixel of the window is bad: the first, in the file's coordinates."""
    if bad.any():
        row, column = np.unravel_index(bad.argmax(), bad.shape)
        raise UserError(
            f"{path}: {int(bad.sum())} pixels of channel {printable(entry.name)} are {what}, "
            f"the first at column {window.left + column}, row {window.top + row}. {advice}"
        )


def write(path: Path, pixels: np.ndarray, data: Window | None = None, display: Window | None = None) -> None:
    """Write (H, W, 4) float16 or float32 as R G B A, ZIP-compressed; the file appears complete or not at all.

    `pixels` fill the data window. Both windows are the image where none are given.
    """
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    for name, window in (("dataWindow", data), ("displayWindow", display)):
        if window is not None:
            header[name] = ((window.left, window.top), (window.right, window.bottom))

    def save(partial: Path) -> None:
        with OpenEXR.File(header, {"RGBA": np.ascontiguousarray(pixels)}) as file:
            file.write(str(partial))

    files.whole(path, save)
