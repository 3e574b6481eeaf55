"""The command `validation/run aperture`."""

from pathlib import Path
from typing import Annotated

import typer

from bokeh_validation import pictures, terminal
from bokeh_validation.frame import sheet, tiling


def aperture(
    sides: Annotated[int | None, typer.Option(help="A regular polygon, first corner straight up.")] = None,
    vertices: Annotated[
        str | None, typer.Option(metavar='"x,y x,y ..."', help="Any convex polygon: x right, y down, unit: the CoC.")
    ] = None,
    rotation: Annotated[float, typer.Option(help="Degrees, from +x towards +y (down).")] = 0.0,
    squeeze: Annotated[float, typer.Option(help="Width of the bokeh over its height, as BokehSqueeze.")] = 1.0,
    exact: Annotated[
        bool, typer.Option("--exact", help="The two passes of the exact method: 4, 6, 8, 10 sides.")
    ] = False,
    output: Annotated[Path | None, typer.Option("-o", "--output", metavar="FILE.png", help="Draw it.")] = None,
    json_file: terminal.JsonFile = None,
) -> None:
    """The line passes that make a polygon with min, or the exact ones (docs/apertures.md)."""
    module, make = (tiling, tiling.tiling) if exact else (sheet, sheet.sheet)
    page = make(sides, vertices, rotation, squeeze)
    terminal.check_writable(output, json_file)
    if output is not None:
        pictures.write_png(output, module.picture(page))
    terminal.write_json(json_file, module.as_json(page))
    terminal.tell(module.summary(page), *module.table(page))
