"""Times of the methods against naive, each other and floors (Table 1 of the paper): the work behind `bench`.

A floor is what the fetches alone cost: a method's passes with shaders that fetch as often, from the same textures at
the same places, and only add up.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from math import ceil, tan
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from bokeh_validation import __version__, doctor, files, shaders, terminal
from bokeh_validation.drivers.base import TimedDriver, Timing, software_device
from bokeh_validation.errors import UserError
from bokeh_validation.frame import methods
from bokeh_validation.plan import fetches
from bokeh_validation.reference.lines import lines
from bokeh_validation.shaders.entries import GRID, LINE
from bokeh_validation.shaders.passes import Pass
from bokeh_validation.truth import ray_traced
from lab.bench import pack
from lab.bench.script import SHORTEST

# --------------------------------------------------------------------------------------------------------- the floors

SLOTS = ("ColorSamp", "ColorSampB", "ColorSampC", "ColorSampD", "DepthSamp")


def floor(item: Pass) -> Pass:
    """The floor of a filter pass along lines with a fixed number of samples; another pass stays as it is."""
    along, count = lines(item), item.samples
    if not along or item.spec.role == GRID:
        return item
    # the paper's samples are from end to end of a line, the others in the middle of equal parts
    parts, offset = (count - 1, 0.0) if item.spec.role == LINE else (count, 0.5)
    to_uv = np.array([1.0 / item.values()["BokehAspectRatio"], 1.0])
    deep = "; depth += BokehFetchDepth(BokehDepthSamp, BokehToTexture({}))" if "DepthSamp" in item.inputs else ""
    body = "vec4 center = BokehFetch(BokehColorSamp, uv); vec4 sum = center; float depth = 0.0; float coc = center.a"
    body += deep.format("uv")
    if item.spec.role == LINE and "ColorSampB" in item.inputs:
        body += "; sum += BokehFetch(BokehColorSampB, uv)"  # the other parallelogram of a final pass
    for line in along:
        first, step = (line.segment.middle - line.segment.half) * to_uv, 2.0 * line.segment.half * to_uv / parts
        place = f"uv + coc * ({_vector(first)} + {_vector(step)} * (float(i) + {offset}))"
        body += f"; for (int i = 0; i < {count}; i++) {{ vec2 place = {place}"
        body += f"; sum += BokehFetch(Bokeh{line.slot}, place){deep.format('place')}; }}"
    # a mean of all; its alpha is what the next pass fetches by, so the sum's goes into the colour
    body += f"; vec3 mean = (sum.rgb + sum.a + depth) * {1.0 / (1 + count * len(along))!r}"
    targets = len(item.outputs)
    sources = {"glsl": _glsl(body, targets), "hlsl": _hlsl(body, targets), "wgsl": _wgsl(body, targets)}
    return replace(item, entry="BokehFloor", parameters={}, sources=sources)


def _vector(value: np.ndarray) -> str:
    return f"vec2({value[0]:.9e}, {value[1]:.9e})"


def _glsl(body: str, targets: int) -> str:
    # the library alone: its passes would bring a main() of their own
    head = f"{shaders.GLSL_VERSIONS['330']}\n" + shaders.file_text("glsl")
    head += "".join(f"uniform sampler2D Bokeh{slot};\n" for slot in SLOTS) + "in vec2 BokehUV;\n"
    head += "".join(f"layout(location = {i}) out vec4 floor{i};\n" for i in range(targets))
    stores = "".join(f"; floor{i} = vec4(mean, center.a)" for i in range(targets))
    return f"{head}void main() {{ vec2 uv = BokehUV; {body}{stores}; }}\n"


def _hlsl(body: str, targets: int) -> str:
    body = re.sub(r"(BokehFetch\((?:[^()]|\([^()]*\))*)\)", r"\1 BOKEH_LINEAR)", body)
    body = re.sub(r"\bvec([234])\b", r"float\1", body).replace("for (", "BOKEH_LOOP for (")
    outputs = ", ".join(f"out float4 floor{i} : BOKEH_TARGET({i})" for i in range(targets))
    stores = "".join(f"; floor{i} = float4(mean, center.a)" for i in range(targets))
    return f"{shaders.hlsl(6, {})}\nvoid BokehFloor_PS(BOKEH_INPUT, {outputs}) {{ {body}{stores}; }}\n"


def _wgsl(body: str, targets: int) -> str:
    body = re.sub(r"(BokehFetch\((?:[^()]|\([^()]*\))*)\)", r"\1, BokehLinearClamp)", body)
    body = re.sub(r"\b(vec[234]|float|int) (\w+) =", r"var \2: \1 =", body)
    for pattern, name in ((r"\b(vec[234])\b", r"\1f"), (r"\bfloat\b", "f32"), (r"\bint\b", "i32")):
        body = re.sub(pattern, name, body)
    head = "".join(f"@location({i}) floor{i}: vec4f, " for i in range(targets))
    results = ", ".join(["vec4f(mean, center.a)"] * targets)
    head = f"{shaders.wgsl()}\nstruct FloorTargets {{ {head}}}\n@fragment fn BokehFloor_PS(input: BokehVertex)"
    return f"{head} -> FloorTargets {{ let uv: vec2f = input.uv; {body}; return FloorTargets({results}); }}\n"


# ----------------------------------------------------------------------------------------------------------- the rows

# Samples on a line for the effective counts of Table 1, 16, 64, 144, 256, 400 and 576, and the default count
SIDES = (4, 8, 12, methods.PAPER_SAMPLES, 16, 20, 24)
SCENE = ray_traced.MARKET  # much of it is out of focus, near and far
# Constant CoC of Table 1, fraction of the image height: BOKEH_MAX_COC as it comes. The paper does not say which it had.
COC = 0.1
FARTHEST = 1e4  # metres: the floors add up depth, and infinity has no mean
TARGET_BYTES = 8  # RGBA16F


@dataclass(frozen=True)
class Row:
    """A method with its settings.

    naive    key of the naive row with as many effective samples
    against  key of the paper's row that it replaces
    floor    passes that only fetch; none for naive, and where a pass fetches as often as the CoC needs
    """

    key: str
    passes: tuple[Pass, ...]
    naive: str | None = None
    against: str | None = None
    floor: tuple[Pass, ...] = ()


def table_one(size: tuple[int, int], sides: Sequence[int] = SIDES) -> list[Row]:
    """Naive, the paper's polygons and `exact` at the same sample spacing, with a constant CoC."""
    rows = []

    def add(key: str, method: str, aperture: str, samples: int, **others) -> None:
        settings = methods.Settings(method, aperture, samples, camera=methods.Camera(max_coc=1.0), coc=COC)
        passes = methods.plan(settings, size).passes
        floors = () if method == "naive-grid" else tuple(map(floor, passes))
        rows.append(Row(key, passes, floor=floors, **others))

    for side in sides:
        naive = f"naive {side**2}"
        add(naive, "naive-grid", "hexagon", side)
        # the paper's line is as long as its polygon is wide: 2 edges of a hexagon, 2.414 of an octagon
        for aperture, edge in (("hexagon", 0.5), ("octagon", tan(np.pi / 8))):
            paper = f"paper {aperture} {side**2}"
            add(paper, "paper", aperture, side, naive=naive)
            samples = max(2, ceil(side * edge))
            add(f"exact {aperture} {side**2}", "exact", aperture, samples, naive=naive, against=paper)
    return rows


