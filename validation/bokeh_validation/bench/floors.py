"""Floors: for each filter pass one that makes the same fetches at the same places and only adds them up.

The first pass, which makes the CoC, stays as it is. Every target depends on all that the method's depends on, on all
four channels, so that no compiler can leave a fetch out. Alpha is the pixel's CoC: the next pass fetches by it.
"""

import re
from dataclasses import replace

import numpy as np

from bokeh_validation import paths, shaders
from bokeh_validation.reference.lines import Line, lines
from bokeh_validation.reference.segments import Segment
from bokeh_validation.shaders.entries import ADAPTIVE, COPYING_ENTRIES, GRID, LINE
from bokeh_validation.shaders.passes import Pass

ENTRY = "BokehFloor"


def adaptive(item: Pass) -> float:
    """Pixels between the samples of a filter pass that takes as many as the CoC needs; 0 for fixed counts."""
    return 0.0 if ends(item) else item.values()["BokehSpacing"]


def ends(item: Pass) -> bool:
    """Whether the first and the last sample are a line's ends, as the paper has them; else middles of equal parts."""
    return item.spec.role in (LINE, GRID)


def others(item: Pass) -> tuple[str, ...]:
    """Further colour textures that a filter pass fetches at the pixel."""
    return ("ColorSampB",) if item.spec.role in (LINE, ADAPTIVE) and "ColorSampB" in item.inputs else ()


# ---------------------------------------------------------------------------------------------------------------- GLSL


def _number(value: float) -> str:
    text = f"{value:.9g}"
    return text if any(mark in text for mark in ".e") else text + ".0"


def _vector(value: np.ndarray) -> str:
    return f"vec2({_number(value[0])}, {_number(value[1])})"


def _fetch(slot: str, place: str = "uv") -> str:
    return f"BokehFetch(Bokeh{slot}, {place})"


def _added(item: Pass, name: str, line: Line, side: np.ndarray | None, deep: bool) -> str:
    """A block that adds up a line's samples, and of depth too where `deep`, to the variable `name`.

    The program has `uv` and `coc`, the CoC that the pass blurs by. A grid is a line moved along `side`, half of it.
    """
    values, count, spacing = item.values(), item.samples, adaptive(item)
    to_uv = np.array([1.0 / values["BokehAspectRatio"], 1.0])
    middle, half = line.segment.middle * to_uv, line.segment.half * to_uv
    parts = count - 1 if ends(item) else count
    first, between = middle - half + (0.0 if ends(item) else half / parts), 2.0 * half / parts
    loop, place, guard = f"for (int i = 0; i < {count}; i++)", "first + between * float(i)", ""
    block = ["vec4 colors = vec4(0.0, 0.0, 0.0, 0.0)", *(["float depths = 0.0"] if deep else [])]
    if spacing > 0.0:
        # as many samples as the line needs, where BokehLineSum has them
        length = 2.0 * line.segment.half_length * values["BokehImageHeight"]
        block += [
            f"float cells = clamp({_number(length / spacing)} * coc, 1.0, {count}.0)",
            f"vec2 halfLine = {_vector(half)} * coc",
            f"vec2 first = uv + {_vector(middle)} * coc - halfLine",
            "vec2 between = halfLine * (2.0 / cells)",
        ]
        place = "first + between * (float(i) + 0.5 * clamp(cells - float(i), 0.0, 1.0))"
        guard = "if (float(i) >= cells) { break; } "
    else:
        start = first if side is None else first - side * to_uv
        block += [f"vec2 first = uv + {_vector(start)} * coc", f"vec2 between = {_vector(between)} * coc"]
    if side is not None:
        loop = f"for (int j = 0; j < {count}; j++) {{ {loop}"
        place = f"first + {_vector(2.0 * side * to_uv / parts)} * coc * float(j) + between * float(i)"
    taken = f"vec2 coords = {place}; colors += {_fetch(line.slot, 'coords')};"
    taken += " depths += BokehFetchNearest(BokehDepthSamp, coords).r;" if deep else ""
    block += [f"{loop} {{ {guard}{taken} }}{' }' if side is not None else ''}"]
    return f"{{ {'; '.join(block)} {name} += colors{' + depths' if deep else ''}; }}"


