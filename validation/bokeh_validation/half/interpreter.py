"""Runs functions of the shaders in NumPy, for many inputs at once, with any mix of half and float.

A scalar is an array (N, 1), a vector (N, components): N inputs at once, or N = 1 where they all agree. Integers are
int64 arrays, conditions bool arrays. A literal is a Python number and takes the precision of what it meets.

Rounding. IEEE 754 binary16, to nearest even, after every operation: NumPy computes one in float32 and rounds it, which
is the same for + - * / and sqrt, since 24 bits are at least 2 * 11 + 2. sin, cos, exp2 and log2 come rounded from
float32. What does not fit becomes infinite. Numbers below 2^-14 keep what bits they have, or become 0 (`flush`):
devices do either.

Precision follows the rules of GLSL ES: a variable, parameter or return value has one, an operation has that of the
wider operand, and what is assigned is rounded to the variable's. What is made of literals or integers alone has the
precision of its function, as `precision mediump float` would say. A member of a struct has its precision from the
struct, whoever has one.

Both sides of an `if` are run and their assignments masked; a loop runs as long as any input is in it.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from pycparser import c_ast

from bokeh_validation.half import program

HALF, FLOAT = "half", "float"
SMALLEST_NORMAL = 2.0**-14
COMPONENTS = {letter: place for letters in ("xyzw", "rgba") for place, letter in enumerate(letters)}
FETCHES = ("BokehFetch", "BokehFetchNearest", "BokehFetchTable")
RETURNED, MAIN, EVERYTHING = "return", "main", "*"


@dataclass(frozen=True)
class Choice:
    """Which variables are half; the others are float.

    names  function -> names of its half variables and parameters, RETURNED for its result; EVERYTHING for all. The
           function MAIN has the pass's own variables, its uniforms, and uv as 'BokehUV'. A struct is named as a
           function is, with its members.
    """

    names: Mapping[str, frozenset[str]] = field(default_factory=dict)
    everywhere: bool = False

    def of(self, function: str, name: str) -> str:
        """Precision of a variable; of a function's literals with the name EVERYTHING."""
        chosen = self.names.get(function, frozenset())
        return HALF if self.everywhere or EVERYTHING in chosen or name in chosen else FLOAT


ALL_FLOAT = Choice()
ALL_HALF = Choice(everywhere=True)


class Rounded:
    """Half floats and one wider type; what two precisions meet in is the wider.

    wide   what 'float' stands for: np.float32 or np.float64
    flush  half floats below 2^-14 become 0
    """

    def __init__(self, wide: type = np.float32, flush: bool = False):
        self.types = {HALF: np.float16, FLOAT: wide}
        self.flush = flush

    def convert(self, x, precision: str) -> np.ndarray:
        """A number in a precision; integers and literals too."""
        return self._kept(np.atleast_2d(np.asarray(x)).astype(self.types[precision]))

    def _kept(self, x):
        """What literals make is a literal again, not one of NumPy's float64, which would make all that it meets one."""
        if isinstance(x, np.generic):
            return x.item()
        if self.flush and getattr(x, "dtype", None) == np.float16:
            return np.where(np.abs(x) < SMALLEST_NORMAL, np.float16(0), x)
        return x

    def call(self, name: str, *arguments):
        """An operator, or a function that GLSL has itself: arithmetic, comparison or logic."""
        if name in _COMPOSED:
            return _COMPOSED[name](self.call, *arguments)
        return self._kept(_OPERATIONS[name](*arguments))

    def join(self, parts: list, precision: str) -> np.ndarray:
        """A constructor: components side by side; literals alone get `precision`."""
        arrays = [part for part in parts if isinstance(part, np.ndarray)]
        dtype = np.result_type(*arrays) if arrays else self.types[precision]
        columns = [np.atleast_2d(np.asarray(part, dtype)) for part in parts]
        count = max(len(column) for column in columns)
        return np.concatenate([np.broadcast_to(c, (count, c.shape[1])) for c in columns], axis=1)


def _divided(a, b):
    """GLSL cuts integers off; those of the shaders are not negative."""
    whole = all(np.asarray(x).dtype.kind == "i" for x in (a, b))
    return a // b if whole else np.divide(a, b)


_OPERATIONS = {
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
    "!": np.logical_not,
    "min": np.minimum,
    "max": np.maximum,
    **{name: getattr(np, name) for name in ("abs", "floor", "ceil", "sin", "cos", "sqrt", "exp2", "log2")},
}


