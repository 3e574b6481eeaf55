"""The picture of the layered method in float64: section [13] of the libraries, in ball arithmetic (balls.py).

Names are the shaders'. Radii of colours in a weighted mean would count each weight's error at the colour's full size;
so sums run over differences to the pixel in the middle, which is the same mean: sum(w c) / sum(w) =
m + sum(w (c - m)) / sum(w).
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from bokeh_validation.reference import balls, cuts, segments
from bokeh_validation.reference.balls import Ball
from bokeh_validation.reference.images import Image
from bokeh_validation.reference.layer_terms import (
    Constants,
    Sample,
    far_slope_of,
    near_slope_of,
    outline,
    part,
    share,
    spread_radius,
)
from bokeh_validation.reference.layers import Layers
from bokeh_validation.reference.precision import Precision
from bokeh_validation.shaders.entries import FIRST, SECOND, Entry


class Picture(Layers):
    """The last pass: a gather of what is in no layer, and the layers over and under it."""

    def _enlarged(self, index: int, x, y) -> Ball:
        """`BokehFetchLayer`."""
        if not self.layers.cubic:
            return self.fetch(index, x, y)
        texel_x, texel_y = np.floor(x - 0.5) + 0.5, np.floor(y - 0.5) + 0.5
        weights = []
        for f in (x - texel_x, y - texel_y):
            w0, w2 = f * (f * (1.0 - 0.5 * f) - 0.5), f * (f * (2.0 - 1.5 * f) + 0.5)
            w3 = f * f * (0.5 * f - 0.5)
            weights.append((w0, 1.0 - w0 - w3, w3, w2))
        (x0, x12, x3, x2), (y0, y12, y3, y2) = weights
        inner_x, inner_y = texel_x + x2 / x12, texel_y + y2 / y12
        fetched = [
            (self.fetch(index, inner_x, inner_y), x12 * y12),
            (self.fetch(index, texel_x - 1.0, inner_y), x0 * y12),
            (self.fetch(index, texel_x + 2.0, inner_y), x3 * y12),
            (self.fetch(index, inner_x, texel_y - 1.0), x12 * y0),
            (self.fetch(index, inner_x, texel_y + 2.0), x12 * y3),
        ]
        total = sum(weight for _, weight in fetched)
        mean = sum((item * weight[..., None] for item, weight in fetched), self.exact(0.0)) / total[..., None]
        least = most = fetched[0][0]
        for item, _ in fetched[1:]:
            least, most = balls.minimum(least, item), balls.maximum(most, item)
        return balls.minimum(balls.maximum(mean, least), most)

    def layered(self) -> list[Image]:
        """`BokehLayered`: map, reaches, near, far, middle, back."""
        return self.banded(self._layered)

    def _layered(self, x, y, rows) -> list[Ball]:
        layers = self.layers
        # Direct3D 9 has no fetch without a filter, so that its place counts here too
        center = self.fetch(0, x, y)
        own_color = center[..., :3]
        tile = self.fetch(1, x / 8.0, y / 8.0)
        s = center[..., 3] * layers.height
        near_slope, far_slope = near_slope_of(tile[..., 0]), far_slope_of(tile[..., 1])
        near_share, far_share = share(-s, near_slope), share(s, far_slope)
        add_far = balls.maximum(far_share, near_share)
        near, far = self._enlarged(2, 0.5 * x, 0.5 * y), self._enlarged(3, 0.5 * x, 0.5 * y)
        zero = self.exact(np.zeros_like(x))

        own_radius = spread_radius(s)
        rest = own_radius * balls.minimum(16.0 - 16.0 * far_share, 1.0) * (1.0 - near_share)
        radius = balls.maximum(rest, 0.5 * balls.maximum(tile[..., 2], tile[..., 3] * far_share))
        radius = balls.select(self.exact(0.998), near[..., 3], zero, radius)
        power = 1.0 + balls.clamp(balls.log2(balls.maximum(radius, 1.0) / balls.maximum(rest, 1.0)), 0.0, 1.0)
        radii = [zero, *(self._ring_radius(ring, radius, power) for ring in range(1, layers.rings + 2))]
        area = 0.25 * radii[1] * radii[1]
        weight = (1.0 - near_share) * (1.0 - far_share * add_far) * area
        total = weight * balls.reciprocal(own_radius * own_radius, area)
        steepness = 3.0 * balls.clamp((tile[..., 0] - 6.0) / 6.0, 0.0, 1.0)
        steepness = steepness + 100.0 * balls.clamp((tile[..., 0] - 16.0) / 16.0, 0.0, 1.0)
        # over differences to the pixel itself, so that errors of weights count by these
        color = self.exact(np.zeros((*x.shape, 3)))
        widest = color
        for ring in range(1, layers.rings + 1):
            before, current, following = radii[ring - 1], radii[ring], radii[ring + 1]
            inner, outer = 0.5 * (before + current), 0.5 * (current + following)
            if ring == layers.rings:
                outer = 1.5 * current - 0.5 * before
            offsets = outline(ring, layers)
            cell = (outer * outer - inner * inner) / float(len(offsets))
            slope = 1.0 / (outer - inner)
            for place, share_of_edge in self._ring_places(x, y, rows, ring, current):
                pixel = self.fetch(0, *(_towards_texel(value, steepness) for value in place))
                q = pixel[..., 3] * layers.height
                behind = balls.clamp((q - s) * 2.0, 0.0, 1.0) * (1.0 - near_share)
                # below 0 it is in no ring
                spread = 0.5 * balls.absolute(q) - 0.5
                spread = balls.minimum(spread + (own_radius - spread) * behind, radius)
                weight = (1.0 - share(-q, near_slope)) * (1.0 - share(q, far_slope) * add_far) * cell * share_of_edge
                weight = weight * balls.clamp((spread - inner) * slope, 0.0, 1.0)
                weight = weight * balls.reciprocal(spread * spread, area)
                total = total + weight
                away = pixel[..., :3] - own_color
                color = color + away * weight[..., None]
                widest = balls.maximum(widest, balls.absolute(away))
        return [self._composite(x, y, center, tile, near, far, near_share, add_far, color, total, widest)]

    def _ring_radius(self, ring: int, radius: Ball, power: Ball) -> Ball:
        """`BokehRingRadius`."""
        part = ring / (self.layers.rings + 0.5)
        return balls.maximum(radius * balls.exp2(power * np.log2(part)), float(ring))

    def _ring_places(self, x, y, rows, ring: int, current: Ball):
        """Where the samples of a ring are taken."""
        layers = self.layers
        for sample in outline(ring, layers):
            place_x, place_y = self.moved(x, y, sample, current, rows)
            if layers.jitter is not None:
                noise = Ball(layers.jitter[rows], layers.open_jitter[rows] if self.precision else None)
                phase = noise * balls.clamp(current / float(ring) - 1.0, 0.0, 1.0) * current
                next_x, next_y = part(sample.next_x, rows), part(sample.next_y, rows)
                place_x, place_y = place_x + phase * next_x, place_y + phase * next_y
            yield (place_x, place_y), self._share(sample, rows)

    def _share(self, sample: Sample, rows) -> Ball | float:
        """`BokehEdgeShare`: corners are no farther than 1 away and off by e = 2 cuts.TURNS lines, so twice a triangle
        is off by 2 e, and so is its mean: 8 areas of the polygon, a tenth of a square's or more, over its sides.
        """
        if self.layers.lengths is None:
            return 1.0
        found = part(sample.share, rows)
        if self.precision is None:
            return Ball(found)
        return Ball(found, (1.0 + found) * 10.0 * self.layers.sides * cuts.TURNS * self.precision.line)

    def _composite(self, x, y, center, tile, near, far, near_share, add_far, color, total, widest) -> Ball:
        """What `BokehLayered` does after the gather.

        color   sum of weights times (colour - the pixel's own)
        widest  largest such difference: a mean of colours, whatever the weights, is no farther from the pixel's own
        """
        own = center[..., :3]
        far_alpha = far[..., 3]
        plain_total = total + far_alpha * add_far
        plain = color + (far[..., :3] - far_alpha[..., None] * own) * add_far[..., None]
        plain = own + plain * balls.reciprocal(plain_total, 1e-3)[..., None]
        if plain.radius is not None:
            far_color = far[..., :3] * balls.reciprocal(far_alpha, 1e-6)[..., None]
            widest = balls.maximum(widest, balls.absolute(far_color - own))
            plain = Ball(plain.value, np.minimum(plain.radius, 2.0 * (widest.value + widest.radius)))
        middle, back = self.fetch(4, 0.25 * x, 0.25 * y), self.fetch(5, 0.25 * x, 0.25 * y)
        empty = 1.0 - balls.minimum(total, 1.0)
        cover = empty * near_share * balls.clamp((middle[..., 3] - 0.3) / 0.4, 0.0, 1.0)
        alpha = balls.minimum(far_alpha, 1.0)
        missing = (1.0 - alpha) * (1.0 - 0.25 * balls.minimum(alpha / 0.05, 1.0))
        background = far[..., :3] * ((1.0 - missing) * balls.reciprocal(far_alpha, 1e-6))[..., None]
        background = background + back[..., :3] * missing[..., None]
        sum_rgb = color + own * total[..., None]
        stack = sum_rgb * balls.reciprocal(total, 1.0)[..., None] + middle[..., :3] * cover[..., None]
        stack = stack + background * (empty - cover)[..., None]
        few = self.exact(1e-3)
        result = balls.select(plain_total, few, own, plain)
        behind = balls.select(plain_total, few, stack, result)
        mixed = behind + (stack - behind) * near_share[..., None]
        result = balls.select(self.exact(0.0), near_share, mixed, result)
        cover = balls.minimum(near[..., 3] * 1.002, 1.0)
        result = (
            result * (1.0 - cover)[..., None]
            + near[..., :3] * (cover * balls.reciprocal(near[..., 3], 1e-6))[..., None]
        )
        reaches = balls.maximum(tile[..., 0], tile[..., 1])
        result = balls.select(self.exact(1.0), reaches, result, own)
        return balls.stack(result[..., 0], result[..., 1], result[..., 2], center[..., 3])


def _towards_texel(place: Ball, steepness: Ball) -> Ball:
    """A place moved towards the nearest texel's centre, along one axis.

    It moves by less than what it is off where the whole number before it is another one than the value's, so that is
    the least radius there.
    """
    before = np.floor(place.value - 0.5)
    f = place - (before + 0.5)
    moved = (before + 0.5) + balls.clamp(f + (f - 0.5) * steepness, 0.0, 1.0)
    if f.radius is None:
        return moved
    open_ = (f.value - f.radius < 0.0) | (f.value + f.radius > 1.0)
    return Ball(moved.value, np.where(open_, np.maximum(moved.radius, f.radius), moved.radius))


def run_pass(
    entry: Entry,
    textures: Sequence[Image],
    size: tuple[int, int],
    values: Mapping[str, float],
    defines: Mapping[str, int],
    precision: Precision | None,
) -> list[Image]:
    """What a layered entry writes to each of its targets; textures in the order of their slots."""
    width, height = round(values["BokehImageWidth"]), round(values["BokehImageHeight"])
    sides = entry.sides or min(max(round(values["BokehSides"]), 4), 10)
    jitter = open_jitter = None
    if values["BokehJitter"] > 0.0:
        index = 2 if entry.name == "BokehLayered" else int(entry.role == SECOND)
        quality = segments.quality(size, 1.0, 2, values["BokehJitter"], values["BokehFrame"], index)
        jitter, open_jitter = quality.jitter, quality.open
    constants = Constants(
        width,
        height,
        sides,
        values["BokehAngle"],
        values["BokehSqueeze"],
        float(np.float32(values["BokehMaxCoC"]) * np.float32(height)),
        jitter,
        open_jitter,
        defines["BOKEH_LAYER_RINGS"],
        defines["BOKEH_LAYER_CELLS"],
        bool(defines["BOKEH_LAYER_CUBIC"]),
        cuts.of_target(size, sides, values, defines),
    )
    run = Picture(textures, size, constants, precision)
    edge, is_far = round(values["BokehEdge"]), values["BokehLayer"] > 0.5
    axis = (1.0 - values["BokehAxis"], values["BokehAxis"])
    if entry.role == FIRST:
        return run.first(is_far, range(2, sides // 2 + 1))
    if entry.role == SECOND:
        return run.second(is_far)
    name = entry.whole or entry.name
    special: dict[str, Callable[[], list[Image]]] = {
        "BokehLayerReach": lambda: run.reach(axis),
        "BokehLayerEdge": lambda: run.first(is_far, [edge]),
        "BokehLayered": run.layered,
    }
    # BokehLayerTiles is run.tiles
    targets = special[name]() if name in special else getattr(run, name.removeprefix("BokehLayer").lower())()
    return [targets[edge - 2]] if entry.whole else targets
