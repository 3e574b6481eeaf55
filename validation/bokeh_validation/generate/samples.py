"""The passes of a frame as the samples of integration/ list them: rows, and how each language writes one."""

import re
from collections.abc import Iterator
from math import degrees
from typing import NamedTuple

from bokeh_validation import plan, shaders
from bokeh_validation.frame import methods
from bokeh_validation.shaders.entries import ADAPTIVE, BOTH, COLORS, COPY, EDGE, ENTRIES, EXACT, Entry
from bokeh_validation.shaders.passes import Pass

# What the samples call what they hand to a frame: the engine's depth buffer, and metres for paper
DEPTH_NAMES = {"depth buffer": "depth", "depth": "metres"}
DEPTH = "depthKind, nearPlane, farPlane"
# No sample has noise on its samples' places, which this numbers
LEFT_OUT = "BokehPassIndex"
# Entries of the layers that read BokehSides, where each pass may be of another polygon
SIDED = ("BokehDownsample", "BokehHoleFill", "BokehComposite")
SIZE = (64, 64)


class Language(NamedTuple):
    """How a table of passes is written.

    head, tail        around all; {} is its name
    row               a pass: {entry} such as BokehTileMax, {name} without Bokeh, {define} such as TILE_MAX, {scale}
                      that its targets' size is divided by, {call} of the library in GLSL, {returned} for the struct
                      and members of several targets, {sets} for its own parameters, {reads} with '-' for a colour
                      slot that it leaves out, {writes}, {quoted} for these, each in quotes, {memory}, {sides}, {copy}:
                      1 where one of {sets} is 1, in a block of parameters that passes share
    parameter, angle  one of {sets}; an angle is in degrees
    polygon, its_end  around the rows of each of several polygons; {} is its sides
    replaced          a word and what the language has in its place
    camel             whether 'near target 2' is called nearTarget2; else near_target_2
    targets           whether a pass may write several
    spacing           of paper; 0: a fixed number of samples
    metres            the pass from the depth buffer to metres, first of paper; without it a sample draws it itself
    """

    head: str
    row: str
    tail: str
    parameter: str = ""
    angle: str = ""
    polygon: str = ""
    its_end: str = ""
    quote: str = '"'
    replaced: tuple[str, str] = ("", "")
    camel: bool = False
    targets: bool = True
    spacing: float = 1.0
    metres: str = ""


PYTHON = Language(
    "{} = [", '    ("{define}", "{reads}", "{writes}", {scale}, {{{sets}}}),', "]",
    '"Bokeh{}": {:g}', '"Bokeh{}": radians({:g})',
    metres='    ("LINEAR_DEPTH", "", "metres", 1, {}),',
)  # fmt: skip
PANDA3D = PYTHON._replace(head="{} = {{", row=f"    {PYTHON.row}", tail="}}", polygon="    {}: [", its_end="    ],")
JAVA = Language(
    "public static final BokehFilter.Step[] {} = {{",
    '    new BokehFilter.Step(BokehPass.{define}, "{reads}", "{writes}", {scale}, Map.of({sets})),', "}};",
    '"{}", {:g}f', '"{}", {:g}f * FastMath.DEG_TO_RAD', replaced=("color", "scene"), camel=True,
    metres='    new BokehFilter.Step(BokehPass.LINEAR_DEPTH, "", "metres", 1, Map.of()),',
)  # fmt: skip
DIRECT3D11 = Language(
    "static const std::vector<Pass> {} = {{",
    '    {{"{entry}_PS", "{reads}", "{writes}", {scale}, {{{sets}}}}},', "}};",
    "{{&BokehParameters::{}, {:.1f}f}}", "{{&BokehParameters::{}, {:.1f}f * PI / 180.0f}}", spacing=0.0,
    metres='    {"BokehLinearDepth_PS", "", "metres", 1, {}},',
)  # fmt: skip
DIRECT3D9 = Language(
    "static const Pass {}[MAX_PASSES] = {{", '    {{"{entry}_PS", "{reads}", "{writes}", {scale}{sets}}},', "}};",
    ", {{PARAMETER({}), {:.1f}f}}", ", {{PARAMETER({}), {:.1f}f * 3.14159265f / 180.0f}}", spacing=0.0,
)  # fmt: skip
VULKAN = Language(
    "inline const std::vector<BokehPass> {} = {{",
    '    {{"{entry}", "{define}", {{"{reads}"}}, {{"{writes}"}}, {{{memory}}}, {scale}, {sides}, {copy}}},', "}};",
)  # fmt: skip
OGRE = Language(
    "static Frame {}(int sides)\n{{\n    static const std::map<int, Frame> frames = {{",
    '            {{"{define}", "{reads}", "{writes}", {scale}, {{{sets}}}}},',
    "    }};\n    return frames.at(sides);\n}}", '{{"Bokeh{}", {:.1f}f}}', "", "        {{{}, {{", "        }}}},",
)  # fmt: skip
SCRIPT = Language(
    "const {} = {{", "    [[{quoted}], {scale}, '{call}'{returned}],", "}};",
    polygon="  {}: [", its_end="  ],", quote="'", camel=True,
)  # fmt: skip
LUA = Language(
    "FRAMES.{} = {{", '    {{ {{ {quoted} }}, {scale}, "{call}"{returned} }},', "}}",
    polygon="  [{}] = {{", its_end="  }},", camel=True,
)  # fmt: skip
GODOT = Language(
    "const {} := {{", '\t\t["{writes}", {scale}, "{call}"],', "}}",
    polygon="\t{}: [", its_end="\t],", replaced=("uv", "UV"), targets=False,
)  # fmt: skip
UNITY = Language(
    "public static readonly Dictionary<int, BokehStep[]> {} = new Dictionary<int, BokehStep[]>\n{{",
    '        new BokehStep(BokehShaderPass.{name}, "{reads}", "{writes}", {scale}) {{{sets}}},', "}};",
    "{} = {:g}f", "", "    [{}] = new[]\n    {{", "    }},", camel=True,
)  # fmt: skip
UNREAL = Language(
    "static const TArray<FBokehStep>* Bokeh{}(int32 Sides)\n{{",
    '            {{&AddBokehPass<FBokeh{name}PS>, TEXT("{reads}"), TEXT("{writes}"), {scale}, {{{sets}}}}},',
    "    return nullptr;\n}}", ".{} = {:.1f}f", "",
    "    if (Sides == {})\n    {{\n        static const TArray<FBokehStep> Steps = {{",
    "        }};\n        return &Steps;\n    }}", camel=True,
)  # fmt: skip
BEVY = Language(
    "pub const {}: Table = &[", '        pass("{entry}_PS", &["{reads}"], &["{writes}"], {scale}, &[{sets}]),', "];",
    "{}({:.1f})", "", "    ({}, &[", "    ]),",
)  # fmt: skip


