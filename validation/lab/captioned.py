"""Arrange images with captions in a grid, and write the documents' images."""

import io
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from bokeh_validation import files
from bokeh_validation.pictures import encoded

GAP, LINE_HEIGHT, TEXT_SIZE, INK = 8, 17, 13, (40, 40, 40)
# Largest PNG among the documents' images, bytes. A larger image is stored as a lossless WebP, a third smaller.
MAX_PNG_BYTES = 700_000


class Captioned(NamedTuple):
    """Pair an 8-bit rgb image (H, W, 3) with the caption under it, which is wrapped to the image's width."""

    pixels: np.ndarray
    caption: str = ""


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


def write_document(folder: Path, name: str, pixels: np.ndarray) -> Path:
    """Write an 8-bit rgb image (H, W, 3) of the documents as NAME.png, or NAME.webp if too large; returns the path.

    Both are lossless, because lossy compression would add banding to a comparison of blur.
    """
    data, path = encoded(pixels, "PNG", optimize=True), folder / f"{name}.png"
    if len(data) > MAX_PNG_BYTES:
        data, path = encoded(pixels, "WEBP", lossless=True, quality=100), folder / f"{name}.webp"
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
