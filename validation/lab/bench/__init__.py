"""Time the methods against `paper`, and reproduce the paper's Table 1: the command `validation/run bench`.

Every frame is what `validation/run plan` prints, drawn and timed by script.py, which can also run alone on any machine
with a GPU (pack.py).
"""

import json
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from itertools import chain
from math import ceil, pi, tan
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from bokeh_validation import __version__, doctor, files, terminal
from bokeh_validation.drivers.base import software_device
from bokeh_validation.errors import UserError
from bokeh_validation.frame import methods
from bokeh_validation.truth import ray_traced
from lab.bench import languages, pack, script

# Samples on a line that correspond to Table 1's 16, 64, 144, 256, 400 and 576 samples, and the default count
SIDES = (4, 8, 12, methods.PAPER_SAMPLES, 16, 20, 24)
SCENE = ray_traced.MARKET  # much of it is out of focus, near and far
# Constant CoC for Table 1, fraction of the image height: the default BokehMaxCoC. The paper does not state its own.
COC = 0.1

# (frame, other frame) -> maximum of its time over the other's, for --judge. In the paper's Table 1, naive at 144
# samples takes 62 / 24 of the time of the paper's hexagon; it must take at least that.
BOUNDS = {
    ("layered low", "paper"): 1.3,
    ("layered medium", "paper"): 2.0,
    ("exact hexagon 576", "paper hexagon 576"): 0.5,
    ("paper hexagon 144", "naive 144"): 24 / 62,
}
# Minimum of rounds with --judge, so that a tenth of the draws is at least one
JUDGED_ROUNDS = 12
# Indices into script.COLUMNS
MEDIAN, LOW = 1, 2


def table_one(sides: Sequence[int] = SIDES) -> dict[str, methods.Settings]:
    """Return settings of naive, the paper's polygons and `exact` with the same sample spacing and a constant CoC.

    sides  samples on a line
    """
    every = {}

    def add(key: str, method: str, aperture: str, samples: int) -> None:
        every[key] = methods.Settings(method, aperture, samples, camera=methods.Camera(max_coc=1.0), coc=COC)

    for side in sides:
        add(f"naive {side**2}", "naive-grid", "hexagon", side)
        # the paper's line is as long as its polygon is wide: 2 edges of a hexagon, 2.414 of an octagon
        for aperture, edge in (("hexagon", 0.5), ("octagon", tan(pi / 8))):
            add(f"paper {aperture} {side**2}", "paper", aperture, side)
            add(f"exact {aperture} {side**2}", "exact", aperture, max(2, ceil(side * edge)))
    return every


def settings() -> dict[str, methods.Settings]:
    """Return settings of the paper's hexagon, and of `exact` and `layered`, with the CoC from depth, and of both in
    focus.
    """
    paper = methods.Settings("paper", "hexagon", camera=SCENE.camera)
    every, sharp = {"paper": paper}, replace(SCENE.camera, aperture_diameter=0.0)
    for method in ("exact", "layered"):
        own = replace(paper, method=method)
        every |= {f"{method} {preset}": replace(own, preset=preset) for preset in methods.PRESETS}
        every[f"{method} in focus"] = replace(own, camera=sharp)
    return every