def table(language: Language, name: str, method: str, aperture: str = "") -> Iterator[str]:
    """The lines of a polygon's table of passes; without `aperture`, of all polygons, and without the CoC map."""
    yield from language.head.format(name).splitlines()
    if aperture:
        yield from [language.metres] * (method == "paper" and bool(language.metres))
        yield from rows(language, method, aperture)
    else:
        for shape in ("hexagon", "octagon") if method == "paper" else EXACT:
            yield from language.polygon.format(EXACT[shape]).splitlines()
            yield from rows(language, method, shape)[1:]
            yield from language.its_end.format().splitlines()
    yield from language.tail.format().splitlines()


def rows(language: Language, method: str, aperture: str) -> list[str]:
    """The passes of a method from the CoC map on, as the language writes them."""
    spacing = language.spacing if method == "paper" else 0.0
    settings = methods.Settings(method, aperture, targets=language.targets, spacing=spacing)
    planned = plan.frame(settings, SIZE)
    names = {}
    for name in (texture["name"] for texture in planned["textures"]):
        names[name] = name[0] + name.title().replace(" ", "")[1:] if language.camel else name.replace(" ", "_")
    names |= DEPTH_NAMES
    memory = {texture["name"]: str(texture["memory"]) for texture in planned["textures"]}
    word, replacement = language.replaced
    separator = '", "' if language in (BEVY, VULKAN) else " "
    lines = []
    steps = [step for step in planned["passes"] if step["entry"] != plan.LINEAR_DEPTH.entry]
    for step, item in zip(steps, methods.plan(settings, SIZE).passes, strict=True):
        sets = {name.removeprefix("Bokeh"): value for name, value in step["changes"].items() if name != LEFT_OUT}
        if item.entry in SIDED:
            sets["Sides"] = item.values()["BokehSides"]
        if "Angle" in sets:
            sets["Angle"] = round(degrees(sets["Angle"]), 6)
        forms = {"Angle": language.angle or language.parameter}
        last = max(COLORS.index(slot) for slot in item.inputs if slot in COLORS)
        writes = [names[name] for name in item.outputs]
        line = language.row.format(
            entry=item.entry,
            name=item.entry.removeprefix("Bokeh"),
            define=step["define"].removeprefix("BOKEH_"),
            reads=separator.join(names.get(item.inputs.get(slot), "-") for slot in COLORS[: last + 1]),
            writes=separator.join(writes),
            quoted=", ".join(f"{language.quote}{name}{language.quote}" for name in writes),
            memory=", ".join(memory[name] for name in item.outputs),
            scale=item.scale,
            sides=EXACT.get(aperture),
            copy=int(1.0 in sets.values()),
            sets=", ".join(forms.get(name, language.parameter).format(name, value) for name, value in sets.items()),
            call=call(item, names),
            returned=f", {language.quote}{' '.join(returned(item))}{language.quote}" if len(writes) > 1 else "",
        )
        lines.append(re.sub(rf"\b{word}\b", replacement, line) if word else line)
    return lines


