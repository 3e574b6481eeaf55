"""The work behind `validation/run aperture`: a polygon's passes as a table, as JSON and as a picture."""

import math
from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from bokeh_validation.errors import UserError
from bokeh_validation.frame import apertures, decomposition, polygons
from bokeh_validation.frame.decomposition import Decomposition

# Twelve directions at most: 24 sides where they come in parallel pairs
MAX_SIDES = 2 * decomposition.MAX_DIRECTIONS
MAX_SQUEEZE = 16.0


@dataclass(frozen=True)
class Sheet:
    """A polygon's passes, turned, and the squeeze of the lens: width of the bokeh / its height."""

    shape: Decomposition
    squeeze: float = 1.0


def sheet(sides: int | None, vertices: str | None, rotation: float = 0.0, squeeze: float = 1.0) -> Sheet:
    """From the options of the command line; exactly one of `sides` and `vertices`. Raises UserError.

    vertices  'x,y x,y x,y ...', units of the CoC, x right, y down
    """
    if (sides is None) == (vertices is None):
        raise UserError("aperture: give either --sides or --vertices.")
    check_lens(rotation, squeeze)
    if vertices is not None:
        return Sheet(decomposition.decompose(parsed(vertices)).rotated(rotation), squeeze)
    if not 3 <= sides <= MAX_SIDES or (sides % 2 and sides > decomposition.MAX_DIRECTIONS):
        raise UserError(
            f"--sides {sides}: each direction of a side is a pass. Give 3 to {decomposition.MAX_DIRECTIONS}, "
            f"or an even number up to {MAX_SIDES}."
        )
    return Sheet(decomposition.decompose(apertures.regular_polygon(sides)).rotated(rotation), squeeze)


def check_lens(rotation: float, squeeze: float) -> None:
    """Raises UserError."""
    if not math.isfinite(rotation):
        raise UserError(f"--rotation {rotation:g} degrees: not allowed. Give any finite number.")
    if not 0.0 < squeeze <= MAX_SQUEEZE:
        raise UserError(f"--squeeze {squeeze:g}: not allowed. Give more than 0, at most {MAX_SQUEEZE:g}.")


def parsed(text: str) -> np.ndarray:
    """Corners (n, 2) from 'x,y x,y ...'. Raises UserError."""
    corners = []
    for number, word in enumerate(text.split(), start=1):
        try:
            x, y = (float(part) for part in word.split(","))
        except ValueError:
            raise UserError(
                f"--vertices: corner {number} is {word!r}. Give x,y without a space between: 0,-0.5 0.4,0.3 ..."
            ) from None
        corners.append((x, y))
    return np.array(corners).reshape(-1, 2)


def summary(sheet: Sheet) -> str:
    """One line."""
    shape = sheet.shape
    parts, passes, shared = len(shape.parts), len(shape.lines), shape.shared
    counts = f"{parts} parallelogram{'s' * (parts != 1)}, {passes} passes, {shared} shared line{'s' * (shared != 1)}"
    return (
        f"{len(shape.polygon)} sides in {len(shape.directions)} directions: {counts}; "
        f"light kept {shape.light:.3f}, at most {shape.bound:.3f}"
    )


def entry(line: decomposition.Line) -> str:
    """The ready-made pass that draws a line."""
    return "BokehAdaptive" if line.combines is None else "BokehAdaptiveFinal"


def table(sheet: Sheet) -> list[str]:
    """The passes, a line of text each, parameters and textures as the shaders name them; last what holds for all."""
    names = [*decomposition.Line(0.0, 1.0, (0.0, 0.0)).parameters()]
    rows = [["pass", "entry", "degrees", *names, "ColorSamp", "ColorSampB"]]
    for number, line in enumerate(sheet.shape.lines, start=1):
        values = [f"{value:.6f}" for value in line.parameters().values()]
        textures = [_source(line.reads, "CoC map"), _source(line.combines, "")]
        rows.append([str(number), entry(line), f"{line.angle:.2f}", *values, *textures])
    lines = columns(rows, numbers=range(2, 3 + len(names)))
    same = [f"BokehSqueeze {sheet.squeeze:g}"] + (["BokehUseMax 0"] if len(sheet.shape.parts) > 1 else [])
    return [*lines, f"in every pass: {', '.join(same)}"]


