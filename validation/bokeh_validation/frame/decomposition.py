"""Which line passes make a convex polygon: the rule that section 4.5 looks for, as docs/apertures.md states it.

A convex polygon is the intersection of strips, one for each direction of its edges; two strips have a parallelogram in
common, which is two line passes. Parallelograms (j, i) and (j, k) can begin with the same line along j where the chords
that i and k cut out of it are equal, or can be made so at no cost of light. So they are stars that share out the
directions: a hub, whose line comes first, and its leaves, m parallelograms in m + 1 passes. Light is lost by the
largest parallelogram; a direction's smallest one is with another edge's, and the largest of those bounds the light.

The shape. Every strip contains the polygon, and each side lies on the border of a strip. So the strips have exactly the
polygon in common, and so have the parallelograms, as every strip is in one. Widened strips still have their side.

Passes. Each side of the polygon needs a piece of a parallelogram's side, so each direction is a line pass: p directions
take at least p passes, and half as many parallelograms, rounded up. A group of m leaves takes m + 1 passes for its
m + 1 directions, so any division into groups takes p. Where p is odd, one group must have two leaves; if no such group
is possible (a square with one corner cut off unevenly), one direction is used twice, for p + 1.

Widening costs no light. A group's areas are the hub's width times the chords. The longest chord is there anyway; the
others grow up to it.

The most light. Keep side i and rotate the other side of a parallelogram around the polygon. Its area is w_i times the
length of the polygon's shadow on a line along i, cast along the other side. As the slope of the rays changes, that
length is convex and piecewise linear, with bends only where a ray runs along a side. So it is smallest along a side,
and no other direction helps. Let A be the area of the smallest parallelogram of i, for the i where that is largest.
Any set of parallelograms has one with i, so area / A is the most that can be kept: `bound`, the command's 'at most'.

Without parallel sides, p passes reach it. Join each direction with the partner of its smallest parallelogram. Remove,
one after the other, joins whose ends both have another. What is left are groups of a hub and its leaves, with all
directions in them and no parallelogram larger than A. The fewest are found by search: the cheapest division into groups
under a limit, in a bisection over the p (p - 1) / 2 areas. That takes at most 4^(p - 1) steps for each limit, 0.1 s for
twelve directions. Regular polygons reach it too: n directions, n / 2 for even n, each with the partner nearest to a
right angle, all parallelograms of equal area.

Polygons are (n, 2), x right and y down, in units of the circle of confusion (CoC), as the picture of a highlight shows
them. Angles are in degrees, from +x towards +y.
"""

from bisect import bisect_left
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from itertools import combinations
from math import radians, sin

import numpy as np

from bokeh_validation.errors import UserError
from bokeh_validation.frame import polygons
from bokeh_validation.frame.apertures import direction, rotated
from bokeh_validation.frame.convex import MERGED, checked, cross

# What rounding to three decimals does to a side; a third of a pixel where the CoC is 150 pixels wide.
TOLERANCE = 0.002
MAX_DIRECTIONS = 12
MIN_WIDTH = 0.01
# Areas are compared in steps of this size, relative, so that rounding does not decide between equals.
_STEP = 1e-9


@dataclass(frozen=True)
class Strip:
    """Between two parallel lines that touch the polygon.

    angle           degrees, 0 up to 180, of the lines
    low, high       the lines' places along `normal`, CoC
    free            'low' or 'high' where no edge lies on that line, so that it may be farther out; else None
    """

    angle: float
    low: float
    high: float
    free: str | None = None

    @property
    def normal(self) -> np.ndarray:
        """Unit vector (2,) across the strip."""
        return direction(radians(self.angle + 90.0))

    @property
    def width(self) -> float:
        """CoC."""
        return self.high - self.low

    def widened(self, width: float) -> "Strip":
        """The strip with its free line farther out; with both, where none is free: by less than the tolerance."""
        if self.free == "low":
            return replace(self, low=self.high - width)
        if self.free == "high":
            return replace(self, high=self.low + width)
        middle = 0.5 * (self.low + self.high)
        return replace(self, low=middle - 0.5 * width, high=middle + 0.5 * width)


