"""A whole measurement on one driver, as the data that --json writes: seconds, fractions and pixels.

A row's spreads (median, low, high) are over the rounds; each ratio is computed within its round:

    seconds, floor_seconds   of a draw
    floor_ratio              row / its floor; None where there is none
    naive_ratio              naive with as many effective samples / row; None where there is none
    ratios                   row / the rows that it names in `versus`
    rounds, floor_rounds     the raw times by clock
"""

from collections.abc import Callable, Iterable
from dataclasses import asdict
from datetime import UTC, datetime
from importlib import metadata

import numpy as np

from bokeh_validation import __version__, doctor, suite
from bokeh_validation.bench import reads, rows
from bokeh_validation.bench.measure import CLOCKS, Times, interleaved
from bokeh_validation.bench.request import Plan, is_software
from bokeh_validation.drivers.base import TimedDriver

Step = Callable[[str], None]


def measure_rows(
    driver: TimedDriver,
    chosen: Iterable[rows.Row],
    size: tuple[int, int],
    rounds: int,
    step: Step = lambda _: None,
    clock: str | None = None,
    scene: suite.SceneFile = rows.SCENE,
) -> tuple[list[dict], Times]:
    """Time rows and their floors, all interleaved."""
    images = rows.textures(size, scene)
    # one picture and one set of targets for all: 80 jobs of their own would not fit a small device
    shared = driver.prepared((), images, size)
    chosen = list(chosen)
    passes = {row.key: row.passes for row in chosen} | {f"{row.key} floor": row.floor for row in chosen if row.floor}
    jobs = {key: driver.prepared(items, images, size, share=shared) for key, items in passes.items()}
    times = interleaved(jobs, rounds, is_software(driver), step, clock)
    for job in [*jobs.values(), shared]:
        job.release()
    return [_row(row, times, images["depth"]) for row in chosen], times


def _row(row: rows.Row, times: Times, depth: np.ndarray) -> dict:
    floor, naive, settings = f"{row.key} floor" if row.floor else None, row.versus.get("naive"), row.settings
    return {
        "key": row.key,
        "group": row.group,
        "method": settings.method,
        "aperture": settings.aperture,
        "effective": row.effective,
        "samples": settings.count,
        "spacing": settings.spacing,
        "coc": settings.coc,
        "cost": asdict(_cost(row, depth)),
        "seconds": times.spread(row.key),
        "floor_seconds": floor and times.spread(floor),
        "floor_ratio": floor and times.ratio(row.key, floor),
        "naive_ratio": naive and times.ratio(naive, row.key),
        "ratios": {name: {"to": other, **times.ratio(row.key, other)} for name, other in row.versus.items()},
        "rounds": {name: _raw(times.clocks[name][row.key]) for name in CLOCKS},
        "floor_rounds": {name: _raw(times.clocks[name][floor]) for name in CLOCKS} if floor else {},
    }


def _raw(seconds: np.ndarray) -> list:
    """As JSON has it: None where there is no number."""
    return [None if np.isnan(value) else float(value) for value in seconds]


def _cost(row: rows.Row, depth: np.ndarray) -> reads.Cost:
    if row.group == "in focus":
        written = reads.TARGET_BYTES * sum(len(item.outputs) for item in row.passes)
        return reads.Cost(len(row.passes), float(len(row.passes)), 0.0, written)
    return reads.cost(row.passes, depth)


def fit(x: np.ndarray, seconds: np.ndarray) -> dict[str, float]:
    """seconds = constant * x ^ slope, by least squares of the logarithms; r2 = share of the variance it explains.

    Two or more points, all positive.
    """
    lx, ly = np.log(np.asarray(x, float)), np.log(np.asarray(seconds, float))
    slope, constant = np.polyfit(lx, ly, 1)
    rest, all_ = ((ly - slope * lx - constant) ** 2).sum(), ((ly - ly.mean()) ** 2).sum()
    return {"slope": float(slope), "r2": float(1.0 - rest / all_) if all_ > 0.0 else 1.0}


def _curve(name: str, against: str, x: list[float], seconds: list[float]) -> dict:
    """Times along a series; `x` in samples, pixels of CoC or pixels."""
    return {"name": name, "against": against, "x": x, "seconds": seconds, "fit": fit(x, seconds)}


def measure_curves(
    driver: TimedDriver, series: list[rows.Series], rounds: int, step: Step = lambda _: None, clock: str | None = None
) -> list[dict]:
    """Time series, all points of all of them interleaved."""
    jobs = {
        f"{curve.name} {x:.6g}": driver.prepared(passes, rows.textures(size), size)
        for curve in series
        for x, size, passes in curve.points
    }
    times = interleaved(jobs, rounds, is_software(driver), step, clock)
    for job in jobs.values():
        job.release()
    found = []
    for curve in series:
        x = [point[0] for point in curve.points]
        seconds = [times.spread(f"{curve.name} {value:.6g}")["median"] for value in x]
        found.append(_curve(curve.name, curve.against, x, seconds))
    return found


def sample_curves(measured: list[dict]) -> list[dict]:
    """Time against effective samples, out of Table 1's rows."""
    found = []
    for name in ("naive", "paper hexagon", "paper octagon", "exact hexagon", "exact octagon"):
        points = [row for row in measured if row["group"] == "table 1" and row["key"].rsplit(" ", 1)[0] == name]
        x, seconds = [float(row["effective"]) for row in points], [row["seconds"]["median"] for row in points]
        if len(points) > 1:
            found.append(_curve(name, "samples", x, seconds))
    return found


def measure(driver: TimedDriver, plan: Plan, step: Step = lambda _: None) -> dict:
    """The whole measurement on one driver."""
    size, layers_size, few = plan.size_on(driver), plan.layers_size, plan.growth_rounds
    chosen = [*rows.table_one(size, plan.sides), *rows.defaults(size), *rows.adaptive(size), *rows.in_focus(size)]
    found, times = measure_rows(driver, chosen, size, plan.rounds, step, plan.clock)
    layers = rows.layers(layers_size)
    found += measure_rows(driver, layers, layers_size, plan.rounds, step, plan.clock, rows.LAYERS_SCENE)[0]
    curves = sample_curves(found)
    for series in (rows.with_coc(size), rows.with_size(size)):
        curves += measure_curves(driver, series, few, step, plan.clock)
    return {
        "driver": driver.name,
        "adapter": driver.adapter,
        "software": is_software(driver),
        "size": list(size),
        "layers_size": list(layers_size),
        "rounds": plan.rounds,
        "clock": times.clock,
        "clock_check": times.why,
        "rows": found,
        "growth": curves,
    }


def as_json(results: list[dict], missing: dict[str, str]) -> dict:
    """Everything, raw rounds included."""
    versions = {name: metadata.version(name) for name in ("moderngl", "wgpu", "numpy")}
    return {
        "version": __version__,
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "environment": {**doctor.environment(), **versions},
        "coc": rows.COC,
        "scene": rows.SCENE.name,
        "layers_scene": rows.LAYERS_SCENE.name,
        "missing": missing,
        "drivers": results,
    }