def _dot(call, a, b):
    """Sum of products from left to right, each step rounded."""
    products = call("*", a, b)
    total = products[:, [0]]
    for column in range(1, a.shape[-1]):
        total = call("+", total, products[:, [column]])
    return total


# made of the others, each step rounded
_COMPOSED = {
    "dot": _dot,
    "clamp": lambda call, x, low, high: call("min", call("max", x, low), high),
    "length": lambda call, x: call("sqrt", _dot(call, x, x)),
}

# (one of FETCHES, texture, uv or index, mask) -> (N, 4); the mask says which inputs really read
Fetch = Callable[[str, str, object, object], object]


@dataclass
class Evaluator:
    """Functions of the shaders with numbers of a kind and a choice of precisions.

    globals  what main() reads: uniforms, defines, uv; textures by their names
    fetch    what a texture read returns; None where none is to be read
    """

    numbers: Rounded
    choice: Choice
    globals: Mapping[str, object] = field(default_factory=dict)
    fetch: Fetch | None = None

    def call(self, name: str, *arguments):
        """One of program.library(): arrays (N,), (N, components), numbers, or dictionaries of them for structs."""
        with np.errstate(all="ignore"):
            return _Frame(self, program.library()[name], True).run([_column(argument) for argument in arguments])

    def main(self, entry: str) -> dict[str, object]:
        """main() of a pass: what it writes, by name: BokehResult, BokehResultB and so on."""
        frame = _Frame(self, program.main(entry), True)
        with np.errstate(all="ignore"):
            frame.run([])
        return {name: value for name, value in frame.variables.items() if name.startswith("BokehResult")}


def _column(argument):
    """(N,) as (N, 1), also in structs."""
    if isinstance(argument, dict):
        return {name: _column(value) for name, value in argument.items()}
    return argument[:, None] if isinstance(argument, np.ndarray) and argument.ndim == 1 else argument


