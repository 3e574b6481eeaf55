"""The passes of a frame as the samples of integration/ list them: rows, and how each language writes one."""

import re
from collections.abc import Callable, Iterator
from math import degrees
from typing import NamedTuple

from bokeh_validation import paths, shaders
from bokeh_validation.errors import UserError
from bokeh_validation.frame import methods, plan
from bokeh_validation.shaders.entries import ADAPTIVE, COLORS, COPY, EXACT
from bokeh_validation.shaders.passes import Pass

# What the samples call what they hand to a frame
DEPTH_NAME = "metres"
LENS = "apertureDiameter, focalLength, focusDistance, sensorHeight, maxCoC"
# No sample has noise on its samples' places, which this numbers
LEFT_OUT = "BokehPassIndex"
SIZE = (64, 64)


class Row(NamedTuple):
    """A pass.

    entry   such as BokehLayerTiles
    define  such as LAYER_TILES: BOKEH_PASS without BOKEH_
    reads   textures for ColorSamp, ColorSampB .., '-' for a slot that it does not read
    writes  its targets
    scale   they have the full size divided by it, rounded up
    sets    parameters of its own, without Bokeh; an angle in degrees
    call    the function of the library that it is, in GLSL
    memory  number of the memory that each target may share with others: plan.frame()
    """

    entry: str
    define: str
    reads: tuple[str, ...]
    writes: tuple[str, ...]
    scale: int
    sets: dict[str, float]
    call: str
    memory: tuple[int, ...]


# Sides -> passes after the CoC map
Frames = dict[int, list[Row]]


def camel(name: str) -> str:
    """'near target 2' -> 'nearTarget2'."""
    first, *rest = name.split()
    return first + "".join(word.capitalize() for word in rest)


def snake(name: str) -> str:
    """'near target 2' -> 'near_target_2'."""
    return name.replace(" ", "_")


def frames(method: str, named: Callable[[str], str] = snake, targets: bool = True) -> Frames:
    """A method's passes of every polygon that the samples make by it."""
    shapes = ("hexagon", "octagon") if method == "paper" else EXACT
    return {EXACT[aperture]: rows(method, aperture, named, targets)[1:] for aperture in shapes}


def rows(
    method: str, aperture: str, named: Callable[[str], str], targets: bool = True, spacing: float = 1.0
) -> list[Row]:
    """The passes of a method from the CoC map on.

    named    camel or snake: how textures are called
    targets  whether a pass may write several
    spacing  of paper; 0: a fixed number of samples
    """
    settings = methods.Settings(method, aperture, targets=targets, spacing=spacing if method == "paper" else 0.0)
    planned = plan.frame(settings, SIZE)
    memory = {texture["name"]: texture["memory"] for texture in planned["textures"]}

    def own(name: str) -> str:
        return DEPTH_NAME if name == "depth" else named(name)

    listed = []
    for step, item in zip(planned["passes"][1:], methods.plan(settings, SIZE).passes, strict=True):
        last = max(COLORS.index(slot) for slot in item.inputs if slot in COLORS)
        sets = {name: value for name, value in step["changes"].items() if name != LEFT_OUT}
        if item.spec.layers and "BokehSides" in program(step["define"]):
            sets["BokehSides"] = item.values()["BokehSides"]
        row = Row(
            item.entry,
            step["define"].removeprefix("BOKEH_"),
            tuple(own(item.inputs[slot]) if slot in item.inputs else "-" for slot in COLORS[: last + 1]),
            tuple(own(name) for name in item.outputs),
            item.scale,
            {n.removeprefix("Bokeh"): round(degrees(v), 6) if n == "BokehAngle" else v for n, v in sets.items()},
            call(item, own),
            tuple(memory[name] for name in item.outputs),
        )
        listed.append(row)
    return listed


def program(define: str) -> str:
    """What bokeh_passes.glsl has for a value of BOKEH_PASS alone. Raises UserError where it has nothing."""
    text = paths.passes("glsl").read_text(encoding="ascii")
    found = re.search(rf"^#(?:el)?if BOKEH_PASS == {define}\n(.*?)^#(?:elif|endif)", text, re.MULTILINE | re.DOTALL)
    if found is None:
        raise UserError(f"bokeh_passes.glsl: no program {define}")
    return found[1]


def signature(function: str) -> tuple[str, list[list[str]]]:
    """Type of a function of the GLSL library, type and name of its parameters. Raises UserError where there is none."""
    head = re.search(rf"^(\w+) {function}\(([^)]*)\)\n\{{", shaders.text("glsl"), re.MULTILINE)
    if head is None:
        raise UserError(f"glsl: no function {function}")
    return head[1], [parameter.split() for parameter in head[2].split(",")]


