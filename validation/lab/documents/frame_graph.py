"""Draw docs/images/frame_graph.svg: which pass writes and reads which texture, from a frame of integration/frames."""

import json
from collections.abc import Sequence
from html import escape
from pathlib import Path

from bokeh_validation import paths

FRAME = paths.ROOT / "integration/frames/layered-hexagon.json"
# Lengths in pixels of the drawing
LEFT, TOP, COLUMN, ROW, MARGIN = 150, 165, 52, 20, 40
# Scale of a target -> colour of its line; larger targets are darker
COLORS = {1: "#1b3a5c", 2: "#2f7d6d", 4: "#c77d1e", 8: "#a04668"}
STYLE = (
    "text{font:12px sans-serif;fill:#222}.axis{fill:#555}.row{stroke:#e4e4e4}.life{stroke-width:4;stroke-linecap:round}"
)


def title(entry: str) -> str:
    """Return the name of a pass as on the page: without prefix and polygon."""
    return entry.removeprefix("Bokeh").replace("Hexagon", "")


def _texture(row: int, texture: dict, scale: int, right: int) -> list[str]:
    """Return the marks of one texture: its name, its life, a square where it is written and dots where it is read."""
    y, color = TOP + ROW * row + ROW // 2, COLORS[scale]
    written, read = texture["written"], texture["read"]
    first = written if written is not None else min(read)
    last = max([first, *read])
    lines = [
        f'<path class="row" d="M{LEFT} {y}H{right}"/>',
        f'<text x="{LEFT - 10}" y="{y + 4}" text-anchor="end">{escape(texture["name"])}</text>',
        f'<path class="life" stroke="{color}" d="M{_x(first)} {y}H{_x(last)}"/>',
    ]
    if written is not None:
        lines.append(f'<rect x="{_x(written) - 7}" y="{y - 7}" width="14" height="14" fill="{color}"/>')
    for number in read:
        lines.append(f'<circle cx="{_x(number)}" cy="{y}" r="6" fill="#fff" stroke="{color}" stroke-width="3"/>')
    return lines


def _x(number: int) -> int:
    """Return the middle of a pass's column."""
    return LEFT + COLUMN * number + COLUMN // 2


def svg(passes: Sequence[dict], textures: Sequence[dict]) -> str:
    """Return the drawing of a frame: one column for each pass, one row for each texture.

    passes    of a frame: "entry", "scale", "targets"
    textures  of the same frame: "name", "written" (number of a pass, or None), "read" (numbers of passes)
    """
    scales = {name: step["scale"] for step in passes for name in step["targets"]}
    width, bottom = LEFT + COLUMN * len(passes) + 2 * MARGIN, TOP + ROW * len(textures)
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {bottom + 48}" width="{width}">',
        f'<style>{STYLE}</style><rect width="100%" height="100%" fill="#fff"/>',
    ]
    for number, step in enumerate(passes):
        size = "full size" if step["scale"] == 1 else f"1/{step['scale']} size"
        lines.append(
            f'<text transform="translate({_x(number) - 4} {TOP - 8}) rotate(-55)">{number} {title(step["entry"])}'
            f'<tspan class="axis">, {size}</tspan></text>'
        )
    for row, texture in enumerate(textures):
        lines += _texture(row, texture, scales.get(texture["name"], 1), LEFT + COLUMN * len(passes))
    at, y = LEFT, bottom + 28
    for scale, color in COLORS.items():
        name = "full size" if scale == 1 else f"1/{scale} size"
        lines.append(f'<rect x="{at}" y="{y - 11}" width="14" height="14" fill="{color}"/>')
        lines.append(f'<text x="{at + 20}" y="{y}">{name}</text>')
        at += 90
    lines.append(f'<text x="{at + 20}" y="{y}">square: written; circle: read; line: kept</text>')
    return "\n".join([*lines, "</svg>"]) + "\n"


def draw(frame: Path = FRAME) -> str:
    """Return the drawing of a file of integration/frames."""
    planned = json.loads(frame.read_text(encoding="utf-8"))
    return svg(planned["passes"], planned["textures"])
