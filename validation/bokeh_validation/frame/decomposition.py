"""Which line passes make a convex polygon with min: the rule of docs/apertures.md, which has its proof as well.

Polygons are (n, 2), x right and y down, in units of the circle of confusion (CoC), as the picture of a highlight shows
them. Angles are in degrees, from +x towards +y.
"""

from dataclasses import dataclass
from functools import cache
from itertools import combinations
from math import radians, sin
from typing import NamedTuple

import numpy as np

from bokeh_validation.errors import UserError
from bokeh_validation.frame import polygons
from bokeh_validation.frame.apertures import direction, rotated

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
        return {
            "BokehAngle": radians(self.angle),
            "BokehLineLength": self.length,
            "BokehLineCenterX": self.center[0],
            "BokehLineCenterY": self.center[1],
        }


@dataclass(frozen=True, eq=False)
class Decomposition:
    """The passes of a polygon (n, 2), in order; `directions` of its sides, parallel ones counted once.

    `light` is what min leaves of the light of an isolated highlight: `bound` at most, by however many parallelograms.
    """

    polygon: np.ndarray
    directions: int
    passes: tuple[LinePass, ...]
    light: float
    bound: float

    @property
    def parallelograms(self) -> int:
        """How many: each is finished by a pass that reads another."""
        return sum(line.reads is not None for line in self.passes)


class Strip(NamedTuple):
    """Between two parallel lines that touch the polygon: their angle, their places along `normal`, CoC.

    `free` is 'low' or 'high' where no side lies on that line, so that it may be farther out; else ''.
    """

    angle: float
    low: float
    high: float
    free: str

    normal = property(lambda self: direction(radians(self.angle + 90.0)))
    width = property(lambda self: self.high - self.low)

    def chord(self, along: "Strip") -> float:
        """Length that it cuts out of a line along another strip: the side of their parallelogram, CoC."""
        return self.width / abs(sin(radians(self.angle - along.angle)))

    def middle(self, width: float) -> float:
        """Along `normal`, with the free line farther out; or both, where none is free: by less than the tolerance."""
        middles = {"low": self.high - 0.5 * width, "high": self.low + 0.5 * width}
        return middles.get(self.free, 0.5 * (self.low + self.high))


class Star(NamedTuple):
    """Parallelograms that begin with the same line: the hub's and the leaves' indices, and the line's length."""

    hub: int
    leaves: tuple[int, ...]
    chord: float


# Stars, after what they cost: the largest area, then numbers that add up
Choice = tuple[float, tuple[int, ...], tuple[Star, ...]]


def decompose(vertices: np.ndarray, rotation: float = 0.0, tolerance: float = TOLERANCE) -> Decomposition:
    """The passes of a convex polygon (n, 2): the fewest; among those the most light; then the fewest parallelograms.

    Where that leaves a choice: small parallelograms, shared lines along the axes of the image (samples on a slanting
    line ripple), small angles. Turned by `rotation` afterwards, so that a turning iris does not flicker. Raises
    UserError for what is no convex polygon, for more than MAX_DIRECTIONS, and for one too large or too thin.
    """
    polygon = _checked(vertices)
    strips = strips_around(polygon, max(tolerance, MERGED))
    if len(strips) > MAX_DIRECTIONS:
        advice = "and each is a pass. Give a polygon with fewer sides."
        raise UserError(f"polygon: {len(strips)} directions of sides are more than {MAX_DIRECTIONS}, {advice}")
    if min(strip.width for strip in strips) < MIN_WIDTH:
        raise UserError(f"polygon: thinner than {MIN_WIDTH:g} of the CoC. Give a wider one.")
    stars = _stars(strips, max(tolerance, MERGED))
    passes: list[LinePass] = []
    finished = None
    for star in sorted(stars, key=lambda star: (strips[star.hub].angle, star.leaves)):
        hub, shared = strips[star.hub], len(passes)
        # the shared line is centred on the pixel; all of the offset is in the second pass
        passes.append(LinePass(hub.angle + rotation, star.chord))
        for leaf in (strips[index] for index in star.leaves):
            width = max(leaf.width, star.chord * abs(sin(radians(leaf.angle - hub.angle))))
            middles = hub.middle(hub.width), leaf.middle(width)
            # rounded, or it would print as -0 and 1e-17
            center = np.round(-np.linalg.solve(np.array([hub.normal, leaf.normal]), middles), 12)
            center = tuple(map(float, np.round(rotated(center, rotation), 12) + 0.0))
            passes.append(LinePass(leaf.angle + rotation, hub.chord(leaf), center, shared, finished))
            finished = len(passes) - 1
    area = abs(polygons.signed_area(polygon))
    light = area / max(star.chord * strips[star.hub].width for star in stars)
    smallest = (min(i.chord(j) * j.width for i in strips if i is not j) for j in strips)
    return Decomposition(rotated(polygon, rotation), len(strips), tuple(passes), light, area / max(smallest))


