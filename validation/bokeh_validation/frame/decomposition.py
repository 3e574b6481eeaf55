"""`validation/run aperture`: which line passes make a convex polygon with min: docs/methods/polygons.md.

Polygons are (n, 2), x right and y down, in units of the circle of confusion (CoC), as the picture of a highlight shows
them. Angles are in degrees, from +x towards +y.
"""

import json
from dataclasses import dataclass
from functools import cache
from itertools import combinations
from math import radians, sin
from typing import Annotated, NamedTuple

import numpy as np
import typer

from bokeh_validation.errors import UserError
from bokeh_validation.frame import geometry
from bokeh_validation.frame.aperture_shapes import direction, regular_polygon, rotated

# CoC: how far a side may be moved out so that two are parallel or two chords equal. What rounding to three decimals
# does to a side; a third of a pixel where the CoC is 150 pixels wide.
TOLERANCE = 0.002
# CoC: places as near as this are the same.
MERGED = 1e-6
MAX_COORDINATE, MIN_WIDTH, MAX_DIRECTIONS = 2.0, 0.01, 12


@dataclass(frozen=True)
class LinePass:
    """One line pass: the mean along a segment.

    angle     degrees
    length    CoC
    center    middle of the segment of samples, (x, y) from the pixel, CoC. A highlight is shown where a pixel finds it,
              on the other side of it: this is minus the place of the line in the picture of a highlight.
    reads     index of the pass whose result it reads; None: the CoC map
    combines  index of the finished pass that min combines it with; None: none
    """

    angle: float
    length: float = 1.0
    center: tuple[float, float] = (0.0, 0.0)
    reads: int | None = None
    combines: int | None = None

    def parameters(self) -> dict[str, float]:
        """As the shaders name them."""
        center_x, center_y = self.center
        return {
            "BokehAngle": radians(self.angle),
            "BokehLineLength": self.length,
            "BokehLineCenterX": center_x,
            "BokehLineCenterY": center_y,
        }


class Decomposition(NamedTuple):
    """The passes of a polygon, in order, and what min leaves of the light of an isolated highlight.

    `bound` is the most of it that any number of parallelograms leaves.
    """

    passes: tuple[LinePass, ...]
    light: float
    bound: float


class Strip(NamedTuple):
    """Between two parallel lines that touch the polygon: their angle, and their places along `normal`, CoC.

    `free` is 'low' or 'high' where no side lies on that line, so that it may be farther out; else ''.
    """

    angle: float
    low: float
    high: float
    free: str = ""

    normal = property(lambda self: direction(radians(self.angle + 90.0)))
    width = property(lambda self: self.high - self.low)

    def chord(self, along: "Strip") -> float:
        """Length that it cuts out of a line along another strip: the side of their parallelogram, CoC."""
        return self.width / abs(sin(radians(self.angle - along.angle)))

    def border(self, side: np.ndarray, tolerance: float) -> str:
        """'low' or 'high' where a side (2, 2) of the polygon is on that line, else ''."""
        across = side @ self.normal
        if max(across) - self.low <= tolerance:
            return "low"
        return "high" if self.high - min(across) <= tolerance else ""

    def middle(self, width: float) -> float:
        """Along `normal`, with the free line farther out; or both, where none is free: by less than the tolerance."""
        middles = {"low": self.high - 0.5 * width, "high": self.low + 0.5 * width}
        return middles.get(self.free, 0.5 * (self.low + self.high))


# Parallelograms that begin with the same line: the hub, the leaves, and the line's length
Star = tuple[Strip, tuple[Strip, ...], float]
# Stars, after what they cost: the largest area, then numbers that add up
Choice = tuple[float, tuple[int, ...], tuple[Star, ...]]


def decompose(vertices: np.ndarray, rotation: float = 0.0, tolerance: float = TOLERANCE) -> Decomposition:
    """The passes of a convex polygon (n, 2): the fewest; among those the most light; then the fewest parallelograms.

    Where that leaves a choice: small parallelograms, shared lines along the axes of the image (samples on a slanting
    line ripple), small angles. Turned by `rotation` afterwards, so that a turning iris does not flicker. Raises
    UserError for what is no convex polygon, for more than MAX_DIRECTIONS, and for one too large or too thin.
    """
    polygon, tolerance = _checked(vertices), max(tolerance, MERGED)
    strips = strips_around(polygon, tolerance)
    if len(strips) > MAX_DIRECTIONS or min(strip.width for strip in strips) < MIN_WIDTH:
        advice = f"Give one of at most {MAX_DIRECTIONS}, each a pass, and {MIN_WIDTH:g} of the CoC wide."
        raise UserError(f"polygon: too many directions of sides ({len(strips)}), or too thin. {advice}")
    stars = sorted(_stars(strips, tolerance))
    passes: list[LinePass] = []
    finished = None
    for hub, leaves, chord in stars:
        # the shared line is centred on the pixel; all of the offset is in the second pass
        shared = len(passes)
        passes.append(LinePass(hub.angle + rotation, chord))
        for leaf in leaves:
            width = max(leaf.width, chord * abs(sin(radians(leaf.angle - hub.angle))))
            middles = hub.middle(hub.width), leaf.middle(width)
            # rounded, or it would print as -0 and 1e-17
            center = np.round(-np.linalg.solve(np.array([hub.normal, leaf.normal]), middles), 12)
            center = tuple(map(float, np.round(rotated(center, rotation), 12) + 0.0))
            passes.append(LinePass(leaf.angle + rotation, hub.chord(leaf), center, shared, finished))
            finished = len(passes) - 1
    area = abs(geometry.signed_area(polygon))
    light = area / max(chord * hub.width for hub, _, chord in stars)
    smallest = (min(i.chord(j) * j.width for i in strips if i is not j) for j in strips)
    return Decomposition(tuple(passes), light, area / max(smallest))