@dataclass(frozen=True)
class Line:
    """One line pass: the mean along a segment.

    angle     degrees
    length    CoC
    center    middle of the segment of samples, (x, y) from the pixel, CoC. A highlight is shown where a pixel finds it,
              on the other side of it: this is minus the place of the line in the picture of a highlight.
    reads     index of the pass whose result it reads; None: the CoC map
    combines  index of the finished pass that min combines it with; None: none
    """

    angle: float
    length: float
    center: tuple[float, float]
    reads: int | None = None
    combines: int | None = None

    def parameters(self) -> dict[str, float]:
        """As the shaders name them."""
        return {
            "BokehAngle": radians(self.angle),
            "BokehLineLength": self.length,
            "BokehLineCenterX": self.center[0],
            "BokehLineCenterY": self.center[1],
        }


@dataclass(frozen=True, eq=False)
class Part:
    """A parallelogram: its corners (4, 2) in the picture of a highlight, and the indices of its two lines."""

    corners: np.ndarray
    first: int
    second: int

    @property
    def area(self) -> float:
        """CoC^2."""
        return abs(polygons.signed_area(self.corners))


@dataclass(frozen=True, eq=False)
class Decomposition:
    """The passes of a polygon.

    polygon     (n, 2), from +x towards +y, without corners that are none
    directions  angles of its edges, degrees; parallel edges count once
    lines       the passes, in order
    parts       the parallelograms, in the order in which they are finished
    bound       light kept cannot be more, however many parallelograms there are
    """

    polygon: np.ndarray
    directions: tuple[float, ...]
    lines: tuple[Line, ...]
    parts: tuple[Part, ...]
    bound: float

    @property
    def shared(self) -> int:
        """How many passes are saved by parallelograms that begin with the same line."""
        return 2 * len(self.parts) - len(self.lines)

    @property
    def light(self) -> float:
        """What min leaves of the light of an isolated highlight."""
        return abs(polygons.signed_area(self.polygon)) / max(part.area for part in self.parts)

    def rotated(self, rotation: float) -> "Decomposition":
        """Turned by `rotation` degrees: the same passes at every angle, so that a turning iris does not flicker."""
        return Decomposition(
            rotated(self.polygon, rotation),
            tuple(angle + rotation for angle in self.directions),
            tuple(
                replace(line, angle=line.angle + rotation, center=_point(rotated(np.array([line.center]), rotation)[0]))
                for line in self.lines
            ),
            tuple(replace(part, corners=rotated(part.corners, rotation)) for part in self.parts),
            self.bound,
        )


def strips(polygon: np.ndarray, tolerance: float = TOLERANCE) -> list[Strip]:
    """One strip for each direction of the edges of a checked polygon, by angle.

    tolerance  CoC: opposite sides are parallel where a common direction moves none of their ends by more
    """
    sides = np.roll(polygon, -1, axis=0) - polygon
    lengths = np.linalg.norm(sides, axis=1)
    found, alone = [], set(range(len(sides)))
    for a, b in combinations(range(len(sides)), 2):
        leaning = abs(cross(sides[a], sides[b])) / (lengths[a] * lengths[b])
        parallel = sides[a] @ sides[b] < 0.0 and leaning * max(lengths[a], lengths[b]) <= max(tolerance, MERGED)
        if parallel and alone.issuperset((a, b)):
            # the longer side counts more: its ends would move more
            found.append(_strip(polygon, sides[a] - sides[b], None))
            alone -= {a, b}
    found += [_strip(polygon, sides[index], index) for index in alone]
    return sorted(found, key=lambda strip: strip.angle)


