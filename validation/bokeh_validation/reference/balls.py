"""Ball arithmetic: numbers with how far off a correct device may be, through every operation.

A ball is a value and a radius. Each operation takes the radii of its operands along and adds its own rounding in
float32, so that what a device computes by the same formula lies within the ball of the result:

    a + b        ra + rb                                    + r |a + b|
    a b          |a| rb + |b| ra + ra rb                    + r |a b|
    a / b        (ra + |a / b| rb) / (|b| - rb)             + r |a / b|;   without bound where b may be 0
    max, min     the larger radius: neither is steeper than its operands
    sqrt, log2, exp2   the larger distance to the function at value - radius and value + radius, + r

    r = 4 x 2^-24: a division may be off by 2.5 units in the last place and the others by less (Vulkan, Direct3D 11);
    log2 and exp2 by 2^-21, times the argument in exp2.

Where a comparison is open, the result is the ball around both outcomes. Operands that depend on each other count as if
they did not, which makes balls larger than they need be, never smaller.

Without radii (None) the same expressions are plain float64.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bokeh_validation.reference import sampling
from bokeh_validation.reference.images import Image
from bokeh_validation.reference.precision import FLOAT_STEP, Precision

OPERATION = 4 * FLOAT_STEP
FUNCTION = 2.0**-21


@dataclass(frozen=True, eq=False)
class Ball:
    """Values (any shape) and their radii (the same shape), or None."""

    value: np.ndarray
    radius: np.ndarray | None = None

    # NumPy's own operators give way to these
    __array_ufunc__ = None

    def _with(self, other: "Ball | np.ndarray | float", value: Callable, radius: Callable) -> "Ball":
        other = other if isinstance(other, Ball) else Ball(np.asarray(other, np.float64), 0.0)
        with np.errstate(all="ignore"):
            result = value(self.value, other.value)
            if self.radius is None or other.radius is None:
                return Ball(result)
            found = radius(self.value, self.radius, other.value, other.radius, result)
        return Ball(result, np.where(np.isnan(found), np.inf, found))

    def __add__(self, other):
        return self._with(other, np.add, lambda a, ra, b, rb, c: ra + rb + OPERATION * np.abs(c))

    def __sub__(self, other):
        return self._with(other, np.subtract, lambda a, ra, b, rb, c: ra + rb + OPERATION * np.abs(c))

    def __mul__(self, other):
        return self._with(other, np.multiply, _product)

    def __truediv__(self, other):
        return self._with(other, np.divide, _quotient)

    __radd__ = __add__
    __rmul__ = __mul__

    def __rsub__(self, other):
        return -self + other

    def __rtruediv__(self, other):
        return Ball(np.asarray(other, np.float64), None if self.radius is None else 0.0) / self

    def __neg__(self):
        return Ball(-self.value, self.radius)

    def __getitem__(self, key):
        return Ball(self.value[key], None if self.radius is None else self.radius[key])


def _product(a, ra, b, rb, c):
    # 0 times an endless radius is 0: a weight of 0 takes no part
    return np.where(
        ((a == 0) & (ra == 0)) | ((b == 0) & (rb == 0)), 0.0, np.abs(a) * rb + np.abs(b) * ra + ra * rb
    ) + OPERATION * np.abs(c)


def _quotient(a, ra, b, rb, c):
    least = np.abs(b) - rb
    return np.where(least > 0, (ra + np.abs(c) * rb) / least, np.inf) + OPERATION * np.abs(c)


def exact(value, like: Ball) -> Ball:
    """A ball of radius 0, or without radius as `like` is."""
    value = np.asarray(value, np.float64)
    return Ball(value, None if like.radius is None else np.zeros_like(value))


def maximum(a: Ball, b: Ball | float) -> Ball:
    """The larger of two."""
    return a._with(b, np.maximum, lambda a, ra, b, rb, c: _hull(np.maximum, a, ra, b, rb, c))


def minimum(a: Ball, b: Ball | float) -> Ball:
    """The smaller of two."""
    return a._with(b, np.minimum, lambda a, ra, b, rb, c: _hull(np.minimum, a, ra, b, rb, c))


def _hull(function, a, ra, b, rb, c):
    return np.maximum(function(a + ra, b + rb) - c, c - function(a - ra, b - rb))


def reciprocal(a: Ball, least: Ball | float) -> Ball:
    """1 / max(a, least), bounded also where the ball of `a` reaches below `least`, which is more than 0."""
    least = least if isinstance(least, Ball) else exact(np.full_like(a.value, least), a)
    value = 1.0 / np.maximum(a.value, least.value)
    if a.radius is None or least.radius is None:
        return Ball(value)
    with np.errstate(all="ignore"):
        largest = 1.0 / np.maximum(a.value - a.radius, least.value - least.radius)
        smallest = 1.0 / np.maximum(a.value + a.radius, least.value + least.radius)
    radius = np.where(largest > 0.0, np.maximum(largest - value, value - smallest), np.inf)
    return Ball(value, radius + OPERATION * value)


def clamp(a: Ball, low: float, high: float) -> Ball:
    """Between two numbers; a radius without bound has one then."""
    return minimum(maximum(a, low), high)


def absolute(a: Ball) -> Ball:
    """Without sign."""
    return Ball(np.abs(a.value), a.radius)


def monotone(a: Ball, function: Callable, rounding: Callable) -> Ball:
    """A function that only grows, or only falls; `rounding` of its value is what it adds."""
    with np.errstate(all="ignore"):
        value = function(a.value)
        if a.radius is None:
            return Ball(value)
        ends = np.abs(function(a.value + a.radius) - value), np.abs(value - function(a.value - a.radius))
        radius = np.maximum(*ends) + rounding(value)
    return Ball(value, np.where(np.isnan(radius), np.inf, radius))


def sqrt(a: Ball) -> Ball:
    """Square root; of what may be below 0, as of 0."""
    return monotone(a, lambda x: np.sqrt(np.maximum(x, 0.0)), lambda v: OPERATION * v)


def log2(a: Ball) -> Ball:
    """Logarithm."""
    return monotone(a, lambda x: np.log2(np.maximum(x, 1e-30)), lambda v: FUNCTION + OPERATION * np.abs(v))


def exp2(a: Ball) -> Ball:
    """Power of two. The argument's own size counts: a device rounds it first."""
    return monotone(a, np.exp2, lambda v: v * FUNCTION * (1.0 + np.abs(np.log2(np.maximum(v, 1e-300)))))


