"""A whole measurement on one driver, and all of it as data."""

from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from importlib import metadata

import numpy as np

from bokeh_validation import __version__, doctor, suite
from bokeh_validation.bench import growth, reads, rows
from bokeh_validation.bench.measure import CLOCKS, Spread, Times, interleaved
from bokeh_validation.drivers.base import TimedDriver

# Drivers with a way to draw without upload and read-back, in the order in which they are tried
DRIVERS = ("egl", "osmesa", "wgpu", "dxc")
DEFAULT_DRIVERS = ("osmesa", "wgpu")
# Parts of the names of devices that are programs on this machine's cores
SOFTWARE = ("llvmpipe", "softpipe", "SwiftShader", "Microsoft Basic Render")
SIZE, SOFTWARE_SIZE, QUICK_SIZE = (800, 800), (400, 400), (160, 160)
# Of the layers: the scene as it is
LAYERS_SIZE = (960, 540)
ROUNDS, QUICK_ROUNDS, GROWTH_ROUNDS = 9, 5, 5


def is_software(driver: TimedDriver) -> bool:
    """Whether the device is a program: its times say nothing about a GPU."""
    return any(name in driver.adapter for name in SOFTWARE)


@dataclass(frozen=True)
class Plan:
    """What to measure.

    size   (width, height); None: 800 x 800 on a GPU, as the paper has it, and smaller in software
    clock  'wall', 'cpu' or 'query'; None: see measure.chosen_clock
    """

    size: tuple[int, int] | None = None
    rounds: int | None = None
    quick: bool = False
    clock: str | None = None

    def size_on(self, driver: TimedDriver) -> tuple[int, int]:
        """(width, height) for a driver."""
        if self.size is not None:
            return self.size
        if self.quick:
            return QUICK_SIZE
        return SOFTWARE_SIZE if is_software(driver) else SIZE

    @property
    def layers_size(self) -> tuple[int, int]:
        """(width, height) for the layers."""
        return self.size or (SOFTWARE_SIZE if self.quick else LAYERS_SIZE)

    @property
    def counted(self) -> int:
        """Rounds that count."""
        return self.rounds or (QUICK_ROUNDS if self.quick else ROUNDS)

    @property
    def sides(self) -> tuple[int, ...]:
        """Samples on a line."""
        return rows.QUICK_SIDES if self.quick else rows.SIDES

    @property
    def steps(self) -> int:
        """Steps of the progress bar for each driver: the rounds of the rows, of the layers and of two kinds of growth,
        each with a warm-up.
        """
        return 2 * (self.counted + 1) + 2 * (min(self.counted, GROWTH_ROUNDS) + 1)


@dataclass(frozen=True)
class Measured:
    """A row with its times. Ratios are over the rounds, each computed within its round.

    floor   row / its floor; None where there is none
    naive   naive with as many effective samples / row; None where there is none
    versus  row / the rows that it names in `versus`
    """

    row: rows.Row
    cost: reads.Cost
    seconds: Spread
    floor_seconds: Spread | None
    floor: Spread | None
    naive: Spread | None
    versus: dict[str, Spread]
    raw: dict[str, list]
    raw_floor: dict[str, list]


@dataclass(frozen=True)
class Curve:
    """Times along a series: `x` in samples, pixels of CoC or pixels."""

    name: str
    against: str
    x: list[float]
    seconds: list[float]
    fit: growth.Fit


@dataclass(frozen=True)
class Result:
    """All of one driver."""

    driver: str
    adapter: str
    software: bool
    size: tuple[int, int]
    layers_size: tuple[int, int]
    rounds: int
    clock: str
    why: str
    rows: list[Measured]
    curves: list[Curve]

    def find(self, key: str) -> Measured:
        """The row of that key."""
        return next(found for found in self.rows if found.row.key == key)


def measure_rows(
    driver: TimedDriver,
    chosen: Iterable[rows.Row],
    size: tuple[int, int],
    rounds: int,
    step: Callable[[str], None] = lambda _: None,
    clock: str | None = None,
    scene: suite.SceneFile = rows.SCENE,
) -> tuple[list[Measured], Times]:
    """Time rows and their floors, all interleaved."""
    images = rows.textures(size, scene)
    # one picture and one set of targets for all: 80 jobs of their own would not fit a small device
    shared = driver.prepared((), images, size)
    jobs = {}
    chosen = list(chosen)
    for row in chosen:
        for key, passes in ((row.key, row.passes), (row.key + " floor", row.floor)):
            if passes:
                jobs[key] = driver.prepared(passes, images, size, share=shared)
    times = interleaved(jobs, rounds, is_software(driver), step=step, clock=clock)
    for job in [*jobs.values(), shared]:
        job.release()
    found = []
    for row in chosen:
        floor = row.key + " floor" if row.floor else None
        versus = {name: times.ratio(row.key, other) for name, other in row.versus.items()}
        found.append(
            Measured(
                row,
                _cost(row, images["depth"]),
                Spread.of(times.seconds[row.key]),
                Spread.of(times.seconds[floor]) if floor else None,
                times.ratio(row.key, floor) if floor else None,
                times.ratio(row.versus["naive"], row.key) if "naive" in row.versus else None,
                versus,
                {name: _raw(times.clocks[name][row.key]) for name in CLOCKS},
                {name: _raw(times.clocks[name][floor]) for name in CLOCKS} if floor else {},
            )
        )
    return found, times


