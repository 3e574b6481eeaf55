"""Runs functions of the shaders in NumPy, for many inputs at once, with any mix of half and float.

A scalar is an array (N, 1), a vector (N, components): N inputs at once, or N = 1 where they all agree. Integers are
int64 arrays, conditions bool arrays. A literal is a Python number and takes the precision of what it meets.

Rounding. IEEE 754 binary16, to nearest even, after every operation: NumPy computes one in float32 and rounds it, which
is the same for + - * / and sqrt, since 24 bits are at least 2 * 11 + 2. sin, cos, exp2 and log2 come rounded from
float32. What does not fit becomes infinite. Numbers below 2^-14 keep what bits they have.

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

COMPONENTS = {letter: place for letters in ("xyzw", "rgba") for place, letter in enumerate(letters)}
FETCHES = ("BokehFetch", "BokehFetchNearest", "BokehFetchTable")
RETURNED, MAIN, EVERYTHING = "return", "main", "*"

# Function -> its variables and parameters that are half, RETURNED for its result; EVERYTHING for all, of one function
# or of all. The function MAIN has the pass's own variables, its uniforms, and uv as 'BokehUV'. A struct is named as a
# function is, with its members. The rest is float.
Choice = Mapping[str, tuple[str, ...]]
ALL_FLOAT: Choice = {}
ALL_HALF: Choice = {EVERYTHING: (EVERYTHING,)}


def is_half(choice: Choice, function: str, name: str) -> bool:
    """Whether a variable is; EVERYTHING for a function's literals."""
    return bool({name, EVERYTHING} & {*choice.get(function, ()), *choice.get(EVERYTHING, ())})


# ------------------------------------------------------------------------------------------------------------- numbers


def convert(x, dtype: type) -> np.ndarray:
    """A number in a precision; integers and literals too."""
    return np.atleast_2d(np.asarray(x)).astype(dtype)


def operate(name: str, *arguments):
    """An operator, or a function that GLSL has itself: arithmetic, comparison or logic."""
    found = OPERATIONS[name](*arguments)
    # what literals make is a literal again, not one of NumPy's float64, which would make all that it meets one
    return found.item() if isinstance(found, np.generic) else found


def joined(parts: list, dtype: type) -> np.ndarray:
    """A constructor: components side by side; literals alone get `dtype`."""
    arrays = [part for part in parts if isinstance(part, np.ndarray)]
    dtype = np.result_type(*arrays) if arrays else dtype
    columns = [np.atleast_2d(np.asarray(part, dtype)) for part in parts]
    count = max(len(column) for column in columns)
    return np.concatenate([np.broadcast_to(c, (count, c.shape[1])) for c in columns], axis=1)


def _divided(a, b):
    """GLSL cuts integers off; those of the shaders are not negative."""
    whole = all(np.asarray(x).dtype.kind == "i" for x in (a, b))
    return a // b if whole else np.divide(a, b)


def _dot(a, b):
    """Sum of products from left to right, each step rounded."""
    products = a * b
    return sum((products[:, [column]] for column in range(1, products.shape[1])), products[:, [0]])


OPERATIONS = {
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
    "dot": _dot,
    "clamp": lambda x, low, high: operate("min", operate("max", x, low), high),
    "length": lambda x: np.sqrt(_dot(x, x)),
}


# ------------------------------------------------------------------------------------------------------------ programs

# (one of FETCHES, texture, uv or index, mask) -> (N, 4); the mask says which inputs really read
Fetch = Callable[[str, str, object, object], object]


@dataclass
class Evaluator:
    """Functions of the shaders with numbers of a kind and a choice of precisions.

    wide     what 'float' stands for: np.float32 or np.float64
    globals  what main() reads: uniforms, defines, uv; textures by their names
    fetch    what a texture read returns; None where none is to be read
    """

    wide: type = np.float32
    choice: Choice = field(default_factory=dict)
    globals: Mapping[str, object] = field(default_factory=dict)
    fetch: Fetch | None = None

    def call(self, name: str, *arguments):
        """One of program.library(): arrays (N,), (N, components), numbers, or dictionaries of them for structs."""
        with np.errstate(all="ignore"):
            return _Call(self, program.library()[name]).run([_column(argument) for argument in arguments])

    def main(self, entry: str) -> dict[str, object]:
        """main() of a pass: what it writes, by name: BokehResult, BokehResultB and so on."""
        call = _Call(self, program.main(entry))
        with np.errstate(all="ignore"):
            call.run([])
        return {name: value for name, value in call.variables.items() if name.startswith("BokehResult")}

    def precision(self, function: str, name: str = EVERYTHING) -> type:
        """Of a variable; of a function's literals."""
        return np.float16 if is_half(self.choice, function, name) else self.wide


def _column(argument):
    """(N,) as (N, 1), also in structs."""
    if isinstance(argument, dict):
        return {name: _column(value) for name, value in argument.items()}
    return argument[:, None] if isinstance(argument, np.ndarray) and argument.ndim == 1 else argument


def _both(a, b):
    """Where two masks hold."""
    if a is True:
        return b
    return a if b is True else np.logical_and(a, b)


