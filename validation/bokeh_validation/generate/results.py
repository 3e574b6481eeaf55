"""Write the pages' tables of measured numbers from docs/data, and docs/data/results.csv with the same numbers as a
list.

Each table of a page lies between a pair of markers with the table's name. To change a number, change docs/data, then
run `validation/run generate`.
"""

import csv
import io
import json
from collections.abc import Iterator
from functools import cache
from statistics import mean

from bokeh_validation import paths
from bokeh_validation.probes import lights_apart, rims, thin

Table = list[list[str]]
CSV = "docs/data/results.csv"
SCENES = ("market_7", "street_11", "canopy_12", "street_11x3", "canopy_12x3")
# Key in truth.json and peers.json -> name of the measure, and its format
MEASURES = {"flip": ("FLIP", "{:.4f}"), "psnr": ("PSNR", "{:.2f}"), "light": ("light kept", "{:.3f}")}


@cache
def data(name: str) -> dict:
    """Return the content of a JSON file of docs/data."""
    return json.loads((paths.ROOT / f"docs/data/{name}.json").read_text(encoding="utf-8"))


def ray_traced() -> dict[str, dict[str, dict]]:
    """Return method or effect -> scene -> its row in truth.json or peers.json, this package's methods first."""
    rows: dict[str, dict[str, dict]] = {}
    for name in ("truth", "peers"):
        for row in data(name)["rows"]:
            rows.setdefault(row["label"], {})[row["scene"]] = row
    return rows


def flip_means() -> dict[str, float]:
    """Return method or effect -> mean FLIP over the five scenes."""
    return {label: mean(rows[scene]["flip"] for scene in SCENES) for label, rows in ray_traced().items()}


def peer_times() -> Table:
    """Return the times of other effects and of this package's methods in ascending order."""
    header = ["method", "ms", "ratio to BokehPass", "lower quartile", "upper quartile"]
    rows = sorted(data("peer_times")["rows"], key=lambda row: row["ratio"])
    return [header] + [
        [row["label"], f"{row['ms']:.0f}", *(f"{value:.2f}" for value in (row["ratio"], *row["quartiles"]))]
        for row in rows
    ]


def gpu_times() -> tuple[Table, Table]:
    """Return the milliseconds on a GPU from gpu_times.json, which a bench folder's script wrote: of whole frames at
    each size, and of the passes of `layered` at the largest size.
    """
    sizes = data("gpu_times")["sizes"]
    keys = list(next(iter(sizes.values()))["frames"])
    whole = [["method", "preset", *(size.replace("x", " x ") for size in sizes)]]
    for key in keys:
        method, _, preset = key.partition(" ")
        shown = [f"`{method}`, all in focus", "MEDIUM"] if preset == "in focus" else [f"`{method}`", preset.upper()]
        whole.append([*shown, *(f"{size['frames'][key][0][1]:.2f}" for size in sizes.values())])
    frames = list(sizes.values())[-1]["frames"]
    layered = [key for key in keys if key.startswith("layered ")]
    passes = [["pass", *(key.removeprefix("layered ") for key in layered)]]
    for rows in zip(*(frames[key] for key in layered), strict=True):
        passes.append([rows[0][0].removeprefix("Bokeh"), *(f"{row[1]:.2f}" for row in rows)])
    return whole, passes


def lights_apart_tables() -> dict[str, Table]:
    """Return the tables of lights_apart.json. Where only CoC and size differ, each size has columns of its own."""
    recorded, found = lights_apart.recorded(), {}
    for name, group in lights_apart.GROUPS.items():
        sizes = sorted({apart.pixels for apart in group.lights})
        by_size = len({(apart.textured, apart.rim, apart.background) for apart in group.lights}) == 1 < len(sizes)
        by_size &= not group.lights[0].rim
        for index, measure in enumerate(lights_apart.MEASURES):
            rows: dict[str, list[str]] = {}
            header = ["light", *lights_apart.METHODS]
            if by_size:
                header = ["CoC of the light", *(f"{m}, {size} px" for m in lights_apart.METHODS for size in sizes)]
            for method in lights_apart.METHODS:
                for apart in group.lights:
                    value = recorded[group.aperture, apart.label, method][index]
                    rows.setdefault(f"{apart.coc:g}" if by_size else apart.label, []).append(f"{value:.2f}")
            found[f"lights apart, {name}, {measure}"] = [header, *([label, *row] for label, row in rows.items())]
    return found


