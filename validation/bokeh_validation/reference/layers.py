"""The layers in float64: sections [10] to [12] of the libraries, pass by pass, in ball arithmetic (balls.py)."""

from collections.abc import Callable, Sequence

import numpy as np

from bokeh_validation.reference import balls, cuts, segments
from bokeh_validation.reference.balls import Ball
from bokeh_validation.reference.images import Image
from bokeh_validation.reference.layer_terms import (
    Run,
    blur_weight,
    brightest,
    far_slope_of,
    near_slope_of,
    outline,
    reach_tiles,
    reaching,
    share,
    with_one,
)

MAX_COLOR = 65504.0


class Layers(Run):
    """The passes up to the finished layers, and what fills the holes behind near objects."""

    # [10] layers

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

    # [11] holes

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
                    place = self.moved(x, y, sample, radius, rows)
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

    # [12] polygons at half size

    def _line(self, index: int, x, y, rows, k: int, second_pass: bool, coc: Ball) -> Ball:
        """`BokehLayerLine`: mean along edge k."""
        layers = self.layers
        edge = (k, layers.sides, layers.rotation, layers.squeeze, second_pass, layers.lengths)
        segment = segments.polygon_edge(*edge).part(rows)
        half_length = self.exact(segment.half_length + np.zeros_like(x))
        if self.precision:
            half_length = Ball(half_length.value, half_length.radius + segment.stretch * self.precision.line)
        length = 2.0 * half_length * coc
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
                    turned = segment.turns * self.precision.line * (length_of + segment.half_length)
                    offset = Ball(offset.value, offset.radius + turned)
                place.append(self.exact(start) + offset * coc)
            total = total + self.fetch(index, *place) * cell[..., None]
        return total / cells[..., None]

    def _coc(self, index: int, x, y, is_far: bool) -> Ball:
        """`BokehLayerCoC`."""
        coc = 0.5 * self.fetch(index, x / 4.0, y / 4.0)[..., int(is_far)]
        return balls.sqrt(balls.maximum(coc * coc - 8.0, 0.25))

    def area(self, function: Callable, *edges: int, rows: slice) -> Ball | float:
        """segments.parallelogram or segments.weight of some edges, for colours of some rows."""
        found = function(*edges, self.layers.sides, self.layers.lengths)
        if self.layers.lengths is None:
            return found
        off = cuts.AREAS * cuts.STRETCH * self.precision.line if self.precision else None
        found = found[rows][..., None]
        return Ball(found, None if off is None else np.full_like(found, off))

    def first(self, is_far: bool, targets: Sequence[int]) -> list[Image]:
        """`BokehLayerFirst`: the targets T_k of `targets`."""

        def band(x, y, rows):
            coc = self._coc(1, x, y, is_far)
            lines = {i: self._line(0, x, y, rows, i, False, coc) for i in range(1, max(targets))}
            center = self.fetch(0, x, y)
            result = []
            for k in targets:
                areas = [self.area(segments.parallelogram, k, i, rows=rows) for i in range(1, k)]
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
            weights = [self.area(segments.weight, k, rows=rows) for k in edges]
            total = self.exact(0.0)
            for k, weight in zip(edges, weights, strict=True):
                total = total + weight * self._line(k - 2, x, y, rows, k, True, coc)
            return [balls.select(self.exact(0.5), coc, total / sum(weights), self.fetch(0, x, y))]

        return self.banded(band)