def textures(size: tuple[int, int]) -> dict[str, np.ndarray]:
    """Return the scene scaled to (width, height) by nearest texel: 'color' and 'depth'."""
    scene = ray_traced.picture(SCENE)
    columns, rows = (np.arange(side) * whole // side for side, whole in zip(size, scene.size, strict=True))
    return {"color": scene.color[rows][:, columns], "depth": scene.depth[rows][:, columns]}


def timed(
    every: Mapping[str, methods.Settings], driver: str, adapter: str | None, size: tuple[int, int], rounds: int
) -> tuple[str, float, list[dict]]:
    """Time frames on a driver. Raises Unavailable.

    every    name -> settings
    size     (width, height)
    rounds   how often all frames are drawn
    Returns the device, the fraction of the elapsed time that its timer reports, and for each frame what --json writes.
    A pass is [entry, median, 10th percentile, 90th percentile], milliseconds.
    """
    with tempfile.TemporaryDirectory(prefix="bokeh-") as folder:
        pack.fill(Path(folder), every, [textures(size)], wheels=False)
        (plans,) = json.loads(Path(folder, "frames.json").read_bytes())["sizes"].values()
        device, frames = languages.DRIVERS[driver](adapter, Path(folder), plans)
        found = script.measured(frames, 0.0, rounds)
    rows = []
    for key, (whole, *passes) in found["frames"].items():
        targets = [texture for texture in plans[key]["textures"] if texture["written"] is not None]
        texels = {texture["name"]: texture["bytes"] / (size[0] * size[1]) for texture in targets}
        written = sum(texels[name] for item in plans[key]["passes"] for name in item["targets"])
        rows.append({"key": key, "fetches": plans[key]["fetches"], "bytes": written, "whole": whole, "passes": passes})
    return device, found["timer"], rows


def against(key: str) -> str | None:
    """Return the frame to compare with: in Table 1 the method before it in the table, otherwise the paper's hexagon."""
    method, _, samples = key.rpartition(" ")
    before = {"paper": f"naive {samples}", "exact": key.replace("exact", "paper")}
    return before.get(method.split()[0]) if samples.isdecimal() else None if key == "paper" else "paper"


def ratio(rows: Sequence[Mapping], key: str, other: str, column: int = MEDIAN) -> float:
    """Return a frame's time over another's. Frames are drawn in turn, so that a slow moment of the machine affects
    both.
    """
    times = {row["key"]: row["whole"][column] for row in rows}
    return times[key] / times[other]


def broken(rows: Sequence[Mapping]) -> list[str]:
    """Return a line for each of BOUNDS that is exceeded.

    The 10th percentile of the draws is used, because other work on the machine can only slow a draw down.
    """
    ratios = {pair: ratio(rows, *pair, LOW) for pair in BOUNDS}
    return [
        f"{key} takes {ratios[key, other]:.2f} of the time of {other}; the bound is {most:.2f}"
        for (key, other), most in BOUNDS.items()
        if ratios[key, other] > most
    ]


LEGEND = """fetches: colour + depth per pixel, at most; bytes: written per pixel; ±: half of what 8 draws in 10 span;
time over: its time as a multiple of the time of another"""


def table(rows: Sequence[Mapping]) -> Table:
    """Return a table of all frames for the terminal."""
    shown = Table("method", "passes", "fetches", "bytes", "ms", "time over", box=None)
    keys = {row["key"] for row in rows}
    for row in rows:
        cost = str(len(row["passes"])), "{color:.4g} + {depth:.4g}".format(**row["fetches"]), f"{row['bytes']:.4g}"
        _, median, low, high = row["whole"]
        other = against(row["key"])
        over = f"{ratio(rows, row['key'], other):.3g} {other}" if other in keys else ""
        shown.add_row(row["key"], *cost, f"{median:.3g} ±{(high - low) / 2:.2g}", over)
    return shown


# -------------------------------------------------------------------------------------------------------- the command

DEFAULT, SIZE = "wgpu", "960x540"
PACK_SIZES = ("1920x1080", "3840x2160")


def bench(
    driver: Annotated[
        str | None, typer.Option(help="wgpu (WGSL; the default), dxc (HLSL, as SPIR-V) or egl (GLSL on OpenGL).")
    ] = None,
    adapter: terminal.Adapter = None,
    size: Annotated[str | None, typer.Option(metavar="WxH", help="Default: 960x540; of a pack two others.")] = None,
    rounds: Annotated[int, typer.Option(help="Number of measured rounds.", min=3, max=1000)] = 5,
    judge: Annotated[
        bool, typer.Option("--judge", help="Only frames whose time has a bound; exit code 1 where one is above it.")
    ] = False,
    json_file: terminal.JsonFile = None,
    folder: Annotated[Path | None, typer.Option("--pack", metavar="DIR", help="A folder that times any GPU.")] = None,
    wheels: Annotated[
        bool, typer.Option("--wheels", help="With --pack: add the wheels that Linux x86-64 needs, 5 MB.")
    ] = False,
) -> None:
    """Time the methods against the paper's, and reproduce Table 1 of the paper."""
    sizes = [terminal.parsed_size(text, 16, 8192) for text in ([size] if size else PACK_SIZES if folder else [SIZE])]
    if folder:
        if driver or adapter or json_file or judge:
            raise UserError("--pack: nothing is timed. Leave out --driver, --adapter, --judge, --json.")
        pictures = list(map(textures, sizes))
        files.new_folder("--pack", folder, lambda made: pack.fill(made, settings(), pictures, wheels))
        return terminal.tell(f"{folder}: the first lines of bench.py there say how")
    if wheels:
        raise UserError("--wheels: no effect without --pack DIR. Give both.")
    (name,) = terminal.chosen("--driver", [driver or DEFAULT], languages.DRIVERS)
    terminal.check_writable(json_file)
    every, pixels = settings() | table_one(), sizes[0]
    if judge:
        rounds, every = max(rounds, JUDGED_ROUNDS), {key: every[key] for key in sorted(set(chain(*BOUNDS)))}
    device, timer, rows = timed(every, name, adapter, pixels, rounds)
    terminal.tell(device, f"{SCENE.name} at {pixels[0]} x {pixels[1]}, {rounds} rounds", LEGEND)
    # a pipe has no width
    Console(width=None if terminal.console.is_terminal else 120).print(table(rows))
    if not script.AGREES[0] <= timer <= script.AGREES[1]:
        terminal.tell(script.DISAGREES.format(timer))
    found = {"version": __version__, "date": datetime.now(UTC).isoformat(timespec="seconds"), "driver": name}
    found |= {"adapter": device, "software": bool(software_device(device)), "timer": timer}
    found |= {"size": pixels, "rounds": rounds, "columns": script.COLUMNS, "rows": rows}
    terminal.write_json(json_file, {**found, "environment": doctor.environment()})
    if judge:
        terminal.tell(*(problems := broken(rows)))
        terminal.end(not problems)
