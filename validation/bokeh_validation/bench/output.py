"""A measurement as tables, as markdown and as a picture."""

import io
from collections.abc import Iterator

from PIL import Image
from rich.table import Table

from bokeh_validation.bench.measure import Spread
from bokeh_validation.bench.rows import LAYERS_SCENE
from bokeh_validation.bench.session import Measured, Result

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


def _spread(found: Spread | None) -> str:
    """Median and half the distance between the tenth and the ninetieth percentile."""
    return "" if found is None else f"{found.median:.2f} ±{(found.high - found.low) / 2:.2f}"


HEADS = ("method", "passes", "fetches", "bytes", "ms", "fps", "naive/it", "paper", "it/paper's", "it/floor")
# Columns that say nothing about a GPU when they come from software
ABSOLUTE = ("ms", "fps")
LEGEND = (
    "fetches: colour + depth a pixel; bytes: written a pixel, RGBA16F; naive/it: time of naive with as many effective",
    "samples; paper: so in the paper's Table 1; it/paper's: to the paper's method; ±: half of what 8 in 10 rounds span",
)


def _cells(found: Measured) -> list[str]:
    cost, seconds = found.cost, found.seconds
    name = found.row.key.rsplit(" ", 1)[0]
    paper = paper_ratio(name, found.row.effective) if "naive" in found.versus else None
    return [
        found.row.key,
        str(cost.passes),
        f"{cost.color:.4g} + {cost.depth:.4g}",
        f"{cost.written:.4g}",
        f"{1e3 * seconds.median:.3g}",
        f"{1.0 / seconds.median:.3g}",
        _spread(found.naive),
        "" if paper is None else f"{paper:.2f}",
        _spread(found.versus.get("paper")),
        _spread(found.floor),
    ]


def tables(result: Result) -> list:
    """For the terminal, 120 columns: all rows, then how the times grow."""
    table = Table(box=None, pad_edge=False)
    for head in HEADS:
        marked = head + " (software)" if result.software and head in ABSOLUTE else head
        table.add_column(marked, justify="left" if head == "method" else "right", no_wrap=head not in ABSOLUTE)
    group = None
    for found in result.rows:
        if found.row.group != group and group is not None:
            table.add_row()
        group = found.row.group
        table.add_row(*_cells(found))
    curves = Table("time against", "method", "slope", "R2", box=None, pad_edge=False)
    for curve in result.curves:
        curves.add_row(curve.against, curve.name, f"{curve.fit.slope:.2f}", f"{curve.fit.r2:.3f}")
    size, layers = (f"{width} x {height}" for width, height in (result.size, result.layers_size))
    sizes = f"{size}; the layers {LAYERS_SCENE.name} at {layers}"
    head = [f"{result.driver}: {result.adapter}", f"{sizes}; {result.rounds} rounds, {result.why}", *LEGEND]
    return [*head, table, curves]


def markdown(data: dict) -> list[str]:
    """The table of docs/performance.md from what --json wrote: three ratios for each driver, no absolute times."""
    names = [driver["driver"] for driver in data["drivers"]]
    kinds = ("naive/it", "it/paper's", "it/floor")
    heads = ["method", "passes", "fetches", "bytes", *(f"{name}: {kind}" for name in names for kind in kinds)]
    lines = [f"| {' | '.join(heads)} |", "|" + "---|" * len(heads)]
    for rows in _side_by_side(data, False):
        cost = rows[0]["cost"]
        cells = [
            rows[0]["key"],
            str(cost["passes"]),
            f"{cost['color']:.4g} + {cost['depth']:.4g}",
            f"{cost['written']:.4g}",
        ]
        for row in rows:
            cells += [_shown(row["naive_ratio"]), _shown(row["ratios"].get("paper")), _shown(row["floor_ratio"])]
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def layers_markdown(data: dict) -> list[str]:
    """The table of the layers there: the ratio to the paper's hexagon for each driver."""
    names = [driver["driver"] for driver in data["drivers"]]
    heads = ["", "passes", "fetches", "bytes", *(f"{name}: it/paper's" for name in names)]
    lines = [f"| {' | '.join(heads)} |", "|" + "---|" * len(heads)]
    for rows in _side_by_side(data, True):
        cost = rows[0]["cost"]
        cells = [
            rows[0]["key"],
            str(cost["passes"]),
            f"{cost['color']:.4g} + {cost['depth']:.4g}",
            f"{cost['written']:.4g}",
            *(_shown(row["ratios"].get("paper")) for row in rows),
        ]
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def _side_by_side(data: dict, layers: bool) -> Iterator[tuple[dict, ...]]:
    """The row of each driver: the layers, or all others."""
    for rows in zip(*(driver["rows"] for driver in data["drivers"]), strict=True):
        if (rows[0]["group"] == "layers") == layers:
            yield rows