def _strip(polygon: np.ndarray, side: np.ndarray, edge: int | None) -> Strip:
    """Along `side`; `edge`: index of the only edge on it."""
    # rounded before the remainder is taken, so that it does not depend on the direction in which a side is walked
    angle = round(float(np.degrees(np.arctan2(side[1], side[0]))), 10) % 180.0
    bare = Strip(angle, 0.0, 0.0)
    places = polygon @ bare.normal
    low, high = float(places.min()), float(places.max())
    if edge is None:
        return Strip(angle, low, high)
    return Strip(angle, low, high, "low" if places[edge] > 0.5 * (low + high) else "high")


# --------------------------------------------------------------------------------------------------------------- rule


def chord(strip: Strip, along: Strip) -> float:
    """Length that `strip` cuts out of a line along another one: the side of their parallelogram, CoC."""
    return strip.width / abs(sin(radians(strip.angle - along.angle)))


@dataclass(frozen=True)
class Star:
    """Parallelograms that begin with the same line: indices of the hub's strip and of the leaves', and the chord."""

    hub: int
    leaves: tuple[int, ...]
    chord: float


def decompose(vertices: np.ndarray, tolerance: float = TOLERANCE) -> Decomposition:
    """The passes of a convex polygon (n, 2): the fewest; among those the most light; then the fewest parallelograms.

    tolerance  CoC: how far a side may be moved out so that two are parallel, or two chords equal

    Where that leaves a choice: small parallelograms, shared lines along the axes of the image (samples on a slanting
    line ripple), small angles. p directions make p passes, or p + 1 where p is odd and no two parallelograms can share
    a line. The search is exact: a bisection over the areas of p (p - 1) / 2 pairs, and in each step the cheapest way to
    share out the directions among stars, at most 4^(p - 1) steps, far fewer as a rule (0.1 s for 12 directions).
    Raises UserError as `checked` does, for more than MAX_DIRECTIONS directions and for one thinner than MIN_WIDTH.
    """
    polygon = checked(vertices)
    found = strips(polygon, tolerance)
    if len(found) > MAX_DIRECTIONS:
        raise UserError(
            f"polygon: {len(found)} directions of sides are more than {MAX_DIRECTIONS}, and each is a pass. "
            "Give a polygon with fewer sides."
        )
    if min(strip.width for strip in found) < MIN_WIDTH:
        raise UserError(f"polygon: thinner than {MIN_WIDTH:g} of the CoC. Give a wider one.")
    lines, parts = _passes(found, _stars(found, tolerance))
    bound = abs(polygons.signed_area(polygon)) / _least_area(found)
    return Decomposition(polygon, tuple(strip.angle for strip in found), lines, parts, bound)


def _least_area(found: list[Strip]) -> float:
    """No parallelograms that make the polygon are all smaller: each direction with its best partner."""
    return max(min(chord(i, j) * j.width for i in found if i is not j) for j in found)


def _stars(found: list[Strip], tolerance: float) -> list[Star]:
    """The partition into stars; with one direction in two of them where there is no other way."""
    areas = sorted({chord(i, j) * j.width for i, j in combinations(found, 2)})
    for again in (0, 1):

        def stars(area: float, again: int = again) -> list[Star] | None:
            return _covered(found, area * (1.0 + _STEP), again, tolerance)

        least = bisect_left(areas, True, key=lambda area: stars(area) is not None)
        if least < len(areas):
            return stars(areas[least])
    raise AssertionError("one direction twice is always enough: pairs of directions, and one more")