def _raw(seconds: np.ndarray) -> list:
    """As JSON has it: None where there is no number."""
    return [None if np.isnan(value) else float(value) for value in seconds]


def _cost(row: rows.Row, depth: np.ndarray) -> reads.Cost:
    if row.group == "in focus":
        written = reads.TARGET_BYTES * sum(len(item.outputs) for item in row.passes)
        return reads.Cost(len(row.passes), float(len(row.passes)), 0.0, written)
    return reads.cost(row.passes, depth)


def measure_curves(
    driver: TimedDriver,
    series: list[growth.Series],
    rounds: int,
    step: Callable[[str], None] = lambda _: None,
    clock: str | None = None,
) -> list[Curve]:
    """Time series, all points of all of them interleaved."""
    jobs = {}
    for curve in series:
        for x, size, passes in curve.points:
            jobs[f"{curve.name} {x:.6g}"] = driver.prepared(passes, rows.textures(size), size)
    times = interleaved(jobs, rounds, is_software(driver), step=step, clock=clock)
    for job in jobs.values():
        job.release()
    found = []
    for curve in series:
        x = [point[0] for point in curve.points]
        seconds = [Spread.of(times.seconds[f"{curve.name} {value:.6g}"]).median for value in x]
        found.append(Curve(curve.name, curve.against, x, seconds, growth.Fit.of(x, seconds)))
    return found


def sample_curves(measured: list[Measured]) -> list[Curve]:
    """Time against effective samples, out of Table 1's rows."""
    found = []
    for name in ("naive", "paper hexagon", "paper octagon", "exact hexagon", "exact octagon"):
        points = [m for m in measured if m.row.group == "table 1" and m.row.key.rsplit(" ", 1)[0] == name]
        x, seconds = [float(m.row.effective) for m in points], [m.seconds.median for m in points]
        if len(points) > 1:
            found.append(Curve(name, "samples", x, seconds, growth.Fit.of(x, seconds)))
    return found


def measure(driver: TimedDriver, plan: Plan, step: Callable[[str], None] = lambda _: None) -> Result:
    """The whole measurement on one driver."""
    size = plan.size_on(driver)
    chosen = [*rows.table_one(size, plan.sides), *rows.defaults(size), *rows.adaptive(size), *rows.in_focus(size)]
    found, times = measure_rows(driver, chosen, size, plan.counted, step, plan.clock)
    size_of_layers = plan.layers_size
    found += measure_rows(
        driver, rows.layers(size_of_layers), size_of_layers, plan.counted, step, plan.clock, rows.LAYERS_SCENE
    )[0]
    few = min(plan.counted, GROWTH_ROUNDS)
    curves = sample_curves(found)
    curves += measure_curves(driver, growth.with_coc(size), few, step, plan.clock)
    curves += measure_curves(driver, growth.with_size(size), few, step, plan.clock)
    return Result(
        driver.name,
        driver.adapter,
        is_software(driver),
        size,
        size_of_layers,
        plan.counted,
        times.clock,
        times.why,
        found,
        curves,
    )


def as_json(results: list[Result], missing: dict[str, str]) -> dict:
    """Everything, raw rounds included; seconds, fractions and pixels."""
    versions = {name: metadata.version(name) for name in ("moderngl", "wgpu", "numpy")}
    return {
        "version": __version__,
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "environment": {**doctor.environment(), **versions},
        "coc": rows.COC,
        "scene": rows.SCENE.name,
        "layers_scene": rows.LAYERS_SCENE.name,
        "missing": missing,
        "drivers": [_driver_json(result) for result in results],
    }


def _driver_json(result: Result) -> dict:
    return {
        "driver": result.driver,
        "adapter": result.adapter,
        "software": result.software,
        "size": list(result.size),
        "layers_size": list(result.layers_size),
        "rounds": result.rounds,
        "clock": result.clock,
        "clock_check": result.why,
        "rows": [_row_json(found) for found in result.rows],
        "growth": [asdict(curve) for curve in result.curves],
    }


def _optional(found: Spread | None) -> dict | None:
    return None if found is None else asdict(found)


def _row_json(found: Measured) -> dict:
    settings = found.row.settings
    return {
        "key": found.row.key,
        "group": found.row.group,
        "method": settings.method,
        "aperture": settings.aperture,
        "effective": found.row.effective,
        "samples": settings.count,
        "spacing": settings.spacing,
        "coc": settings.coc,
        "cost": asdict(found.cost),
        "seconds": asdict(found.seconds),
        "floor_seconds": _optional(found.floor_seconds),
        "floor_ratio": _optional(found.floor),
        "naive_ratio": _optional(found.naive),
        "ratios": {name: {"to": found.row.versus[name], **asdict(spread)} for name, spread in found.versus.items()},
        "rounds": found.raw,
        "floor_rounds": found.raw_floor,
    }
