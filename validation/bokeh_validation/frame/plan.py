"""A method's frame as data: what `validation/run plan` prints, and what docs/passes.md is made from.

It is made from the passes that the drivers run (methods.plan), and holds all that an engine needs to draw them.
"""

import math
from collections.abc import Iterable, Iterator
from typing import Annotated

import typer

from bokeh_validation import __version__, files, options, paths, shaders, terminal
from bokeh_validation.errors import UserError
from bokeh_validation.frame import fetches, methods
from bokeh_validation.shaders.entries import COLORS, COPYING_ENTRIES
from bokeh_validation.shaders.passes import BINDINGS, FIRST_SAMPLER, PARAMETERS, SLOTS, Pass, is_linear, target_size

LEAST_SIDE, MOST_SIDE = 2, 16384
FORMAT, TEXEL_BYTES = "RGBA16F", 8
PAGE = paths.ROOT / "docs/passes.md"
BEGIN, END = "<!-- made by validation/run plan --docs: begin -->\n", "<!-- end -->\n"
PAGE_SIZE = (1920, 1080)


def frame(settings: methods.Settings, size: tuple[int, int]) -> dict:
    """Everything, ready for JSON. Raises UserError for settings that mean nothing.

    Passes are numbered from 1. A pass's parameters are `parameters` with its own `changes`: one block for all passes
    will do. `constants` are fixed when its program is compiled. `last_read` is the last pass that reads a texture, null
    for the result; textures with the same number in `memory` may be one target. Bindings are those of WebGPU and
    Vulkan, `register` is Direct3D's. Fetches are those of a texel of its targets, at most; those of the frame are a
    pixel of the full size.
    """
    options.check(settings)
    plan = methods.plan(settings, size)
    same, changes = _parameters(plan.passes)
    textures = _textures(plan, size)
    steps = []
    for number, (item, changed) in enumerate(zip(plan.passes, changes, strict=True), start=1):
        step = {
            "pass": number,
            "entry": item.entry,
            "define": shaders.glsl_pass(item.entry),
            "inputs": [_input(item, slot) for slot in SLOTS if slot in item.inputs],
            "targets": list(item.outputs),
            "scale": item.scale,
            "size": list(target_size(item.scale, size)),
            "format": FORMAT,
            "changes": changed,
            "constants": item.constants,
            "fetches": fetches.of_pass(item),
            "free": [texture["name"] for texture in textures if texture["last_read"] == number],
        }
        steps.append(step)
    made = {texture["memory"]: texture["bytes"] for texture in textures if texture["written"]}
    return {
        "version": __version__,
        "method": settings.method,
        "aperture": settings.aperture,
        "preset": settings.preset if settings.method == "layered" else None,
        "several_targets": settings.targets,
        "size": list(size),
        "passes": steps,
        "parameters": same,
        "bindings": {"parameters": 0, "sampler": FIRST_SAMPLER},
        "textures": textures,
        "tables": {name: table[0, :, :2].tolist() for name, table in plan.tables.items()},
        "result": plan.result,
        "bytes": sum(texture["bytes"] for texture in textures if texture["written"]),
        "bytes_shared": sum(made.values()),
        "fetches": fetches.of_frame(plan.passes),
    }


def _input(item: Pass, slot: str) -> dict:
    """A texture of a pass. What is not filtered is fetched; shader model 3 needs a nearest filter for that."""
    return {
        "slot": slot,
        "register": SLOTS.index(slot),
        "binding": BINDINGS[slot],
        "texture": item.inputs[slot],
        "filter": "linear" if is_linear(item.entry, slot) else "nearest",
    }


def _parameters(passes: tuple[Pass, ...]) -> tuple[dict[str, float], list[dict[str, float]]]:
    """All parameters as most passes have them, and what each pass has differently.

    The passes that make the CoC map read the camera only, so what they do not give is no difference.
    """
    filters = [item for item in passes if item.entry not in COPYING_ENTRIES]
    differ = {name for name in PARAMETERS if len({item.values()[name] for item in filters}) > 1}
    same = dict(PARAMETERS)
    for item in passes:
        same |= {name: value for name, value in item.parameters.items() if name not in differ}
    # an entry that is drawn twice says each time what differs, the defaults too
    told = {(item.entry, name) for item in passes for name in item.parameters}
    changes = [{n: v for n, v in item.values().items() if n in differ and (item.entry, n) in told} for item in passes]
    return same, changes