def columns(rows: list[list[str]], numbers: range) -> list[str]:
    """Cells as aligned lines; the columns in `numbers` to the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(
            cell.rjust(width) if i in numbers else cell.ljust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]


def _source(index: int | None, otherwise: str) -> str:
    return otherwise if index is None else f"pass {index + 1}"


def as_json(sheet: Sheet) -> dict:
    """Everything, for programs. Passes are numbered from 1 as in the table; `polygon` is before the squeeze."""
    shape = sheet.shape
    passes = [
        {
            "pass": number,
            "entry": entry(line),
            "degrees": line.angle,
            "parameters": {**line.parameters(), "BokehSqueeze": sheet.squeeze},
            "reads": None if line.reads is None else line.reads + 1,
            "combines": None if line.combines is None else line.combines + 1,
        }
        for number, line in enumerate(shape.lines, start=1)
    ]
    parts = [
        {"passes": [part.first + 1, part.second + 1], "corners": part.corners.tolist(), "area": part.area}
        for part in shape.parts
    ]
    return {
        "polygon": shape.polygon.tolist(),
        "directions": list(shape.directions),
        "passes": passes,
        "parallelograms": parts,
        "shared": shape.shared,
        "light": shape.light,
        "bound": shape.bound,
    }


# ------------------------------------------------------------------------------------------------------------- picture

PANEL, CAPTION, COLUMNS = 250, 46, 4
# drawn larger, then scaled down: smooth edges
SUPERSAMPLING = 4
INK, FAINT, SHAPE = (40, 40, 40), (190, 190, 190), (205, 205, 205)
# Okabe and Ito's colours, which the colour-blind can tell apart
COLORS = ((0, 114, 178), (213, 94, 0), (0, 158, 115), (204, 121, 167), (230, 159, 0), (86, 180, 233))
CIRCLE = np.array([0.5 * apertures.direction(angle) for angle in np.linspace(0.0, 2.0 * np.pi, 181)[:-1]])


class Canvas:
    """Panels in rows; places in CoC from a panel's middle, in pixels of the finished picture, y down."""

    def __init__(self, panels: int, reach: float):
        self.columns = min(panels, COLUMNS)
        rows = -(-panels // self.columns)
        self.size = (self.columns * PANEL, rows * (PANEL + CAPTION))
        self.image = Image.new("RGB", [SUPERSAMPLING * n for n in self.size], "white")
        self.draw = ImageDraw.Draw(self.image)
        self.scale = 0.46 * PANEL / reach

    def places(self, panel: int, points: np.ndarray) -> list[tuple[float, float]]:
        row, column = divmod(panel, self.columns)
        middle = np.array([(column + 0.5) * PANEL, row * (PANEL + CAPTION) + 0.5 * PANEL])
        return [tuple(p) for p in SUPERSAMPLING * (middle + self.scale * np.asarray(points, float))]

    def polygon(self, panel: int, points: np.ndarray, fill) -> None:
        self.draw.polygon(self.places(panel, points), fill=fill)

    def path(self, panel: int, points: np.ndarray, color, width: float) -> None:
        """Closed where it has more than two points."""
        places = self.places(panel, points)
        places = [*places, *places[:2]] if len(places) > 2 else places
        self.draw.line(places, fill=color, width=round(SUPERSAMPLING * width), joint="curve")

    def dot(self, panel: int, place: np.ndarray, color, radius: float) -> None:
        ((x, y),) = self.places(panel, [place])
        r = SUPERSAMPLING * radius
        self.draw.ellipse([x - r, y - r, x + r, y + r], fill=color)

    def text(self, panel: int, place: np.ndarray, text: str, color, size: float, shift=(0.0, 0.0)) -> None:
        """Centred on a place, moved by `shift` pixels, with a white rim."""
        ((x, y),) = self.places(panel, [place])
        x, y = x + SUPERSAMPLING * shift[0], y + SUPERSAMPLING * shift[1]
        font = ImageFont.load_default(SUPERSAMPLING * size)
        rim = {"stroke_width": 2 * SUPERSAMPLING, "stroke_fill": "white"}
        self.draw.multiline_text((x, y), text, fill=color, font=font, anchor="mm", align="center", **rim)

    def finished(self) -> np.ndarray:
        return np.asarray(self.image.resize(self.size, Image.Resampling.BOX))


def picture(sheet: Sheet) -> np.ndarray:
    """8-bit rgb (H, W, 3), as the picture of a highlight shows it: the polygon, then each parallelogram with its lines.

    The first line lies about the pixel; the second one carries it along, and has all of the offset.
    """
    squeeze = np.array([sheet.squeeze, 1.0])
    shape = sheet.shape
    corners = [part.corners * squeeze for part in shape.parts]
    circle = CIRCLE * squeeze
    reach = max(float(np.abs(points).max()) for points in (circle, *corners))
    canvas = Canvas(1 + len(corners), reach)
    outline = shape.polygon * squeeze
    canvas.polygon(0, outline, SHAPE)
    canvas.path(0, circle, FAINT, 1)
    for index, points in enumerate(corners):
        canvas.path(0, points, color(index), 2)
    canvas.path(0, outline, INK, 2)
    caption(canvas, 0, f"min keeps {shape.light:.3f} of the light\n{len(shape.lines)} passes")
    for index, (part, points) in enumerate(zip(shape.parts, corners, strict=True)):
        _panel(canvas, index + 1, sheet, part, points, outline, circle, color(index))
    return canvas.finished()


def _panel(canvas: Canvas, panel: int, sheet: Sheet, part, points, outline, circle, color) -> None:
    squeeze = np.array([sheet.squeeze, 1.0])
    canvas.polygon(panel, points, lighter(color))
    canvas.polygon(panel, polygons.clip_convex(outline, points), tuple(int(0.55 * c + 90) for c in lighter(color)))
    canvas.path(panel, circle, FAINT, 1)
    canvas.path(panel, outline, INK, 1)
    canvas.path(panel, points, color, 2)
    canvas.dot(panel, np.zeros(2), INK, 3)
    # lines first, then their numbers on top
    drawn, words = [], []
    for index, width in ((part.first, 5), (part.second, 3)):
        line = sheet.shape.lines[index]
        # minus: the picture is the mirror image of where the samples are
        middle, half = -np.array(line.center), 0.5 * line.length * apertures.direction(math.radians(line.angle))
        canvas.path(panel, np.array([middle - half, middle + half]) * squeeze, INK, width)
        along = half * squeeze / np.linalg.norm(half * squeeze)
        drawn.append((index, (middle + 0.8 * half) * squeeze, (-11 * along[1], 11 * along[0])))
        ending = "" if line.combines is None else f", min with {line.combines + 1}"
        words.append(f"pass {index + 1}: {line.angle:.4g}° · {line.length:.3f}{ending}")
    for index, end, shift in drawn:
        canvas.text(panel, end, str(index + 1), INK, 15, shift)
    caption(canvas, panel, "\n".join(words))


def caption(canvas: Canvas, panel: int, text: str) -> None:
    """Two lines under a panel."""
    canvas.text(panel, np.zeros(2), text, INK, 14, shift=(0.0, 0.5 * PANEL + 0.45 * CAPTION))


def color(index: int) -> tuple[int, int, int]:
    """One of six that can be told apart."""
    return COLORS[index % len(COLORS)]


def lighter(paint: tuple[int, int, int]) -> tuple[int, int, int]:
    """For areas."""
    return tuple(255 - round(0.22 * (255 - c)) for c in paint)
