"""Describe a method's frame as data: `validation/run plan` prints it, and `validation/run generate` writes it into the
samples.

The data are made from the passes that the drivers run (methods.plan) and hold everything that an engine needs to draw
them.
"""

import json
import re
from dataclasses import asdict, replace
from typing import Annotated

import typer

from bokeh_validation import __version__, options, paths, shaders, terminal
from bokeh_validation.errors import UserError
from bokeh_validation.frame import methods
from bokeh_validation.plan import fetches
from bokeh_validation.shaders.entries import COPY, COPYING_ENTRIES, DEPTH, LATERAL, STEADY, UNREAD, VIEW
from bokeh_validation.shaders.parameters import BLOCK_FLOATS, PARAMETERS
from bokeh_validation.shaders.passes import BINDINGS, FIRST_SAMPLER, SLOTS, Pass, is_linear, target_area, target_size

LEAST_SIDE, MOST_SIDE = 2, 16384
# Role of an entry -> format of its target, and bytes per texel
FORMATS = {DEPTH: ("R32F", 4)}
USUAL_FORMAT = ("RGBA16F", 8)
SIGNED_MAP = "BokehSignedCoCMap"
# Converts the engine's depth buffer to metres for paper and naive; the harness's drivers receive metres
LINEAR_DEPTH = Pass("BokehLinearDepth", {"DepthSamp": "depth buffer"}, "depth")
# Drawn for BokehDebugMode instead of all passes after the signed map
DEBUG = Pass("BokehDebug", {"ColorSamp": "coc", "DepthSamp": "depth buffer"}, "result")
VERTEX = {
    "entry": "BokehFullScreen",
    "define": "BOKEH_FULL_SCREEN",
    "vertices": 3,
    "topology": "triangle list",
    "vertex_buffer": None,
    "note": "Draw three vertices without a vertex buffer: they are made of the vertex index. Core OpenGL draws nothing "
    "without a bound vertex array: bind an empty one. Shader model 3 has no vertex index: there it takes a quad of "
    "your own with a position of -1 .. 1.",
}
# Parameters whose values only the engine knows; `parameters` holds the values of the settings, or defaults.
OVERWRITE = {
    "lens": list(methods.LENS),
    "depth buffer": ["BokehDepthKind", "BokehNear", "BokehFar"],
    "size": ["BokehAspectRatio", "BokehImageWidth", "BokehImageHeight"],
    "each frame, with BokehJitter": ["BokehFrame"],
}
NOTES = (
    "To make the program of a pass, join these parts into one text: the lines of `before`, a #define of each "
    "constant, then `files` in their order. In WGSL, set the constants when you create the pipeline instead. The "
    "vertex shader is made in the same way, with the `define` of `vertex`; in HLSL and WGSL it is an entry point of "
    "the same text. GLSL may also start with version 300 es or 450, and HLSL may be shader model 3 to 6.",
    "The `size` of a target is the full size divided by `scale`, rounded up. A pass draws to its whole target, "
    "unless it has a `viewport` (x, y, width, height in texels of the target).",
    "Switch off blending, depth test and culling. `linear` means a sampler with a linear filter, clamped, without "
    "mip levels. A `nearest` texture is fetched texel by texel. It needs a nearest filter in shader model 3, and in "
    "OpenGL ES if it is a 32-bit float texture.",
    "A pass takes the values of `parameters`, but those in its own `changes` replace them in this pass. Your engine "
    "must set the parameters that `overwrite` names.",
    "BokehSignedCoCMap reads the engine's depth buffer, and BokehDepthKind says what the buffer holds. If there is "
    "a pass BokehLinearDepth, it converts depth to metres; leave it out if your depth is in metres already.",
    "WebGPU: all bindings are in `group`. A pass has a sampler if `sampler` is true. With layout 'auto', a pass "
    "also has the bindings in `unread`, which it never reads: bind the texture that is named there, or any other.",
    "`debug` is a pass that you may draw after the CoC map, instead of all other passes. BokehDebugMode 0 shows the "
    "colour, 1 the depth, 2 the CoC, and 3 the near and the far field.",
    "A constant that is not listed has the library's default, which belongs to the preset MEDIUM. For another "
    "preset, put its `define` before the files, or in WGSL set the constants that it `stands_for`. Do not define "
    "both a preset and one of its constants, since that is an error.",
    "If a preset sets BOKEH_LAYER_SCALE to 4, passes and targets with a `scale` of 2 have a `scale` of 4 instead.",
)


