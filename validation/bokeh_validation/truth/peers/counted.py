"""How many texels an effect fetches a pixel, from the shaders that it hands to WebGL.

The rule: of every draw of a frame but those of the scene itself and those onto the canvas, all fetches that its main()
can reach, a loop as often as it turns, of two branches the larger one; times the share of the picture that the draw
covers. Depth and colour count alike. Bevy's loops turn as often as the blur at a pixel needs: counted at its limit.
"""

import math
import re
from collections import defaultdict
from collections.abc import Iterable
from functools import cache

from bokeh_validation.compilers.glslang import GLSLANG

FETCHES = {"texture", "textureLod", "textureGrad", "textureProj", "textureOffset", "texelFetch"}
FUNCTION = re.compile(r"\b\w+\s+(\w+)\s*\(([^()]*)\)\s*\{")
TURNS = re.compile(r"int (\w+) = (\d+) ; \1 (<=?) (\d+) ; .*")
OF_THE_SCENE = re.compile(r"\bpeerLight\b|\bgl_FragDepth =")


def fetches(draws: Iterable[dict]) -> float:
    """Of a frame: draws as page/peers.js finds them."""
    return sum(one["share"] * of_text(one["text"]) for one in draws if not OF_THE_SCENE.search(one["text"]))


def of_bevy(effect: str, diameter: float) -> int:
    """Of both passes, where the circle of confusion is as large as it may be, in pixels."""
    if effect == "BevyBokeh":
        return 2 * (1 + 2 * (1 + round(diameter / 2)))  # depth, and two lines from their end
    support = math.ceil(1.5 * diameter / 4)
    return 2 * (1 + 1 + 2 * math.ceil(support / 2))  # depth, the middle, and two at a time to both sides


@cache
def of_text(text: str) -> int:
    """Of one fragment shader in GLSL ES 3.00, for a pixel."""
    bodies, known = defaultdict(list), {}
    plain = _preprocessed(text)
    for found in FUNCTION.finditer(plain):
        bodies[found[1]].append(re.findall(r"[\w.]+|[<>=!]=|[^\w\s]", plain[found.end() - 1 :]))

    def block(tokens: list[str], at: int) -> tuple[int, int]:
        count, at = 0, at + 1
        while tokens[at] != "}":
            more, at = statement(tokens, at)
            count += more
        return count, at + 1

    def parentheses(tokens: list[str], at: int) -> int:
        deep = 0
        while True:
            deep += {"(": 1, ")": -1}.get(tokens[at], 0)
            at += 1
            if deep == 0:
                return at

    def calls(tokens: list[str]) -> int:
        pairs = zip(tokens, tokens[1:], strict=False)
        return sum(1 if name in FETCHES else of(name) for name, after in pairs if after == "(")

    def statement(tokens: list[str], at: int) -> tuple[int, int]:
        if tokens[at] == "{":
            return block(tokens, at)
        if tokens[at] in ("for", "if"):
            end = parentheses(tokens, at + 1)
            head = tokens[at + 2 : end - 1]
            count, after = statement(tokens, end)
            if tokens[at] == "for":
                return count * _turns(head), after
            other = 0
            if tokens[after] == "else":
                other, after = statement(tokens, after + 1)
            return calls(head) + max(count, other), after
        if tokens[at] in ("while", "do", "switch"):
            raise ValueError(f"a {tokens[at]} is not counted")
        end = tokens.index(";", at)
        return calls(tokens[at:end]), end + 1

    def of(name: str) -> int:
        if name not in known:
            known[name] = 0  # one of the same name that it calls is counted beside it
            known[name] = sum(block(tokens, 0)[0] for tokens in bodies.get(name, ()))
        return known[name]

    return of("main")


def _turns(head: list[str]) -> int:
    found = TURNS.match(" ".join(head))
    if found is None:
        raise ValueError(f"a loop that is not counted: {' '.join(head)}")
    return int(found[4]) - int(found[2]) + (found[3] == "<=")


def _preprocessed(text: str) -> str:
    """Without its macros, comments and directives."""
    done = GLSLANG.run(["-E", "shader.frag"], {"shader.frag": text.encode()})
    if not done.ok:
        raise ValueError(done.messages)
    return re.sub(r"^\s*#.*$", "", done.messages, flags=re.MULTILINE)
