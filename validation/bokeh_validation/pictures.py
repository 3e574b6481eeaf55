"""Convert HDR images to 8 bits to look at: single, in a captioned grid, as a file, or embedded in a page."""

import base64
import io
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from bokeh_validation import files, metrics

GAP, LINE_HEIGHT, TEXT_SIZE, INK = 8, 17, 13, (40, 40, 40)
# Largest PNG among the documents' images, bytes. A larger image is stored as a lossless WebP, a third smaller.
MAX_PNG_BYTES = 700_000


class Captioned(NamedTuple):
    """Pair an 8-bit rgb image (H, W, 3) with the caption under it, which is wrapped to the image's width."""

    pixels: np.ndarray
    caption: str = ""


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
    share = np.clip(distance / full, 0.0, 1.0)
    return (np.stack([np.clip(3 * share - k, 0.0, 1.0) for k in range(3)], axis=-1) * 255).astype(np.uint8)


def enlarged(pixels: np.ndarray, factor: int) -> np.ndarray:
    """Enlarge each pixel of an image (H, W, ...) to a block, so that single pixels can be seen."""
    return np.repeat(np.repeat(pixels, factor, axis=0), factor, axis=1)


def halved(pixels: np.ndarray) -> np.ndarray:
    """Return an 8-bit rgb image (H, W, 3) at half its size."""
    return np.asarray(Image.fromarray(pixels).reduce(2))


def crop(image: np.ndarray, left: int, top: int, width: int, height: int) -> np.ndarray:
    """Return a rectangle of an image (H, W, ...), in pixels."""
    return image[top : top + height, left : left + width]


def grid(rows: Sequence[Sequence[Captioned]]) -> np.ndarray:
    """Arrange images and their captions in rows on white; returns 8-bit rgb (H, W, 3)."""
    captions = [[_wrapped(panel.caption, panel.pixels.shape[1]) for panel in row] for row in rows]
    # height of each row's images, and of its captions with a small margin above them
    picture_heights = [max(panel.pixels.shape[0] for panel in row) for row in rows]
    line_counts = [max(map(len, row)) for row in captions]
    text_heights = [4 + LINE_HEIGHT * count if count else 0 for count in line_counts]
    width = max(sum(panel.pixels.shape[1] + GAP for panel in row) for row in rows) + GAP
    page = Image.new("RGB", (width, sum(picture_heights) + sum(text_heights) + GAP * (len(rows) + 1)), "white")
    draw, top = ImageDraw.Draw(page), GAP
    for row, row_captions, height, text_height in zip(rows, captions, picture_heights, text_heights, strict=True):
        left = GAP
        for panel, lines in zip(row, row_captions, strict=True):
            page.paste(Image.fromarray(panel.pixels), (left, top))
            for number, line in enumerate(lines):
                position = (left + panel.pixels.shape[1] / 2, top + height + 4 + (number + 0.5) * LINE_HEIGHT)
                draw.text(position, line, fill=INK, font=_font(), anchor="mm")
            left += panel.pixels.shape[1] + GAP
        top += height + text_height + GAP
    return np.asarray(page)


def _font() -> ImageFont.FreeTypeFont:
    """Return Pillow's built-in font, so that images are the same on every machine."""
    return ImageFont.load_default(TEXT_SIZE)


def _wrapped(text: str, width: int) -> list[str]:
    """Break text into lines that fit into `width` pixels, as far as the length of words allows."""
    lines: list[str] = []
    for word in text.split():
        longer = f"{lines[-1]} {word}" if lines else word
        if lines and _font().getlength(longer) <= width:
            lines[-1] = longer
        else:
            lines.append(word)
    return lines


def _encoded(pixels: np.ndarray, kind: str, **options: object) -> bytes:
    """Encode 8-bit rgb (H, W, 3) as PNG, JPEG or WebP."""
    buffer = io.BytesIO()
    Image.fromarray(pixels).save(buffer, kind, **options)
    return buffer.getvalue()


def png_uri(pixels: np.ndarray) -> str:
    """Return 8-bit rgb (H, W, 3) as a PNG data: URI, for a page without other files."""
    return f"data:image/png;base64,{base64.b64encode(_encoded(pixels, 'PNG', optimize=True)).decode('ascii')}"


def jpeg_uri(pixels: np.ndarray, width: int | None = None) -> str:
    """Return 8-bit rgb (H, W, 3) as a JPEG data: URI, which is lossy, scaled down to at most `width` pixels."""
    if width and pixels.shape[1] > width:
        height = round(pixels.shape[0] * width / pixels.shape[1])
        pixels = np.asarray(Image.fromarray(pixels).resize((width, height), Image.Resampling.BOX))
    return f"data:image/jpeg;base64,{base64.b64encode(_encoded(pixels, 'JPEG', quality=85)).decode('ascii')}"


def write_png(path: Path, pixels: np.ndarray) -> None:
    """Write 8-bit rgb (H, W, 3) as a PNG; the file appears complete or not at all."""
    data = _encoded(pixels, "PNG", optimize=True)
    files.whole(path, lambda partial: partial.write_bytes(data))


def write_document(folder: Path, name: str, pixels: np.ndarray) -> Path:
    """Write an 8-bit rgb image (H, W, 3) of the documents as NAME.png, or NAME.webp if too large; returns the path.

    Both are lossless, because lossy compression would add banding to a comparison of blur.
    """
    data, path = _encoded(pixels, "PNG", optimize=True), folder / f"{name}.png"
    if len(data) > MAX_PNG_BYTES:
        data, path = _encoded(pixels, "WEBP", lossless=True, quality=100), folder / f"{name}.webp"
    files.whole(path, lambda partial: partial.write_bytes(data))
    return path


def write_animation(folder: Path, name: str, frames: Sequence[np.ndarray], milliseconds: int, quality: int) -> Path:
    """Write 8-bit rgb frames (H, W, 3) as NAME.webp, a lossy animation that loops forever, and return its path."""
    first, *further = map(Image.fromarray, frames)
    buffer, path = io.BytesIO(), folder / f"{name}.webp"
    options = {"save_all": True, "append_images": further, "duration": milliseconds, "loop": 0, "method": 6}
    first.save(buffer, "WEBP", quality=quality, **options)
    files.whole(path, lambda partial: partial.write_bytes(buffer.getvalue()))
    return path
