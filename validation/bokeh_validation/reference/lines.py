"""The lines that a filter pass averages along: sections [2], [5] and [8] of the libraries."""

from dataclasses import dataclass

import numpy as np

from bokeh_validation.reference import cuts
from bokeh_validation.reference.segments import Segment, line_segment, parallelogram, polygon_edge, weight
from bokeh_validation.shaders.entries import ADAPTIVE, COLORS, EDGE, FIRST, GRID, LINE, SECOND
from bokeh_validation.shaders.passes import Pass


@dataclass(frozen=True)
class Line:
    """A line of a pass.

    slot    the texture that is averaged along it
    shares  its weight in each of the pass's targets, before these are normalised
    """

    slot: str
    segment: Segment
    shares: tuple[float, ...] = (1.0,)


def lines(item: Pass, size: tuple[int, int] | None = None) -> tuple[Line, ...]:
    """All lines of a filter pass; none for what is no such pass, takes its places from a table, or blurs layers.

    A grid of n x n samples is n lines of n. `size` is that of the target: with it, lines are those of every pixel where
    the lens has a character; without it, those of the middle of the image.
    """
    values, (entry, color) = item.given(), (item.spec, COLORS[0])
    angle, squeeze = values["BokehAngle"], values["BokehSqueeze"]
    if entry.role == LINE:
        return (Line(color, line_segment(angle, 1.0, (0.0, 0.0), squeeze)),)
    if entry.role == ADAPTIVE:
        middle = (values["BokehLineCenterX"], values["BokehLineCenterY"])
        return (Line(color, line_segment(angle, values["BokehLineLength"], middle, squeeze)),)
    if entry.role == GRID:
        across = line_segment(values["BokehAngleB"], 1.0, (0.0, 0.0), squeeze).half
        along = line_segment(angle, 1.0, (0.0, 0.0), squeeze).half
        return tuple(Line(color, Segment(t * across, along)) for t in np.linspace(-1.0, 1.0, item.samples))
    if entry.layers or entry.role not in (FIRST, SECOND, EDGE):
        return ()
    sides = entry.sides or round(values["BokehSides"])
    last = sides // 2
    lengths = cuts.of_target(size, sides, values, item.constants) if size else None

    def edge(k: int, second_pass: bool) -> Segment:
        return polygon_edge(k, sides, angle, squeeze, second_pass, lengths)

    if entry.role == SECOND:
        return tuple(Line(COLORS[k - 2], edge(k, True), (weight(k, sides, lengths),)) for k in range(2, last + 1))
    targets = range(2, last + 1) if entry.role == FIRST else (round(values["BokehEdge"]),)
    return tuple(
        Line(color, edge(i, False), tuple(parallelogram(k, i, sides, lengths) for k in targets))
        for i in range(1, max(targets))
    )
