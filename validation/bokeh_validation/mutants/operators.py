"""Mutants made from the GLSL text: every statement of every function with one or two things wrong, always the same.

The parity check knows that the other languages say the same, statement by statement: what only numbers can show is
shown on one of them.
"""

import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import NamedTuple

from bokeh_validation import shaders
from bokeh_validation.mutants.mutant import Mutant, originals
from bokeh_validation.shaders import parity, rules
from bokeh_validation.shaders.entries import ENTRIES

EQUIVALENTS = Path(__file__).with_name("equivalents.txt")
FILES = [keys["glsl"] for keys in (parity.LIBRARY, parity.LAYERS, parity.PASSES)]
# So many of a statement, by different operators
EACH = 2
# Arguments with brackets in them; what stands between two operators; a name; a number
CALL = r"\((?:[^()]|\((?:[^()]|\((?:[^()]|\([^()]*\))*\))*\))*\)"
TERM = rf"-?(?:[\w.]+(?:{CALL})?|{CALL})(?:\.[a-z]+)?"
NAME = r"(?<![.\w])[A-Za-z]\w*(?:\.\w+)*"
NUMBER = r"(?<![\w.])\d+(?:\.\d+)?(?![\w.])"
PAIRS = "min max, sin cos, floor ceil, BOKEH_MIN_DEPTH BOKEH_MAX_DEPTH, + -, * /, && ||, == !=, true false"
SWIZZLES = ".x .y, .r .g, .b .a, .z .w, .xy .yx, .zw .wz, .rg .gr, .rb .br, .rgb .bgr, .xyxy .yxyx, .T2 .T3, .T4 .T5"
OTHER = {"<": ">", ">": "<", ">=": "<", "<=": ">"}
for pair in f"{PAIRS}, {SWIZZLES}".split(", "):
    first, second = pair.split()
    OTHER |= {first: second, second: first}

Scope = Mapping[str, str]
Edit = Callable[[re.Match, Scope], str]


def _other(found: re.Match, _: Scope) -> str:
    return OTHER[found[0]]


def _removed(_: re.Match, __: Scope) -> str:
    return ""


def _number(found: re.Match, _: Scope) -> str:
    """Another number: one less where it is the end of a loop, else one more or twice as much."""
    if "." not in found[0]:
        return str(int(found[0]) + (-1 if found.string[: found.start()].endswith("< ") else 1))
    return repr(2.0 * float(found[0])) if float(found[0]) else "1.0"


def _first_argument(found: re.Match, _: Scope) -> str:
    """Of a call, in brackets."""
    depth = 0
    for place in range(found[0].index("("), len(found[0])):
        depth += {"(": 1, ")": -1}.get(found[0][place], 0)
        if depth == 0 or (depth == 1 and found[0][place] == ","):
            return f"{found[0][found[0].index('(') : place]})"
    return found[0]


def _swapped(found: re.Match, scope: Scope) -> str:
    """Two arguments of one type."""
    first, second = (scope.get(name[name.rfind(".") :] if "." in name else name, name) for name in found.groups())
    return f"{found[2]}, {found[1]}" if first == second else found[0]


def _neighbour(found: re.Match, scope: Scope) -> str:
    """The next parameter or variable of the same type; of the passes or of the function, as it is."""
    name, declared = found[0], found.string.partition(" = ")[0].split()[-1]
    alike = [other for other in scope if scope[other] == scope.get(name) and other != declared]
    near = [
        other
        for other in alike
        if other[:5] == name[:5] or (scope[other] == "sampler2D" and "Bokeh" not in other + name)
    ]
    return near[(near.index(name) + 1) % len(near)] if name in near else name


# What a driver does by itself to a variable that nobody sets
ZEROED = re.compile(r"= (?:0\.0|vec\d\([0., ]+\));")
# operator -> pattern, and what takes the place of what it finds
OPERATORS: dict[str, tuple[str, Edit]] = {
    "sign": (r"(?<=[\w)] )[+-](?= )", _other),
    "guard": (rf"\b(?:clamp|abs|BokehSafe\w+|BokehToTexture|BokehGridCoords|min|max){CALL}", _first_argument),
    "axis": (r"\.(?:[xyrgbazw]|xy|zw|rg|gr|rb|rgb|xyxy|T\d)\b(?!\()", _other),
    "min and max": (r"\b(?:min|max|sin|cos|floor|ceil)(?=\()|\bBOKEH_M(?:IN|AX)_DEPTH\b", _other),
    "constant": (NUMBER, _number),
    "condition": (r"(?<= )(?:[<>]=?|==|&&)(?= )|\b(?:true|false)\b", _other),
    "negated": (r"(?<![\w)] )-(?=[\w(])", _removed),
    "operands": (rf"(?<!min\()(?<!max\()({NAME}), ({NAME})\b(?![.(])", _swapped),
    "neighbour": (r"(?<=[( ])[A-Za-z]\w+\b(?=[;,)])", _neighbour),
    "factor": (rf"(?<!= 1\.0) [*/] {TERM}(?=[;,) ])", _removed),
    "term": (rf" [+-] {TERM}(?=[;,) ])", _removed),
    "product": (r"(?<=[\w)] )[*/](?= )", _other),
    "dropped": (r"\A(?!return|break|for|if|else)[\w.]+(?: [-+*]?=|\().*;\Z", lambda *_: ";"),
    "always": (r"(?<=if )\(.*\)\Z", lambda *_: "(true)"),
    "never": (r"(?<=if )\(.*\)\Z", lambda *_: "(false)"),
}