def frame(settings: methods.Settings, size: tuple[int, int], viewport: tuple[int, int, int, int] | None = None) -> dict:
    """Return everything that an engine needs to draw a frame, ready for JSON; NOTES say how to read it.

    size      (width, height) of the textures, pixels
    viewport  (x, y, width, height) if the image fills only a part of them, counted from the first row in memory. x and
              y must be multiples of every pass's scale; ValueError is raised otherwise

    `last_read` is the last pass that reads a texture, null for the result; textures with the same number in `memory`
    may share a target. `binding` is for WebGPU and Vulkan, `register` for Direct3D. `fetches` of a pass is the maximum
    for one texel of its targets; `fetches` of the frame is per full-size pixel.
    """
    plan = methods.plan(settings, viewport[2:] if viewport else size)
    if any("depth" in render_pass.inputs.values() and render_pass.entry != SIGNED_MAP for render_pass in plan.passes):
        plan = replace(plan, passes=(LINEAR_DEPTH, *plan.passes))
    else:
        plan = replace(plan, passes=tuple(_from_buffer(render_pass) for render_pass in plan.passes))
    if viewport:
        plan = methods.in_viewport(plan, viewport, size)
    unread = [_unread(render_pass) for render_pass in plan.passes]
    plan = replace(plan, passes=tuple(_read(render_pass) for render_pass in plan.passes))
    same, changes = _parameters(plan.passes)
    has_presets = settings.method == "layered" or settings.has_preset
    presets = _presets(settings.method) if has_presets else {}
    textures = _textures(plan, size)
    targets = [texture for texture in textures if texture["written"] is not None]
    return {
        "version": __version__,
        "settings": asdict(settings),
        "method": settings.method,
        "aperture": settings.aperture,
        "preset": presets.get(settings.preset),
        "presets": presets,
        "several_targets": settings.use_mrt,
        "size": list(size),
        "notes": list(NOTES),
        "programs": programs(settings),
        "vertex": VERTEX,
        "passes": [
            {**_step(number, render_pass, changed, size, textures), "unread": unread_inputs}
            for number, (render_pass, changed, unread_inputs) in enumerate(
                zip(plan.passes, changes, unread, strict=True)
            )
        ],
        "debug": _debug(plan.passes, size),
        "parameters": same,
        "overwrite": OVERWRITE,
        "block": {"floats": BLOCK_FLOATS, "order": list(PARAMETERS)},
        "bindings": {"group": 0, "parameters": 0, "sampler": FIRST_SAMPLER},
        "textures": textures,
        "tables": {name: table[0, :, :2].tolist() for name, table in plan.tables.items()},
        "result": plan.result,
        "bytes": sum(texture["bytes"] for texture in targets),
        "bytes_shared": sum({texture["memory"]: texture["bytes"] for texture in targets}.values()),
        "fetches": fetches.of_frame(plan.passes),
    }


def _presets(method: str) -> dict[str, dict]:
    """Return name of a preset -> its define, and the constants that the define sets."""
    names, presets = methods.PRESET_CONSTANTS, methods.PRESETS
    if method == "exact":
        names, presets = methods.EXACT_CONSTANTS, methods.EXACT_PRESETS
    described = {}
    for name, values in presets.items():
        constants_of = dict(zip(names, values, strict=True))
        described[name] = {"name": name, "define": f"BOKEH_PRESET_{name.upper()}", "stands_for": constants_of}
    return described


def text(planned: dict) -> str:
    """Format a frame as JSON with one pass, texture or note per line."""
    members = []
    for key, value in planned.items():
        entries, brackets = [], "[]"
        if isinstance(value, dict) and key != "settings" and any(isinstance(entry, dict) for entry in value.values()):
            entries, brackets = [f"{json.dumps(name)}: {json.dumps(entry)}" for name, entry in value.items()], "{}"
        elif key == "notes" or (isinstance(value, list) and any(isinstance(entry, dict) for entry in value)):
            entries = [json.dumps(entry) for entry in value]
        lines = ",\n".join(f"  {entry}" for entry in entries)
        formatted = f"{brackets[0]}\n{lines}\n {brackets[1]}" if entries else json.dumps(value)
        members.append(f" {json.dumps(key)}: {formatted}")
    return "{\n" + ",\n".join(members) + "\n}\n"


def _from_buffer(render_pass: Pass) -> Pass:
    """Return the pass reading the engine's depth buffer instead of metres."""
    renamed = {slot: "depth buffer" if name == "depth" else name for slot, name in render_pass.inputs.items()}
    return replace(render_pass, inputs=renamed)


def _read(render_pass: Pass) -> Pass:
    """Return the pass without inputs that its single target does not need: the GLSL program has no uniform for them."""
    left_out = [read["slot"] for read in _unread(render_pass)]
    return replace(
        render_pass, inputs={slot: name for slot, name in render_pass.inputs.items() if slot not in left_out}
    )


