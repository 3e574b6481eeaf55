"""Two kinds of numbers that the shaders' text can be run on: rounded ones, and a value with a bound on its error.

A scalar is an array (N, 1), a vector (N, components), mat4 (N, 16): N inputs at once, or N = 1 where they all agree. A
literal is a Python number and takes the precision of what it meets. Integers are int64 arrays, conditions bool arrays.

Rounding. IEEE 754 binary16, to nearest even, after every operation: NumPy computes one in float32 and rounds it, which
is the same for + - * / and sqrt, since 24 bits are at least 2 * 11 + 2. sin, cos, exp2 and log2 come rounded from
float32. What does not fit becomes infinite. Numbers below 2^-14 keep what bits they have, or become 0 (`flush`):
devices do either.
"""

from dataclasses import dataclass

import numpy as np

HALF, FLOAT = "half", "float"
SMALLEST_NORMAL = 2.0**-14
# between 65504 and the next power of two: from here on a half float rounds to infinite
HALF_OVERFLOW = 65520.0

Precision = str


class Rounded:
    """Half floats and one wider type, as arrays of NumPy; what two precisions meet in is the wider.

    wide   what 'float' stands for: np.float32 or np.float64
    flush  half floats below 2^-14 become 0
    """

    def __init__(self, wide: type = np.float32, flush: bool = False):
        self.types = {HALF: np.float16, FLOAT: wide}
        self.flush = flush

    def convert(self, x, precision: Precision) -> np.ndarray:
        """A number in a precision; integers and literals too."""
        return self._kept(np.atleast_2d(np.asarray(x)).astype(self.types[precision]))

    def values(self, x) -> np.ndarray:
        """As float64."""
        return np.asarray(x, np.float64)

    def _kept(self, x):
        if self.flush and getattr(x, "dtype", None) == np.float16:
            return np.where(np.abs(x) < SMALLEST_NORMAL, np.float16(0), x)
        return x

    def binary(self, operator: str, a, b):
        """a operator b: arithmetic, comparison or logic."""
        return self._kept(_literal(_BINARY[operator](a, b)))

    def negative(self, a):
        """-a."""
        return -a

    def call(self, name: str, arguments: list):
        """A function that GLSL has itself."""
        return self._kept(_literal(_BUILTIN[name](self, *arguments)))

    def join(self, parts: list, precision: Precision) -> np.ndarray:
        """A constructor: components side by side; literals alone get `precision`."""
        arrays = [part for part in parts if isinstance(part, np.ndarray)]
        dtype = np.result_type(*arrays) if arrays else self.types[precision]
        return np.concatenate(_same_count([np.atleast_2d(np.asarray(part, dtype)) for part in parts]), axis=1)

    def part(self, x: np.ndarray, columns: list[int]) -> np.ndarray:
        """Components of a vector."""
        return x[:, columns]

    def select(self, mask, new, old):
        """`new` where the mask holds, `old` elsewhere."""
        return np.where(mask, new, old)

    def both(self, a, b):
        """Where two masks hold."""
        return np.logical_and(a, b)

    def inverted(self, mask):
        """Where a mask does not hold."""
        return np.logical_not(mask)

    def anywhere(self, mask) -> bool:
        """Whether a mask holds for any input."""
        return bool(np.any(mask))


def _same_count(arrays: list[np.ndarray]) -> list[np.ndarray]:
    count = max(len(array) for array in arrays)
    return [array if len(array) == count else np.repeat(array, count, axis=0) for array in arrays]


def _literal(x):
    """What literals make is a literal again, not one of NumPy's float64, which would make all that it meets one."""
    return x.item() if isinstance(x, np.generic) else x


def _divided(a, b):
    """GLSL cuts integers off; those of the shaders are not negative."""
    if all(np.asarray(x).dtype.kind == "i" for x in (a, b)):
        return a // b
    return np.divide(a, b)


_BINARY = {
    "+": np.add,
    "-": np.subtract,
    "*": np.multiply,
    "/": _divided,
    "<": np.less,
    ">": np.greater,
    "<=": np.less_equal,
    ">=": np.greater_equal,
    "==": np.equal,
    "&&": np.logical_and,
    "||": np.logical_or,
}


