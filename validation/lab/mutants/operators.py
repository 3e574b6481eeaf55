"""Make mutants from the GLSL text: every statement of every function with one mistake, always the same one.

Parity checks that the other languages have the same statements, so numerical mistakes need to be shown in one of them
only.
"""

import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from pathlib import Path

from bokeh_validation import shaders
from bokeh_validation.shaders import calls, parity, rules
from lab.mutants.mutant import Mutant, originals, together

EQUIVALENTS = Path(__file__).with_name("equivalents.txt")
FILES = [keys["glsl"] for keys in parity.FILES.values()]
# Arguments with brackets in them; an operand; a name
CALL = r"\((?:[^()]|\((?:[^()]|\((?:[^()]|\([^()]*\))*\))*\))*\)"
TERM = rf"-?(?:[\w.]+(?:{CALL})?|{CALL})(?:\.[a-z]+)?"
NAME = r"(?<![.\w])[A-Za-z]\w*(?:\.\w+)*"
# Excludes arguments of functions whose order does not matter
ORDERED = r"(?<!min\()(?<!max\()(?<!BokehLayerWeight\()(?<!BokehRotated\()"
PAIRS = "+ -, * /, && ||, == !=, true false, min max, sin cos, floor ceil"
SWIZZLES = ".x .y, .r .g, .b .a, .z .w, .xy .yx, .zw .wz, .rg .gr, .rb .br, .rgb .bgr, .xyxy .yxyx"
MEMBERS = (
    ".strip2 .strip3, .strip4 .strip5, .nearLayer .farLayer, .gatherTiles .layerCoC, .farWithHoles .nearQuarter, "
    ".nearQuarter .farQuarter"
)
OTHER = {
    "<": ">",
    ">": "<",
    ">=": "<",
    "<=": ">",
    ".layerCoCSums": ".gatherCoC",
    ".sums": ".gatherCoC",
    ".farFill": ".midFill",
}
for pair in f"{PAIRS}, {SWIZZLES}, {MEMBERS}".split(", "):
    first, second = pair.split()
    OTHER |= {first: second, second: first}

# Text in front of a number that is reduced by one. A loop that ends early misses a sample, and a first pass that is
# asked for one line too few fails; one more would only cost fetches.
LESS = re.compile(r"(?:< |Bokeh(?:ExactFirst|LayerPolygon)\((?:\w+, )+)\Z")
GUARDS = r"(?:clamp|abs|BokehSanitize|BokehToTexture|BokehGridCoords|min|max)"
Types = Mapping[str, str]


def _other(match: re.Match, _: Types) -> str:
    return OTHER[match[0]]


def _number(match: re.Match, _: Types) -> str:
    """Return another number: one less where one more would not show, else one more or twice as much."""
    if "." not in match[0]:
        return str(int(match[0]) + (-1 if LESS.search(match.string[: match.start()]) else 1))
    return repr(2.0 * float(match[0])) if float(match[0]) else "1.0"


def _swapped(match: re.Match, types: Types) -> str:
    """Swap two arguments of the same type."""
    # components such as .x have no declared type; they are floats
    first, second = (types.get(name[name.rfind(".") :] if "." in name else name, "float") for name in match.groups())
    return f"{match[2]}, {match[1]}" if first == second else match[0]


# kind -> pattern, and the replacement of its matches, the likeliest mistakes first
OPERATORS: dict[str, tuple[str, Callable[[re.Match, Types], str]]] = {
    "operator": (
        r"(?<=[\w)] )[-+*/](?= )|(?<= )(?:[<>]=?|==|&&)(?= )|\b(?:true|false)\b"
        r"|\b(?:min|max|sin|cos|floor|ceil)(?=\()",
        _other,
    ),
    "axis": (
        r"\.(?:[xyrgbazw]|xy|zw|rg|gr|rb|rgb|xyxy|strip\d|(?:near|far)Layer|(?:layerCoCS|s)ums|gatherTiles|layerCoC|farWithHoles|(?:near|far)Quarter|farFill)\b(?!\()",
        _other,
    ),
    "constant": (r"(?<![\w.])\d+(?:\.\d+)?(?![\w.])", _number),
    "operands": (rf"{ORDERED}({NAME}), ({NAME})\b(?![.(])", _swapped),
    "guard": (rf"\b{GUARDS}\(((?:[^(),]|{CALL})*)(?:,(?:[^()]|{CALL})*)?\)", lambda found, _: f"({found[1]})"),
    "term": (rf"(?<!= 1\.0) [-+*/] {TERM}(?=[;,) ])|(?<![\w)] )-(?=[\w(])", lambda *_: ""),
    "never": (r"(?<=if )\(.*\)\Z", lambda *_: "(false)"),
    "always": (r"(?<=if )\(.*\)\Z", lambda *_: "(true)"),
    "dropped": (r"\A(?!return|break|for|if|else)[\w.]+(?: [-+*]?=|\().*;\Z", lambda *_: ";"),
}
# Kinds that replace the whole statement or condition
WHOLE_STATEMENT = ("always", "never", "dropped")
# Drivers initialise variables to 0, so removing such a statement would not show
ZEROED = re.compile(r"= (?:0\.0|vec\d\([0., ]+\));")
# Assignments that compilers require for targets that a pass lacks; nobody reads them
UNREAD = re.compile(r"targets\.strip\d = (?:zero|targets\.strip\d);")