class _Frame:
    """One call of a function. A mask is True or (N, 1): the inputs that go this way."""

    def __init__(self, evaluator: Evaluator, function: program.Function, mask):
        self.evaluator, self.numbers, self.function = evaluator, evaluator.numbers, function
        self.name = function.name
        self.variables: dict[str, object] = {}
        self.types: dict[str, str] = dict(function.parameters)
        self.mask = mask
        self.loops: list[object] = []  # per loop: which inputs are still in it
        self.result = None

    def run(self, arguments: list):
        for (name, kind), value in zip(self.function.parameters.items(), arguments, strict=True):
            self.variables[name] = self._typed(name, kind, value)
        self._statement(self.function.body)
        return self.result

    def _typed(self, name: str, kind: str, value):
        """A value as the variable holds it."""
        if kind in (*program.INTEGERS, "sampler2D"):
            return value
        if kind in program.structs():
            return {member: self._member(kind, member, each) for member, each in value.items()}
        return self.numbers.convert(value, self._precision(name))

    def _member(self, struct: str, member: str, value):
        """A value as a member of a struct holds it."""
        if program.structs()[struct][member] in program.INTEGERS:
            return value
        return self.numbers.convert(value, self.evaluator.choice.of(struct, member))

    def _precision(self, name: str = EVERYTHING) -> str:
        return self.evaluator.choice.of(self.name, name)

    # ------------------------------------------------------------------------------------------------------ statements

    def _statement(self, node: c_ast.Node) -> None:
        getattr(self, f"_do_{type(node).__name__}")(node)

    def _do_Compound(self, node: c_ast.Compound) -> None:
        for item in node.block_items or ():
            self._statement(item)

    def _do_Decl(self, node: c_ast.Decl) -> None:
        self.types[node.name] = program.type_name(node)
        if node.init is not None:
            self.variables[node.name] = self._typed(node.name, self.types[node.name], self._value(node.init))
        elif self.types[node.name] in program.structs():
            self.variables[node.name] = {}

    def _do_DeclList(self, node: c_ast.DeclList) -> None:
        for item in node.decls:
            self._statement(item)

    def _do_Assignment(self, node: c_ast.Assignment) -> None:
        value = self._value(node.rvalue)
        if node.op != "=":
            value = self.numbers.call(node.op[0], self._value(node.lvalue), value)
        if isinstance(node.lvalue, c_ast.StructRef):
            name = node.lvalue.field.name
            place = self.variables[node.lvalue.name.name]
            value = self._member(self.types[node.lvalue.name.name], name, value)
        else:
            name, place = node.lvalue.name, self.variables
            value = self._typed(name, self.types.get(name, "vec4"), value)
        old = place.get(name)
        place[name] = value if self.mask is True or old is None else np.where(self.mask, value, old)

    def _do_FuncCall(self, node: c_ast.FuncCall) -> None:
        """What every pass begins with: images fill their textures here, so there is no viewport to set."""
        if node.name.name != "BokehUseViewport":
            raise NotImplementedError(f"{self.name}: a call of {node.name.name} as a statement")

    def _do_UnaryOp(self, node: c_ast.UnaryOp) -> None:
        """`i++` of a loop: for all inputs alike, since those that left do not look at it again."""
        if node.op != "p++":
            raise NotImplementedError(f"{self.name}: {node.op} as a statement")
        self.variables[node.expr.name] = self.variables[node.expr.name] + 1

    def _do_If(self, node: c_ast.If) -> None:
        before, condition = self.mask, self._value(node.cond)
        for branch, taken in ((node.iftrue, condition), (node.iffalse, np.logical_not(condition))):
            mask = _both(before, taken)
            if branch is not None and np.any(mask):
                self.mask = True if np.all(mask) else mask
                self._statement(branch)
        self.mask = _both(before, self.loops[-1]) if self.loops else before

    def _do_For(self, node: c_ast.For) -> None:
        before = self.mask
        self._statement(node.init)
        self.loops.append(before)
        while True:
            going = _both(self.loops[-1], self._value(node.cond))
            if not np.any(going):
                break
            self.loops[-1] = self.mask = True if np.all(going) else going
            self._statement(node.stmt)
            self.mask = True
            self._statement(node.next)
        self.loops.pop()
        self.mask = before

    def _do_Break(self, node: c_ast.Break) -> None:
        self.loops[-1] = _both(self.loops[-1], np.logical_not(self.mask))

    def _do_Return(self, node: c_ast.Return) -> None:
        if self.loops or self.result is not None:
            raise NotImplementedError(f"{self.name}: a return that is not the last statement")
        value = self._value(node.expr)
        # what a struct holds has its precision
        self.result = value if isinstance(value, dict) else self.numbers.convert(value, self._precision(RETURNED))

    # ----------------------------------------------------------------------------------------------------- expressions

    def _value(self, node: c_ast.Node):
        return getattr(self, f"_of_{type(node).__name__}")(node)

    def _of_Constant(self, node: c_ast.Constant):
        return int(node.value) if node.type == "int" else float(node.value)

    def _of_ID(self, node: c_ast.ID):
        if node.name in ("true", "false"):
            return node.name == "true"
        if node.name in self.variables:
            return self.variables[node.name]
        given = self.evaluator.globals
        value = given[node.name] if node.name in given else program.constants()[node.name]
        # a define is a literal
        if isinstance(value, str) or node.name in program.constants():
            return value
        return self.numbers.convert(value, self.evaluator.choice.of(MAIN, node.name))

    def _of_BinaryOp(self, node: c_ast.BinaryOp):
        return self.numbers.call(node.op, self._value(node.left), self._value(node.right))

    def _of_UnaryOp(self, node: c_ast.UnaryOp):
        value = self._value(node.expr)
        return -value if node.op == "-" else self.numbers.call(node.op, value)

    def _of_StructRef(self, node: c_ast.StructRef):
        """A member, or components of a vector."""
        value = self._value(node.name)
        if isinstance(value, dict):
            return value[node.field.name]
        return value[:, [COMPONENTS[letter] for letter in node.field.name]]

    def _of_FuncCall(self, node: c_ast.FuncCall):
        name = node.name.name
        arguments = [self._value(argument) for argument in node.args.exprs] if node.args else []
        if name in FETCHES:
            read = self.evaluator.fetch(name, arguments[0], arguments[1], self.mask)
            return self.numbers.convert(read, self.evaluator.choice.of(name, RETURNED))
        if name == "new_int":
            return np.asarray(arguments[0], np.float64).astype(np.int64)
        if name == "new_float":
            return self.numbers.convert(arguments[0], self._precision())
        if name.startswith("new_"):
            return self.numbers.join(arguments, self._precision())
        for functions in (program.library(), program.helpers()):
            if name in functions:
                return _Frame(self.evaluator, functions[name], self.mask).run(arguments)
        return self.numbers.call(name, *arguments)


def _both(a, b):
    """Where two masks hold."""
    if a is True:
        return b
    return a if b is True else np.logical_and(a, b)
