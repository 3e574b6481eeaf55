"""Runs functions of the shaders on numbers of numbers.py, for many inputs at once.

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
from bokeh_validation.half.numbers import FLOAT, HALF, Precision, Rounded

COMPONENTS = {letter: place for letters in ("xyzw", "rgba") for place, letter in enumerate(letters)}
FETCHES = ("BokehFetch", "BokehFetchNearest", "BokehFetchTable")
RETURNED = "return"
MAIN = "main"


@dataclass(frozen=True)
class Choice:
    """Which variables are half; the others are float.

    names  function -> names of its half variables and parameters, RETURNED for its result; EVERYTHING for all. The
           function MAIN has the pass's own variables, its uniforms, and uv as 'BokehUV'. A struct is named as a
           function is, with its members.
    """

    EVERYTHING = "*"

    names: Mapping[str, frozenset[str]] = field(default_factory=dict)
    everywhere: bool = False

    def of(self, function: str, name: str) -> Precision:
        """Precision of a variable; of a function's literals with the name EVERYTHING."""
        chosen = self.names.get(function, frozenset())
        return HALF if self.everywhere or self.EVERYTHING in chosen or name in chosen else FLOAT


ALL_FLOAT = Choice()
ALL_HALF = Choice(everywhere=True)

# (one of FETCHES, texture, uv or index, mask) -> (N, 4); the mask says which inputs really read
Fetch = Callable[[str, str, object, object], object]


class Evaluator:
    """Functions of the shaders with numbers of a kind and a choice of precisions.

    globals  what main() reads: uniforms, defines, uv; textures by their names
    fetch    what a texture read returns; None where none is to be read
    """

    def __init__(
        self, numbers: Rounded, choice: Choice, globals_: Mapping[str, object] | None = None, fetch: Fetch | None = None
    ):
        self.numbers, self.choice, self.fetch = numbers, choice, fetch
        self.globals = {**program.constants(), **(globals_ or {})}

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
    """One call of a function."""

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

    def _precision(self, name: str = Choice.EVERYTHING) -> Precision:
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
            value = self.numbers.binary(node.op[0], self._value(node.lvalue), value)
        if isinstance(node.lvalue, c_ast.StructRef):
            name = node.lvalue.field.name
            place = self.variables[node.lvalue.name.name]
            value = self._member(self.types[node.lvalue.name.name], name, value)
        else:
            name, place = node.lvalue.name, self.variables
            value = self._typed(name, self.types.get(name, "vec4"), value)
        old = place.get(name)
        place[name] = value if self.mask is True or old is None else self.numbers.select(self.mask, value, old)

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
        for branch, taken in ((node.iftrue, condition), (node.iffalse, self.numbers.inverted(condition))):
            mask = taken if before is True else self.numbers.both(before, taken)
            if branch is not None and self.numbers.anywhere(mask):
                self.mask = mask if self._varies(mask) else True
                self._statement(branch)
        self.mask = before
        if self.loops and self.loops[-1] is not True:
            self.mask = self.loops[-1] if before is True else self.numbers.both(before, self.loops[-1])

    def _varies(self, mask) -> bool:
        """Whether not all inputs go this way."""
        return self.numbers.anywhere(self.numbers.inverted(mask))

    def _do_For(self, node: c_ast.For) -> None:
        before = self.mask
        self._statement(node.init)
        self.loops.append(before)
        while True:
            going = self._value(node.cond)
            if self.loops[-1] is not True:
                going = self.numbers.both(self.loops[-1], going)
            if not self.numbers.anywhere(going):
                break
            self.loops[-1] = self.mask = going if self._varies(going) else True
            self._statement(node.stmt)
            self._advance(node.next)
        self.loops.pop()
        self.mask = before

    def _advance(self, node: c_ast.Node) -> None:
        self.mask = True
        self._statement(node)

    def _do_Break(self, node: c_ast.Break) -> None:
        left = self.numbers.inverted(self.mask) if self.mask is not True else False
        self.loops[-1] = left if self.loops[-1] is True else self.numbers.both(self.loops[-1], left)

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
        value = self.evaluator.globals[node.name]
        # a define is a literal
        if isinstance(value, str) or node.name in program.constants():
            return value
        return self.numbers.convert(value, self.evaluator.choice.of(MAIN, node.name))

    def _of_BinaryOp(self, node: c_ast.BinaryOp):
        return self.numbers.binary(node.op, self._value(node.left), self._value(node.right))

    def _of_UnaryOp(self, node: c_ast.UnaryOp):
        value = self._value(node.expr)
        return {"-": self.numbers.negative, "!": self.numbers.inverted}[node.op](value)

    def _of_StructRef(self, node: c_ast.StructRef):
        """A member, or components of a vector."""
        value = self._value(node.name)
        if isinstance(value, dict):
            return value[node.field.name]
        return self.numbers.part(value, [COMPONENTS[letter] for letter in node.field.name])

    def _of_FuncCall(self, node: c_ast.FuncCall):
        name = node.name.name
        arguments = [self._value(argument) for argument in node.args.exprs] if node.args else []
        if name in FETCHES:
            read = self.evaluator.fetch(name, arguments[0], arguments[1], self.mask)
            return self.numbers.convert(read, self.evaluator.choice.of(name, RETURNED))
        if name.startswith("new_"):
            return self._constructed(name.removeprefix("new_"), arguments)
        for functions in (program.library(), program.helpers()):
            if name in functions:
                return _Frame(self.evaluator, functions[name], self.mask).run(arguments)
        return self.numbers.call(name, arguments)

    def _constructed(self, kind: str, arguments: list):
        if kind == "int":
            return self.numbers.values(arguments[0]).astype("int64")
        if kind == "float":
            return self.numbers.convert(arguments[0], self._precision())
        return self.numbers.join(arguments, self._precision())
