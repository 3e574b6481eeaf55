"""The work behind `validation/run aperture --exact`: the lines of both passes as a table, as JSON and as a picture."""

import math
from dataclasses import dataclass

import numpy as np

from bokeh_validation.errors import UserError
from bokeh_validation.frame import apertures, methods
from bokeh_validation.frame.sheet import CIRCLE, FAINT, INK, Canvas, caption, check_lens, color, columns, lighter
from bokeh_validation.reference import segments


@dataclass(frozen=True)
class Tiling:
    """A polygon of the exact method; rotation in degrees, squeeze = width of the bokeh / its height."""

    sides: int
    rotation: float = 0.0
    squeeze: float = 1.0

    def edge(self, k: int, second_pass: bool) -> segments.Segment:
        """Edge k as one of the passes filters along it."""
        return segments.polygon_edge(k, self.sides, math.radians(self.rotation), self.squeeze, second_pass)

    def tiles(self) -> list[tuple[int, int, np.ndarray]]:
        """(i, k, corners (4, 2)) of every parallelogram, i < k, in units of the CoC."""
        found = []
        for k in range(2, self.sides // 2 + 1):
            second = self.edge(k, True)
            for i in range(1, k):
                first = self.edge(i, False)
                middle, u, v = first.middle + second.middle, first.half, second.half
                found.append((i, k, np.array([middle + u + v, middle + u - v, middle - u - v, middle - u + v])))
        return found

    @property
    def weights(self) -> dict[int, float]:
        """Share of the result that comes from edge k of the second pass."""
        parts = {k: segments.weight(k, self.sides) for k in range(2, self.sides // 2 + 1)}
        total = sum(parts.values())
        return {k: part / total for k, part in parts.items()}


def tiling(sides: int | None, vertices: str | None, rotation: float, squeeze: float) -> Tiling:
    """From the options of the command line. Raises UserError."""
    if vertices is not None:
        raise UserError("--vertices: --exact makes regular polygons only. Give --sides, or leave --exact out.")
    if sides not in methods.EXACT.values():
        known = ", ".join(map(str, methods.EXACT.values()))
        raise UserError(f"--sides {sides}: the exact passes make polygons of {known} sides. Give one of them.")
    check_lens(rotation, squeeze)
    return Tiling(sides, rotation, squeeze)


def table(shape: Tiling) -> list[str]:
    """The lines of both passes, a line of text each; lengths and places in units of the CoC."""
    rows = [["pass", "edge", "degrees", "length", "centre x", "centre y", "goes to", "weight"]]
    half = shape.sides // 2
    for k in range(1, half):
        shares = [f"T{t} {segments.parallelogram(t, k, shape.sides):.3f}" for t in range(k + 1, half + 1)]
        rows.append(["1", str(k), *_numbers(shape.edge(k, False)), ", ".join(shares), ""])
    for k in range(2, half + 1):
        rows.append(["2", str(k), *_numbers(shape.edge(k, True)), "result", f"{shape.weights[k]:.4f} T{k}"])
    return columns(rows, numbers=range(2, 6))


def _numbers(line: segments.Segment) -> list[str]:
    angle = math.degrees(math.atan2(line.half[1], line.half[0])) % 180.0
    return [f"{angle:.2f}", *(f"{round(value, 6) + 0.0:.6f}" for value in (2.0 * line.half_length, *line.middle))]


def summary(shape: Tiling) -> str:
    """One line."""
    targets = shape.sides // 2 - 1
    return (
        f"{shape.sides} sides: {len(shape.tiles())} parallelograms, {2 * targets} lines; 2 passes with "
        f"{targets} target{'s' if targets > 1 else ''}, or {targets + 1} passes with one; light kept 1.000"
    )


def as_json(shape: Tiling) -> dict:
    """Everything, for programs."""

    def line(k: int, second_pass: bool) -> dict:
        found = shape.edge(k, second_pass)
        return {"edge": k, "middle": found.middle.tolist(), "half": found.half.tolist()}

    half = shape.sides // 2
    return {
        "sides": shape.sides,
        "rotation_degrees": shape.rotation,
        "squeeze": shape.squeeze,
        "first_pass": [line(k, False) for k in range(1, half)],
        "second_pass": [{**line(k, True), "weight": shape.weights[k]} for k in range(2, half + 1)],
        "parallelograms": [{"edges": [i, k], "corners": corners.tolist()} for i, k, corners in shape.tiles()],
    }


def picture(shape: Tiling) -> np.ndarray:
    """8-bit rgb (H, W, 3): the tiling, coloured by the edge of the second pass, then the lines of each pass."""
    stretch = np.array([shape.squeeze, 1.0])
    outline = apertures.even_polygon(shape.sides, shape.rotation) * stretch
    circle = CIRCLE * stretch
    half = shape.sides // 2
    lines = [shape.edge(k, True) for k in range(2, half + 1)]
    ends = [np.abs(line.middle).max() + line.half_length for line in lines]
    canvas = Canvas(3, max(*ends, float(np.abs(circle).max())))
    # minus, here and below: the picture of a highlight is the mirror image of where the samples are
    for i, k, corners in shape.tiles():
        canvas.polygon(0, -corners, lighter(color(k - 2)))
        canvas.path(0, -corners, color(k - 2), 1.5)
        canvas.text(0, -corners.mean(axis=0), f"{i}·{k}", INK, 13)
    canvas.path(0, circle, FAINT, 1)
    canvas.path(0, outline, INK, 2)
    caption(canvas, 0, f"{len(shape.tiles())} parallelograms,\nfirst · second edge")
    for panel, edges in ((1, range(1, half)), (2, range(2, half + 1))):
        canvas.path(panel, circle, FAINT, 1)
        canvas.path(panel, outline, FAINT, 1)
        for k in edges:
            line = shape.edge(k, panel == 2)
            paint = INK if panel == 1 else color(k - 2)
            canvas.path(panel, np.array([-line.middle - line.half, -line.middle + line.half]), paint, 4)
            beside = -line.middle + 0.06 * np.array([-line.half[1], line.half[0]]) / line.half_length
            canvas.text(panel, beside, str(k), paint, 15)
        canvas.dot(panel, np.zeros(2), INK, 3)
    caption(canvas, 1, "first pass: a blur along\neach line, mixed to targets")
    shares = ", ".join(f"{k}: {weight:.3f}" for k, weight in shape.weights.items())
    caption(canvas, 2, f"second pass: its weights\n{shares}")
    return canvas.finished()
