"""Numbers that the shaders' text can be run on: half floats beside a wider type, every operation rounded.

A scalar is an array (N, 1), a vector (N, components): N inputs at once, or N = 1 where they all agree. A
literal is a Python number and takes the precision of what it meets. Integers are int64 arrays, conditions bool arrays.

Rounding. IEEE 754 binary16, to nearest even, after every operation: NumPy computes one in float32 and rounds it, which
is the same for + - * / and sqrt, since 24 bits are at least 2 * 11 + 2. sin, cos, exp2 and log2 come rounded from
float32. What does not fit becomes infinite. Numbers below 2^-14 keep what bits they have, or become 0 (`flush`):
devices do either.
"""

import numpy as np

HALF, FLOAT = "half", "float"
SMALLEST_NORMAL = 2.0**-14

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
    "%": np.remainder,
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