# Those that leave nothing of a statement
WHOLE = ("dropped", "always", "never")


class Function(NamedTuple):
    """A function or entry of the GLSL: its file, the text of that without comments, and where in it the body is."""

    key: str
    text: str
    start: int
    end: int

    def scope(self) -> dict[str, str]:
        """Name -> type: parameters of the passes, members, its own parameters and variables."""
        everywhere = "".join(originals()[key] for key in FILES)
        uniforms = re.findall(r"^(?:BOKEH_PARAMETER\(|uniform )(\w+),? (\w+)[);]", everywhere, re.MULTILINE)
        members = re.findall(r"^    (\w+) (\w+);$", everywhere, re.MULTILINE)
        head = self.text.rindex("\n\n", 0, self.start)
        own = re.findall(r"\b(float|int|bool|vec\d|Bokeh[A-Z]\w+|sampler2D) (\w+)\b(?!\()", self.text[head : self.end])
        swizzles = dict.fromkeys([f".{letter}" for letter in "xyzwrgba"], "float")
        return (
            swizzles | {f".{name}": kind for kind, name in members} | {name: kind for kind, name in (*uniforms, *own)}
        )

    def statements(self) -> Iterator[tuple[int, int, str]]:
        """Where each statement and head of a block begins and ends, and its text with single spaces."""
        depth, begin = 0, self.start + 1
        for place in range(begin, self.end - 1):
            depth += {"(": 1, ")": -1}.get(self.text[place], 0)
            if depth == 0 and self.text[place] in ";{}":
                part = self.text[begin : place + (self.text[place] == ";")]
                if part.strip():
                    yield begin + len(part) - len(part.lstrip()), begin + len(part.rstrip()), " ".join(part.split())
                begin = place + 1


@cache
def functions() -> dict[str, Function]:
    """All of the GLSL by their names; an entry has that of the other languages, which ends in _PS or _VS."""
    entries = {shaders.glsl_pass(entry): f"{entry}_PS" for entry in ENTRIES}
    result = {}
    for key in FILES:
        text = shaders.COMMENT.sub(lambda found: " " * len(found[0]), originals()[key])
        for found in shaders.FUNCTION.finditer(text):
            name = found["name"]
            if name == "main":
                define = re.findall(r"^#(?:el)?if BOKEH_PASS == (\w+)$", text[: found.start()], re.MULTILINE)[-1]
                name = entries.get(define, "BokehFullScreen_VS")
            result[name] = Function(key, text, *found.span("body"))
    return result


def live(text: str, constants: Iterable[tuple[str, int]]) -> str:
    """A body without the branches that these constants switch off."""
    for name, value in constants:
        for least in re.findall(rf"if \({name} > (\d)\)$", text, re.MULTILINE):
            if value <= int(least):
                branch = rf"^( *)if \({name} > {least}\)\n\1\{{\n(?:.*\n)*?\1\}}$"
                text = re.sub(branch, "", text, flags=re.MULTILINE)
    return text


@cache
def reached(name: str, constants: frozenset[tuple[str, int]] = frozenset()) -> frozenset[str]:
    """A function, those that it calls, and those that they call; the same for the body of a main function."""
    own = functions().get(name)
    body = live(own.text[own.start : own.end] if own else name, constants)
    called = {word for word in re.findall(r"\bBokeh\w+(?=\()", body) if word in functions() and word != name}
    return frozenset({name}.union(*(reached(word, constants) for word in called)))


@cache
def equivalents() -> dict[tuple[str, ...], str]:
    """(place, operator, statement) -> why nothing can show it: the lines after one or more of them.

    The statement is the broken one, or where the operator leaves nothing of it, the one that was there.
    """
    found: dict[tuple[str, ...], str] = {}
    for group in EQUIVALENTS.read_text(encoding="utf-8").split("\n\n")[1:]:
        rows = group.strip("\n").split("\n")
        reason = " ".join(row.strip() for row in rows if row.startswith(" "))
        found |= {tuple(row.split(": ", 2)): reason for row in rows if not row.startswith(" ")}
    return found


def mutants() -> Iterator[Mutant]:
    """All that the operators make, of the functions in their order."""
    for name, function in functions().items():
        if name.endswith("_VS"):
            continue
        whole, scope = originals()[function.key], function.scope()
        common = not re.search(rf"{rules.SAMPLING}\(", whole[function.start : function.end])
        # the operators take turns in a function, so that no edit elsewhere changes which are made
        used: Counter[str] = Counter()
        for start, end, text in function.statements():
            kinds = ("constant",) if ZEROED.search(text) else OPERATORS
            able = {kind: edits for kind in kinds if (edits := list(_edits(kind, text, scope)))}
            for kind in sorted(able, key=lambda kind: used[kind])[:EACH]:
                broken = able[kind][used[kind] % len(able[kind])]
                used[kind] += 1
                title = f"{name}-{kind.replace(' ', '-')}-{used[kind]}"
                texts = {function.key: whole[:start] + broken + whole[end:]}
                argued = equivalents().get((name, kind, text if kind in WHOLE else broken), "")
                yield Mutant(title, kind, "glsl", name, (text, broken), texts, common=common, argued=argued)


def _edits(kind: str, text: str, scope: Scope) -> Iterator[str]:
    """What an operator makes of a statement."""
    pattern, edit = OPERATORS[kind]
    for found in re.finditer(pattern, text):
        new = edit(found, scope)
        if new != found[0]:
            yield text[: found.start()] + new + text[found.end() :]