def bodies() -> Iterator[tuple[str, str, str, int, int]]:
    """Yield file, name, the file's text without comments, and start and end of the body, for every GLSL function."""
    for key in FILES:
        text = shaders.COMMENT.sub(lambda match: " " * len(match[0]), originals()[key])
        for name, match in calls.found_functions(text):
            yield key, name, text, *match.span("body")


def _statements(text: str, start: int, end: int) -> Iterator[tuple[int, int, str]]:
    """Yield begin, end and text, with single spaces, of each statement and head of a block."""
    depth, begin = 0, start + 1
    for place in range(begin, end - 1):
        depth += {"(": 1, ")": -1}.get(text[place], 0)
        if depth == 0 and text[place] in ";{}":
            part = text[begin : place + (text[place] == ";")]
            if part.strip():
                yield begin + len(part) - len(part.lstrip()), begin + len(part.rstrip()), " ".join(part.split())
            begin = place + 1


def _types(text: str) -> dict[str, str]:
    """Return name -> type of everything that GLSL declares; members have a dot in front."""
    declared = re.findall(r"\b(float|int|bool|vec\d|Bokeh[A-Z]\w+|sampler2D) (\w+)\b(?!\()", text)
    parameters = re.findall(r"^BOKEH_PARAMETER\((\w+), (\w+)\)$", text, re.MULTILINE)
    members = re.findall(r"^    (\w+) (\w+);$", text, re.MULTILINE)
    return {f".{name}": kind for kind, name in members} | {name: kind for kind, name in (*declared, *parameters)}


@cache
def equivalents() -> dict[tuple[str, str], str]:
    """Return (place, change) -> reason why nothing can show it: the unindented line above it in equivalents.txt."""
    reasons, reason = {}, ""
    for line in EQUIVALENTS.read_text(encoding="utf-8").splitlines():
        if line.startswith(" "):
            places, _, change = line.strip().partition(": ")
            reasons |= {(place, change): reason for place in places.split(", ")}
        else:
            reason = line
    return reasons


def mutants() -> Iterator[Mutant]:
    """Yield one mutant of every statement that an operator can change."""
    everywhere = _types(shaders.COMMENT.sub("", together({}, "glsl")))
    for key, name, text, start, end in bodies():
        if name.endswith("_VS"):
            continue
        original, types = originals()[key], everywhere | _types(text[text.rindex("\n\n", 0, start) : end])
        porting = re.search(parity.PORTING, original, re.MULTILINE)
        is_ported = porting is not None and porting.start() < start < porting.end()
        common = not is_ported and not re.search(rf"{rules.SAMPLING}\(", original[start:end])
        # operators take turns within a function, so that edits elsewhere do not change which mutants are made
        uses: Counter[str] = Counter()
        for statement_start, statement_end, statement in _statements(text, start, end):
            if UNREAD.fullmatch(statement):
                continue
            kinds = ("constant",) if ZEROED.search(statement) else OPERATORS
            possible = {kind: edits for kind in kinds if (edits := list(_edits(kind, statement, types)))}
            if possible:
                kind = min(possible, key=lambda kind: uses[kind])
                broken = possible[kind][uses[kind] % len(possible[kind])]
                uses[kind] += 1
                change = f"({kind}) {statement}" if kind in WHOLE_STATEMENT else broken
                texts = {key: original[:statement_start] + broken + original[statement_end:]}
                argued = equivalents().get((name, change), "")
                yield Mutant(f"{name}-{kind}-{uses[kind]}", kind, name, change, texts, common=common, argued=argued)

    yield from tuned()


def tuned() -> Iterator[Mutant]:
    """Yield one mutant of every tuned constant: twice its value. Its place is the first function that reads it."""
    for key in FILES:
        original = originals()[key]
        for match in re.finditer(r"^#define (BOKEH_TUNED_\w+) (\S+)$", original, re.MULTILINE):
            users = [name for _, name, text, start, end in bodies() if re.search(rf"\b{match[1]}\b", text[start:end])]
            change = f"#define {match[1]} {2.0 * float(match[2])!r}"
            texts = {key: original[: match.start()] + change + original[match.end() :]}
            argued = equivalents().get((users[0], change), "")
            yield Mutant(f"{match[1]}-constant", "constant", users[0], change, texts, argued=argued)


def _edits(kind: str, statement: str, types: Types) -> Iterator[str]:
    """Yield each variant of a statement that an operator produces."""
    pattern, edit = OPERATORS[kind]
    for match in re.finditer(pattern, statement):
        new = edit(match, types)
        if new != match[0]:
            yield statement[: match.start()] + new + statement[match.end() :]