def _unread(render_pass: Pass) -> list[dict]:
    """Return the inputs that the pass's single target does not need.

    In WGSL the entry still declares them, since its target is chosen by an override constant.
    """
    if render_pass.spec.whole not in UNREAD:
        return []
    slots = UNREAD[render_pass.spec.whole][render_pass.constants["BOKEH_TARGET_INDEX"]]
    return [
        {"slot": slot, "binding": BINDINGS[slot], "texture": render_pass.inputs[slot]}
        for slot in slots
        if slot in render_pass.inputs
    ]


def _debug(passes: tuple[Pass, ...], size: tuple[int, int]) -> dict | None:
    """Return the pass of the debug views, or None if the CoC map has no sign."""
    if passes[0].entry != SIGNED_MAP:
        return None
    render_pass = replace(DEBUG, viewport=passes[0].viewport, parameters=passes[0].parameters)
    return _step(1, render_pass, {}, size, [])


def _step(
    number: int, render_pass: Pass, changed: dict[str, float], size: tuple[int, int], textures: list[dict]
) -> dict:
    """Return a pass as frame() lists it.

    number   index of the pass
    changed  parameters that differ from the frame's common ones
    size     (width, height) of the full size
    """
    return {
        "pass": number,
        "entry": render_pass.entry,
        "define": shaders.glsl_pass(render_pass.entry),
        "inputs": [
            {
                "slot": slot,
                "uniform": f"Bokeh{slot}",
                "register": register,
                "binding": BINDINGS[slot],
                "texture": render_pass.inputs[slot],
                "filter": "linear" if is_linear(render_pass.entry, slot) else "nearest",
            }
            for register, slot in enumerate(SLOTS)
            if slot in render_pass.inputs
        ],
        "sampler": any(is_linear(render_pass.entry, slot) for slot in render_pass.inputs),
        "targets": list(render_pass.outputs),
        "scale": render_pass.scale,
        "size": list(target_size(render_pass.scale, size)),
        "viewport": list(target_area(render_pass.scale, render_pass.viewport)) if render_pass.viewport else None,
        "format": FORMATS.get(render_pass.spec.role, USUAL_FORMAT)[0],
        "changes": changed,
        "constants": constants(render_pass),
        "fetches": fetches.of_pass(render_pass),
        "free": [texture["name"] for texture in textures if texture["last_read"] == number],
    }


def programs(settings: methods.Settings) -> dict[str, dict]:
    """Return language -> the files to concatenate in order, the lines before them, and the entries' names."""
    first_lines = {
        "glsl": ["#version 330", "#define BOKEH_PASS {define}"],
        "hlsl": ["#define BOKEH_HLSL_SM 5"],
        "wgsl": [],
    }
    needs = {"exact": [], "layered": ["bokeh_layers"]}.get(settings.method, ["bokeh_paper"])
    if settings.lateral or settings.cats_eye or settings.roundness < 1.0 or settings.focus:
        needs = [*needs, "bokeh_lens"]
    programs_by_language = {}
    for language, lines in first_lines.items():
        # WGSL has no #ifdef, so its passes always need every file
        stems = list(paths.STEMS) if language == "wgsl" else ["bokeh", *needs, "bokeh_passes"]
        programs_by_language[language] = {
            "files": [f"{language}/{stem}.{language}" for stem in stems],
            "before": lines,
            "entry": "main" if language == "glsl" else "{entry}_PS",
            "vertex_entry": "main" if language == "glsl" else "BokehFullScreen_VS",
        }
    return programs_by_language


def constants(render_pass: Pass) -> dict[str, float]:
    """Return the constants that a program is compiled with, apart from the defaults of the library and of the preset.

    Constants with the value 0 have their default and are left out.
    """
    values = {
        name: value for name, value in render_pass.constants.items() if name not in methods.PRESET_CONSTANTS and value
    }
    counts = {name: values.pop(name, 0.0) for name in ("BOKEH_PAPER_SAMPLES", *methods.EXACT_CONSTANTS)}
    paper, samples, spacing = counts.values()
    if render_pass.spec.layers or render_pass.spec.role in (COPY, DEPTH, LATERAL, STEADY, VIEW):
        return values
    if paper:
        return values if paper == methods.PAPER_SAMPLES else {"BOKEH_PAPER_SAMPLES": paper, **values}
    if "BOKEH_SPACING" in render_pass.defines:
        # the preset's define sets both counts
        return values
    return {"BOKEH_NUM_SAMPLES": samples, "BOKEH_SPACING": spacing, **values}


