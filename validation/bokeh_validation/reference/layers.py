"""The layered method in float64: sections [10] to [13] of the libraries, pass by pass, in ball arithmetic (balls.py).

Names are the shaders'. Radii of colours in a weighted mean would count each weight's error at the colour's full size;
so sums run over differences to the pixel in the middle, which is the same mean: sum(w c) / sum(w) =
m + sum(w (c - m)) / sum(w).
"""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from math import ceil, cos, floor, pi, sin

import numpy as np

from bokeh_validation.entries import FIRST, SECOND, Entry
from bokeh_validation.reference import balls, segments
from bokeh_validation.reference.balls import Ball, Texture
from bokeh_validation.reference.gather import BAND_ROWS, THREADS
from bokeh_validation.reference.images import Image
from bokeh_validation.reference.precision import FLOAT_STEP, Precision

MAX_COLOR = 65504.0


@dataclass(frozen=True)
class Layers:
    """`BokehLayers`, and what the library's constants say.

    height    of the image, pixels
    largest   possible CoC, pixels
    noise     (value, error, wraps) of segments.noise for the target, times the amount; None: no jitter
    """

    width: int
    height: int
    sides: int
    rotation: float
    squeeze: float
    largest: float
    jitter: np.ndarray | None
    open_jitter: np.ndarray | None
    rings: int
    cells: int
    cubic: bool