def select(less: Ball, than: Ball | float, yes: Ball, no: Ball) -> Ball:
    """`yes` where less < than, else `no`; both where that is open. All of one shape, or with channels at the end."""
    gap = less - than
    value = gap.value
    open_, first = None, value < 0.0
    if gap.radius is not None:
        open_ = np.abs(value) <= gap.radius
    while first.ndim < yes.value.ndim:
        first = first[..., None]
        open_ = None if open_ is None else open_[..., None]
    value = np.where(first, yes.value, no.value)
    if open_ is None or yes.radius is None or no.radius is None:
        return Ball(value)
    with np.errstate(invalid="ignore"):
        both = np.abs(yes.value - no.value) + np.maximum(yes.radius, no.radius)
        both = np.where(np.isnan(both), np.inf, both)
    return Ball(value, np.where(open_, both, np.where(first, yes.radius, no.radius)))


def stack(*channels: Ball) -> Ball:
    """Channels (H, W) to (H, W, C)."""
    value = np.stack([channel.value for channel in channels], axis=-1)
    if channels[0].radius is None:
        return Ball(value)
    return Ball(value, np.stack([np.broadcast_to(c.radius, c.value.shape) for c in channels], axis=-1))


class Texture:
    """A texture as a linear filter with clamp reads it."""

    def __init__(self, image: Image, precision: Precision | None):
        self.image, self.precision = image, precision
        self.size = image.size
        if precision:
            across, down = sampling.slopes(image.value)
            error = np.zeros_like(image.value) if image.error is None else image.error
            still = sampling.neighbourhood(error) + precision.filter * sampling.neighbourhood(np.abs(image.value))
            near = (still, across, down)
            # of 3 x 3 texels, for places off by half a texel; of 5 x 5, by one and a half
            wide = tuple(sampling.neighbourhood(field) for field in near)
            self.near, self.wide = (
                [field.reshape(-1, image.value.shape[2]) for field in fields] for fields in (near, wide)
            )

    def fetch(self, x: Ball, y: Ball) -> Ball:
        """At places in texels from the corner, (H, W, C)."""
        value = sampling.bilinear(self.image.value, x.value, y.value)
        if self.precision is None:
            return Ball(value)
        texel = sampling.nearest_index(x.value, y.value, self.size)
        off_x = self.precision.place(self.size[0]) + x.radius
        off_y = self.precision.place(self.size[1]) + y.radius
        off = np.maximum(off_x, off_y)
        off_x, off_y = np.minimum(off_x, 1.5)[..., None], np.minimum(off_y, 1.5)[..., None]
        still, across, down = (field.take(texel, axis=0) for field in self.near)
        radius = still + off_x * across + off_y * down
        far = off > 0.5
        if far.any():
            still, across, down = (field.take(texel[far], axis=0) for field in self.wide)
            radius[far] = still + off_x[far] * across + off_y[far] * down
        # of what is farther off the slopes say nothing
        radius[off > 1.5] = np.inf
        return Ball(value, radius)