def _dot(numbers, a, b):
    """Sum of products from left to right, each step rounded."""
    products = numbers.binary("*", a, b)
    total = numbers.part(products, [0])
    for column in range(1, a.shape[-1]):
        total = numbers.binary("+", total, numbers.part(products, [column]))
    return total


def _clamp(numbers, x, low, high):
    return numbers.call("min", [numbers.call("max", [x, low]), high])


def _length(numbers, x):
    return numbers.call("sqrt", [_dot(numbers, x, x)])


def _of_numpy(function):
    """A function of NumPy, which knows the precision from its operands."""
    return lambda _, *arguments: function(*arguments)


_BUILTIN = {
    "dot": _dot,
    "clamp": _clamp,
    "length": _length,
    "min": _of_numpy(np.minimum),
    "max": _of_numpy(np.maximum),
    **{name: _of_numpy(getattr(np, name)) for name in ("abs", "floor", "ceil", "sin", "cos", "sqrt", "exp2", "log2")},
}


@dataclass(frozen=True)
class Bounded:
    """A number as it should be, and how far off the rounded one may be; float64 arrays of one shape."""

    value: np.ndarray
    error: np.ndarray

    @property
    def shape(self) -> tuple[int, ...]:
        """As of an array."""
        return self.value.shape

    def __len__(self) -> int:
        return len(self.value)


@dataclass(frozen=True)
class Open:
    """A condition: how it comes out, and where rounding may turn it."""

    holds: np.ndarray
    open: np.ndarray


