"""Implement GLSL's operators and functions on intervals, and on constants as the compiler computes them."""

from collections.abc import Callable, Mapping
from operator import add, and_, ge, gt, le, lt, mul, ne, sub, truediv

import numpy as np

from bokeh_validation.reference import intervals
from bokeh_validation.reference.intervals import FUNCTION, Interval, interval


class FromUniform(int):
    """Mark an integer that came from a uniform: the device, not the compiler, computes with it."""


def _either(of_numbers: Callable, of_intervals: Callable | None = None) -> Callable:
    """Return a function of two arguments that computes with intervals if either is one, else with plain numbers."""

    def function(a, b):
        if isinstance(a, Interval) or isinstance(b, Interval):
            return (of_intervals or of_numbers)(interval(a), interval(b))
        return of_numbers(a, b)

    return function


def _divided(a, b):
    both = isinstance(a, int) and isinstance(b, int)
    return a // b if both else truediv(a, b)


def _same(a, b) -> bool:
    """Compare whole numbers, or a uniform, which is one number for all pixels, with a number."""
    return (a.value.item() if isinstance(a, Interval) else a) == b


_SYMBOLS = {"+": add, "-": sub, "*": mul, "/": _divided, "<": lt, ">": gt, "<=": le, ">=": ge}
OPERATORS = {symbol: _either(function) for symbol, function in _SYMBOLS.items()}
# these take whole numbers that are the same for all pixels
OPERATORS |= {"==": _same, "!=": ne, "&&": and_}
_least, _most = _either(min, intervals.smaller), _either(max, intervals.larger)


def _whole(number):
    """Implement int(), which truncates; the arguments here are never negative."""
    if not isinstance(number, Interval):
        return number if isinstance(number, int) else int(number)
    number = number.each(np.floor)
    return FromUniform(number.value.item()) if number.is_exact and number.value.size == 1 else number


def _float(number):
    if isinstance(number, FromUniform):
        return interval(number)
    return number if isinstance(number, Interval) else float(number)


def _dot(a: Interval, b: Interval) -> Interval:
    products = a * b
    return sum((products.rows([k]) for k in range(1, len(products.value))), products.rows([0]))


def _root(number: Interval) -> Interval:
    return intervals.growing(lambda x: np.sqrt(np.maximum(x, 0.0)), number, intervals.DIVISION)


def _power(function: Callable) -> Callable:
    return lambda x: intervals.growing(function, interval(x), FUNCTION * (1.0 + 1.5 * np.abs(interval(x).value)))


def _log2(number: Interval | float) -> Interval | float:
    if not isinstance(number, Interval):
        return float(np.log2(number))
    return intervals.growing(lambda x: np.log2(np.maximum(x, 1e-30)), number, intervals.OPERATION, FUNCTION)


FUNCTIONS: Mapping[str, Callable] = {
    "new_int": _whole,
    "new_float": _float,
    **{f"new_vec{count}": lambda *parts: intervals.side_by_side(parts) for count in (2, 3, 4)},
    "min": _least,
    "max": _most,
    "clamp": lambda x, low, high: _least(_most(x, low), high),
    "abs": abs,
    "floor": lambda x: interval(x).each(np.floor),
    "ceil": lambda x: interval(x).each(np.ceil),
    "dot": _dot,
    "length": lambda x: _root(_dot(x, x)),
    "sqrt": _root,
    "exp": _power(np.exp),
    "exp2": _power(np.exp2),
    "log2": _log2,
}