class _Call(c_ast.NodeVisitor):
    """One call of a function: visiting a statement runs it, visiting an expression returns its value.

    A mask is True or (N, 1): the inputs that go this way.
    """

    def __init__(self, evaluator: Evaluator, function: program.Function, mask=True):
        self.evaluator, self.function, self.name = evaluator, function, function.name
        self.variables: dict[str, object] = {}
        self.types: dict[str, str] = dict(function.parameters)
        self.mask = mask
        self.loops: list[object] = []  # per loop: which inputs are still in it
        self.result = None

    def run(self, arguments: list):
        for (name, kind), value in zip(self.function.parameters.items(), arguments, strict=True):
            self.variables[name] = self._typed(name, kind, value)
        self.visit(self.function.body)
        return self.result

    def _typed(self, name: str, kind: str, value):
        """A value as the variable holds it."""
        if kind in (*program.INTEGERS, "sampler2D"):
            return value
        if kind in program.structs():
            return {member: self._member(kind, member, each) for member, each in value.items()}
        return convert(value, self.evaluator.precision(self.name, name))

    def _member(self, struct: str, member: str, value):
        """A value as a member of a struct holds it."""
        whole = program.structs()[struct][member] in program.INTEGERS
        return value if whole else convert(value, self.evaluator.precision(struct, member))

    def generic_visit(self, node: c_ast.Node):
        raise NotImplementedError(f"{self.name}: {type(node).__name__}")

    # ------------------------------------------------------------------------------------------------------ statements

    def visit_Compound(self, node: c_ast.Compound) -> None:
        for item in node.block_items or ():
            self.visit(item)

    def visit_DeclList(self, node: c_ast.DeclList) -> None:
        for item in node.decls:
            self.visit(item)

    def visit_Decl(self, node: c_ast.Decl) -> None:
        kind = self.types[node.name] = program.type_name(node)
        if node.init is not None:
            self.variables[node.name] = self._typed(node.name, kind, self.visit(node.init))
        elif kind in program.structs():
            self.variables[node.name] = {}

    def visit_Assignment(self, node: c_ast.Assignment) -> None:
        value = self.visit(node.rvalue)
        if node.op != "=":
            value = operate(node.op[0], self.visit(node.lvalue), value)
        if isinstance(node.lvalue, c_ast.StructRef):
            struct, name = node.lvalue.name.name, node.lvalue.field.name
            place, value = self.variables[struct], self._member(self.types[struct], name, value)
        else:
            name, place = node.lvalue.name, self.variables
            value = self._typed(name, self.types.get(name, "vec4"), value)
        old = place.get(name)
        place[name] = value if self.mask is True or old is None else np.where(self.mask, value, old)

    def visit_If(self, node: c_ast.If) -> None:
        before, condition = self.mask, self.visit(node.cond)
        for branch, taken in ((node.iftrue, condition), (node.iffalse, np.logical_not(condition))):
            mask = _both(before, taken)
            if branch is not None and np.any(mask):
                self.mask = True if np.all(mask) else mask
                self.visit(branch)
        self.mask = _both(before, self.loops[-1]) if self.loops else before

    def visit_For(self, node: c_ast.For) -> None:
        before = self.mask
        self.visit(node.init)
        self.loops.append(before)
        while np.any(going := _both(self.loops[-1], self.visit(node.cond))):
            self.loops[-1] = self.mask = True if np.all(going) else going
            self.visit(node.stmt)
            self.mask = True
            self.visit(node.next)
        self.loops.pop()
        self.mask = before

    def visit_Break(self, node: c_ast.Break) -> None:
        self.loops[-1] = _both(self.loops[-1], np.logical_not(self.mask))

    def visit_Return(self, node: c_ast.Return) -> None:
        if self.loops or self.result is not None:
            raise NotImplementedError(f"{self.name}: a return that is not the last statement")
        value = self.visit(node.expr)
        # what a struct holds has its precision
        whole = isinstance(value, dict)
        self.result = value if whole else convert(value, self.evaluator.precision(self.name, RETURNED))

    # ----------------------------------------------------------------------------------------------------- expressions

    def visit_Constant(self, node: c_ast.Constant):
        return int(node.value) if node.type == "int" else float(node.value)

    def visit_ID(self, node: c_ast.ID):
        if node.name in ("true", "false"):
            return node.name == "true"
        if node.name in self.variables:
            return self.variables[node.name]
        given = self.evaluator.globals
        value = given[node.name] if node.name in given else program.constants()[node.name]
        # a define is a literal
        if isinstance(value, str) or node.name in program.constants():
            return value
        return convert(value, self.evaluator.precision(MAIN, node.name))

    def visit_BinaryOp(self, node: c_ast.BinaryOp):
        return operate(node.op, self.visit(node.left), self.visit(node.right))

    def visit_UnaryOp(self, node: c_ast.UnaryOp):
        value = self.visit(node.expr)
        if node.op == "p++":
            # a loop's, for all inputs alike: those that left do not look at it again
            self.variables[node.expr.name] = value + 1
            return value
        return -value if node.op == "-" else operate(node.op, value)

    def visit_StructRef(self, node: c_ast.StructRef):
        """A member, or components of a vector."""
        value = self.visit(node.name)
        if isinstance(value, dict):
            return value[node.field.name]
        return value[:, [COMPONENTS[letter] for letter in node.field.name]]

    def visit_FuncCall(self, node: c_ast.FuncCall):
        name, evaluator = node.name.name, self.evaluator
        if name == "BokehUseViewport":
            # what every pass begins with: images fill their textures here, so there is no viewport to set
            return None
        arguments = [self.visit(argument) for argument in node.args.exprs] if node.args else []
        if name in FETCHES:
            read = evaluator.fetch(name, arguments[0], arguments[1], self.mask)
            return convert(read, evaluator.precision(name, RETURNED))
        if name == "new_int":
            return np.asarray(arguments[0], np.float64).astype(np.int64)
        if name == "new_float":
            return convert(arguments[0], evaluator.precision(self.name))
        if name.startswith("new_"):
            return joined(arguments, evaluator.precision(self.name))
        for functions in (program.library(), program.helpers()):
            if name in functions:
                return _Call(evaluator, functions[name], self.mask).run(arguments)
        return operate(name, *arguments)
