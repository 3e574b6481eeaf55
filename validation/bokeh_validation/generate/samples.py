"""Describe the passes of a frame for the templates of the samples."""

from collections.abc import Callable
from dataclasses import dataclass
from math import degrees

from bokeh_validation import plan, shaders
from bokeh_validation.frame import methods
from bokeh_validation.shaders import calls
from bokeh_validation.shaders.entries import ADAPTIVE, COLORS, COPY, EDGE, ENTRIES, EXACT, LINE
from bokeh_validation.shaders.passes import Pass

# The samples' names for the inputs of a frame: the engine's depth buffer, and metres for paper
DEPTH_NAMES = {"depth buffer": "depth", "depth": "metres"}
DEPTH = "depthKind, nearPlane, farPlane"
# Numbers the passes for random sample offsets, which no sample uses
LEFT_OUT = "BokehPassIndex"
# Entries of the layers that read BokehSides, set in each pass in case the polygons of passes differ
SIDED = ("BokehDownsample", "BokehHoleFill", "BokehComposite")
SIZE = (64, 64)


@dataclass(frozen=True)
class Row:
    """Describe a pass of a frame.

    entry     such as BokehTileMax; `name` is TileMax, `define` TILE_MAX
    reads     a texture for each colour slot up to the last one in use, '-' for an unused slot
    writes    names of its targets
    memory    number of the memory of each target
    scale     divisor of its targets' size
    linear    whether it reads any texture with a linear filter
    sets      parameters that differ in this pass, without Bokeh -> value; Angle is in degrees
    call      of the library's function, in GLSL
    returned  name and members of the struct that the call returns, if the pass writes several targets
    """

    entry: str
    define: str
    reads: tuple[str, ...]
    writes: tuple[str, ...]
    memory: tuple[int, ...]
    scale: int
    linear: bool
    sets: dict[str, float]
    call: str
    returned: tuple[str, ...]

    @property
    def name(self) -> str:
        """Return the entry's name without Bokeh."""
        return self.entry.removeprefix("Bokeh")


def snake(name: str) -> str:
    """Spell a texture's name in snake case: near_strip_2 for 'near strip 2'."""
    return name.replace(" ", "_")


def camel(name: str) -> str:
    """Spell a texture's name in camel case: nearStrip2 for 'near strip 2'."""
    return name[0] + name.title().replace(" ", "")[1:]


def polygons(method: str) -> dict[str, int]:
    """Return the polygons that samples offer with a method -> number of sides."""
    return {name: EXACT[name] for name in (("hexagon", "octagon") if method == "paper" else EXACT)}


def frame(
    method: str,
    aperture: str,
    style: Callable[[str], str] = snake,
    targets: bool = True,
    adaptive: bool = False,
    memory: str = "",
) -> list[Row]:
    """Return the passes of a method, the CoC map first.

    style     how a texture's name is spelt: `snake` or `camel`
    targets   whether a pass may write several targets
    adaptive  whether lines of paper take as many samples as their length needs
    memory    prefix of the targets' names, which are then numbered by their memory, so that targets that may share it
              have one name; '': their own names
    """
    spacing = 1.0 if adaptive and method == "paper" else 0.0
    settings = methods.Settings(method, aperture, use_mrt=targets, spacing=spacing)
    planned = plan.frame(settings, SIZE)
    names = {texture["name"]: style(texture["name"]) for texture in planned["textures"]} | DEPTH_NAMES
    numbers = {texture["name"]: texture["memory"] for texture in planned["textures"]}
    if memory:
        names |= {name: f"{memory}{number}" for name, number in numbers.items() if number is not None}
    steps = [step for step in planned["passes"] if step["entry"] != plan.LINEAR_DEPTH.entry]
    return [
        _row(step, render_pass, names, numbers)
        for step, render_pass in zip(steps, methods.plan(settings, SIZE).passes, strict=True)
    ]


def after_map(method: str, aperture: str, style: Callable[[str], str] = snake, **chosen: bool) -> list[Row]:
    """Return the passes of a method after the CoC map; arguments as in frame()."""
    return frame(method, aperture, style, **chosen)[1:]


def targets(rows: list[Row]) -> dict[str, int]:
    """Return name of each target -> divisor of its size."""
    return {name: row.scale for row in rows for name in row.writes}


