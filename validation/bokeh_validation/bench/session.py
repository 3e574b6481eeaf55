"""A whole measurement on one driver, as the data that --json writes: seconds, fractions and pixels.

A row's spreads (median, low, high) are over the rounds; each ratio is computed within its round:

    seconds, floor_seconds   of a draw
    floor_ratio              row / its floor; None where there is none
    naive_ratio              naive with as many effective samples / row; None where there is none
    ratios                   row / the rows that it names in `versus`
    rounds, floor_rounds     the raw times by clock
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib import metadata

import numpy as np

from bokeh_validation import __version__, doctor
from bokeh_validation.bench import rows
from bokeh_validation.bench.measure import Times, interleaved
from bokeh_validation.drivers.base import TimedDriver, software_device
from bokeh_validation.truth import ray_traced

Step = Callable[[str], None]
SIZE, SOFTWARE_SIZE = (800, 800), (400, 400)


@dataclass(frozen=True)
class Plan:
    """What to measure.

    size         (width, height); None: 800 x 800 on a GPU, as the paper has it, and smaller in software
    layers_size  the same for the layers
    rounds       that count
    sides        samples on a line
    clock        'wall', 'cpu' or 'query'; None: see measure.chosen_clock
    """

    size: tuple[int, int] | None
    layers_size: tuple[int, int]
    rounds: int
    sides: tuple[int, ...]
    clock: str | None

    def size_on(self, driver: TimedDriver) -> tuple[int, int]:
        """(width, height) for a driver."""
        return self.size or (SOFTWARE_SIZE if software_device(driver.adapter) else SIZE)

    @property
    def growth_rounds(self) -> int:
        """Rounds of the two kinds of growth."""
        return min(self.rounds, 5)

    @property
    def steps(self) -> int:
        """Of the progress bar for each driver: rows, layers and two kinds of growth, each with a warm-up."""
        return 2 * (self.rounds + 1) + 2 * (self.growth_rounds + 1)


def measure_rows(
    driver: TimedDriver,
    chosen: Iterable[rows.Row],
    size: tuple[int, int],
    rounds: int,
    step: Step = lambda _: None,
    clock: str | None = None,
    scene: ray_traced.SceneFile = rows.SCENE,
) -> tuple[list[dict], Times]:
    """Time rows and their floors, all interleaved."""
    images = rows.textures(size, scene)
    # one picture and one set of targets for all: 80 jobs of their own would not fit a small device
    shared = driver.prepared((), images, size)
    chosen = list(chosen)
    passes = {row.key: row.passes for row in chosen} | {f"{row.key} floor": row.floor for row in chosen if row.floor}
    jobs = {key: driver.prepared(items, images, size, share=shared) for key, items in passes.items()}
    times = interleaved(jobs, rounds, bool(software_device(driver.adapter)), step, clock)
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
        "cost": rows.cost(row.passes, depth)._asdict(),
        "seconds": times.spread(row.key),
        "floor_seconds": floor and times.spread(floor),
        "floor_ratio": floor and times.spread(row.key, floor),
        "naive_ratio": naive and times.spread(naive, row.key),
        "ratios": {name: {"to": other, **times.spread(row.key, other)} for name, other in row.versus.items()},
        "rounds": times.raw(row.key),
        "floor_rounds": times.raw(floor) if floor else {},
    }


def _curve(name: str, against: str, x: list[float], seconds: list[float]) -> dict:
    """Times along a series, and the fit seconds = constant * x ^ slope by least squares of the logarithms.

    x   samples, pixels of CoC or pixels; two or more, all positive
    r2  share of the variance that the fit explains
    """
    lx, ly = np.log(np.asarray(x, float)), np.log(np.asarray(seconds, float))
    slope, constant = np.polyfit(lx, ly, 1)
    rest, whole = ((ly - slope * lx - constant) ** 2).sum(), ((ly - ly.mean()) ** 2).sum()
    fit = {"slope": float(slope), "r2": float(1.0 - rest / whole) if whole > 0.0 else 1.0}
    return {"name": name, "against": against, "x": x, "seconds": seconds, "fit": fit}


def _growth(driver: TimedDriver, against: str, series: dict[str, list[rows.Point]], plan: Plan, step: Step):
    """Time series, all points of all of them interleaved."""
    jobs = {
        f"{name} {x:.6g}": driver.prepared(passes, rows.textures(size), size)
        for name, points in series.items()
        for x, size, passes in points
    }
    times = interleaved(jobs, plan.growth_rounds, bool(software_device(driver.adapter)), step, plan.clock)
    for job in jobs.values():
        job.release()
    for name, points in series.items():
        x = [point[0] for point in points]
        yield _curve(name, against, x, [times.spread(f"{name} {value:.6g}")["median"] for value in x])


def _sample_curves(measured: list[dict]):
    """Time against effective samples, out of Table 1's rows."""
    for name in ("naive", "paper hexagon", "paper octagon", "exact hexagon", "exact octagon"):
        points = [row for row in measured if row["group"] == "table 1" and row["key"].rsplit(" ", 1)[0] == name]
        x, seconds = [float(row["effective"]) for row in points], [row["seconds"]["median"] for row in points]
        if len(points) > 1:
            yield _curve(name, "samples", x, seconds)


def measure(driver: TimedDriver, plan: Plan, step: Step = lambda _: None) -> dict:
    """The whole measurement on one driver."""
    size, layers_size = plan.size_on(driver), plan.layers_size
    chosen = [*rows.table_one(size, plan.sides), *rows.defaults(size), *rows.adaptive(size), *rows.in_focus(size)]
    found, times = measure_rows(driver, chosen, size, plan.rounds, step, plan.clock)
    layers = rows.layers(layers_size)
    found += measure_rows(driver, layers, layers_size, plan.rounds, step, plan.clock, rows.LAYERS_SCENE)[0]
    curves = [*_sample_curves(found)]
    for against, series in (("CoC", rows.with_coc(size)), ("pixels", rows.with_size(size))):
        curves += _growth(driver, against, series, plan, step)
    return {
        "driver": driver.name,
        "adapter": driver.adapter,
        "software": bool(software_device(driver.adapter)),
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
