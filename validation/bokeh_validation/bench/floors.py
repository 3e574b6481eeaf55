"""Floors: for each filter pass one that makes the same fetches at the same places and only adds them up.

The first pass, which makes the CoC, stays as it is. Every target depends on all that the method's depends on, on all
four channels, so that no compiler can leave a fetch out. Alpha is the pixel's CoC: the next pass fetches by it.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from bokeh_validation import paths, shaders
from bokeh_validation.bench.reads import Line, Reads, reads
from bokeh_validation.entries import COPYING_ENTRIES
from bokeh_validation.passes import Pass

ENTRY = "BokehFloor"
SLOTS = ("ColorSamp", "ColorSampB", "ColorSampC", "ColorSampD", "DepthSamp")


@dataclass(frozen=True)
class Dialect:
    """How one language writes what the floors need.

    vec2, vec4, scalar  types
    declare   (type, name) -> the beginning of a declaration
    texture   slot -> a texture with its sampler, as an argument; texels: one without
    frame     (statements, expressions of the targets) -> the complete program
    """

    vec2: str
    vec4: str
    scalar: str
    declare: Callable[[str, str], str]
    texture: Callable[[str], str]
    texels: Callable[[str], str]
    frame: Callable[[list[str], list[str]], str]


@cache
def _text(language: str) -> str:
    """The functions that floors are made of."""
    return (Path(__file__).parent / f"floor.{language}").read_text(encoding="ascii")


def _indented(statements: list[str]) -> str:
    return "".join(f"    {statement};\n" for statement in statements)


def _glsl(statements: list[str], results: list[str]) -> str:
    # the library alone: its passes would bring a main() of their own
    head = f"{shaders.GLSL_VERSIONS['330']}\n" + paths.library("glsl").read_text(encoding="ascii") + _text("glsl")
    outputs = "".join(f"layout(location = {i}) out vec4 Floor{i};\n" for i in range(len(results)))
    stores = [f"Floor{i} = {result}" for i, result in enumerate(results)]
    return f"{head}\n{outputs}\nvoid main()\n{{\n    vec2 uv = BokehUV;\n{_indented(statements + stores)}}}\n"


def _hlsl(statements: list[str], results: list[str]) -> str:
    outputs = ", ".join(f"out float4 floor{i} : BOKEH_TARGET({i})" for i in range(len(results)))
    stores = [f"floor{i} = {result}" for i, result in enumerate(results)]
    head = shaders.hlsl(6, {}) + _text("hlsl")
    return f"{head}\nvoid {ENTRY}_PS(BOKEH_INPUT, {outputs})\n{{\n{_indented(statements + stores)}}}\n"


def _wgsl(statements: list[str], results: list[str]) -> str:
    members = "".join(f"    @location({i}) floor{i}: vec4f,\n" for i in range(len(results)))
    head = shaders.wgsl() + _text("wgsl") + f"\nstruct FloorTargets\n{{\n{members}}}\n"
    body = _indented(["let uv: vec2f = input.uv", *statements, f"return FloorTargets({', '.join(results)})"])
    return f"{head}\n@fragment fn {ENTRY}_PS(input: BokehVertex) -> FloorTargets\n{{\n{body}}}\n"


def _named(slot: str) -> str:
    return f"Bokeh{slot}"


DIALECTS = {
    "glsl": Dialect("vec2", "vec4", "float", lambda kind, name: f"{kind} {name}", _named, _named, _glsl),
    "hlsl": Dialect(
        "float2",
        "float4",
        "float",
        lambda kind, name: f"{kind} {name}",
        lambda slot: f"BOKEH_SHARED(Bokeh{slot}, BokehColorSamp)",
        _named,
        _hlsl,
    ),
    "wgsl": Dialect(
        "vec2f",
        "vec4f",
        "f32",
        lambda kind, name: f"var {name}: {kind}",
        lambda slot: f"Bokeh{slot}, BokehLinearClamp",
        _named,
        _wgsl,
    ),
}


def _number(value: float) -> str:
    text = f"{value:.9g}"
    return text if any(mark in text for mark in ".e") else text + ".0"


def _vector(dialect: Dialect, value: np.ndarray) -> str:
    return f"{dialect.vec2}({_number(value[0])}, {_number(value[1])})"


def _line(dialect: Dialect, line: Line, deep: bool, aspect: float, height: float) -> str:
    """The expression that adds up a line's samples; `coc` is the CoC that the pass blurs by."""
    to_uv = np.array([1.0 / aspect, 1.0])
    middle, half = line.middle * to_uv, line.half * to_uv
    # without depth the place of its texture is taken by one that is there
    depth = dialect.texels("DepthSamp" if deep else line.slot)
    textures = f"{dialect.texture(line.slot)}, {depth}, {str(deep).lower()}"
    if line.spacing > 0.0:
        length = 2.0 * float(np.hypot(*line.half)) * height
        cells = f"clamp({_number(length / line.spacing)} * coc, 1.0, {line.count}.0)"
        places = f"uv + {_vector(dialect, middle)} * coc, {_vector(dialect, half)} * coc"
        return f"FloorAdaptive({textures}, {places}, {cells}, {line.count})"
    parts = line.count - 1 if line.ends else line.count
    between = 2.0 * half / parts
    first = middle - half + (0.0 if line.ends else 0.5 * between)
    if line.side is None:
        places = f"uv + {_vector(dialect, first)} * coc, {_vector(dialect, between)} * coc"
        return f"FloorLine({textures}, {places}, {line.count})"
    side = line.side * to_uv
    places = f"uv + {_vector(dialect, first - side)} * coc, {_vector(dialect, between)} * coc"
    return f"FloorGrid({textures}, {places}, {_vector(dialect, 2.0 * side / parts)} * coc, {line.count})"