def _checked(vertices: np.ndarray) -> np.ndarray:
    """The polygon without repeated corners. Raises UserError."""
    polygon = np.array(list(dict.fromkeys(map(tuple, np.asarray(vertices, float).tolist()))))
    if len(polygon) < 3 or not (abs(polygon) <= MAX_COORDINATE).all():
        advice = f"Give three or more, x and y up to {MAX_COORDINATE:g}: the unit is the CoC, 1 = its diameter."
        raise UserError(f"polygon: {len(polygon)} different corners, or one is too far out. {advice}")
    for start, end in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        x, y = (end - start) / np.linalg.norm(end - start)
        places = (polygon - start) @ [-y, x]
        if places.min() < -MERGED and places.max() > MERGED:
            raise UserError("polygon: not convex. Give the corners of a convex polygon in order.")
    return polygon


def strips_around(polygon: np.ndarray, tolerance: float) -> list[Strip]:
    """One for each direction of the sides, by angle: sides on the borders of one strip have a direction in common."""
    ends = np.stack([polygon, np.roll(polygon, -1, axis=0)], axis=1)
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    strips: list[Strip] = []
    # the longest first: its ends would be moved most
    for side in ends[np.argsort(-lengths.round(9), kind="stable")]:
        if any(strip.border(side, tolerance) for strip in strips):
            continue
        x, y = side[1] - side[0]
        # rounded before the remainder is taken, so that it does not depend on the direction in which a side is walked
        angle = round(float(np.degrees(np.arctan2(y, x))), 10) % 180.0
        places = polygon @ Strip(angle, 0.0, 0.0).normal
        strip = Strip(angle, float(places.min()), float(places.max()))
        taken = {strip.border(other, tolerance) for other in ends}
        strips.append(strip._replace(free="".join({"low", "high"} - taken)))
    return sorted(strips)


def _stars(strips: list[Strip], tolerance: float) -> tuple[Star, ...]:
    """The groups that share out the directions; with one direction in two of them where there is no other way.

    All divisions are tried, each set of directions once: some 3^11 steps for 12 directions, a few seconds.
    """

    @cache
    def star(members: tuple[Strip, ...]) -> Choice | None:
        """With the best of them as the hub, if the leaves have one chord along it, or can be widened to it."""
        choices = []
        for hub in set(members):
            leaves = tuple(strip for strip in members if strip != hub)
            longest = max((leaf.chord(hub) for leaf in leaves), default=0.0)
            fits = all(leaf.free or longest - leaf.chord(hub) <= tolerance for leaf in leaves)
            if fits and len(set(leaves)) == len(members) - 1:
                area, count, slant = longest * hub.width, len(leaves), abs((hub.angle + 45.0) % 90.0 - 45.0)
                # rounded, so that noise does not decide between equals
                costs = count, *(round(1e6 * cost) for cost in (area * count, slant * count, hub.angle))
                choices.append((round(area, 9), costs, ((hub, leaves, longest),)))
        return min(choices, default=None)

    @cache
    def best(left: tuple[Strip, ...]) -> Choice | None:
        """The cheapest stars that have each of these directions as often as it is in `left`."""
        if not left:
            return 0.0, (0, 0, 0, 0), ()
        choices = []
        others = range(1, len(left))
        for picked in (set(some) for count in others for some in combinations(others, count)):
            first = star((left[0], *(left[index] for index in picked)))
            rest = first and best(tuple(left[index] for index in others if index not in picked))
            if rest:
                costs = tuple(map(sum, zip(first[1], rest[1], strict=True)))
                choices.append((max(first[0], rest[0]), costs, first[2] + rest[2]))
        return min(choices, default=None)

    twice = (best(tuple(sorted((*strips, strip)))) for strip in strips)
    return (best(tuple(strips)) or min(filter(None, twice)))[2]


def aperture(
    sides: Annotated[int | None, typer.Option(help="A regular polygon, first corner straight up.")] = None,
    vertices: Annotated[
        str | None, typer.Option(metavar='"x,y x,y ..."', help="Any convex polygon: x right, y down, unit: the CoC.")
    ] = None,
) -> None:
    """Print the line passes that make a polygon with min, as JSON (docs/methods/polygons.md); passes are numbered from
    1.
    """
    if (sides is None) == (vertices is None):
        raise UserError("aperture: give either --sides or --vertices.")
    if sides is not None and not 3 <= sides <= 2 * MAX_DIRECTIONS:
        raise UserError(f"--sides {sides}: not allowed. Give 3 to {2 * MAX_DIRECTIONS}.")
    shape = decompose(regular_polygon(sides) if vertices is None else parsed(vertices))
    passes = [
        {
            "pass": number,
            "entry": "BokehAdaptive" if line.combines is None else "BokehAdaptiveFinal",
            "degrees": line.angle,
            "parameters": line.parameters(),
            "reads": None if line.reads is None else line.reads + 1,
            "combines": None if line.combines is None else line.combines + 1,
        }
        for number, line in enumerate(shape.passes, start=1)
    ]
    typer.echo(json.dumps({"passes": passes, "light": shape.light, "bound": shape.bound}, indent=1))


def parsed(text: str) -> np.ndarray:
    """Corners (n, 2) from 'x,y x,y ...'. Raises UserError."""
    try:
        corners = [(float(x), float(y)) for x, y in (corner.split(",") for corner in text.split())]
    except ValueError:
        raise UserError(f"--vertices {text}: give x,y without a space between: 0,-0.5 0.4,0.3 ...") from None
    return np.array(corners).reshape(-1, 2)
