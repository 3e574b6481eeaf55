"""HDR to PNG, for people to look at."""

import base64
import io
from pathlib import Path

import numpy as np
from PIL import Image

from bokeh_validation import files, metrics


def display(color: np.ndarray, exposure: float = 1.0, tone_map: bool = False) -> np.ndarray:
    """Linear rgb (H, W, >= 3) to 8 bits: cut off at 1, or tone-mapped; gamma 2.2."""
    color = _exposed(color, exposure)
    return _bytes(metrics.tone_mapped(color) if tone_map else np.clip(color, 0.0, 1.0) ** (1.0 / 2.2))


def filmic(color: np.ndarray, exposure: float = 1.0) -> np.ndarray:
    """Linear rgb (H, W, >= 3) to 8 bits by a filmic curve (Narkowicz's fit of ACES); gamma 2.2."""
    x = _exposed(color, exposure)
    return _bytes(np.clip(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0) ** (1.0 / 2.2))


def _exposed(color: np.ndarray, exposure: float) -> np.ndarray:
    return np.nan_to_num(color[..., :3].astype(np.float64) * exposure, nan=0.0, posinf=1e6, neginf=0.0).clip(0.0)


def _bytes(shown: np.ndarray) -> np.ndarray:
    return (np.clip(shown, 0.0, 1.0) * 255 + 0.5).astype(np.uint8)


def heat(distance: np.ndarray, full: float) -> np.ndarray:
    """Distances (H, W) to 8 bits: 0 black, red, yellow, `full` and more white."""
    share = np.clip(distance / full, 0.0, 1.0)
    return (np.stack([np.clip(3 * share - k, 0.0, 1.0) for k in range(3)], axis=-1) * 255).astype(np.uint8)


def enlarged(pixels: np.ndarray, factor: int) -> np.ndarray:
    """Each pixel as a block, so that single pixels can be seen."""
    return np.repeat(np.repeat(pixels, factor, axis=0), factor, axis=1)


def halved(pixels: np.ndarray) -> np.ndarray:
    """8-bit rgb at half its size."""
    return np.asarray(Image.fromarray(pixels).reduce(2))


def coarse(pixels: np.ndarray, step: int = 4) -> np.ndarray:
    """8-bit rgb in steps: its PNG is half as large, and nobody sees it."""
    return np.minimum((pixels.astype(int) + step // 2) // step * step, 255).astype(np.uint8)


def png_bytes(pixels: np.ndarray) -> bytes:
    """8-bit rgb (H, W, 3) as a PNG."""
    return _encoded(Image.fromarray(pixels), "PNG", optimize=True)


def png_uri(pixels: np.ndarray) -> str:
    """8-bit rgb as a data: address, for a page without files beside it."""
    return f"data:image/png;base64,{base64.b64encode(png_bytes(pixels)).decode('ascii')}"


def jpeg_uri(pixels: np.ndarray, width: int | None = None) -> str:
    """8-bit rgb as a data: address, not to the last bit, and at most so wide."""
    picture = Image.fromarray(pixels)
    if width and picture.width > width:
        picture = picture.resize((width, round(picture.height * width / picture.width)), Image.Resampling.BOX)
    return f"data:image/jpeg;base64,{base64.b64encode(_encoded(picture, 'JPEG', quality=85)).decode('ascii')}"


def _encoded(picture: Image.Image, kind: str, **options: object) -> bytes:
    buffer = io.BytesIO()
    picture.save(buffer, kind, **options)
    return buffer.getvalue()


def write_png(path: Path, pixels: np.ndarray) -> None:
    """Write 8-bit rgb; the file appears complete or not at all."""
    data = png_bytes(pixels)
    files.whole(path, lambda partial: partial.write_bytes(data))
