"""Loops of the GLSL written out, so that a compiler's static counts are those of the path that a pixel takes.

A compiler counts what is in a loop once, and some count it as if it ran eight times. Here every loop whose number of
iterations is known becomes that many copies of its body; whatever is still a loop counts once. Copies run to the end:
what a loop takes to count, to compare and to leave is not in them, a few instructions an iteration.
"""

import re
from collections.abc import Mapping

_LOOP = re.compile(r"for \(int (\w+) = (\w+); \1 (<=?) ([^;]+); \1\+\+\)\s*\{")
_BREAK = re.compile(r"if \([^;{}]*\)\s*\{\s*break;\s*\}")
# Bounds that are known to the caller under another name
_BOUNDS = {
    "int(ceil(cells))": "BOKEH_LAYER_CELLS",
    "255": "tiles",
    "layers.polygon.sides": "sides",
    "layers.polygon.sides / 2": "edges",
}


def unrolled(source: str, values: Mapping[str, int]) -> str:
    """GLSL with its loops written out.

    values  what bounds are made of: BOKEH_NUM_SAMPLES, BOKEH_LAYER_RINGS, BOKEH_LAYER_CELLS, `sides` of the polygon,
            `tiles` along one axis that the largest CoC reaches. A loop with another bound stays
    """
    loop = _LOOP.search(source)
    if loop is None:
        return source
    begin, end = loop.end(), _closing(source, loop.end())
    name, first, comparison, bound = loop.groups()
    start, stop = _number(first, values), _number(bound, values)
    body, rest = source[begin : end - 1], unrolled(source[end:], values)
    if start is None or stop is None:
        return source[:begin] + unrolled(body, values) + "}" + rest
    body = _BREAK.sub("", body)
    copies = [
        f"{{ const int {name} = {index}; {unrolled(body, {**values, name: index})} }}"
        for index in range(start, stop + (comparison == "<="))
    ]
    return source[: loop.start()] + "\n".join(copies) + rest


def _number(text: str, values: Mapping[str, int]) -> int | None:
    name = _BOUNDS.get(text, text)
    if name == "onEdge" and "ring" in values:
        # as BokehOnEdge
        return max(int(6.0 * values["ring"] / values["sides"] + 0.5), 1)
    if name == "edges":
        return values["sides"] // 2
    return int(name) if name.isdecimal() else values.get(name)


def _closing(source: str, begin: int) -> int:
    """One past the brace that ends the block whose text begins at `begin`."""
    depth = 1
    for brace in re.finditer(r"[{}]", source[begin:]):
        depth += 1 if brace[0] == "{" else -1
        if depth == 0:
            return begin + brace.end()
    raise ValueError("a block without its end")