def _shown(found: dict | None) -> str:
    return "" if found is None else _spread(Spread(found["median"], found["low"], found["high"]))


def plot(results: list[Result]) -> bytes:
    """PNG: time against samples, CoC and pixels (relative), and how far each method is from its floor."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12.0, 3.6 * len(results)), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(len(results), 4, squeeze=False)
    for line, result in zip(axes, results, strict=True):
        for axis, (against, label) in zip(line, AXES, strict=False):
            _curves(axis, result, against, label)
        _floors(line[3], result)
        line[0].set_title(f"{result.driver}, {result.size[0]} x {result.size[1]}", loc="left", fontsize=9)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=90)
    # few colours: a third of the bytes
    small = io.BytesIO()
    Image.open(buffer).convert("RGB").quantize(64, dither=Image.Dither.NONE).save(small, "PNG", optimize=True)
    return small.getvalue()


AXES = (("samples", "effective samples"), ("CoC", "CoC, pixels"), ("pixels", "pixels"))
COLORS = {"naive": "#888888", "paper hexagon": "#1f77b4", "paper octagon": "#17a2b8", "exact hexagon": "#d62728"}
COLORS |= {"exact octagon": "#ff7f0e", "exact hexagon adaptive": "#2ca02c"}


def _curves(axis, result: Result, against: str, label: str) -> None:
    from matplotlib.ticker import NullLocator

    chosen = [curve for curve in result.curves if curve.against == against]
    if not chosen:
        return
    unit = min(min(curve.seconds) for curve in chosen)
    for curve in chosen:
        name = curve.name.removesuffix(" 144")
        axis.plot(
            curve.x,
            [seconds / unit for seconds in curve.seconds],
            "o-",
            color=COLORS.get(name),
            markersize=3,
            linewidth=1.2,
            label=f"{name}: slope {curve.fit.slope:.2f}",
        )
    axis.set_xscale("log")
    axis.set_yscale("log")
    longest = max(max(curve.seconds) for curve in chosen) / unit
    axis.set_ylim(0.8, longest * max(longest**0.5, 1.6))  # the legend's place is above the curves
    # plain numbers at the points: those of a logarithmic axis run into each other here
    places = chosen[0].x
    shown = [f"{place**0.5:.0f}²" if against == "pixels" else f"{place:.3g}" for place in places]
    axis.xaxis.set_minor_locator(NullLocator())
    axis.set_xticks(places, shown)
    times = [time for time in (1, 2, 5, 10, 20, 50, 100, 200, 500) if time <= longest * 1.2]
    axis.yaxis.set_minor_locator(NullLocator())
    axis.set_yticks(times, [str(time) for time in times])
    axis.set_xlabel(label, fontsize=8)
    axis.set_ylabel("time, shortest = 1", fontsize=8)
    axis.grid(True, alpha=0.25)
    axis.tick_params(labelsize=7)
    axis.legend(fontsize=6.5, loc="upper left")


def _floors(axis, result: Result) -> None:
    # of Table 1 the middle is enough to see
    shown = [m for m in reversed(result.rows) if m.floor and (m.row.group != "table 1" or m.row.effective == 144)]
    places = range(len(shown))
    medians = [found.floor.median for found in shown]
    errors = [[m.floor.median - m.floor.low for m in shown], [m.floor.high - m.floor.median for m in shown]]
    colors = [next((c for name, c in COLORS.items() if m.row.key.startswith(name)), "#888888") for m in shown]
    axis.barh(places, medians, xerr=errors, color=colors, error_kw={"linewidth": 0.7}, height=0.7)
    axis.set_yticks(places, [found.row.key for found in shown], fontsize=7)
    axis.axvline(1.0, color="black", linewidth=0.7)
    axis.axvline(1.3, color="black", linewidth=0.7, linestyle=":")
    axis.set_xlabel("time / floor", fontsize=8)
    axis.tick_params(axis="x", labelsize=7)