def settings() -> dict[str, methods.Settings]:
    """The paper's hexagon, and those of `exact` and `layered`, with the CoC from depth; and both in focus."""
    paper = methods.Settings("paper", "hexagon", camera=SCENE.camera)
    every, sharp = {"paper": paper}, replace(SCENE.camera, aperture_diameter=0.0)
    for method in ("exact", "layered"):
        own = replace(paper, method=method)
        every |= {f"{method} {preset}": replace(own, preset=preset) for preset in methods.PRESETS}
        every[f"{method} in focus"] = replace(own, camera=sharp)
    return every


def in_depth(size: tuple[int, int]) -> list[Row]:
    """All of `settings`, against the paper's hexagon."""
    return [Row(key, methods.plan(one, size).passes, against="paper") for key, one in settings().items()]


def textures(size: tuple[int, int]) -> dict[str, np.ndarray]:
    """The scene at (width, height), nearest texel: 'color' and 'depth'."""
    scene = ray_traced.picture(SCENE)
    columns, rows = (np.arange(side) * whole // side for side, whole in zip(size, scene.size, strict=True))
    depth = np.minimum(scene.depth[rows][:, columns], np.float32(FARTHEST))
    return {"color": scene.color[rows][:, columns], "depth": depth}


# ---------------------------------------------------------------------------------------------------------- the times

MOST_REPEATS = 10000


def measured(driver: TimedDriver, rows: Sequence[Row], size: tuple[int, int], rounds: int) -> tuple[str, list[dict]]:
    """Name of the clock, 'wall' or 'cpu'; and of each row what --json writes, in the order of the rows.

    Every round times every frame and floor once, in another order; ratios are of the same round.
    """
    images, calls = textures(size), {}
    # the picture is uploaded once
    shared = driver.prepared((), images, size)
    for row in rows:
        for kind, passes in {"frame": row.passes, "floor": row.floor}.items():
            if passes:
                calls[row.key, kind] = driver.prepared(passes, images, size, share=shared).timed
    clock, seconds = interleaved(calls, rounds, bool(software_device(driver.adapter)))
    return clock, [_as_json(row, seconds) for row in rows]


def interleaved(
    calls: Mapping[object, Callable[[int], Timing]], rounds: int, software: bool
) -> tuple[str, dict[object, np.ndarray]]:
    """The clock used, and key -> seconds (rounds,): CPU time in software, else the time on the clock."""
    random, repeats = np.random.default_rng(1), {}
    for key, call in calls.items():
        call(1)  # compiles what the runtime compiles on first use
        repeats[key] = min(MOST_REPEATS, ceil(SHORTEST / max(call(1).wall, 1e-9)))
    timings = {key: [] for key in calls}
    for _ in range(rounds):
        for index in random.permutation(len(calls)):
            key = list(calls)[index]
            timings[key].append(calls[key](repeats[key]))
    clock = "cpu" if software else "wall"
    return clock, {key: np.array([getattr(timing, clock) for timing in several]) for key, several in timings.items()}


def spread(values: np.ndarray) -> dict:
    """Median of all rounds and what a tenth of them is below and above; and all of them."""
    low, median, high = np.percentile(values, (10, 50, 90))
    return {"median": float(median), "low": float(low), "high": float(high), "rounds": values.tolist()}


def _as_json(row: Row, seconds: Mapping[object, np.ndarray]) -> dict:
    frame, counts = seconds[row.key, "frame"], fetches.of_frame(row.passes)
    others = {"against": (row.against, "frame"), "floor": (row.key, "floor")}
    ratios = {name: spread(frame / seconds[key]) for name, key in others.items() if key in seconds}
    ratios |= {"naive": spread(seconds[row.naive, "frame"] / frame)} if row.naive else {}
    return {
        "key": row.key,
        "fetches": {kind: counts[kind] for kind in ("color", "depth")},
        "bytes": sum(TARGET_BYTES * len(item.outputs) / item.scale**2 for item in row.passes),
        "seconds": spread(frame),
        "ratios": ratios,
        "passes": len(row.passes),
    }


# -------------------------------------------------------------------------------------------------------- the command

# Drivers that draw without upload and read-back
DRIVERS = ("osmesa", "egl", "wgpu", "dxc")
SIZE, SOFTWARE_SIZE, PACK_SIZES = (960, 540), (400, 225), ((1920, 1080), (3840, 2160))
LEGEND = """fetches: colour + depth per pixel, at most; bytes: written per pixel; ±: half of what 8 rounds in 10 span
naive/it: naive's time to its own, with as many samples; it/paper's: its time to that of the paper's method"""


def table(rows: list[dict]) -> Table:
    """All frames, for the terminal."""
    shown = Table("method", "passes", "fetches", "bytes", "ms", "naive/it", "it/paper's", "it/floor", box=None)
    for row in rows:
        cost = str(row["passes"]), "{color:.4g} + {depth:.4g}".format(**row["fetches"]), f"{row['bytes']:.4g}"
        ratios = (_cell(row["ratios"].get(name)) for name in ("naive", "against", "floor"))
        shown.add_row(row["key"], *cost, _cell(row["seconds"], 1e3), *ratios)
    return shown


def _cell(values: dict | None, unit: float = 1.0) -> str:
    """Median and half the distance between the tenth and the ninetieth percentile."""
    return f"{unit * values['median']:.3g} ±{unit * (values['high'] - values['low']) / 2:.2g}" if values else ""


def bench(
    driver: Annotated[
        list[str] | None, typer.Option(help=f"One of {', '.join(DRIVERS)}; may be given again. Default: osmesa, wgpu.")
    ] = None,
    adapter: terminal.Adapter = None,
    size: Annotated[str | None, typer.Option(metavar="WxH", help="Default: 960x540; in software 400x225.")] = None,
    rounds: Annotated[int, typer.Option(help="Rounds that count.", min=3, max=1000)] = 5,
    json_file: terminal.JsonFile = None,
    folder: Annotated[Path | None, typer.Option("--pack", metavar="DIR", help="A folder that times any GPU.")] = None,
    wheels: Annotated[bool, typer.Option("--wheels", help="With --pack: and what Linux x86-64 needs, 5 MB.")] = False,
) -> None:
    """Table 1: time of the methods against naive, against each other and against a floor of the same fetches."""
    given = terminal.parsed_size(size, 16, 8192) if size else None
    if folder:
        if driver or adapter or json_file:
            raise UserError("--pack: nothing is timed. Leave out --driver, --adapter, --json.")
        pictures = [textures(pixels) for pixels in ([given] if given else PACK_SIZES)]
        files.new_folder("--pack", folder, lambda made: pack.fill(made, settings(), pictures, wheels))
        return terminal.tell(f"{folder}: the first lines of bench.py there say how")
    if wheels:
        raise UserError("--wheels: no effect without --pack DIR. Give both.")
    names = terminal.chosen("--driver", driver, DRIVERS, ("osmesa", "wgpu"))
    terminal.check_writable(json_file)
    present, missing = terminal.pick_drivers(names, adapter)
    results = []
    for timed in present:
        software = bool(software_device(timed.adapter))
        pixels = given or (SOFTWARE_SIZE if software else SIZE)
        clock, rows = measured(timed, [*table_one(pixels), *in_depth(pixels)], pixels, rounds)
        device = {"driver": timed.name, "adapter": timed.adapter, "software": software, "clock": clock}
        results.append({**device, "size": pixels, "rounds": rounds, "rows": rows})
        where = f"{SCENE.name} at {pixels[0]} x {pixels[1]}, {rounds} rounds, clock: {clock}"
        terminal.tell(f"{timed.name}: {timed.adapter}", where, LEGEND)
        # a pipe has no width of its own
        Console(width=None if terminal.console.is_terminal else 120).print(table(rows))
    for name, reason in missing.items():
        terminal.console.print(f"{terminal.NOT_RUN} {name}: {reason}")
    found = {"version": __version__, "date": datetime.now(UTC).isoformat(timespec="seconds"), "missing": missing}
    terminal.write_json(json_file, {**found, "environment": doctor.environment(), "drivers": results})