def _row(step: dict, render_pass: Pass, names: dict[str, str], memory: dict[str, int]) -> Row:
    sets = {name.removeprefix("Bokeh"): value for name, value in step["changes"].items() if name != LEFT_OUT}
    if render_pass.entry in SIDED:
        sets["Sides"] = render_pass.values()["BokehSides"]
    if "Angle" in sets:
        sets["Angle"] = round(degrees(sets["Angle"]), 6)
    last_slot = max(COLORS.index(slot) for slot in render_pass.inputs if slot in COLORS)
    return Row(
        entry=render_pass.entry,
        define=step["define"].removeprefix("BOKEH_"),
        reads=tuple(names.get(render_pass.inputs.get(slot), "-") for slot in COLORS[: last_slot + 1]),
        writes=tuple(names[name] for name in render_pass.outputs),
        memory=tuple(memory[name] for name in render_pass.outputs),
        scale=render_pass.scale,
        linear=step["sampler"],
        sets=sets,
        call=call(render_pass, names),
        returned=returned(render_pass) if len(render_pass.outputs) > 1 else (),
    )


# Arguments that each sample has under the library's names
LOCALS = ("vec2 uv", "BokehPolygon polygon", "BokehLayerContext layers", "BokehSamplingSettings settings")


def call(render_pass: Pass, names: dict[str, str]) -> str:
    """Return the GLSL call of the library's function in a pass, with a sample's names of textures, uniforms and
    locals.

    Every sample has the locals and uniforms uv, lens, depthKind, nearPlane, farPlane, layers, polygon, settings,
    rotation and squeeze. Raises ValueError for a parameter that no sample has an argument for.
    """
    entry, values = render_pass.spec, render_pass.values()
    textures = {slot: names[name] for slot, name in render_pass.inputs.items()}
    if entry.role == LINE:
        # samples of the paper's method use ADAPTIVE, or the entry itself
        return ""
    if entry.role == COPY:
        depth_arguments = f"depth, uv, uv, lens, {DEPTH}" if entry.name == plan.SIGNED_MAP else "metres, uv, lens"
        return f"{entry.name}(color, {depth_arguments})"
    if entry.role == ADAPTIVE:
        angle = f"radians({degrees(values['BokehAngle']):.1f}) + rotation"
        segment = f"BokehSegment({angle}, 1.0, vec2(0.0, 0.0), squeeze)"
        line = f"BokehDepthOfFieldAdaptive({textures['ColorSamp']}, metres, uv, {segment}, settings, true)"
        other = textures.get("ColorSampB")
        return f"BokehCombine({line}, BokehFetch({other}, uv), false)" if other else line
    function, signature = _called(render_pass)
    arguments, sampled, slots = [], "", iter(COLORS)
    for kind, name in signature.parameters:
        if kind == "BOKEH_TEXTURE":
            # a slot without a target of this polygon gets the previous texture, which is not read
            sampled = textures.get(next(slots), sampled)
        argument_of = {
            "BOKEH_TEXTURE": sampled,
            "vec2 layerCoC": f"BokehLayerCoC({names.get('layer coc')}, layers)",
            "int": f"{_last(render_pass)}",
            **dict.fromkeys(LOCALS, name),
        }
        argument = entry.given.get(name) or argument_of.get(kind) or argument_of.get(f"{kind} {name}")
        if argument is None:
            raise ValueError(f"{function}: say in samples.call() what the samples give for '{kind} {name}'")
        arguments.append(argument)
    text = f"{function}({', '.join(arguments)})"
    members = returned(render_pass)[1:] if len(render_pass.outputs) == 1 else ()
    return f"{text}.{members[render_pass.constants.get('BOKEH_TARGET_INDEX', 0)]}" if members else text


def returned(render_pass: Pass) -> tuple[str, ...]:
    """Return name and members of the struct that a pass's function returns, one member per target, or () if it returns
    none.
    """
    _, signature = _called(render_pass)
    members = [name for kind, name in calls.structs(shaders.text("glsl")).get(signature.kind, ()) if kind == "vec4"]
    if not members:
        return ()
    targets = ENTRIES[render_pass.spec.whole].targets if render_pass.spec.whole else max(render_pass.spec.targets, 1)
    if render_pass.spec.role == EDGE:
        targets = 4
    return signature.kind, *members[:targets]


def _called(render_pass: Pass) -> tuple[str, calls.Signature]:
    """Return the library function from which a pass's entry takes its result, and its signature."""
    signatures = calls.signatures(shaders.text("glsl"))
    for name in calls.called_from(shaders.file_text("glsl", "bokeh_passes"), render_pass.entry):
        kind, parameters = signatures[name]
        # skip functions that only fetch a texture
        if parameters and parameters[0][0] == "BOKEH_TEXTURE" and kind != "vec2" and "Fetch" not in name:
            return name, signatures[name]
    raise ValueError(f"{render_pass.entry} calls no function of the library that reads its textures")


def _last(render_pass: Pass) -> int:
    """Return the argument of BokehExactFirst that names the last target needed."""
    return (
        render_pass.constants["BOKEH_TARGET_INDEX"] + 2
        if render_pass.spec.role == EDGE
        else render_pass.spec.sides // 2
    )
