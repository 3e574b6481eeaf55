"""`validation/run aperture`: the line passes that make a convex polygon with min, and how much light they keep."""

import math
from typing import Annotated

import numpy as np
import typer

from bokeh_validation import terminal
from bokeh_validation.errors import UserError
from bokeh_validation.frame.apertures import regular_polygon
from bokeh_validation.frame.decomposition import MAX_DIRECTIONS, decompose

MAX_SQUEEZE = 16.0
ROW = "{:<6}{:<20}{:>7}  {:>10}  {:>15}  {:>16}  {:>16}  {:<9}  {}"


def aperture(
    sides: Annotated[int | None, typer.Option(help="A regular polygon, first corner straight up.")] = None,
    vertices: Annotated[
        str | None, typer.Option(metavar='"x,y x,y ..."', help="Any convex polygon: x right, y down, unit: the CoC.")
    ] = None,
    rotation: Annotated[float, typer.Option(help="Degrees, from +x towards +y (down).")] = 0.0,
    squeeze: Annotated[float, typer.Option(help="Width of the bokeh over its height, as BokehSqueeze.")] = 1.0,
    json_file: terminal.JsonFile = None,
) -> None:
    """The line passes that make a polygon with min (docs/apertures.md)."""
    if (sides is None) == (vertices is None):
        raise UserError("aperture: give either --sides or --vertices.")
    if not math.isfinite(rotation):
        raise UserError(f"--rotation {rotation:g} degrees: not allowed. Give any finite number.")
    if not 0.0 < squeeze <= MAX_SQUEEZE:
        raise UserError(f"--squeeze {squeeze:g}: not allowed. Give more than 0, at most {MAX_SQUEEZE:g}.")
    if sides is not None and (not 3 <= sides <= 2 * MAX_DIRECTIONS or (sides % 2 and sides > MAX_DIRECTIONS)):
        advice = f"Give 3 to {MAX_DIRECTIONS}, or an even number up to {2 * MAX_DIRECTIONS}."
        raise UserError(f"--sides {sides}: each direction of a side is a pass. {advice}")
    terminal.check_writable(json_file)
    shape = decompose(parsed(vertices) if sides is None else regular_polygon(sides), rotation)
    passes = [
        {
            "pass": number,
            "entry": "BokehAdaptive" if line.combines is None else "BokehAdaptiveFinal",
            "degrees": line.angle,
            "parameters": {**line.parameters(), "BokehSqueeze": squeeze},
            "reads": None if line.reads is None else line.reads + 1,
            "combines": None if line.combines is None else line.combines + 1,
        }
        for number, line in enumerate(shape.passes, start=1)
    ]
    # passes are numbered from 1; the polygon is before the squeeze
    whole = {"polygon": shape.polygon.tolist(), "passes": passes, "light": shape.light, "bound": shape.bound}
    terminal.write_json(json_file, whole)
    terminal.tell(
        f"{shape.directions} directions of sides: {shape.parallelograms} parallelograms, {len(passes)} passes; "
        f"light kept {shape.light:.3f}, at most {shape.bound:.3f}"
    )
    names = [*shape.passes[0].parameters()]
    terminal.tell(ROW.format("pass", "entry", "degrees", *names, "ColorSamp", "ColorSampB"))
    for line in passes:
        numbers = [f"{line['degrees']:.2f}", *(f"{line['parameters'][name]:.6f}" for name in names)]
        source, other = (f"pass {line[key]}" if line[key] else "" for key in ("reads", "combines"))
        terminal.tell(ROW.format(line["pass"], line["entry"], *numbers, source or "CoC map", other).rstrip())
    terminal.tell(f"in every pass: BokehSqueeze {squeeze:g}, BokehUseMax 0")


def parsed(text: str) -> np.ndarray:
    """Corners (n, 2) from 'x,y x,y ...'. Raises UserError."""
    corners = []
    for number, word in enumerate(text.split(), start=1):
        try:
            x, y = map(float, word.split(","))
        except ValueError:
            advice = "Give x,y without a space between: 0,-0.5 0.4,0.3 ..."
            raise UserError(f"--vertices: corner {number} is {word!r}. {advice}") from None
        corners.append((x, y))
    return np.array(corners).reshape(-1, 2)