def _parameters(passes: tuple[Pass, ...]) -> tuple[dict[str, float], list[dict[str, float]]]:
    """Return the parameters that are the same in all passes, and the parameters in which each pass differs.

    The passes that write the CoC map and depth in metres read only the camera's parameters, so their other parameters
    are not counted as differences.
    """
    filters = [render_pass for render_pass in passes if render_pass.entry not in (LINEAR_DEPTH.entry, *COPYING_ENTRIES)]
    differ = {name for name in PARAMETERS if len({render_pass.values()[name] for render_pass in filters}) > 1}
    same = dict(PARAMETERS)
    for render_pass in passes:
        same |= {name: value for name, value in render_pass.parameters.items() if name not in differ}
    # an entry that is drawn twice lists what differs each time, default values included
    listed = {(render_pass.entry, name) for render_pass in passes for name in render_pass.parameters}
    changes = [
        {n: v for n, v in render_pass.values().items() if n in differ and (render_pass.entry, n) in listed}
        for render_pass in passes
    ]
    return same, changes


def _textures(plan: methods.Plan, size: tuple[int, int]) -> list[dict]:
    """Return the textures that the passes read and write, by first use; `written` is None for those that the engine
    supplies.
    """
    textures: dict[str, dict] = {}
    for number, render_pass in enumerate(plan.passes):
        for name in render_pass.inputs.values():
            texture_size = plan.tables[name].shape[1::-1] if name in plan.tables else size
            unwritten = {
                "name": name,
                "written": None,
                "size": list(texture_size),
                "format": None,
                "bytes": None,
                "read": [],
            }
            textures.setdefault(name, unwritten)["read"].append(number)
        wide, high = target_size(render_pass.scale, size)
        target_format, texel_bytes = FORMATS.get(render_pass.spec.role, USUAL_FORMAT)
        for name in render_pass.outputs:
            layout = {"size": [wide, high], "format": target_format, "bytes": texel_bytes * wide * high}
            textures[name] = {"name": name, "written": number, **layout, "read": []}
    # a target reuses the memory of one of the same size and format that is no longer read
    last_in_memory: list[dict] = []
    for name, texture in textures.items():
        texture["last_read"] = None if name == plan.result else texture["read"][-1]
        texture["memory"] = None
        if texture["written"] is not None:
            free = (number for number, other in enumerate(last_in_memory) if _is_free(other, texture))
            texture["memory"] = number = next(free, len(last_in_memory))
            last_in_memory[number : number + 1] = [texture]
    return list(textures.values())


def _is_free(other: dict, texture: dict) -> bool:
    """Return whether a texture may reuse the memory of another; the memory of the result is never reused."""
    fits = (other["size"], other["format"]) == (texture["size"], texture["format"])
    return fits and other["last_read"] is not None and other["last_read"] < texture["written"]


@options.with_settings
def plan(
    settings: methods.Settings,
    size: Annotated[str, typer.Option(metavar="WxH", help="Size of the textures, pixels.")] = "1920x1080",
    viewport: Annotated[
        str | None, typer.Option(metavar="WxH+X+Y", help="Place of the image, if it fills only a part of its textures.")
    ] = None,
    sets: options.Sets = None,
) -> None:
    """Print every pass of a method in order, as JSON: entry, inputs, targets, sizes, formats, filters, parameters."""
    full_size = terminal.parsed_size(size, LEAST_SIDE, MOST_SIDE)
    planned = frame(settings, full_size, _viewport(viewport, full_size) if viewport else None)
    for name, value in options.parsed_sets(sets).items():
        if any(name in step["changes"] for step in planned["passes"]):
            raise UserError(f"--set {name}: differs from pass to pass. Give the option that it follows from.")
        planned["parameters"][name] = value
    typer.echo(text(planned), nl=False)


def _viewport(text: str, size: tuple[int, int]) -> tuple[int, int, int, int]:
    """Parse '1280x720+64+32' into (x, y, width, height), pixels. Raises UserError if it does not fit into `size`."""
    numbers = re.fullmatch(r"(\d{1,5})x(\d{1,5})\+(\d{1,5})\+(\d{1,5})", text)
    wide, high, x, y = map(int, numbers.groups()) if numbers else (0, 0, 0, 0)
    fits = min(wide, high) >= LEAST_SIDE and x + wide <= size[0] and y + high <= size[1]
    # the smallest targets have 1/8 of the size, so they need multiples of 8
    if not fits or x % 8 or y % 8:
        raise UserError(
            f"--viewport {text}: no part of {size[0]} x {size[1]}. Give width x height + x + y in pixels, x and y "
            f"multiples of 8, for example 1280x720+64+32."
        )
    return x, y, wide, high
