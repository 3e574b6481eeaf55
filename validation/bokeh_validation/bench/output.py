"""A measurement as tables and as a picture."""

import numpy as np
from rich.table import Table

from bokeh_validation.bench.rows import LAYERS_SCENE

# Table 1 of the paper: frames a second on a GeForce 8600 GT, 800 x 800, the engine's own work included
PAPER = {
    "paper hexagon": {16: 105, 64: 80, 144: 62, 256: 52, 400: 46, 576: 40},
    "paper octagon": {16: 93, 64: 65, 144: 51, 256: 41, 400: 35, 576: 30},
    "naive": {16: 106, 64: 47, 144: 24},
}


def paper_ratio(name: str, effective: int | None) -> float | None:
    """How many times as long as this the naive method took in the paper, where it has both."""
    of, naive = PAPER.get(name, {}).get(effective), PAPER["naive"].get(effective)
    return None if of is None or naive is None else of / naive


def _spread(found: dict | None) -> str:
    """Median and half the distance between the tenth and the ninetieth percentile."""
    return "" if found is None else f"{found['median']:.2f} ±{(found['high'] - found['low']) / 2:.2f}"


HEADS = ("method", "passes", "fetches", "bytes", "ms", "fps", "naive/it", "paper", "it/paper's", "it/floor")
# Columns that say nothing about a GPU when they come from software
ABSOLUTE = ("ms", "fps")
LEGEND = (
    "fetches: colour + depth a pixel; bytes: written a pixel, RGBA16F; naive/it: time of naive with as many effective",
    "samples; paper: so in the paper's Table 1; it/paper's: to the paper's method; ±: half of what 8 in 10 rounds span",
)


def _cells(row: dict) -> list[str]:
    cost, seconds = row["cost"], row["seconds"]["median"]
    paper = paper_ratio(row["key"].rsplit(" ", 1)[0], row["effective"]) if row["naive_ratio"] else None
    return [
        row["key"],
        str(cost["passes"]),
        f"{cost['color']:.4g} + {cost['depth']:.4g}",
        f"{cost['written']:.4g}",
        f"{1e3 * seconds:.3g}",
        f"{1.0 / seconds:.3g}",
        _spread(row["naive_ratio"]),
        "" if paper is None else f"{paper:.2f}",
        _spread(row["ratios"].get("paper")),
        _spread(row["floor_ratio"]),
    ]


def tables(result: dict) -> list:
    """For the terminal, 120 columns: all rows, then how the times grow."""
    table = Table(box=None, pad_edge=False)
    for head in HEADS:
        marked = head + " (software)" if result["software"] and head in ABSOLUTE else head
        table.add_column(marked, justify="left" if head == "method" else "right", no_wrap=head not in ABSOLUTE)
    group = result["rows"][0]["group"]
    for row in result["rows"]:
        if row["group"] != group:
            table.add_row()
        group = row["group"]
        table.add_row(*_cells(row))
    curves = Table("time against", "method", "slope", "R2", box=None, pad_edge=False)
    for curve in result["growth"]:
        curves.add_row(curve["against"], curve["name"], f"{curve['fit']['slope']:.2f}", f"{curve['fit']['r2']:.3f}")
    size, layers = (f"{width} x {height}" for width, height in (result["size"], result["layers_size"]))
    sizes = f"{size}; the layers {LAYERS_SCENE.name} at {layers}"
    rounds = f"{result['rounds']} rounds, {result['clock_check']}"
    return [f"{result['driver']}: {result['adapter']}", f"{sizes}; {rounds}", *LEGEND, table, curves]


def plot(results: list[dict]) -> np.ndarray:
    """8-bit rgb: time against samples, CoC and pixels (relative), and how far each method is from its floor."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12.0, 3.6 * len(results)), dpi=90, layout="constrained")
    canvas = FigureCanvasAgg(figure)
    axes = figure.subplots(len(results), 4, squeeze=False)
    for line, result in zip(axes, results, strict=True):
        for axis, (against, label) in zip(line, AXES, strict=False):
            chosen = [curve for curve in result["growth"] if curve["against"] == against]
            if chosen:
                _curves(axis, chosen, label)
        _floors(line[3], result)
        line[0].set_title(f"{result['driver']}, {result['size'][0]} x {result['size'][1]}", loc="left", fontsize=9)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3]


AXES = (("samples", "effective samples"), ("CoC", "CoC, pixels"), ("pixels", "pixels"))
COLORS = {"naive": "#888888", "paper hexagon": "#1f77b4", "paper octagon": "#17a2b8", "exact hexagon": "#d62728"}
COLORS |= {"exact octagon": "#ff7f0e", "exact hexagon adaptive": "#2ca02c"}


def _curves(axis, chosen: list[dict], label: str) -> None:
    unit = min(min(curve["seconds"]) for curve in chosen)
    for curve in chosen:
        name = curve["name"].removesuffix(" 144")
        times, slope = [seconds / unit for seconds in curve["seconds"]], curve["fit"]["slope"]
        style = {"color": COLORS.get(name), "markersize": 3, "linewidth": 1.2}
        axis.loglog(curve["x"], times, "o-", label=f"{name}: slope {slope:.2f}", **style)
    longest = max(max(curve["seconds"]) for curve in chosen) / unit
    axis.set_ylim(0.8, longest * max(longest**0.5, 1.6))  # the legend's place is above the curves
    # plain numbers at the points: those of a logarithmic axis run into each other here
    places = chosen[0]["x"]
    axis.set_xticks(places, [f"{place**0.5:.0f}²" if label == "pixels" else f"{place:.3g}" for place in places])
    times = [time for time in (1, 2, 5, 10, 20, 50, 100, 200, 500) if time <= longest * 1.2]
    axis.set_yticks(times, [str(time) for time in times])
    axis.minorticks_off()
    axis.set_xlabel(label, fontsize=8)
    axis.set_ylabel("time, shortest = 1", fontsize=8)
    axis.grid(True, alpha=0.25)
    axis.tick_params(labelsize=7)
    axis.legend(fontsize=6.5, loc="upper left")


def _floors(axis, result: dict) -> None:
    # of Table 1 the middle is enough to see
    shown = [row for row in reversed(result["rows"]) if row["floor_ratio"]]
    shown = [row for row in shown if row["group"] != "table 1" or row["effective"] == 144]
    places, ratios = range(len(shown)), [row["floor_ratio"] for row in shown]
    errors = [[r["median"] - r["low"] for r in ratios], [r["high"] - r["median"] for r in ratios]]
    colors = [next((c for name, c in COLORS.items() if row["key"].startswith(name)), "#888888") for row in shown]
    medians = [ratio["median"] for ratio in ratios]
    axis.barh(places, medians, xerr=errors, color=colors, error_kw={"linewidth": 0.7}, height=0.7)
    axis.set_yticks(places, [row["key"] for row in shown], fontsize=7)
    axis.axvline(1.0, color="black", linewidth=0.7)
    axis.axvline(1.3, color="black", linewidth=0.7, linestyle=":")
    axis.set_xlabel("time / floor", fontsize=8)
    axis.tick_params(axis="x", labelsize=7)
