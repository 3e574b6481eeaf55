"""OpenEXR in and out: colour and depth in, colour and CoC out. Every refusal is a UserError of one line."""

import contextlib
import io
import os
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenEXR

from bokeh_validation.errors import UserError

MAX_PIXELS = 16384 * 16384


@dataclass(frozen=True)
class Scene:
    """An image with depth.

    color     (H, W, 4), float16 where R, G and B are half floats in the file, else float32; alpha is 1
    depth     (H, W) float32, metres along the view axis; None where none was asked for
    """

    color: np.ndarray
    depth: np.ndarray | None

    @property
    def size(self) -> tuple[int, int]:
        """(width, height)"""
        return self.color.shape[1], self.color.shape[0]

    @property
    def storage(self) -> str:
        """Target format that keeps what the file has: 'half' or 'float'."""
        return "half" if self.color.dtype == np.float16 else "float"


def read(path: Path, depth_channel: str | None = "Z") -> Scene:
    """Read R, G, B and a depth channel; `depth_channel=None` reads no depth.

    Raises UserError for a missing or broken file, missing channels, an empty image, and for values that no scene has:
    NaN or infinite colour, NaN depth. Infinite depth is a sky and is let pass.
    """
    channels = _channels(path)
    missing = [name for name in "RGB" if name not in channels]
    if missing:
        raise UserError(f"{path}: no channel {', '.join(missing)} (it has {_listed(channels)}). Save it as R G B.")
    planes = [channels[name] for name in "RGB"]
    shape = planes[0].shape
    if any(plane.shape != shape for plane in planes) or len(shape) != 2:
        raise UserError(f"{path}: R, G and B differ in size. Save it without chroma subsampling.")
    if 0 in shape:
        raise UserError(
            f"{path}: the image is empty ({shape[1]} x {shape[0]} pixels). Save it with at least one pixel."
        )
    for name, plane in zip("RGB", planes, strict=True):
        _refuse(
            path,
            name,
            ~np.isfinite(plane),
            "NaN or infinite",
            "Clean it, for example by clamping, before it is blurred.",
        )
    dtype = np.float16 if all(plane.dtype == np.float16 for plane in planes) else np.float32
    color = np.ones((*shape, 4), dtype)
    color[..., :3] = np.stack(planes, axis=-1)
    return Scene(color, None if depth_channel is None else _depth(path, channels, depth_channel, shape))


def _channels(path: Path) -> dict[str, np.ndarray]:
    if not path.exists():
        raise UserError(f"{path}: no such file. Check the path.")
    if path.is_dir():
        raise UserError(f"{path}: is a folder. Name an EXR file in it.")
    if not os.access(path, os.R_OK):
        raise UserError(f"{path}: may not be read. Check its permissions.")
    said: list[str] = []
    try:
        with _overheard(said):
            return _read_channels(path)
    except UserError:
        raise
    except Exception as error:
        reason = " ".join((said[0] if said else str(error)).split())
        raise UserError(f"{path}: cannot be read as OpenEXR ({reason}). Save it again.") from error


@contextlib.contextmanager
def _overheard(said: list[str]):
    """Collect what the library prints on its own, in C to descriptor 2 and in Python: a refusal must be one line."""
    python_text = io.StringIO()
    with tempfile.TemporaryFile() as c_text:
        kept = os.dup(2)
        os.dup2(c_text.fileno(), 2)
        try:
            with contextlib.redirect_stdout(python_text):
                yield
        finally:
            os.dup2(kept, 2)
            os.close(kept)
            c_text.seek(0)
            said += [
                line for line in (python_text.getvalue() + c_text.read().decode(errors="replace")).splitlines() if line
            ]


def _read_channels(path: Path) -> dict[str, np.ndarray]:
    header = OpenEXR.File(str(path), separate_channels=True, header_only=True).header()
    low, high = header["dataWindow"]
    width, height = int(high[0]) - int(low[0]) + 1, int(high[1]) - int(low[1]) + 1
    if width <= 0 or height <= 0:
        raise UserError(f"{path}: the image is empty ({width} x {height} pixels). Save it with at least one pixel.")
    if width * height > MAX_PIXELS:
        raise UserError(f"{path}: {width} x {height} pixels are more than {MAX_PIXELS}. Crop or scale it.")
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: np.asarray(channel.pixels) for name, channel in file.channels().items()}


def _depth(path: Path, channels: dict[str, np.ndarray], name: str, shape: tuple[int, ...]) -> np.ndarray:
    if name not in channels:
        raise UserError(
            f"{path}: no depth channel {name!r} (it has {_listed(channels)}). "
            "Name one with --depth-channel, or give --coc."
        )
    depth = channels[name].astype(np.float32)
    if depth.shape != shape:
        raise UserError(f"{path}: depth channel {name!r} differs in size from the colour. Save both at one size.")
    _refuse(path, name, np.isnan(depth), "NaN", "Give every pixel a depth in metres; the sky may be infinite.")
    return depth


def _refuse(path: Path, name: str, bad: np.ndarray, what: str, advice: str) -> None:
    if bad.any():
        row, column = np.argwhere(bad)[0]
        raise UserError(
            f"{path}: {int(bad.sum())} pixels of channel {name} are {what}, "
            f"the first at column {column}, row {row}. {advice}"
        )


def _listed(channels: dict[str, np.ndarray]) -> str:
    return " ".join(channels) or "none"


def write(path: Path, pixels: np.ndarray) -> None:
    """Write (H, W, 4) float16 or float32 as R G B A, ZIP-compressed; the file appears complete or not at all."""
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}

    def save(partial: Path) -> None:
        with OpenEXR.File(header, {"RGBA": np.ascontiguousarray(pixels)}) as file:
            file.write(str(partial))

    whole(path, save)


def whole(path: Path, save) -> None:
    """Call `save` with a temporary path beside `path`, then put it in its place."""
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
    try:
        check_writable(path)
        save(partial)
        os.replace(partial, path)
    except UserError:
        raise
    except Exception as error:
        raise UserError(f"{path}: cannot be written ({' '.join(str(error).split())}). Name another place.") from error
    finally:
        partial.unlink(missing_ok=True)


def check_writable(path: Path) -> None:
    """Refuse a place that cannot be written before any work is done."""
    folder = path.parent
    if path.is_dir():
        raise UserError(f"{path}: is a folder. Name a file in it.")
    if not folder.is_dir():
        raise UserError(f"{path}: there is no folder {folder}. Make it first.")
    if not os.access(folder, os.W_OK) or (path.exists() and not os.access(path, os.W_OK)):
        raise UserError(f"{path}: may not be written. Check the permissions, or name another place.")