def _checked(vertices: np.ndarray) -> np.ndarray:
    """The polygon without repeated corners. Raises UserError, naming corners from 1 on."""
    polygon = np.array(list(dict.fromkeys(map(tuple, np.asarray(vertices, float).tolist()))))
    if len(polygon) < 3:
        raise UserError(f"polygon: {len(polygon)} different corners. Give three or more, x and y each.")
    for number, (x, y) in enumerate(polygon, start=1):
        if not max(abs(x), abs(y)) <= MAX_COORDINATE:
            advice = f"Give numbers up to {MAX_COORDINATE:g}: the unit is the CoC, 1 = its diameter."
            raise UserError(f"polygon: corner {number} is {x:g},{y:g}. {advice}")
    for number, (start, end) in enumerate(zip(polygon, np.roll(polygon, -1, axis=0), strict=True), start=1):
        x, y = (end - start) / np.linalg.norm(end - start)
        places = (polygon - start) @ [-y, x]
        if places.min() < -MERGED and places.max() > MERGED:
            advice = "Give the corners of a convex polygon in order."
            raise UserError(f"polygon: not convex: it is on both sides of the line from corner {number} on. {advice}")
    return polygon


def strips_around(polygon: np.ndarray, tolerance: float) -> list[Strip]:
    """One for each direction of the sides, by angle: sides on the borders of one strip have a direction in common."""
    ends = np.stack([polygon, np.roll(polygon, -1, axis=0)], axis=1)
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)

    def border(index: int, strip: Strip, length: float) -> str:
        """'low' or 'high' where a side is on that line, and a side as long as the strip's would be as well, else ''."""
        across = ends[index] @ strip.normal
        off = {"low": max(across) - strip.low, "high": strip.high - min(across)}
        leaning = np.ptp(across) / lengths[index] * length
        return next((line for line in off if max(off[line], leaning) <= tolerance), "")

    strips: dict[Strip, float] = {}
    # the longest first: its ends would be moved most
    for index in np.argsort(-lengths.round(9), kind="stable"):
        if any(border(index, *strip) for strip in strips.items()):
            continue
        x, y = ends[index, 1] - ends[index, 0]
        # rounded before the remainder is taken, so that it does not depend on the direction in which a side is walked
        angle = round(float(np.degrees(np.arctan2(y, x))), 10) % 180.0
        places = polygon @ Strip(angle, 0.0, 0.0, "").normal
        strip = Strip(angle, float(places.min()), float(places.max()), "")
        taken = {border(other, strip, lengths[index]) for other in range(len(polygon))}
        strips[strip._replace(free="".join({"low", "high"} - taken))] = lengths[index]
    return sorted(strips)


def _stars(strips: list[Strip], tolerance: float) -> tuple[Star, ...]:
    """The groups that share out the directions; with one direction in two of them where there is no other way.

    All divisions are tried, each set of directions once: some 3^11 steps for 12 directions, a second or two.
    """

    @cache
    def star(members: tuple[int, ...]) -> Choice | None:
        """With the best of them as the hub, if the leaves have one chord along it, or can be widened to it."""
        choices = []
        for hub in set(members):
            leaves = tuple(index for index in members if index != hub)
            chords = [strips[leaf].chord(strips[hub]) for leaf in leaves]
            rigid = [length for leaf, length in zip(leaves, chords, strict=True) if not strips[leaf].free]
            if len(set(leaves)) == len(members) - 1 and max(chords) - min(rigid, default=max(chords)) <= tolerance:
                area, angle, count = max(chords) * strips[hub].width, strips[hub].angle, len(leaves)
                slant = abs((angle + 45.0) % 90.0 - 45.0)
                # rounded, so that noise does not decide between equals
                costs = count, *(round(1e6 * cost) for cost in (area * count, slant * count, angle))
                choices.append((round(area, 9), costs, (Star(hub, leaves, max(chords)),)))
        return min(choices, default=None)

    @cache
    def best(left: tuple[int, ...]) -> Choice | None:
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

    every = range(len(strips))
    twice = (best(tuple(sorted((*every, index)))) for index in every)
    return (best(tuple(every)) or min(filter(None, twice)))[2]
