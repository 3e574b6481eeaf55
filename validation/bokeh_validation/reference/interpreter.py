"""Run the GLSL of a pass on intervals: the value of each target, and how far off a correct device may be.

All pixels run every branch that any of them takes, and every iteration of a loop, unless few enough take it to run it
for them alone. If devices may take different branches, a pixel's variables become the interval around both outcomes;
likewise if it may have left a loop. Constants are plain Python numbers, computed as the compiler does; values from
uniforms are Intervals. A struct is a dictionary of its members.

Three cases use more than the operations alone:

  * floor(x) in a declaration, where x may be on either side of a whole number: the rest of the block runs once for
    each side, since floor(x) + f(x - floor(x)) is usually the same from both.
  * BokehRotated: the error of a direction is a disc, which a rotation does not enlarge.
  * BokehSines and BokehCosSin: the error is known, and smaller than what their operations could add up to.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import product

import numpy as np
from pycparser import c_ast

from bokeh_validation.numerics.precision import FLOAT_STEP, SINE
from bokeh_validation.reference.builtin import FUNCTIONS, OPERATORS
from bokeh_validation.reference.glsl import Library
from bokeh_validation.reference.intervals import Condition, Interval, chosen, interval, picked, put_back

COMPONENTS = {letter: place for letters in ("xyzw", "rgba") for place, letter in enumerate(letters)}
# functions that read a texture -> the method that does it
FETCHES = {"BokehFetchTexture": "linear", "BokehFetchTexel": "nearest", "BokehFetchDepth": "depth"}
# function with Listing 3's comparison
LEAKAGE = "BokehLeakageWeight"
# tests the bits of a number; float64 compares numbers as they are, so that the comparison beside it is enough
IS_NAN = "BokehIsNaN"
# calls to skip: the image fills its textures here, so there is no viewport to set
SET_UP = ("BokehUseViewport", "BokehSetViewport")

# A branch or a loop runs for its own pixels only if that leaves out this many, and at least a quarter of all
FEW = 1024

Variables = dict[str, object]


def _rotated(direction: Interval, axis: Interval) -> Interval:
    """Compute `BokehRotated` with an error that does not grow with each rotation."""
    (x, y), (c, s) = direction.value, axis.value
    value = np.stack([x * c - y * s, x * s + y * c])
    error_before = np.hypot(*direction.error) if direction.turned is None else direction.turned
    turn = np.hypot(*axis.error)
    error_after = error_before * (1.0 + turn) + np.hypot(x, y) * (turn + 3 * FLOAT_STEP)
    return Interval(value, value - error_after, value + error_after, error_after)


def _sines(angles: Interval) -> Interval:
    """Compute `BokehSines` from the sine itself."""
    value, error = np.sin(angles.value), angles.error + SINE
    return Interval(value, value - error, value + error)


def _cos_sin(angle: Interval | float) -> Interval:
    """Compute `BokehCosSin` from cosine and sine themselves."""
    angle = interval(angle)
    value, error = np.concatenate([np.cos(angle.value), np.sin(angle.value)]), angle.error + SINE
    return Interval(value, value - error, value + error)


OWN = {"BokehSines": _sines, "BokehCosSin": _cos_sin}

# ----------------------------------------------------------------------------------------------------------- the text


@cache
def _breaks(node: c_ast.Node) -> bool:
    """Return whether a statement leaves the loop around it."""
    within = (child for _, child in node.children() if not isinstance(child, c_ast.For))
    return isinstance(node, c_ast.Break) or any(_breaks(child) for child in within)


def _is_floor(node: c_ast.Node | None, of: c_ast.Node | None = None) -> bool:
    """Return whether a node is floor() of a variable, of the variable `of` if given."""
    is_call = isinstance(node, c_ast.FuncCall) and node.name.name == "floor"
    argument = node.args.exprs[0] if is_call else None
    return isinstance(argument, c_ast.ID) and (of is None or getattr(of, "name", None) == argument.name)


@dataclass
class Run:
    """Run a pass over some pixels.

    library    the functions
    given      uniforms, constants and BokehUV by name; a texture's name maps to itself
    textures   name -> execution.Texture
    count      number of pixels
    undecided  (count,) bool: one of Listing 3's comparisons, or the side of a random offset, is open and makes a
               difference
    """

    library: Library
    given: Mapping[str, object]
    textures: Mapping[str, object]
    count: int
    undecided: np.ndarray = field(init=False)

    def __post_init__(self):
        self.undecided = np.zeros(self.count, bool)

    def main(self, entry: str) -> Variables:
        """Run main() of an entry and return its variables, among them the targets by name."""
        variables: Variables = {}
        with np.errstate(all="ignore"):
            _Call(self, np.ones(self.count, bool)).visit(self.library.main(entry).body, variables)
        return variables

    def result(self, name: str, arguments: Sequence, here: np.ndarray):
        """Return what a function returns for the pixels `here`, (count,) bool."""
        function, call = self.library.function(name), _Call(self, here, name)
        call.visit(function.body, dict(zip(function.parameters, arguments, strict=True)))
        return call.result


@dataclass
class _Loop:
    """Track which pixels (count,) are still in a loop in float64, and the variables with which the others left it."""

    value: np.ndarray
    exits: list[tuple[Condition, Variables]] = field(default_factory=list)
    stopped: bool = False


class _Call:
    """Run one call of a function for all pixels.

    here  (count,) bool: pixels for which some device reaches the current statement
    """

    def __init__(self, run: Run, here: np.ndarray, name: str = "main"):
        self.run, self.here, self.name = run, here, name
        self.loop: _Loop | None = None
        self.result = None

    def visit(self, node: c_ast.Node, variables: Variables) -> None:
        """Run a statement."""
        getattr(self, f"_{type(node).__name__}")(node, variables)

    def value(self, node: c_ast.Node, variables: Variables):
        """Evaluate an expression."""
        return getattr(self, f"_{type(node).__name__}")(node, variables)

    def undecided(self, where: np.ndarray) -> None:
        """Mark pixels as undecided, among those that reach the current statement."""
        self.run.undecided |= where & self.here

    # ------------------------------------------------------------------------------------------------------ statements

    def _Compound(self, node: c_ast.Compound, variables: Variables) -> None:
        self.sequence(node.block_items or (), variables)

    def sequence(self, nodes: Sequence[c_ast.Node], variables: Variables) -> None:
        """Run statements in order until one leaves the loop."""
        for index, node in enumerate(nodes):
            self.visit(node, variables)
            if self.loop and self.loop.stopped:
                return
            is_floor = isinstance(node, c_ast.Decl) and _is_floor(node.init)
            if is_floor and self.two_sided(node, nodes[index + 1 :], variables):
                return

    def two_sided(self, node: c_ast.Decl, following: Sequence[c_ast.Node], variables: Variables) -> bool:
        """Run the rest of a block for both sides of a whole number; returns False, without running it, if the side is
        not open.
        """
        name, source = node.name, node.init.args.exprs[0].name
        floor, number = variables[name], variables[source]
        is_open = floor.high - floor.low == 1.0
        if not is_open.any():
            return False
        other_side = floor.low + floor.high - floor.value
        saved, reached = dict(variables), self.here
        for sides in product((False, True), repeat=len(is_open)):
            swapped = np.array(sides)[:, None]
            side = np.where(swapped & is_open, other_side, floor.value)
            low = np.where(is_open, np.maximum(number.low, side), number.low)
            high = np.where(is_open, np.minimum(number.high, side + 1.0), number.high)
            limits = np.where(is_open, side, floor.low), np.where(is_open, side, floor.high)
            branch_variables = saved | {
                name: Interval(side, *limits),
                source: Interval(np.clip(number.value, low, high), low, high),
            }
            self.here = reached & (is_open | ~swapped).all(axis=0)
            if not self.here.any():
                continue
            self.sequence(following, branch_variables)
            if not swapped.any():
                variables |= branch_variables
            else:
                # these pixels get the interval around both sides
                other_pixels = Condition(np.ones_like(reached), ~self.here, np.ones_like(reached))
                variables |= {
                    variable: chosen(other_pixels, variables[variable], branch_variables[variable])
                    for variable in set(saved) - {name, source}
                }
        self.here, variables[source] = reached, number
        return True

    def _DeclList(self, node: c_ast.DeclList, variables: Variables) -> None:
        for declaration in node.decls:
            self.visit(declaration, variables)

    def _Decl(self, node: c_ast.Decl, variables: Variables) -> None:
        if node.init is not None:
            variables[node.name] = self.value(node.init, variables)
        elif node.type.type.names[0] in self.run.library.structs:
            variables[node.name] = {}

    def _Assignment(self, node: c_ast.Assignment, variables: Variables) -> None:
        value = self.value(node.rvalue, variables)
        if node.op != "=":
            value = OPERATORS[node.op[0]](self.value(node.lvalue, variables), value)
        if isinstance(node.lvalue, c_ast.StructRef):
            struct, member = node.lvalue.name.name, node.lvalue.field.name
            variables[struct] = {**variables[struct], member: value}
        else:
            variables[node.lvalue.name] = value

    def _Return(self, node: c_ast.Return, variables: Variables) -> None:
        self.result = self.value(node.expr, variables)

    def _If(self, node: c_ast.If, variables: Variables) -> None:
        where = self.value(node.cond, variables)
        if isinstance(where, bool):
            branch = node.iftrue if where else node.iffalse
            if branch is not None:
                self.visit(branch, variables)
        elif _breaks(node.iftrue):
            self.leave(where, variables)
        else:
            yes = self.branch(node.iftrue, variables, where.possible)
            no = self.branch(node.iffalse, variables, ~where.sure)
            # a branch that no pixel takes may leave a struct without members
            only_branch = (
                no if not (self.here & where.possible).any() else yes if not (self.here & ~where.sure).any() else None
            )
            variables |= only_branch or {name: chosen(where, yes[name], no[name]) for name in variables}
            if self.name == LEAKAGE and isinstance(variables["weight"], Interval):
                weight = variables["weight"]
                self.undecided(where.possible & ~where.sure & (weight.low < weight.high)[0])

    def branch(self, node: c_ast.Node | None, variables: Variables, where: np.ndarray) -> Variables:
        """Return all variables after a branch, run for the pixels `where`."""
        branch_variables, reached = dict(variables), self.here
        self.here = reached & where
        if node is not None and self.are_few():
            self.alone(lambda few, few_variables: few.visit(node, few_variables), branch_variables)
        elif node is not None and self.here.any():
            self.visit(node, branch_variables)
        self.here = reached
        return branch_variables

    def are_few(self) -> bool:
        """Return whether so few pixels reach the current statement that it is quicker to run it for them alone."""
        live = np.count_nonzero(self.here)
        return 0 < live <= min(len(self.here) * 3 // 4, len(self.here) - FEW)

    def alone(self, follow: Callable[["_Call", Variables], None], variables: Variables) -> None:
        """Run something for the pixels that reach the current statement only, and update the variables.

        follow  takes a call with only these pixels, and their variables
        """
        places, count = np.flatnonzero(self.here), len(self.here)
        given = {name: picked(number, places, count) for name, number in self.run.given.items()}
        run = Run(self.run.library, given, self.run.textures, len(places))
        few = _Call(run, np.ones(len(places), bool), self.name)
        if self.loop:
            few.loop = _Loop(self.loop.value[places])
        before = {name: picked(number, places, count) for name, number in variables.items()}
        after = dict(before)
        follow(few, after)
        self.run.undecided[places] |= run.undecided
        for name in variables:
            if after[name] is not before[name]:
                variables[name] = put_back(after[name], variables[name], places, count)

    def _For(self, node: c_ast.For, variables: Variables) -> None:
        names_before, outer_loop, reached = set(variables), self.loop, self.here
        self.loop = _Loop(np.ones_like(reached))
        self.visit(node.init, variables)
        self.iterate(node, variables)
        self.loop, self.here = outer_loop, reached
        for name in set(variables) - names_before:
            del variables[name]

    def iterate(self, node: c_ast.For, variables: Variables) -> None:
        """Run a loop from its condition on until all pixels have left it."""
        loop = self.loop
        while (going := self.value(node.cond, variables)) is not False:
            if going is not True:
                self.leave(~going, variables)
            if self.are_few():
                self.alone(lambda few, few_variables: few.iterate(node, few_variables), variables)
                break
            if not self.here.any():
                break
            self.visit(node.stmt, variables)
            if loop.stopped:
                break
            self.value(node.next, variables)
        for where, left_with in reversed(loop.exits):
            variables |= {name: chosen(where, value, variables[name]) for name, value in left_with.items()}

    def leave(self, where: Condition, variables: Variables) -> None:
        """Make the pixels for which a condition holds leave the loop."""
        loop = self.loop
        where = Condition(where.value & loop.value, where.sure & self.here, where.possible & self.here)
        if where.possible.any():
            loop.exits.append((where, dict(variables)))
        self.here, loop.value = self.here & ~where.sure, loop.value & ~where.value

    def _Break(self, node: c_ast.Break, variables: Variables) -> None:
        del node, variables
        self.loop.stopped = True

    # ----------------------------------------------------------------------------------------------------- expressions

    def _Constant(self, node: c_ast.Constant, variables: Variables) -> int | float:
        del variables
        return int(node.value) if node.type == "int" else float(node.value)

    def _ID(self, node: c_ast.ID, variables: Variables):
        for scope in (variables, self.run.given, self.run.library.constants):
            if node.name in scope:
                return scope[node.name]
        return {"true": True, "false": False}[node.name]

    def _BinaryOp(self, node: c_ast.BinaryOp, variables: Variables):
        left = self.value(node.left, variables)
        if node.op == "&&" and left is False:
            return False
        right = self.value(node.right, variables)
        difference = OPERATORS[node.op](left, right)
        if node.op == "-" and _is_floor(node.right, of=node.left):
            # x - floor(x) is 0 to 1 on both sides of a whole number
            wraps = right.low != right.high
            if self.name == "BokehNoise" and self.run.given["BokehJitter"].value > 0.0:
                self.undecided(wraps[0])
            limits = np.where(wraps, 0.0, difference.low), np.where(wraps, 1.0, difference.high)
            return Interval(difference.value, *limits)
        return difference

    def _UnaryOp(self, node: c_ast.UnaryOp, variables: Variables):
        value = self.value(node.expr, variables)
        if node.op == "p++":
            variables[node.expr.name] = value + 1
        if node.op == "!":
            return not value if isinstance(value, bool) else ~value
        return -value

    def _StructRef(self, node: c_ast.StructRef, variables: Variables):
        """Return a member of a struct, or components of a vector."""
        value = self.value(node.name, variables)
        if isinstance(value, dict):
            return value[node.field.name]
        places = [COMPONENTS[letter] for letter in node.field.name]
        in_a_row = places == list(range(places[0], places[0] + len(places)))
        return value.rows(slice(places[0], places[-1] + 1) if in_a_row else places)

    def _FuncCall(self, node: c_ast.FuncCall, variables: Variables):
        name = node.name.name
        if name in SET_UP:
            return None
        arguments = [self.value(argument, variables) for argument in node.args.exprs] if node.args else []
        if name == IS_NAN:
            return False
        if name in FETCHES:
            return getattr(self.run.textures[arguments[0]], FETCHES[name])(*arguments[1:])
        if name == "BokehRotated" and all(isinstance(argument, Interval) for argument in arguments):
            return _rotated(*arguments)
        if name in OWN:
            return OWN[name](*arguments)
        if name in FUNCTIONS:
            return FUNCTIONS[name](*arguments)
        return self.run.result(name, arguments, self.here)