class Run:
    """One pass over some rows of its target, `size` texels in all."""

    def __init__(self, textures: Sequence[Image], size: tuple[int, int], layers: Layers, precision: Precision | None):
        self.textures = [Texture(image, precision) for image in textures]
        self.size, self.layers, self.precision = size, layers, precision

    def banded(self, function: Callable[[np.ndarray, np.ndarray, slice], Sequence[Ball]]) -> list[Image]:
        """`function(x, y, rows)` for all rows, in bands that stay in the cache; x, y texel centres (rows, W)."""
        width, height = self.size
        step = max(1, BAND_ROWS * 512 // max(width, 1))

        def band(start: int) -> Sequence[Ball]:
            rows = slice(start, min(start + step, height))
            y, x = np.mgrid[rows, 0:width] + 0.5
            return function(x, y, rows)

        with ThreadPoolExecutor(THREADS) as pool:
            parts = list(pool.map(band, range(0, height, step)))
        return [_image([part[i] for part in parts]) for i in range(len(parts[0]))]

    def exact(self, value) -> Ball:
        """Numbers that every device has alike."""
        value = np.asarray(value, np.float64)
        return Ball(value, np.zeros_like(value) if self.precision else None)

    def fetch(self, index: int, x, y) -> Ball:
        """A filtered fetch of a texture at places in its texels."""
        place = [value if isinstance(value, Ball) else self.exact(value) for value in (x, y)]
        return self.textures[index].fetch(*place)

    # ------------------------------------------------------------------------------------------------------------------
    # [10] layers
    # ------------------------------------------------------------------------------------------------------------------

    def tiles(self) -> list[Image]:
        """`BokehLayerTiles`."""

        def band(x, y, rows):
            found = self.exact(np.zeros((*x.shape, 3)))
            near, far, level = found[..., 0], found[..., 1], found[..., 2]
            for j in range(8):
                for i in range(8):
                    pixel = self.fetch(0, (x - 0.5) * 8 + 0.5 + i, (y - 0.5) * 8 + 0.5 + j)
                    s = pixel[..., 3] * self.layers.height
                    near, far = balls.maximum(near, -s), balls.maximum(far, s)
                    level = level + balls.log2(balls.maximum(brightest(pixel), 1e-5))
            near, far = balls.minimum(near, MAX_COLOR), balls.minimum(far, MAX_COLOR)
            return [balls.stack(near, far, level / 64.0, self.exact(np.ones_like(x)))]

        return self.banded(band)

    def reach(self, axis: tuple[float, float]) -> list[Image]:
        """`BokehLayerReach`."""

        def band(x, y, rows):
            radius = reach_tiles(self.layers)
            near, far, level = (self.exact(np.zeros_like(x)) for _ in range(3))
            for tiles in range(-radius, radius + 1):
                tile = self.fetch(0, x + axis[0] * tiles, y + axis[1] * tiles)
                near = balls.maximum(near, reaching(tile[..., 0], abs(tiles)))
                far = balls.maximum(far, reaching(tile[..., 1], abs(tiles)))
                level = level + tile[..., 2]
            return [balls.stack(near, far, level / (2.0 * radius + 1.0), self.exact(np.ones_like(x)))]

        return self.banded(band)

    def split(self) -> list[Image]:
        """`BokehLayerSplit`: near, far, sums, leftovers."""

        def band(x, y, rows):
            middle = (x - 0.5) * 2 + 1.0, (y - 0.5) * 2 + 1.0
            reach = self.fetch(1, middle[0] / 8, middle[1] / 8)
            near_slope, far_slope = near_slope_of(reach[..., 0]), far_slope_of(reach[..., 1])
            unit = balls.exp2(-reach[..., 2])
            zero = self.exact(np.zeros_like(x))
            far = self.exact(np.zeros((*x.shape, 4)))
            near = far
            sums = [zero] * 4
            left_near, left_far, largest = zero, zero, zero
            pixels = []
            for j in range(2):
                for i in range(2):
                    pixel = self.fetch(0, middle[0] + i - 0.5, middle[1] + j - 0.5)
                    s = pixel[..., 3] * self.layers.height
                    near_share, far_share = share(-s, near_slope), share(s, far_slope)
                    weight = far_share * blur_weight(brightest(pixel) * unit)
                    far = far + with_one(pixel) * far_share[..., None]
                    sums[2], sums[3] = sums[2] + weight * s / 128.0, sums[3] + weight
                    left_near = balls.maximum(left_near, -s * balls.minimum(4.0 - 4.0 * near_share, 1.0))
                    left_far = balls.maximum(left_far, s * balls.minimum(4.0 - 4.0 * far_share, 1.0))
                    largest = balls.maximum(largest, near_share)
                    pixels.append((pixel, s, near_share))
            behind = zero
            darkest = self.exact(np.full((*x.shape, 3), MAX_COLOR))
            endless = darkest
            for j in range(4):
                for i in range(4):
                    pixel = self.fetch(0, middle[0] + i - 1.5, middle[1] + j - 1.5)
                    near_share = share(-(pixel[..., 3] * self.layers.height), near_slope)
                    half = 0.5 * largest
                    behind = balls.maximum(behind, balls.select(near_share, half, brightest(pixel), zero))
                    darkest = balls.minimum(darkest, balls.select(near_share, half, endless, pixel[..., :3]))
            limit = brightest(darkest)
            for pixel, s, near_share in pixels:
                bright = brightest(pixel)
                clean = balls.minimum(pixel[..., :3], darkest)
                # within 0 and 1 where it is used
                part = balls.clamp((behind - bright) / (behind - limit), 0.0, 1.0)
                part = balls.select(limit, bright, part, self.exact(np.ones_like(x)))
                one = self.exact(np.ones_like(x))
                part = balls.select(bright, behind, part, one)
                color = balls.select(bright, behind, clean, pixel[..., :3])
                near_share = near_share * part
                weight = near_share * blur_weight(brightest(color) * unit)
                near = near + with_one(color) * near_share[..., None]
                sums[0], sums[1] = sums[0] - weight * s / 128.0, sums[1] + weight
            one = self.exact(np.ones_like(x))
            return [
                near * 0.25,
                far * 0.25,
                balls.minimum(balls.stack(*sums) * 0.25, MAX_COLOR),
                balls.stack(balls.minimum(left_near, MAX_COLOR), balls.minimum(left_far, MAX_COLOR), zero, one),
            ]

        return self.banded(band)

    def kernels(self) -> list[Image]:
        """`BokehLayerKernels`: leftovers, sums."""

        def band(x, y, rows):
            zero, one = self.exact(np.zeros_like(x)), self.exact(np.ones_like(x))
            sums, left = self.exact(np.zeros((*x.shape, 4))), self.exact(np.zeros((*x.shape, 2)))
            for j in range(4):
                for i in range(4):
                    place = (x - 0.5) * 4 + 0.5 + i, (y - 0.5) * 4 + 0.5 + j
                    sums = sums + self.fetch(0, *place)
                    left = balls.maximum(left, self.fetch(1, *place)[..., :2])
            return [balls.stack(left[..., 0], left[..., 1], zero, one), sums / 16.0]

        return self.banded(band)

    def _spread(self, x, y, axis: tuple[float, float]) -> tuple[Ball, Ball, Ball]:
        """Leftovers (H, W) near and far, and sums (H, W, 4)."""
        reach = self.fetch(2, x, y)
        sigma = [0.6 * balls.maximum(reach[..., k] / 16.0, 1.0) for k in (0, 1)]
        radius = reach_tiles(self.layers)
        zero = self.exact(np.zeros_like(x))
        left, total = [zero, zero], [zero, zero]
        sums = [zero] * 4
        for tiles in range(-radius, radius + 1):
            place = x + axis[0] * tiles, y + axis[1] * tiles
            found, around = self.fetch(1, *place), self.fetch(0, *place)
            for k in (0, 1):
                weight = balls.exp2(-0.5 * tiles * tiles / np.log(2.0) / (sigma[k] * sigma[k]))
                sums[2 * k] = sums[2 * k] + found[..., 2 * k] * weight
                sums[2 * k + 1] = sums[2 * k + 1] + found[..., 2 * k + 1] * weight
                total[k] = total[k] + weight
                left[k] = balls.maximum(left[k], reaching(around[..., k], abs(tiles)))
        return left[0], left[1], balls.stack(*(sums[k] / total[k // 2] for k in range(4)))

    def spread(self) -> list[Image]:
        """`BokehLayerSpread` along rows."""

        def band(x, y, rows):
            near, far, sums = self._spread(x, y, (1.0, 0.0))
            return [balls.stack(near, far, self.exact(np.zeros_like(x)), self.exact(np.ones_like(x))), sums]

        return self.banded(band)

    def sizes(self) -> list[Image]:
        """`BokehLayerSizes`: what reaches, CoC of the layers."""

        def band(x, y, rows):
            near, far, sums = self._spread(x, y, (0.0, 1.0))
            reach = self.fetch(2, x, y)
            zero, one = self.exact(np.zeros_like(x)), self.exact(np.ones_like(x))
            found = []
            for k, least in ((0, 6.0), (1, 10.0)):
                size = 128.0 * sums[..., 2 * k] * balls.reciprocal(sums[..., 2 * k + 1], 1e-4)
                size = balls.select(self.exact(1e-4), sums[..., 2 * k + 1], size, zero)
                found.append(balls.select(self.exact(least), reach[..., k], size, zero))
            return [balls.stack(reach[..., 0], reach[..., 1], near, far), balls.stack(*found, zero, one)]

        return self.banded(band)

    # ------------------------------------------------------------------------------------------------------------------
    # [11] holes
    # ------------------------------------------------------------------------------------------------------------------

    def holes(self) -> list[Image]:
        """`BokehLayerHoles`: middle, far, shares."""

        def band(x, y, rows):
            first = (x - 0.5) * 4 + 0.5, (y - 0.5) * 4 + 0.5
            reach = self.fetch(1, (first[0] + 1.5) / 8, (first[1] + 1.5) / 8)
            near_slope, far_slope = near_slope_of(reach[..., 0]), far_slope_of(reach[..., 1])
            unit = balls.exp2(-reach[..., 2])
            middle = far = self.exact(np.zeros((*x.shape, 4)))
            zero, one = self.exact(np.zeros_like(x)), self.exact(np.ones_like(x))
            in_middle, in_far = zero, zero
            for j in range(4):
                for i in range(4):
                    pixel = self.fetch(0, first[0] + i, first[1] + j)
                    s = pixel[..., 3] * self.layers.height
                    near_share = share(-s, near_slope)
                    not_near = balls.maximum(1.0 - 2.0 * near_share, 0.0625 - 0.0625 * near_share)
                    far_share = share(s, far_slope)
                    weight = not_near / (1.0 + brightest(pixel) * unit)
                    middle = middle + with_one(pixel) * (weight * (1.0 - far_share))[..., None]
                    far = far + with_one(pixel) * (weight * far_share)[..., None]
                    in_middle = in_middle + (1.0 - far_share) * not_near
                    in_far = in_far + far_share * not_near
            return [middle / 16.0, far / 16.0, balls.stack(in_middle / 16.0, in_far / 16.0, zero, one)]

        return self.banded(band)

    def fill(self) -> list[Image]:
        """`BokehLayerFill`: middle with its share, back."""

        def band(x, y, rows):
            reach = self.fetch(3, x / 2.0, y / 2.0)[..., 0]
            one, zero = self.exact(np.ones_like(x)), self.exact(np.zeros_like(x))
            center = [self.fetch(k, x, y) for k in range(3)]
            found = list(center)
            for ring in (1, 2):
                radius = balls.maximum(reach / 16.0, 1.0) * float(ring)
                weight = 1.0 / (1.0 + 16.0 * radius * radius)
                # no near layer, no holes
                weight = balls.select(reach, 6.0, zero, weight)
                for sample in outline(ring, self.layers):
                    place = self._moved(x, y, sample, radius)
                    for k in range(3):
                        found[k] = found[k] + self.fetch(k, *place) * weight[..., None]
            middle, far, shares = found
            both = (middle[..., :3] + far[..., :3]) * balls.reciprocal(middle[..., 3] + far[..., 3], 1e-6)[..., None]
            part = shares[..., 0] * balls.reciprocal(shares[..., 0] + shares[..., 1], 1e-6)
            least = self.exact(1e-6)
            result = []
            for item, alpha in ((middle, part), (far, one)):
                own = item[..., :3] * balls.reciprocal(item[..., 3], 1e-6)[..., None]
                own = balls.select(least, item[..., 3], own, both)
                result.append(balls.stack(own[..., 0], own[..., 1], own[..., 2], alpha))
            return result

        return self.banded(band)

    def _moved(self, x, y, sample: "Sample", scale: Ball) -> tuple[Ball, Ball]:
        """A place on the outline, times a scale.

        The shader turns one corner into the next, so each edge adds the error of sin and cos once more, and three
        roundings.
        """

        def along(offset: float) -> Ball:
            ball = self.exact(np.full_like(x, offset))
            if ball.radius is None:
                return ball
            turned = (sample.edge + 2) * (self.precision.line + 3 * FLOAT_STEP)
            return Ball(ball.value, ball.radius + turned * max(1.0, self.layers.squeeze))

        return self.exact(x) + along(sample.x) * scale, self.exact(y) + along(sample.y) * scale

    # ------------------------------------------------------------------------------------------------------------------
    # [12] polygons at half size
    # ------------------------------------------------------------------------------------------------------------------

    def _line(self, index: int, x, y, rows, k: int, second_pass: bool, coc: Ball) -> Ball:
        """`BokehLayerLine`: mean along edge k."""
        layers = self.layers
        segment = segments.polygon_edge(k, layers.sides, layers.rotation, layers.squeeze, second_pass)
        length = 2.0 * segment.half_length * coc
        cells = balls.clamp(length, 2.0, float(layers.cells))
        phase = self.exact(np.full_like(x, 0.5))
        if layers.jitter is not None:
            noise = Ball(layers.jitter[rows], layers.open_jitter[rows] if self.precision else None)
            phase = phase + noise * balls.clamp(length / cells - 1.0, 0.0, 1.0)
        total = self.exact(np.zeros((*x.shape, 4)))
        most = cells.value if cells.radius is None else cells.value + cells.radius
        for i in range(int(np.ceil(np.minimum(most.max(), layers.cells)))):
            cell = balls.clamp(cells - float(i), 0.0, 1.0)
            t = 2.0 * (float(i) + cell * phase) / cells - 1.0
            place = []
            for axis, start in ((0, x), (1, y)):
                offset = segment.middle[axis] + segment.half[axis] * t
                if self.precision:
                    length_of = abs(segment.middle[axis]) + abs(segment.half[axis])
                    offset = Ball(offset.value, offset.radius + self.precision.line * (length_of + segment.half_length))
                place.append(self.exact(start) + offset * coc)
            total = total + self.fetch(index, *place) * cell[..., None]
        return total / cells[..., None]

    def _coc(self, index: int, x, y, is_far: bool) -> Ball:
        """`BokehLayerCoC`."""
        coc = 0.5 * self.fetch(index, x / 4.0, y / 4.0)[..., int(is_far)]
        return balls.sqrt(balls.maximum(coc * coc - 8.0, 0.25))

    def first(self, is_far: bool, targets: Sequence[int]) -> list[Image]:
        """`BokehLayerFirst`: the targets T_k of `targets`."""
        sides = self.layers.sides

        def band(x, y, rows):
            coc = self._coc(1, x, y, is_far)
            lines = {i: self._line(0, x, y, rows, i, False, coc) for i in range(1, max(targets))}
            center = self.fetch(0, x, y)
            result = []
            for k in targets:
                areas = [segments.parallelogram(k, i, sides) for i in range(1, k)]
                mean = sum((area * lines[i] for i, area in enumerate(areas, 1)), self.exact(0.0)) / sum(areas)
                result.append(balls.select(self.exact(0.5), coc, mean, center))
            return result

        return self.banded(band)

    def second(self, is_far: bool) -> list[Image]:
        """`BokehLayerSecond`; the CoC of the layers are the last texture."""
        sides = self.layers.sides

        def band(x, y, rows):
            coc = self._coc(len(self.textures) - 1, x, y, is_far)
            edges = range(2, sides // 2 + 1)
            weights = [segments.weight(k, sides) for k in edges]
            total = self.exact(0.0)
            for k, weight in zip(edges, weights, strict=True):
                total = total + weight * self._line(k - 2, x, y, rows, k, True, coc)
            return [balls.select(self.exact(0.5), coc, total / sum(weights), self.fetch(0, x, y))]

        return self.banded(band)

    # ------------------------------------------------------------------------------------------------------------------
    # [13] the picture
    # ------------------------------------------------------------------------------------------------------------------

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
            for place in self._ring_places(x, y, rows, ring, current):
                pixel = self.fetch(0, *(_towards_texel(value, steepness) for value in place))
                q = pixel[..., 3] * layers.height
                behind = balls.clamp((q - s) * 2.0, 0.0, 1.0) * (1.0 - near_share)
                spread = spread_radius(q)
                spread = balls.minimum(spread + (own_radius - spread) * behind, radius)
                weight = (1.0 - share(-q, near_slope)) * (1.0 - share(q, far_slope) * add_far) * cell
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
            place_x, place_y = self._moved(x, y, sample, current)
            if layers.jitter is not None:
                noise = Ball(layers.jitter[rows], layers.open_jitter[rows] if self.precision else None)
                phase = noise * balls.clamp(current / float(ring) - 1.0, 0.0, 1.0) * current
                place_x, place_y = place_x + phase * sample.next_x, place_y + phase * sample.next_y
            yield place_x, place_y

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


def _image(parts: Sequence[Ball]) -> Image:
    """Bands to an image; undecided nowhere, since open comparisons are in the radius."""
    value = np.concatenate([part.value for part in parts])
    if parts[0].radius is None:
        return Image(value)
    radius = np.concatenate([np.broadcast_to(part.radius, part.value.shape) for part in parts])
    return Image(value, radius, np.zeros(value.shape[:2], bool))


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


def brightest(pixel: Ball) -> Ball:
    """`BokehBrightest`."""
    return balls.maximum(balls.maximum(pixel[..., 0], pixel[..., 1]), pixel[..., 2])


def with_one(pixel: Ball) -> Ball:
    """rgb, 1."""
    one = np.ones(pixel.value.shape[:-1])
    radius = None if pixel.radius is None else np.zeros_like(one)
    return balls.stack(pixel[..., 0], pixel[..., 1], pixel[..., 2], Ball(one, radius))


def slope_of(largest: Ball, none: float, whole: float) -> Ball:
    """`BokehLayerSlope`."""
    gate = balls.clamp((largest - none) / (whole - none), 0.001, 1.0)
    return 5.0 / balls.maximum(largest / gate, 2.0)


def near_slope_of(largest: Ball) -> Ball:
    """`BokehNearSlope`."""
    return slope_of(largest, 6.0, 12.0)


def far_slope_of(largest: Ball) -> Ball:
    """`BokehFarSlope`."""
    return slope_of(largest, 10.0, 16.0)


def share(coc: Ball, slope: Ball) -> Ball:
    """`BokehLayerShare`."""
    return balls.clamp(coc * slope - 2.0, 0.0, 1.0)


def reaching(coc: Ball, tiles: int) -> Ball:
    """`BokehReaching`."""
    return coc * balls.clamp(coc / 16.0 + (1.0 - max(tiles - 2.0, 0.0)), 0.0, 1.0)


def reach_tiles(layers: Layers) -> int:
    """`BokehReachTiles`."""
    return min(ceil(layers.largest / 16.0) + 2, 127)


def blur_weight(brightness: Ball) -> Ball:
    """`BokehBlurWeight`."""
    return balls.minimum(0.01 + brightness, 10000.0)


def spread_radius(s: Ball) -> Ball:
    """`BokehSpreadRadius`."""
    return balls.maximum(0.5 * balls.absolute(s) - 0.5, 0.0)


@dataclass(frozen=True)
class Sample:
    """A sample on the outline of a polygon with corners at a distance of 1.

    edge            it is on, 0 ..
    x, y            place
    next_x, next_y  from it to the next one on the edge
    """

    edge: int
    x: float
    y: float
    next_x: float
    next_y: float


def outline(ring: int, layers: Layers) -> list[Sample]:
    """The samples of a ring, `BokehOnEdge` on each edge."""
    sides = layers.sides
    corners = [layers.rotation + (2 * j - 1) * pi / sides for j in range(sides + 1)]
    points = np.array([(cos(angle) * layers.squeeze, sin(angle)) for angle in corners])
    on_edge = max(floor(6.0 * ring / sides + 0.5), 1)
    found = []
    for edge, (corner, following) in enumerate(zip(points[:-1], points[1:], strict=True)):
        along = (following - corner) / on_edge
        found += [Sample(edge, *(corner + along * i), *along) for i in range(on_edge)]
    return found


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
    layers = Layers(
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
    )
    run = Run(textures, size, layers, precision)
    edge, is_far = round(values["BokehEdge"]), values["BokehLayer"] > 0.5
    axis = (1.0 - values["BokehAxis"], values["BokehAxis"])
    calls: dict[str, Callable[[], list[Image]]] = {
        "BokehLayerTiles": run.tiles,
        "BokehLayerReach": lambda: run.reach(axis),
        "BokehLayerSplit": run.split,
        "BokehLayerKernels": run.kernels,
        "BokehLayerSpread": run.spread,
        "BokehLayerSizes": run.sizes,
        "BokehLayerHoles": run.holes,
        "BokehLayerFill": run.fill,
        "BokehLayerEdge": lambda: run.first(is_far, [edge]),
        "BokehLayered": run.layered,
    }
    if entry.whole:
        return [calls[entry.whole]()[edge - 2]]
    if entry.role == FIRST:
        return run.first(is_far, range(2, sides // 2 + 1))
    if entry.role == SECOND:
        return run.second(is_far)
    return calls[entry.name]()