def _textures(plan: methods.Plan, size: tuple[int, int]) -> list[dict]:
    """What the passes read and write, in the order of their first use; `written` is null where it is handed in."""
    read: dict[str, list[int]] = {}
    found: dict[str, dict] = {}
    for number, item in enumerate(plan.passes, start=1):
        for name in item.inputs.values():
            read.setdefault(name, []).append(number)
            if name not in found:
                table = plan.tables.get(name)
                whole = size if table is None else (table.shape[1], table.shape[0])
                found[name] = {"name": name, "written": None, "size": list(whole), "format": None, "bytes": None}
        wide, high = target_size(item.scale, size)
        for name in item.outputs:
            kind = {"size": [wide, high], "format": FORMAT, "bytes": TEXEL_BYTES * wide * high}
            found[name] = {"name": name, "written": number, **kind}
    for name, texture in found.items():
        texture["read"] = read.get(name, [])
        texture["last_read"] = None if name == plan.result else texture["read"][-1]
    _share(found.values())
    return list(found.values())


def _share(textures: Iterable[dict]) -> None:
    """Number the memory: a target takes that of one of its size that nobody reads any more."""
    taken: list[dict] = []
    for texture in textures:
        texture["memory"] = None
        if texture["written"]:
            free = (
                number
                for number, other in enumerate(taken)
                if other["size"] == texture["size"] and (other["last_read"] or math.inf) < texture["written"]
            )
            texture["memory"] = number = next(free, len(taken))
            taken[number : number + 1] = [texture]


# ---------------------------------------------------------------------------------------------------------------- text

WORDS = {"color": "colour", "depth": "depth", "table": "the table"}


def lines(found: dict) -> Iterator[str]:
    """A frame as text."""
    wide, high = found["size"]
    preset = f" {found['preset']}" if found["preset"] else ""
    targets = "several targets" if found["several_targets"] else "one target"
    yield f"{found['method']}{preset} {found['aperture']}, {wide} x {high}, {targets} a pass"
    given = {name: value for name, value in found["parameters"].items() if value != PARAMETERS[name]}
    yield f"in every pass: {_values(given)}; what is not named has its default"
    yield f"constants: {_values(constants(found))}"
    yield "linear: linear filter, clamp; nearest: fetched texel by texel, in shader model 3 by a nearest filter"
    for step in found["passes"]:
        yield ""
        yield f"{step['pass']:2}  {step['entry']}  ({step['define']})"
        for source in step["inputs"]:
            yield f"      {source['slot']} <- {source['texture']}  ({source['filter']})"
        share = "" if step["scale"] == 1 else f", 1/{step['scale']}"
        yield f"      writes {', '.join(step['targets'])}  ({_size(step['size'])} {step['format']}{share})"
        if step["changes"]:
            yield f"      sets {_values(step['changes'])}"
        yield f"      fetches a texel, at most: {_counts(step['fetches'])}"
        if step["free"]:
            yield f"      not read any more: {', '.join(step['free'])}"
    yield ""
    yield f"fetches a pixel of the full size, at most: {_counts(found['fetches'])}"
    yield f"targets: {_megabytes(found['bytes'])} MB, {_megabytes(found['bytes_shared'])} MB where they share memory"


def constants(found: dict) -> dict[str, int]:
    """What the programs of a frame are compiled with; the first pass has no filter, and takes any of these.

    The passes of the layers have no number of samples of their own.
    """
    last = found["passes"][-1]["constants"]
    return {n: v for n, v in last.items() if n != "BOKEH_NUM_SAMPLES" or found["method"] != "layered"}


def _values(values: dict) -> str:
    return ", ".join(f"{name} {value:g}" for name, value in values.items())


def _size(size: list[int]) -> str:
    return f"{size[0]} x {size[1]}"


def _counts(counts: dict) -> str:
    return ", ".join(f"{round(count, 1):g} of {WORDS[kind]}" for kind, count in counts.items() if count)


def _megabytes(count: int) -> str:
    return f"{count / 1e6:.0f}"


# ---------------------------------------------------------------------------------------------------------------- page