def call(item: Pass, named: Callable[[str], str]) -> str:
    """The function of the library that a pass calls, with a sample's textures, uniforms and locals.

    uv, layers, polygon, settings, rotation and squeeze are the locals and uniforms that each sample has.
    """
    entry, values = item.spec, item.values()
    textures = {slot: named(name) for slot, name in item.inputs.items()}
    if entry.role == COPY:
        return f"{entry.name}(color, {DEPTH_NAME}, uv, {LENS})"
    if entry.role == ADAPTIVE:
        angle = f"radians({degrees(values['BokehAngle']):.1f}) + rotation"
        segment = f"BokehSegment({angle}, 1.0, vec2(0.0, 0.0), squeeze)"
        line = f"BokehDepthOfFieldAdaptive({textures['ColorSamp']}, {DEPTH_NAME}, uv, {segment}, settings, true)"
        other = textures.get("ColorSampB")
        return f"BokehCombine({line}, BokehFetch({other}, uv), false)" if other else line
    function = re.sub("Square|Hexagon|Octagon|Decagon", "" if entry.layers else "Exact", entry.whole or entry.name)
    returned, parameters = signature(function)
    arguments, sampled, slots = [], "", iter(COLORS)
    for kind, name in parameters:
        if kind == "sampler2D":
            # a slot that the polygon has no target for gets the one before, and does not read it
            sampled = textures.get(next(slots), sampled)
        argument = {
            "sampler2D": sampled,
            "vec2": "uv" if name == "uv" else "vec2(0.0, 1.0)" if values["BokehAxis"] else "vec2(1.0, 0.0)",
            "bool": "true" if values["BokehLayer"] else "false",
            "int": f"{values['BokehEdge']:.0f}",
        }.get(kind, name)
        arguments.append(argument)
    text = f"{function}({', '.join(arguments)})"
    if entry.whole:
        return f"BokehPickTarget({text}, {values['BokehEdge']:.0f})"
    return f"{text}.T2" if returned == "BokehTargets" and len(item.outputs) == 1 else text


# ----------------------------------------------------------------------------------------------------------- languages


class Language(NamedTuple):
    """How a table of passes is written: format strings of its parts.

    head, tail        of the table, around all; {} is its name
    polygon, its_end  around the rows of each of several polygons; {} is its sides
    row               names of Row's fields, `quoted`: `writes` in quotes
    parameter, angle  one of a row's `sets`
    """

    head: str
    row: str
    tail: str
    parameter: str = ""
    angle: str = ""
    polygon: str = ""
    its_end: str = ""


OF_OGRE = "static Frame {}(int sides)\n{{\n    static const std::map<int, Frame> frames = {{"
PYTHON = Language(
    "{} = [", '    ("{define}", "{reads}", "{writes}", {scale}, {{{sets}}}),', "]",
    '"Bokeh{}": {:g}', '"Bokeh{}": radians({:g})',
)  # fmt: skip
JAVA = Language(
    "public static final BokehFilter.Step[] {} = {{",
    '    new BokehFilter.Step(BokehPass.{define}, "{reads}", "{writes}", {scale}, Map.of({sets})),', "}};",
    '"{}", {:g}f', '"{}", {:g}f * FastMath.DEG_TO_RAD',
)  # fmt: skip
DIRECT3D11 = Language(
    "static const std::vector<Pass> {} = {{",
    '    {{"{entry}_PS", "{reads}", "{writes}", {scale}, {{{sets}}}}},', "}};",
    "{{&BokehParameters::{}, {:.1f}f}}", "{{&BokehParameters::{}, {:.1f}f * PI / 180.0f}}",
)  # fmt: skip
OGRE = Language(
    OF_OGRE, '            {{"{define}", "{reads}", "{writes}", {scale}, {{{sets}}}}},',
    "    }};\n    return frames.at(sides);\n}}", '{{"Bokeh{}", {:.1f}f}}', "", "        {{{}, {{", "        }}}},",
)  # fmt: skip
SCRIPT = Language(
    "const {} = {{", "    [[{quoted}], {scale}, '{call}'],", "}};", polygon="  {}: [", its_end="  ],"
)  # fmt: skip
LUA = Language(
    "FRAMES.{} = {{", '    {{ {{ {quoted} }}, {scale}, "{call}" }},', "}}", polygon="  [{}] = {{", its_end="  }},"
)  # fmt: skip
GODOT = Language(
    "const {} := {{", '\t\t["{writes}", {scale}, "{call}"],', "}}", polygon="\t{}: [", its_end="\t],"
)  # fmt: skip


def table(language: Language, name: str, passes: list[Row] | Frames) -> Iterator[str]:
    """The lines of a table of passes, or of one for each polygon."""
    quote = "'" if language is SCRIPT else '"'
    yield from language.head.format(name).splitlines()
    for sides, listed in passes.items() if isinstance(passes, dict) else [(0, passes)]:
        if sides:
            yield language.polygon.format(sides)
        for row in listed:
            forms = {"Angle": language.angle or language.parameter}
            texts = {
                "reads": " ".join("scene" if language is JAVA and name == "color" else name for name in row.reads),
                "writes": " ".join(row.writes),
                "quoted": ", ".join(f"{quote}{name}{quote}" for name in row.writes),
                "sets": ", ".join(forms.get(k, language.parameter).format(k, v) for k, v in row.sets.items()),
                "call": re.sub(r"\buv\b", "UV", row.call) if language is GODOT else row.call,
            }
            yield language.row.format(**{**row._asdict(), **texts})
        if sides:
            yield language.its_end.format()
    yield from language.tail.format().splitlines()


def bevy(name: str, passes: list[Row]) -> Iterator[str]:
    """Bevy's table. Three textures do between the passes: those that may share their memory are one."""
    places, letters = {"color": "Scene"}, {}
    yield f"const {name}: &[Pass] = &["
    for row in passes:
        for texture, memory in zip(row.writes, row.memory, strict=True):
            known = {"coc": "CoC", "result": "Out"}.get(texture)
            places[texture] = known or letters.setdefault(memory, "ABC"[len(letters) % 3])
        reads, writes = (", ".join(places[texture] for texture in textures) for textures in (row.reads, row.writes))
        yield f'    pass("{row.entry}_PS", &[{reads}], &[{writes}], {row.sets.get("Angle", 0.0):.1f}),'
    yield "];"