def probed() -> dict[str, Table]:
    """Return name of a table -> its rows with the header first, for the numbers that probes check."""
    found = lights_apart_tables()
    rows = [[rim.label, *(f"{value:.2f}" for value in values)] for rim, values in rims.RECORDED.items()]
    found["near lights with a rim"] = [["light", "ripple", "second outline", "light kept"], *rows]
    for name, unit, columns, recorded in (
        ("thin lines", "CoC of the line, pixels", ("copies", "light kept"), thin.LINES),
        ("slits", "near CoC, pixels", ("light", "brightest"), thin.SLITS),
    ):
        header = [unit, *(f"{preset.upper()}: {column}" for preset in thin.PRESETS for column in columns)]
        values = {coc: [value for preset in thin.PRESETS for value in recorded[coc, preset]] for coc, _ in recorded}
        texts = [
            [str(coc), *(f"{v:.2f}" if isinstance(v, float) else str(v) for v in row)] for coc, row in values.items()
        ]
        found[name] = [header, *texts]
    return found


def tables() -> dict[str, dict[str, Table]]:
    """Return page -> name of a table -> its rows with the header first, for all tables of measured numbers."""
    measured = {}
    for key, (name, rounded) in MEASURES.items():
        rows = [[label, *(rounded.format(row[scene][key]) for scene in SCENES)] for label, row in ray_traced().items()]
        measured[f"ray-traced scenes, {name}"] = [["method", *SCENES], *rows]
    one_light = [[label, *text.split("/")] for label, text in data("peers")["one light"].items()]
    measured["one light"] = [["method", "overlap", "light kept"], *one_light]
    measured |= probed()
    pages = {page: dict(page_tables) for page, page_tables in data("printed")["tables"].items()}
    pages["results-data.md"] = measured | pages["results-data.md"]
    flips = [[*row, f"{flip_means()[row[0]]:.4f}"] for row in measured["ray-traced scenes, FLIP"][1:]]
    flips.sort(key=lambda row: float(row[-1]))
    pages["cost.md"]["times of other effects"] = peer_times()
    pages["cost.md"]["times on a GPU"], pages["cost.md"]["passes on a GPU"] = gpu_times()
    comparison = [["method", *SCENES, "mean"], *flips]
    ratios = [[label, ratio] for label, _, ratio, *_ in peer_times()]
    return {"results.md": {"comparison": comparison, "times of other effects": ratios}, **pages}


def markdown(rows: Table) -> Iterator[str]:
    """Yield the lines of a Markdown table."""
    header, *body = rows
    yield f"| {' | '.join(header)} |"
    yield f"|{'---|' * len(header)}"
    for cells in body:
        yield f"| {' | '.join(cells)} |"


def as_csv() -> str:
    """Return docs/data/results.csv: page, table, row, column, value; a row with two labels has them separated by a
    comma.
    """
    target = io.StringIO()
    writer = csv.writer(target, lineterminator="\n")
    writer.writerow(("page", "table", "row", "column", "value"))
    pages = tables()
    # results.md repeats results-data.md and cost.md
    del pages["results.md"]
    for page, page_tables in pages.items():
        for table, (header, *rows) in page_tables.items():
            labels = 2 if header[1] == "preset" else 1
            for row in rows:
                label = ", ".join(filter(None, row[:labels]))
                cells = zip(header[labels:], row[labels:], strict=True)
                writer.writerows((page, table, label.replace("`", ""), column, cell) for column, cell in cells)
    return target.getvalue()