class Bounds:
    """Running error analysis: every operation adds its own rounding to what its operands were off by.

        fl(x) = x (1 + d) + e,  |d| <= u,  |e| <= half of the smallest step (all of SMALLEST_NORMAL with flush)
        (x + a) (y + b) - x y   = x b + y a + a b
        (x + a) / (y + b) - x/y = (a - (x / y) b) / (y + b)
        min, max, floor, ceil, sqrt, exp2, log2 do not fall: they are between what they make of x - |a| and of x + |a|
        |sin(x + a) - sin(x)| <= |a|
        a comparison that the errors leave open may take either branch: the error is then that of the worse one

    What may overflow, or be divided by what may be 0, is off by infinity. All is in one precision; none is mixed.
    """

    UNITS = {HALF: 2.0**-11, FLOAT: 2.0**-24}
    SMALLEST = {HALF: 2.0**-25, FLOAT: 2.0**-150}
    LARGEST = {HALF: HALF_OVERFLOW, FLOAT: 3.4e38}
    # sin, cos, sqrt, exp2, log2 of NumPy's float32 are off by up to 4 of its roundings; half floats have one of 2^-11
    LIBRARY_ROUNDINGS = {HALF: 1.0 + 4 * 2.0**-13, FLOAT: 4.0}

    def __init__(self, precision: Precision = HALF, flush: bool = False):
        self.precision = precision
        self.smallest = SMALLEST_NORMAL if flush and precision == HALF else self.SMALLEST[precision]

    def convert(self, x, precision: Precision) -> Bounded:
        """An input, a literal or an integer: off by its own rounding. `precision` must be the one of all."""
        if precision != self.precision:
            raise ValueError(f"bounds are for {self.precision} alone, not for {precision}")
        if isinstance(x, Bounded):
            return x
        exact = np.atleast_2d(np.asarray(x, np.float64))
        kept = Rounded(np.float32, self.smallest == SMALLEST_NORMAL).convert(exact, precision).astype(np.float64)
        with np.errstate(invalid="ignore"):
            return Bounded(exact, _unknown(np.abs(kept - exact)))

    def values(self, x: Bounded) -> np.ndarray:
        """As float64."""
        return x.value

    def _rounded(self, value, error, roundings: float = 1.0) -> Bounded:
        size = np.abs(value) + error
        error = error + roundings * self.UNITS[self.precision] * size + self.smallest
        return Bounded(value, np.where(size < self.LARGEST[self.precision], _unknown(error), np.inf))

    def _pair(self, a, b) -> tuple[Bounded, Bounded]:
        return self.convert(a, self.precision), self.convert(b, self.precision)

    def binary(self, operator: str, a, b):
        """See Rounded.binary; integers are exact and stay arrays."""
        if operator in ("&&", "||"):
            return _logic(operator, _as_open(a), _as_open(b))
        if not isinstance(a, Bounded) and not isinstance(b, Bounded):
            return _literal(_BINARY[operator](a, b))
        a, b = self._pair(a, b)
        if operator in ("<", ">", "<=", ">="):
            off = a.error + b.error
            return Open(_BINARY[operator](a.value, b.value), ~(np.abs(a.value - b.value) > off) & (off > 0.0))
        value = _BINARY[operator](a.value, b.value)
        if operator in ("+", "-"):
            return self._rounded(value, a.error + b.error)
        if operator == "*":
            across = np.abs(a.value) * b.error + np.abs(b.value) * a.error + a.error * b.error
            return self._rounded(value, _unknown(across))
        least = np.abs(b.value) - b.error
        error = np.where(least > 0.0, (a.error + np.abs(value) * b.error) / least, np.inf)
        return self._rounded(value, _unknown(error))

    def negative(self, a):
        """-a."""
        return Bounded(-a.value, a.error) if isinstance(a, Bounded) else -a

    def call(self, name: str, arguments: list):
        """See Rounded.call."""
        if not any(isinstance(argument, Bounded) for argument in arguments):
            return _literal(_BUILTIN[name](self, *arguments))
        if name in ("dot", "clamp", "length"):
            return _BUILTIN[name](self, *arguments)
        given = [self.convert(argument, self.precision) for argument in arguments]
        function = getattr(np, {"min": "minimum", "max": "maximum"}.get(name, name))
        value = function(*(x.value for x in given))
        first = given[0]
        if name == "abs":
            return Bounded(value, first.error)
        if name in ("sin", "cos"):
            return self._rounded(value, first.error, self.LIBRARY_ROUNDINGS[self.precision])
        # these do not fall: their ends come from the ends of what they are given
        low, high = (function(*(x.value + sign * x.error for x in given)) for sign in (-1.0, 1.0))
        spread = _unknown(np.maximum(np.abs(high - value), np.abs(value - low)))
        if name in ("sqrt", "exp2", "log2"):
            return self._rounded(value, spread, self.LIBRARY_ROUNDINGS[self.precision])
        return Bounded(value, spread)

    def join(self, parts: list, precision: Precision) -> Bounded:
        """See Rounded.join."""
        given = [self.convert(part, precision) for part in parts]
        values = _same_count([x.value for x in given])
        errors = _same_count([x.error for x in given])
        return Bounded(np.concatenate(values, axis=1), np.concatenate(errors, axis=1))

    def part(self, x: Bounded, columns: list[int]) -> Bounded:
        """See Rounded.part."""
        return Bounded(x.value[:, columns], x.error[:, columns])

    def select(self, mask, new: Bounded, old: Bounded) -> Bounded:
        """See Rounded.select; where the mask is open, off by as much as the two are from each other."""
        mask = _as_open(mask)
        either = np.abs(new.value - old.value) + np.maximum(new.error, old.error)
        error = np.where(mask.open, _unknown(either), np.where(mask.holds, new.error, old.error))
        return Bounded(np.where(mask.holds, new.value, old.value), error)

    def both(self, a, b) -> Open:
        """See Rounded.both."""
        return _logic("&&", _as_open(a), _as_open(b))

    def inverted(self, mask) -> Open:
        """See Rounded.inverted."""
        mask = _as_open(mask)
        return Open(~mask.holds, mask.open)

    def anywhere(self, mask) -> bool:
        """See Rounded.anywhere: also where it might."""
        mask = _as_open(mask)
        return bool(np.any(mask.holds | mask.open))


def _unknown(error):
    """An error that came out as NaN, such as infinite times 0, is infinite."""
    return np.where(np.isnan(error), np.inf, error)


def _as_open(mask) -> Open:
    if isinstance(mask, Open):
        return mask
    holds = np.asarray(mask, bool)
    return Open(holds, np.zeros_like(holds))


def _logic(operator: str, a: Open, b: Open) -> Open:
    """What may still come out either way: `a && b` not where one surely fails, `a || b` not where one surely holds."""
    deciding = operator == "||"
    settled = (~a.open & (a.holds == deciding)) | (~b.open & (b.holds == deciding))
    return Open(_BINARY[operator](a.holds, b.holds), (a.open | b.open) & ~settled)