def _body(item: Pass, along: tuple[Line, ...]) -> tuple[list[str], list[str]]:
    """Statements, and an expression for each target."""
    values, spacing, side, deep = item.values(), adaptive(item), None, "DepthSamp" in item.inputs
    samples = item.samples
    if along and item.spec.role == GRID:
        # the first line of a grid is one side away from the middle
        side, samples = -along[0].segment.middle, item.samples**2
        along = (replace(along[0], segment=Segment(np.zeros(2), along[0].segment.half)),)
    skips, height = along and spacing > 0.0, _number(values["BokehImageHeight"])
    coc = f"BokehFilterCoC(abs(center.a), {height}, {_number(spacing)})" if skips else "abs(center.a)"
    names = [f"sum{index}" for index in range(len(along))]
    statements = [f"vec4 center = {_fetch('ColorSamp')}", f"float coc = {coc}"]
    statements += [f"vec4 {name} = center" for name in names]
    taken = [f"{names[0]} += BokehFetchNearest(BokehDepthSamp, uv).r;"] if names and deep else []
    taken += [_added(item, name, line, side, deep) for name, line in zip(names, along, strict=True)]
    statements += [f"{'if (coc > 0.0) ' if skips else ''}{{ {' '.join(taken)} }}"] if taken else []
    rest = "".join(f" + {_fetch(slot)}" for slot in others(item)) if along else ""
    # a first pass with several targets: each holds the lines up to its own, as the method's do
    several = len(item.outputs) > 1
    results = []
    for target in range(len(item.outputs)):
        used = names[: target + 1] if several else names
        scale = _number(1.0 / (samples * len(used) + len(used) + 1))
        statements.append(f"vec4 mean{target} = ({' + '.join(used or ['center'])}{rest}) * {scale}")
        results.append(f"vec4(mean{target}.rgb + mean{target}.a, center.a)")
    return statements, results


# ----------------------------------------------------------------------------------------------------------- languages


def _indented(statements: list[str]) -> str:
    return "".join(f"    {statement};\n" for statement in statements)


def _glsl(statements: list[str], results: list[str]) -> str:
    # the library alone: its passes would bring a main() of their own
    head = f"{shaders.GLSL_VERSIONS['330']}\n" + paths.library("glsl").read_text(encoding="ascii")
    slots = ("ColorSamp", "ColorSampB", "ColorSampC", "ColorSampD", "DepthSamp")
    head += "".join(f"uniform sampler2D Bokeh{slot};\n" for slot in slots) + "in vec2 BokehUV;\n"
    outputs = "".join(f"layout(location = {i}) out vec4 Floor{i};\n" for i in range(len(results)))
    stores = [f"Floor{i} = {result}" for i, result in enumerate(results)]
    return f"{head}\n{outputs}\nvoid main()\n{{\n    vec2 uv = BokehUV;\n{_indented(statements + stores)}}}\n"


def _hlsl(statements: list[str], results: list[str]) -> str:
    outputs = ", ".join(f"out float4 floor{i} : BOKEH_TARGET({i})" for i in range(len(results)))
    body = _indented([*statements, *(f"floor{i} = {result}" for i, result in enumerate(results))])
    body = re.sub(r"\bvec([24])\b", r"float\1", body).replace("for (", "BOKEH_LOOP for (")
    body = re.sub(r"BokehFetch\((\w+)", r"BokehFetch(BOKEH_SHARED(\1, BokehColorSamp)", body)
    return f"{shaders.hlsl(6, {})}\nvoid {ENTRY}_PS(BOKEH_INPUT, {outputs})\n{{\n{body}}}\n"


def _wgsl(statements: list[str], results: list[str]) -> str:
    members = "".join(f"    @location({i}) floor{i}: vec4f,\n" for i in range(len(results)))
    body = _indented(["let uv: vec2f = input.uv", *statements, f"return FloorTargets({', '.join(results)})"])
    body = re.sub(r"\b(vec[24]|float|int) (\w+) =", r"var \2: \1 =", body)
    for pattern, name in ((r"\b(vec[24])\b", r"\1f"), (r"\bfloat\b", "f32"), (r"\bint\b", "i32")):
        body = re.sub(pattern, name, body)
    body = re.sub(r"BokehFetch\((\w+)", r"BokehFetch(\1, BokehLinearClamp", body)
    head = f"{shaders.wgsl()}\nstruct FloorTargets\n{{\n{members}}}\n"
    return f"{head}\n@fragment fn {ENTRY}_PS(input: BokehVertex) -> FloorTargets\n{{\n{body}}}\n"


def _replaced(item: Pass, along: tuple[Line, ...]) -> Pass:
    body = _body(item, along)
    sources = {"glsl": _glsl(*body), "hlsl": _hlsl(*body), "wgsl": _wgsl(*body)}
    wanted = {"ColorSamp", *(("DepthSamp", *others(item), *(line.slot for line in along)) if along else ())}
    inputs = {slot: name for slot, name in item.inputs.items() if slot in wanted}
    return replace(item, entry=ENTRY, inputs=inputs, parameters={}, sources=sources)


def floor(passes: tuple[Pass, ...]) -> tuple[Pass, ...]:
    """A plan's passes with every filter pass replaced by its floor; names of textures and targets stay."""
    return tuple(item if item.entry in COPYING_ENTRIES else _replaced(item, lines(item)) for item in passes)


def one_fetch(passes: tuple[Pass, ...]) -> tuple[Pass, ...]:
    """The same with one colour fetch a pass, at the pixel, and no depth: a pass in focus cannot cost less."""
    return tuple(item if item.entry in COPYING_ENTRIES else _replaced(item, ()) for item in passes)
