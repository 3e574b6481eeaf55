"""Convert HDR images to 8 bits to look at, as a file or embedded in a page."""

import base64
import io
from pathlib import Path

import numpy as np
from PIL import Image

from bokeh_validation import files, metrics


def display(color: np.ndarray, exposure: float = 1.0, tone_map: bool = False) -> np.ndarray:
    """Convert linear rgb (H, W, >= 3) to 8 bits with gamma 2.2: clipped at 1, or tone-mapped."""
    color = _exposed(color, exposure)
    return _bytes(metrics.tone_mapped(color) if tone_map else np.clip(color, 0.0, 1.0) ** (1.0 / 2.2))


def filmic(color: np.ndarray, exposure: float = 1.0) -> np.ndarray:
    """Convert linear rgb (H, W, >= 3) to 8 bits by filmic_curve()."""
    return _bytes(filmic_curve(color, exposure))


def filmic_curve(color: np.ndarray, exposure: float = 1.0) -> np.ndarray:
    """Map linear rgb (H, W, >= 3) to display values 0 to 1: Narkowicz's fit of ACES, then gamma 2.2."""
    x = _exposed(color, exposure)
    return np.clip(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0) ** (1.0 / 2.2)


def _exposed(color: np.ndarray, exposure: float) -> np.ndarray:
    return np.nan_to_num(color[..., :3].astype(np.float64) * exposure, nan=0.0, posinf=1e6, neginf=0.0).clip(0.0)


def _bytes(shown: np.ndarray) -> np.ndarray:
    return (np.clip(shown, 0.0, 1.0) * 255 + 0.5).astype(np.uint8)


def heat(distance: np.ndarray, full: float) -> np.ndarray:
    """Map distances (H, W) to 8-bit rgb: black at 0, then red, yellow, and white from `full` on."""
    fraction = np.clip(distance / full, 0.0, 1.0)
    return (np.stack([np.clip(3 * fraction - k, 0.0, 1.0) for k in range(3)], axis=-1) * 255).astype(np.uint8)


def encoded(pixels: np.ndarray, kind: str, **options: object) -> bytes:
    """Encode 8-bit rgb (H, W, 3) as PNG, JPEG or WebP."""
    buffer = io.BytesIO()
    Image.fromarray(pixels).save(buffer, kind, **options)
    return buffer.getvalue()


def png_uri(pixels: np.ndarray) -> str:
    """Return 8-bit rgb (H, W, 3) as a PNG data: URI, for a page without other files."""
    return f"data:image/png;base64,{base64.b64encode(encoded(pixels, 'PNG', optimize=True)).decode('ascii')}"


def jpeg_uri(pixels: np.ndarray, width: int | None = None) -> str:
    """Return 8-bit rgb (H, W, 3) as a JPEG data: URI, which is lossy, scaled down to at most `width` pixels."""
    if width and pixels.shape[1] > width:
        height = round(pixels.shape[0] * width / pixels.shape[1])
        pixels = np.asarray(Image.fromarray(pixels).resize((width, height), Image.Resampling.BOX))
    return f"data:image/jpeg;base64,{base64.b64encode(encoded(pixels, 'JPEG', quality=85)).decode('ascii')}"


def write_png(path: Path, pixels: np.ndarray) -> None:
    """Write 8-bit rgb (H, W, 3) as a PNG; the file appears complete or not at all."""
    data = encoded(pixels, "PNG", optimize=True)
    files.whole(path, lambda partial: partial.write_bytes(data))