# Arguments that each sample has under the library's name, and two of the line filter, which no sample calls
LOCALS = ("vec2 uv", "BokehPolygon polygon", "BokehLayers layers", "BokehFilter settings")
LOCALS += ("BOKEH_DEPTH_TEXTURE DepthSamp", "vec2 lineEnd")


def call(item: Pass, names: dict[str, str]) -> str:
    """The function of the library that a pass calls, with a sample's names of textures, uniforms and locals.

    uv, lens, depthKind, nearPlane, farPlane, layers, polygon, settings, rotation and squeeze are the locals and
    uniforms that each sample has.
    """
    entry, values = item.spec, item.values()
    textures = {slot: names[name] for slot, name in item.inputs.items()}
    if entry.role == COPY:
        given = f"depth, uv, uv, lens, {DEPTH}" if entry.name == plan.SIGNED_MAP else "metres, uv, lens"
        return f"{entry.name}(color, {given})"
    if entry.role == ADAPTIVE:
        angle = f"radians({degrees(values['BokehAngle']):.1f}) + rotation"
        segment = f"BokehSegment({angle}, 1.0, vec2(0.0, 0.0), squeeze)"
        line = f"BokehDepthOfFieldAdaptive({textures['ColorSamp']}, metres, uv, {segment}, settings, true)"
        other = textures.get("ColorSampB")
        return f"BokehCombine({line}, BokehFetch({other}, uv), false)" if other else line
    function = _function(entry)
    _, parameters = _signature(function)
    arguments, sampled, slots = [], "", iter(COLORS)
    for kind, name in (parameter.split() for parameter in parameters.split(",")):
        if kind == "BOKEH_TEXTURE":
            # a slot that the polygon has no target for gets the one before, and does not read it
            sampled = textures.get(next(slots), sampled)
        known = {
            "BOKEH_TEXTURE": sampled,
            "vec2 sizes": f"BokehLayerSizes({names.get('sizes')}, layers)",
            "vec2 axis": "vec2(0.0, 1.0)" if values["BokehAxis"] else "vec2(1.0, 0.0)",
            "bool": "true" if values["BokehLayer"] else "false",
            "int": f"{_last(item)}",
            **dict.fromkeys(LOCALS, name),
        }
        argument = known.get(kind, known.get(f"{kind} {name}"))
        if argument is None:
            raise ValueError(f"{function}: say in samples.call() what the samples give for '{kind} {name}'")
        arguments.append(argument)
    text = f"{function}({', '.join(arguments)})"
    members = returned(item)[1:] if len(item.outputs) == 1 else ()
    return f"{text}.{members[item.constants.get('BOKEH_TARGET_INDEX', 0)]}" if members else text


def returned(item: Pass) -> tuple[str, ...]:
    """Name and members of the struct that a pass's function returns, as many as the entry has targets; or nothing."""
    kind, _ = _signature(_function(item.spec))
    members = re.findall(rf"^struct {kind}\n\{{\n((?:    vec4 \w+;\n)+)", shaders.text("glsl"), re.MULTILINE)
    if not members:
        return ()
    targets = ENTRIES[item.spec.whole].targets if item.spec.whole else max(item.spec.targets, 1)
    if item.spec.role == EDGE:
        targets = 4
    return kind, *re.findall(r"vec4 (\w+)", members[0])[:targets]


def _function(entry: Entry) -> str:
    """The function of the library that an entry calls."""
    if entry.role == EDGE:
        return "BokehLayerFirst" if entry.layers else "BokehExactFirst"
    layer = "Layers" if entry.sides in BOTH else "Layer"
    return re.sub("(?:Square|Hexagon|Octagon|Decagon)Layer", layer, (entry.whole or entry.name).removesuffix("One"))


def _last(item: Pass) -> int:
    """BokehExactFirst's parameter: the last target that is wanted."""
    return item.constants["BOKEH_TARGET_INDEX"] + 2 if item.spec.role == EDGE else item.spec.sides // 2


def _signature(function: str) -> tuple[str, str]:
    """Type of a function of the GLSL library, and its parameters."""
    return re.search(rf"^(\w+) {function}\(([^)]*)\)\n\{{", shaders.text("glsl"), re.MULTILINE).groups()