SHOWN = (("paper", "hexagon"), ("exact", "hexagon"), ("layered", "hexagon"))
OTHERS = (
    *(("paper", aperture) for aperture in ("square", "hexagon", "octagon")),
    *(("exact", aperture) for aperture in methods.EXACT),
    *(("layered", aperture) for aperture in methods.EXACT),
    ("naive", "hexagon"),
)


def page(text: str) -> str:
    """The text of docs/passes.md with what is between its markers made anew. Raises UserError without markers."""
    if text.count(BEGIN) != 1 or text.count(END) != 1 or text.index(BEGIN) > text.index(END):
        raise UserError(f"{PAGE.name}: its two markers are not there once each. Restore them.")
    before, rest = text.split(BEGIN)
    after = rest.split(END)[1]
    return before + BEGIN + "\n".join([*_page_lines(), ""]) + END + after


def _page_lines() -> Iterator[str]:
    for method, aperture in SHOWN:
        yield from _section(frame(methods.Settings(method, aperture), PAGE_SIZE))
    yield from ("## Other polygons, and one target a pass", "")
    shared = "every target's memory is used again as soon as it is free."
    yield from (f"At {_size(PAGE_SIZE)}, CoC map and result included; *shared*: {shared}", "")
    heads = ("method, shape", "passes", "targets at once, at most", "colour fetches a pixel, at most", "MB", "shared")
    yield _row(*heads, "one target a pass")
    yield "|---|---|---|---|---|---|---|"
    for method, aperture in OTHERS:
        several, one = (frame(methods.Settings(method, aperture, targets=each), PAGE_SIZE) for each in (True, False))
        most = max(len(step["targets"]) for step in several["passes"])
        yield _row(
            f"{method}, {aperture}",
            len(several["passes"]),
            most,
            f"{several['fetches']['color']:.0f}",
            _megabytes(several["bytes"]),
            _megabytes(several["bytes_shared"]),
            f"{len(one['passes'])} passes, {one['fetches']['color']:.0f} fetches" if most > 1 else "the same",
        )


def _section(found: dict) -> Iterator[str]:
    preset = f", preset {found['preset'].upper()}" if found["preset"] else ""
    yield from (f"## {found['method']}, {found['aperture']}{preset}", "")
    yield from (f"Constants: {_values({n: v for n, v in constants(found).items() if v})}.", "")
    yield "| | entry | reads | writes | size | sets | fetches |"
    yield "|---|---|---|---|---|---|---|"
    for step in found["passes"]:
        counts = step["fetches"]
        yield _row(
            step["pass"],
            step["entry"],
            ", ".join(_sources(step["inputs"])),
            ", ".join(step["targets"]),
            "full" if step["scale"] == 1 else f"1/{step['scale']}",
            _values(step["changes"]),
            f"{counts['color']}" + (f", depth {counts['depth']}" if counts["depth"] else ""),
        )
    yield ""


def _sources(inputs: list[dict]) -> Iterator[str]:
    """Textures; each with its slot where that is not the next colour slot, and its filter where it is not linear."""
    expected = iter(COLORS)
    for source in inputs:
        notes = []
        if source["slot"] not in COLORS or source["slot"] != next(expected):
            notes.append(source["slot"])
        if source["filter"] != "linear":
            notes.append(source["filter"])
        yield f"{source['texture']} ({', '.join(notes)})" if notes else source["texture"]


def _row(*cells: object) -> str:
    return f"| {' | '.join(str(cell) for cell in cells)} |"


@options.with_settings
def plan(
    settings: methods.Settings,
    size: Annotated[str, typer.Option(metavar="WxH", help="Of the picture, pixels.")] = "1920x1080",
    json_file: terminal.JsonFile = None,
    docs: Annotated[
        bool, typer.Option("--docs", help="Rewrite the tables of docs/passes.md, and nothing else.")
    ] = False,
) -> None:
    """Every pass of a method in order: entry, inputs, targets, sizes, formats, filters, parameters."""
    if docs:
        text = page(PAGE.read_text(encoding="utf-8"))
        files.whole(PAGE, lambda partial: partial.write_text(text, encoding="utf-8"))
        return
    found = frame(settings, terminal.parsed_size(size, LEAST_SIDE, MOST_SIDE))
    terminal.write_json(json_file, found)
    terminal.tell(*lines(found))