def _covered(found: list[Strip], limit: float, again: int, tolerance: float) -> list[Star] | None:
    """Cheapest stars with parallelograms up to `limit`: every direction once, `again` of them twice; None: none do."""
    cheapest: dict[int, tuple[tuple[int, ...], Star]] = {}
    for star in _star_options(found, limit, tolerance):
        members = 1 << star.hub | sum(1 << leaf for leaf in star.leaves)
        cost = _cost(found, star, limit)
        if members not in cheapest or cost < cheapest[members][0]:
            cheapest[members] = cost, star
    # those that have a direction, and no lower one unless that is for the second time
    having = [
        [
            (members, best)
            for members, best in cheapest.items()
            if members >> k & 1 and (again or not members % (1 << k))
        ]
        for k in range(len(found))
    ]

    @cache
    def best(left: int, spare: int) -> tuple[tuple[int, ...], tuple[Star, ...]] | None:
        if not left:
            return (0,) * 4, ()
        answers = []
        for members, (cost, star) in having[(left & -left).bit_length() - 1]:
            used = (members & ~left).bit_count()
            rest = best(left & ~members, spare - used) if used <= spare else None
            if rest is not None:
                answers.append((tuple(map(sum, zip(cost, rest[0], strict=True))), (star, *rest[1])))
        return min(answers, key=lambda answer: answer[0], default=None)

    answer = best((1 << len(found)) - 1, again)
    return None if answer is None else sorted(answer[1], key=lambda star: (found[star.hub].angle, star.leaves))


def _star_options(found: list[Strip], limit: float, tolerance: float) -> Iterator[Star]:
    """Every star whose parallelograms are up to `limit` and have the same chord along the hub."""
    for hub, strip in enumerate(found):
        chords = {leaf: chord(other, strip) for leaf, other in enumerate(found) if leaf != hub}
        near = [leaf for leaf, length in chords.items() if length * strip.width <= limit]
        for count in range(1, len(near) + 1):
            for leaves in combinations(near, count):
                longest = max(chords[leaf] for leaf in leaves)
                short = [leaf for leaf in leaves if chords[leaf] < longest - max(tolerance, _STEP)]
                if all(found[leaf].free for leaf in short):
                    yield Star(hub, leaves, longest)


def _cost(found: list[Strip], star: Star, limit: float) -> tuple[int, ...]:
    """What is to be small, the weightiest first; whole numbers, so that equals are equal."""
    hub = found[star.hub]
    area = star.chord * hub.width / limit
    slant = abs((hub.angle + 45.0) % 90.0 - 45.0)
    count = len(star.leaves)
    return count, round(1e6 * area * count), round(1e6 * slant * count), round(1e6 * hub.angle)


# ------------------------------------------------------------------------------------------------------------- passes


def _passes(found: list[Strip], stars: Iterable[Star]) -> tuple[tuple[Line, ...], tuple[Part, ...]]:
    lines: list[Line] = []
    parts: list[Part] = []
    for star in stars:
        hub = found[star.hub]
        first = len(lines)
        # The shared line is centred on the pixel; all of the offset is in the second pass.
        lines.append(Line(hub.angle, star.chord, (0.0, 0.0)))
        for leaf in star.leaves:
            strip = found[leaf]
            side = star.chord * abs(sin(radians(strip.angle - hub.angle)))
            corners = _corners(hub, strip.widened(side) if side > strip.width else strip)
            finished = parts[-1].second if parts else None
            center = _point(-corners.mean(axis=0))
            lines.append(Line(strip.angle, chord(hub, strip), center, reads=first, combines=finished))
            parts.append(Part(corners, first, len(lines) - 1))
    return tuple(lines), tuple(parts)


def _corners(a: Strip, b: Strip) -> np.ndarray:
    """Corners in order, (4, 2), of the parallelogram that two strips have in common."""
    normals = np.array([a.normal, b.normal])
    places = [(a.low, b.low), (a.high, b.low), (a.high, b.high), (a.low, b.high)]
    return np.array([np.linalg.solve(normals, place) for place in places])


def _point(place: np.ndarray) -> tuple[float, float]:
    """Without the rounding that would print as -0 and 1e-17."""
    x, y = np.round(place, 12) + 0.0
    return float(x), float(y)
