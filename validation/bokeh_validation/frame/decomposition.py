"""Split a convex polygon into line passes that make it with min: `validation/run aperture`, docs/methods/polygons.md.

Polygons are (n, 2), x right and y down, in units of the circle of confusion (CoC), as seen in the image of a
highlight. Angles are in degrees, from +x towards +y.
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

# How far a side may be moved outwards to make two sides parallel or two chords equal, CoC. It is what rounding to
# three decimals does to a side, and a third of a pixel for a CoC of 150 pixels.
TOLERANCE = 0.002
# Points this close to each other are the same, CoC.
MERGED = 1e-6
MAX_COORDINATE, MIN_WIDTH, MAX_DIRECTIONS = 2.0, 0.01, 12


@dataclass(frozen=True)
class LinePass:
    """Describe one line pass, which averages along a segment.

    angle     degrees
    length    CoC
    center    middle of the segment of samples, (x, y) from the pixel, CoC. A pixel sees a highlight on the opposite
              side of itself, so this is minus the position of the line in the image of a highlight.
    reads     index of the pass whose result it reads; None: the CoC map
    combines  index of the finished pass that it is combined with by min; None: it is not combined
    """

    angle: float
    length: float = 1.0
    center: tuple[float, float] = (0.0, 0.0)
    reads: int | None = None
    combines: int | None = None

    def parameters(self) -> dict[str, float]:
        """Return the shaders' parameters for this line."""
        center_x, center_y = self.center
        return {
            "BokehAngle": radians(self.angle),
            "BokehLineLength": self.length,
            "BokehLineCenterX": center_x,
            "BokehLineCenterY": center_y,
        }


class Decomposition(NamedTuple):
    """Hold the passes of a polygon in order, and how much of an isolated highlight's light min leaves.

    light  fraction of the light that these passes leave
    bound  the largest fraction that any number of parallelograms could leave
    """

    passes: tuple[LinePass, ...]
    light: float
    bound: float


class Strip(NamedTuple):
    """Describe the strip between two parallel lines that touch the polygon.

    angle      degrees
    low, high  positions of the two lines along `normal`, CoC
    free       'low' or 'high' if no side of the polygon lies on that line, so that it may be moved outwards; else ''
    """

    angle: float
    low: float
    high: float
    free: str = ""

    normal = property(lambda self: direction(radians(self.angle + 90.0)))
    width = property(lambda self: self.high - self.low)

    def chord(self, along: "Strip") -> float:
        """Return the length of a line along another strip inside this one, CoC: a side of the parallelogram of both."""
        return self.width / abs(sin(radians(self.angle - along.angle)))

    def border(self, side: np.ndarray, tolerance: float) -> str:
        """Return 'low' or 'high' if a side (2, 2) of the polygon lies on that line, else ''."""
        across = side @ self.normal
        if max(across) - self.low <= tolerance:
            return "low"
        return "high" if self.high - min(across) <= tolerance else ""

    def middle(self, width: float) -> float:
        """Return the centre along `normal` of a strip widened to `width`, CoC.

        The free line moves outwards. If neither is free, both move, by less than the tolerance.
        """
        middles = {"low": self.high - 0.5 * width, "high": self.low + 0.5 * width}
        return middles.get(self.free, 0.5 * (self.low + self.high))


# Parallelograms that share their first line: the shared strip (hub), the other strips (leaves), and the line's length
Star = tuple[Strip, tuple[Strip, ...], float]
# A set of stars, preceded by its costs: the largest area, then costs that are summed over the stars
Choice = tuple[float, tuple[int, ...], tuple[Star, ...]]