def _program(dialect: Dialect, item: Pass, found: Reads) -> str:
    values = item.values()
    aspect, height, spacing = (values[f"Bokeh{name}"] for name in ("AspectRatio", "ImageHeight", "Spacing"))
    declare, vec4 = dialect.declare, dialect.vec4
    statements = [f"{declare(vec4, 'center')} = BokehFetch({dialect.texture('ColorSamp')}, uv)"]
    coc = "abs(center.a)"
    if found.skips and spacing > 0.0:
        coc = f"BokehFilterCoC(abs(center.a), {_number(height)}, {_number(spacing)})"
    statements.append(f"{declare(dialect.scalar, 'coc')} = {coc}")
    names = [f"sum{index}" for index in range(len(found.lines))]
    statements += [f"{declare(vec4, name)} = center" for name in names]
    taken = [f"{names[0]} += BokehFetchNearest({dialect.texels('DepthSamp')}, uv).r"] if names and found.depth else []
    for name, line in zip(names, found.lines, strict=True):
        taken.append(f"{name} += {_line(dialect, line, found.depth, aspect, height)}")
    if found.skips and spacing > 0.0:
        statements.append("if (coc > 0.0) { " + "; ".join(taken) + "; }")
    else:
        statements += taken
    others = "".join(f" + BokehFetch({dialect.texture(slot)}, uv)" for slot in found.others)
    # a first pass with several targets: each holds the lines up to its own, as the method's do
    several = len(item.outputs) > 1
    results = []
    for target in range(len(item.outputs)):
        used = found.lines[: target + 1] if several else found.lines
        scale = _number(1.0 / (sum(line.samples for line in used) + len(used) + 1))
        statements.append(
            f"{declare(vec4, f'mean{target}')} = ({' + '.join(names[: len(used)] or ['center'])}{others}) * {scale}"
        )
        results.append(f"{vec4}(mean{target}.rgb + mean{target}.a, center.a)")
    return dialect.frame(statements, results)


def _replaced(item: Pass, found: Reads) -> Pass:
    sources = {language: _program(dialect, item, found) for language, dialect in DIALECTS.items()}
    wanted = {"ColorSamp", *(["DepthSamp"] if found.depth else []), *found.others, *(line.slot for line in found.lines)}
    inputs = {slot: name for slot, name in item.inputs.items() if slot in wanted}
    return replace(item, entry=ENTRY, inputs=inputs, parameters={}, sources=sources)


def floor(passes: tuple[Pass, ...]) -> tuple[Pass, ...]:
    """A plan's passes with every filter pass replaced by its floor; names of textures and targets stay."""
    return tuple(item if item.entry in COPYING_ENTRIES else _replaced(item, reads(item)) for item in passes)


def one_fetch(passes: tuple[Pass, ...]) -> tuple[Pass, ...]:
    """The same with one colour fetch a pass, at the pixel, and no depth: a pass in focus cannot cost less."""
    return tuple(item if item.entry in COPYING_ENTRIES else _replaced(item, Reads(())) for item in passes)
