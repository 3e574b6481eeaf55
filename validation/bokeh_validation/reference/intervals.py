"""Compute with intervals: a float64 value, with limits that a correct device's float32 result of the same operations
keeps.

Each operation propagates the limits of its operands and adds its own rounding, relative to the result:

    + - *          2^-22: correct rounding is 2^-24, and the compiler may have rounded a constant operand
    /, sqrt        6 x 2^-24: 2.5 units in the last place, plus the above (Vulkan, Direct3D 11)
    exp, log2      2^-21; for exp also times the exponent's size, since a device rounds that first

Numbers that are the same on every device are exact as long as float32 can represent the result. Dependencies between
operands are ignored, which makes intervals wider than necessary but never narrower.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np

from bokeh_validation.numerics.precision import FLOAT_STEP

OPERATION, DIVISION, FUNCTION = 4 * FLOAT_STEP, 6 * FLOAT_STEP, 2.0**-21


@dataclass(eq=False)
class Interval:
    """Hold numbers of many pixels: (components, pixels), or (components, 1) if all pixels have the same.

    value      the numbers as float64 computes them
    low, high  limits, of the same shape; None: exact
    turned     length of a direction's error, (pixels,); the limits alone would grow with each rotation
    """

    value: np.ndarray
    low: np.ndarray | None = None
    high: np.ndarray | None = None
    turned: np.ndarray | None = None

    def __post_init__(self):
        if self.low is None:
            self.low = self.high = self.value

    @property
    def is_exact(self) -> bool:
        """Return whether the number is the same on every device."""
        return self.low is self.value

    @property
    def error(self) -> np.ndarray:
        """Return the larger distance from the value to a limit."""
        return np.maximum(self.high - self.value, self.value - self.low)

    def each(self, function: Callable[[np.ndarray], np.ndarray]) -> "Interval":
        """Apply a monotonically increasing function that rounds nothing, or that selects some of the numbers."""
        value = function(self.value)
        if self.is_exact:
            return Interval(value)
        low, high = function(self.low), function(self.high)
        return Interval(value) if np.array_equal(low, high) else Interval(value, low, high)

    def rows(self, components: slice | list[int]) -> "Interval":
        """Return some of the components."""
        value = self.value[components]
        return Interval(value) if self.is_exact else Interval(value, self.low[components], self.high[components])

    def spread(self, count: int) -> "Interval":
        """Expand to `count` pixels."""
        fields = (self.value, self.low, self.high)
        return Interval(*(np.broadcast_to(field, (len(field), count)) for field in fields))

    def __add__(self, other: "Interval"):
        sums = (getattr(self, name) + getattr(other, name) for name in ("value", "low", "high"))
        return _rounded(*sums, self.is_exact and other.is_exact)

    def __sub__(self, other):
        limits = self.low - other.high, self.high - other.low
        return _rounded(self.value - other.value, *limits, self.is_exact and other.is_exact)

    def __mul__(self, other):
        value, both_exact = self.value * other.value, self.is_exact and other.is_exact
        limits = (value, value) if both_exact else _product(self, other)
        return Interval(value, *limits) if _is_shift(self) or _is_shift(other) else _rounded(value, *limits, both_exact)

    def __truediv__(self, other):
        if _is_shift(other):
            return self * Interval(1.0 / other.value)
        over = Interval(1.0 / other.value, 1.0 / other.high, 1.0 / other.low)
        unbounded = (other.low <= 0.0) & (other.high >= 0.0)
        if unbounded.any():
            over.low, over.high = np.where(unbounded, -np.inf, over.low), np.where(unbounded, np.inf, over.high)
        both_exact = self.is_exact and other.is_exact
        return _rounded(self.value / other.value, *_product(self, over), both_exact, DIVISION)

    def __neg__(self):
        return Interval(-self.value) if self.is_exact else Interval(-self.value, -self.high, -self.low)

    def __abs__(self):
        low = np.maximum(np.maximum(self.low, -self.high), 0.0)
        return Interval(np.abs(self.value), low, np.maximum(self.high, -self.low))

    def __lt__(self, other):
        """Compare. NaN may be smaller or not: Direct3D 9 says that it is, IEEE 754 that it is not; GLSL and WGSL do not
        say.
        """
        return condition(self.value < other.value, self.high < other.low, ~(self.low >= other.high))

    def __le__(self, other):
        return condition(self.value <= other.value, self.high <= other.low, self.low <= other.high)

    def __gt__(self, other):
        return other < self

    def __ge__(self, other):
        return other <= self


def interval(number: Interval | float) -> Interval:
    """Return a number as an interval."""
    return number if isinstance(number, Interval) else Interval(np.full((1, 1), float(number)))


def _is_shift(number: Interval) -> bool:
    """Return whether a number is a power of two, by which multiplication is exact."""
    return number.is_exact and number.value.size == 1 and abs(np.frexp(number.value.item())[0]) == 0.5


def _rounded(value, low, high, both_exact: bool, share: float = OPERATION) -> Interval:
    if both_exact and np.array_equal(value.astype(np.float32), value):
        return Interval(value)
    error = np.abs(value)
    error *= share
    return Interval(value, low - error, high + error)


def _product(a: Interval, b: Interval) -> tuple[np.ndarray, np.ndarray]:
    # of an exact number both limits are the same array
    products = [
        low * high
        for low in ((a.low,) if a.is_exact else (a.low, a.high))
        for high in ((b.low,) if b.is_exact else (b.low, b.high))
    ]
    low, high = reduce(np.minimum, products), reduce(np.maximum, products)
    if not np.isfinite(low.sum() + high.sum()):
        # 0 times an unbounded interval is 0: a weight of 0 has no effect
        is_zero = ((a.low == 0.0) & (a.high == 0.0)) | ((b.low == 0.0) & (b.high == 0.0))
        unknown = np.isnan(low) | np.isnan(high)
        low = np.where(unknown, np.where(is_zero, 0.0, -np.inf), low)
        high = np.where(unknown, np.where(is_zero, 0.0, np.inf), high)
    return low, high


def larger(a: Interval, b: Interval) -> Interval:
    """Return the larger of two intervals, pixel by pixel."""
    return _either(np.maximum, a, b)


def smaller(a: Interval, b: Interval) -> Interval:
    """Return the smaller of two intervals, pixel by pixel."""
    return _either(np.minimum, a, b)


def _either(function, a: Interval, b: Interval) -> Interval:
    value = function(a.value, b.value)
    if a.is_exact and b.is_exact:
        return Interval(value)
    return Interval(value, function(a.low, b.low), function(a.high, b.high))


def growing(function: Callable, number: Interval, share: float | np.ndarray = 0.0, least: float = 0.0) -> Interval:
    """Apply a monotonically increasing function, with an error of `share` times its value plus `least`."""
    image = Interval(*(function(limit) for limit in (number.value, number.low, number.high)))
    error = np.abs(image.value) * share + least
    return Interval(image.value, image.low - error, image.high + error)


def side_by_side(parts: Sequence[Interval | float]) -> Interval:
    """Stack components into one vector."""
    parts = [interval(part) for part in parts]
    count = max(part.value.shape[1] for part in parts)

    def joined(name: str) -> np.ndarray:
        fields = [getattr(part, name) for part in parts]
        return np.concatenate([np.broadcast_to(field, (len(field), count)) for field in fields])

    exact = all(part.is_exact for part in parts)
    return Interval(*(joined(name) for name in (("value",) if exact else ("value", "low", "high"))))


@dataclass(frozen=True)
class Condition:
    """Hold for each pixel, (pixels,) bool, whether a condition is true: in float64, on every device, on any device."""

    value: np.ndarray
    sure: np.ndarray
    possible: np.ndarray

    def __invert__(self):
        return Condition(~self.value, ~self.possible, ~self.sure)

    def __and__(self, other: "Condition | bool") -> "Condition | bool":
        if isinstance(other, bool):
            return self if other else False
        return Condition(self.value & other.value, self.sure & other.sure, self.possible & other.possible)

    __rand__ = __and__


def condition(value: np.ndarray, sure: np.ndarray, possible: np.ndarray) -> Condition | bool:
    """Return a comparison (1, pixels), as a bool if all pixels and devices agree from the start."""
    if value.size == 1 and sure.item() == possible.item():
        return bool(value.item())
    return Condition(value.reshape(-1), sure.reshape(-1), possible.reshape(-1))


def chosen(where: Condition, yes, no):
    """Select `yes` where a condition holds, else `no`; where it is open, the interval around both. Structs are
    selected by member.
    """
    if yes is no:
        return yes
    if isinstance(yes, dict):
        return {name: chosen(where, yes[name], no.get(name, yes[name])) for name in yes}
    if isinstance(yes, Condition) or isinstance(no, Condition):
        return _chosen_condition(where, yes, no)
    yes, no = interval(yes), interval(no)
    fields = [np.where(where.sure, yes.low, no.low), np.where(where.sure, yes.high, no.high)]
    is_open = where.possible & ~where.sure
    if is_open.any():
        fields[0] = np.where(is_open, np.minimum(yes.low, no.low), fields[0])
        fields[1] = np.where(is_open, np.maximum(yes.high, no.high), fields[1])
    value = np.where(where.value, yes.value, no.value)
    return Interval(value) if yes.is_exact and no.is_exact and not is_open.any() else Interval(value, *fields)


def _chosen_condition(where: Condition, yes: Condition | bool, no: Condition | bool) -> Condition:
    """Select the condition `yes` where another one holds, else `no`; where that is open, devices may have either."""
    yes, no = (
        Condition(*(np.full(where.value.shape, one),) * 3) if isinstance(one, bool) else one for one in (yes, no)
    )
    never = ~where.possible
    sure = (yes.sure | never) & (no.sure | where.sure)
    possible = (yes.possible & where.possible) | (no.possible & ~where.sure)
    return Condition(np.where(where.value, yes.value, no.value), sure, possible)


def picked(number, places: np.ndarray, count: int):
    """Return a variable of `count` pixels for those at `places` only; what is the same for all pixels is returned as it
    is.
    """
    if isinstance(number, dict):
        return {name: picked(member, places, count) for name, member in number.items()}
    if isinstance(number, Condition):
        fields = (number.value, number.sure, number.possible)
        return number if len(number.value) < count else Condition(*(field[places] for field in fields))
    if not isinstance(number, Interval) or number.value.shape[-1] < count:
        return number
    fields = (number.value,) if number.is_exact else (number.value, number.low, number.high)
    turned = number.turned
    chosen_pixels = Interval(*(field[..., places] for field in fields))
    chosen_pixels.turned = turned if turned is None or len(turned) < count else turned[places]
    return chosen_pixels


def put_back(number, before, places: np.ndarray, count: int):
    """Return a variable of `count` pixels from one for those at `places`; the others keep what was there before, or
    are 0.
    """
    if isinstance(number, dict):
        before = before if isinstance(before, dict) else {}
        return {name: put_back(member, before.get(name), places, count) for name, member in number.items()}
    if isinstance(number, Condition):
        fields = (number.value, number.sure, number.possible)
        return Condition(*(_put(field, None, places, count) for field in fields))
    if not isinstance(number, Interval) or number.value.shape[-1] == 1:
        return number
    before = before if isinstance(before, Interval) else Interval(np.zeros((1,) * number.value.ndim))
    names = ("value",) if number.is_exact and before.is_exact else ("value", "low", "high")
    whole = Interval(*(_put(getattr(number, name), getattr(before, name), places, count) for name in names))
    if number.turned is not None:
        whole.turned = _put(number.turned, None, places, count)
    return whole


def _put(values: np.ndarray, before: np.ndarray | None, places: np.ndarray, count: int) -> np.ndarray:
    if values.shape[-1] == 1:
        return values
    whole = np.empty((*values.shape[:-1], count), values.dtype)
    whole[...] = 0 if before is None else before
    whole[..., places] = values
    return whole