def decompose(vertices: np.ndarray, rotation: float = 0.0, tolerance: float = TOLERANCE) -> Decomposition:
    """Return the passes of a convex polygon (n, 2), as few as possible; among equals, those that keep the most light.

    rotation   degrees, applied after the choice, so that a rotating iris does not switch between solutions
    tolerance  how far a side may be moved outwards, CoC

    Further ties are broken by the number of parallelograms, small parallelograms, shared lines along the image's axes
    (samples on a slanted line ripple) and small angles. Raises UserError if the polygon is not convex, has more than
    MAX_DIRECTIONS directions of sides, or is too large or too thin.
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
        # the shared line is centred on the pixel; the second pass has the whole offset
        shared = len(passes)
        passes.append(LinePass(hub.angle + rotation, chord))
        for leaf in leaves:
            width = max(leaf.width, chord * abs(sin(radians(leaf.angle - hub.angle))))
            middles = hub.middle(hub.width), leaf.middle(width)
            # rounded to avoid -0 and 1e-17 in the output
            center = np.round(-np.linalg.solve(np.array([hub.normal, leaf.normal]), middles), 12)
            center = tuple(map(float, np.round(rotated(center, rotation), 12) + 0.0))
            passes.append(LinePass(leaf.angle + rotation, hub.chord(leaf), center, shared, finished))
            finished = len(passes) - 1
    area = abs(geometry.signed_area(polygon))
    light = area / max(chord * hub.width for hub, _, chord in stars)
    smallest = (min(i.chord(j) * j.width for i in strips if i is not j) for j in strips)
    return Decomposition(tuple(passes), light, area / max(smallest))


def _checked(vertices: np.ndarray) -> np.ndarray:
    """Return the polygon without repeated corners. Raises UserError if it is too large or not convex."""
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
    """Return one strip for each direction of the polygon's sides, sorted by angle.

    Two sides on the borders of the same strip share a direction.
    """
    ends = np.stack([polygon, np.roll(polygon, -1, axis=0)], axis=1)
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    strips: list[Strip] = []
    # the longest side first, because its ends would have to move farthest
    for side in ends[np.argsort(-lengths.round(9), kind="stable")]:
        if any(strip.border(side, tolerance) for strip in strips):
            continue
        x, y = side[1] - side[0]
        # rounded before the remainder, so that the result does not depend on the direction in which the side is
        # traversed
        angle = round(float(np.degrees(np.arctan2(y, x))), 10) % 180.0
        places = polygon @ Strip(angle, 0.0, 0.0).normal
        strip = Strip(angle, float(places.min()), float(places.max()))
        taken = {strip.border(other, tolerance) for other in ends}
        strips.append(strip._replace(free="".join({"low", "high"} - taken)))
    return sorted(strips)


def _stars(strips: list[Strip], tolerance: float) -> tuple[Star, ...]:
    """Return the cheapest stars that cover all directions; one direction is used twice if there is no other way.

    All partitions are tried, each set of directions once: about 3^11 steps for 12 directions, a few seconds.
    """

    @cache
    def star(members: tuple[Strip, ...]) -> Choice | None:
        """Return the cheapest star of these strips, or None if no strip can be its hub.

        A strip can be the hub if all others have the same chord along it, or can be widened to it.
        """
        choices = []
        for hub in set(members):
            leaves = tuple(strip for strip in members if strip != hub)
            longest = max((leaf.chord(hub) for leaf in leaves), default=0.0)
            fits = all(leaf.free or longest - leaf.chord(hub) <= tolerance for leaf in leaves)
            if fits and len(set(leaves)) == len(members) - 1:
                area, count, slant = longest * hub.width, len(leaves), abs((hub.angle + 45.0) % 90.0 - 45.0)
                # rounded, so that rounding errors do not decide between equals
                costs = count, *(round(1e6 * cost) for cost in (area * count, slant * count, hub.angle))
                choices.append((round(area, 9), costs, ((hub, leaves, longest),)))
        return min(choices, default=None)

    @cache
    def best(left: tuple[Strip, ...]) -> Choice | None:
        """Return the cheapest set of stars that uses each strip as often as it occurs in `left`, or None."""
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
    """Parse 'x,y x,y ...' into corners (n, 2). Raises UserError."""
    try:
        corners = [(float(x), float(y)) for x, y in (corner.split(",") for corner in text.split())]
    except ValueError:
        raise UserError(f"--vertices {text}: give x,y without a space between: 0,-0.5 0.4,0.3 ...") from None
    return np.array(corners).reshape(-1, 2)
