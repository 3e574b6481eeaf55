"""Pictures side by side with a caption under each."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from bokeh_validation import pictures

GAP, LINE, TEXT = 8, 17, 13
INK = (40, 40, 40)
# marks in pictures: seen on dark and on light
MARK = (255, 210, 0)

Place = Sequence[float]


class Panel(NamedTuple):
    """8-bit rgb (H, W, 3) and what is written under it; words are wrapped to the picture's width."""

    pixels: np.ndarray
    caption: str = ""


def grid(rows: Sequence[Sequence[Panel]]) -> np.ndarray:
    """Panels in rows, on white, 8-bit rgb (H, W, 3)."""
    # of each row: its captions and the height of its pictures
    lines = [[wrapped(panel.caption, panel.pixels.shape[1]) for panel in row] for row in rows]
    heights = [max(panel.pixels.shape[0] for panel in row) for row in rows]
    blocks = [h + (4 + LINE * n if (n := max(map(len, row))) else 0) for h, row in zip(heights, lines, strict=True)]
    width = max(sum(panel.pixels.shape[1] + GAP for panel in row) for row in rows) + GAP
    page = Image.new("RGB", (width, sum(blocks) + GAP * (len(rows) + 1)), "white")
    draw, top = ImageDraw.Draw(page), GAP
    for row, captions, height, block in zip(rows, lines, heights, blocks, strict=True):
        left = GAP
        for panel, caption in zip(row, captions, strict=True):
            page.paste(Image.fromarray(panel.pixels), (left, top))
            for number, line in enumerate(caption):
                place = (left + panel.pixels.shape[1] / 2, top + height + 4 + (number + 0.5) * LINE)
                draw.text(place, line, fill=INK, font=font(TEXT), anchor="mm")
            left += panel.pixels.shape[1] + GAP
        top += block + GAP
    return np.asarray(page)


def font(size: float) -> ImageFont.FreeTypeFont:
    """Pillow's own, so that pictures are the same everywhere."""
    return ImageFont.load_default(size)


def wrapped(text: str, width: int) -> list[str]:
    """Lines that fit into `width` pixels, as far as words allow."""
    lines: list[str] = []
    for paragraph in text.splitlines():
        line = ""
        for word in paragraph.split():
            longer = f"{line} {word}".strip()
            if line and font(TEXT).getlength(longer) > width:
                lines.append(line)
                longer = word
            line = longer
        lines.append(line)
    return lines


def toned(color: np.ndarray, exposure: float = 1.0, factor: int = 1) -> np.ndarray:
    """Linear rgb, x / (1 + x) and gamma 2.2, each pixel as a block."""
    return pictures.enlarged(pictures.display(color, exposure, tone_map=True), factor)


def crop(image: np.ndarray, left: int, top: int, width: int, height: int) -> np.ndarray:
    """A part of (H, W, ...)."""
    return image[top : top + height, left : left + width]


def arrows(pixels: np.ndarray, lines: Sequence[tuple[Place, Place]], both: bool = True) -> np.ndarray:
    """Arrows from place to place (x, y), pixels of the picture; `both`: heads at both ends."""
    scale = 4  # drawn larger, then scaled down: smooth edges
    layer = Image.new("L", [scale * n for n in pixels.shape[1::-1]], 0)
    draw = ImageDraw.Draw(layer)
    for start, end in lines:
        arrow(draw, np.array(start) * scale, np.array(end) * scale, 255, 2 * scale, both)
    share = np.asarray(layer.resize(pixels.shape[1::-1], Image.Resampling.BOX))[..., None] / 255.0
    return (pixels * (1 - share) + np.array(MARK) * share + 0.5).astype(np.uint8)


def arrow(draw: ImageDraw.ImageDraw, start: np.ndarray, end: np.ndarray, fill, width: float, both: bool = False):
    """A line with a head at its end."""
    along = _unit(start, end)
    across = np.array([-along[1], along[0]])
    for tip, back in ((end, -along), (start, along)) if both else ((end, -along),):
        base = tip + 4.5 * width * back
        draw.polygon([tuple(tip), tuple(base + 2 * width * across), tuple(base - 2 * width * across)], fill=fill)
    shortened = 4 * width * along
    draw.line([tuple(start + (shortened if both else 0)), tuple(end - shortened)], fill=fill, width=round(width))


def marked(pixels: np.ndarray, marks: dict[str, tuple[Place, Place]]) -> np.ndarray:
    """Arrows from a letter (x, y) to a place (x, y)."""
    image = Image.fromarray(arrows(pixels, [(a + 9 * _unit(a, b), b) for a, b in marks.values()], both=False))
    for text, (place, _) in marks.items():
        rim = {"stroke_width": 2, "stroke_fill": (0, 0, 0)}
        ImageDraw.Draw(image).text(place, text, fill=MARK, font=font(17), anchor="mm", **rim)
    return np.asarray(image)


def _unit(start: Place, end: Place) -> np.ndarray:
    step = np.subtract(end, start, dtype=float)
    return step / np.linalg.norm(step)
