"""What the user asked `validation/run bench` for, checked."""

import re
from dataclasses import dataclass

from bokeh_validation import drivers, terminal
from bokeh_validation.bench import measure, rows
from bokeh_validation.drivers.base import TimedDriver, software_device
from bokeh_validation.errors import UserError

# Drivers with a way to draw without upload and read-back, in the order in which they are tried
DRIVERS = ("egl", "osmesa", "wgpu", "dxc")
DEFAULT_DRIVERS = ("osmesa", "wgpu")
SIZE, SOFTWARE_SIZE, QUICK_SIZE = (800, 800), (400, 400), (160, 160)
# Of the layers: the scene as it is
LAYERS_SIZE = (960, 540)
ROUNDS, QUICK_ROUNDS, GROWTH_ROUNDS = 9, 5, 5
LEAST_SIDE, MOST_SIDE = 16, 8192
LEAST_ROUNDS, MOST_ROUNDS = 3, 1000


def is_software(driver: TimedDriver) -> bool:
    """Whether the device is a program: its times say nothing about a GPU."""
    return bool(software_device(driver.adapter))


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
        return self.size or (SOFTWARE_SIZE if is_software(driver) else SIZE)

    @property
    def growth_rounds(self) -> int:
        """Rounds of the two kinds of growth."""
        return min(self.rounds, GROWTH_ROUNDS)

    @property
    def steps(self) -> int:
        """Of the progress bar for each driver: rows, layers and two kinds of growth, each with a warm-up."""
        return 2 * (self.rounds + 1) + 2 * (self.growth_rounds + 1)


def plan(size: str | None, rounds: int | None, quick: bool, clock: str | None = None) -> Plan:
    """A plan. Raises UserError for a size, a number of rounds or a clock that makes no sense."""
    if clock is not None and clock not in measure.CLOCKS:
        raise UserError(f"--clock {clock}: unknown. Give one of {', '.join(measure.CLOCKS)}.")
    if rounds is not None and not LEAST_ROUNDS <= rounds <= MOST_ROUNDS:
        raise UserError(f"--rounds {rounds}: not allowed. Give {LEAST_ROUNDS} to {MOST_ROUNDS}.")
    wanted = None
    if size is not None:
        match = re.fullmatch(r"(\d{1,6})x(\d{1,6})", size)
        if match is None:
            raise UserError(f"--size {size}: not a size. Give width x height in pixels, for example 800x800.")
        wanted = int(match[1]), int(match[2])
        if not all(LEAST_SIDE <= side <= MOST_SIDE for side in wanted):
            raise UserError(f"--size {size}: not allowed. Give {LEAST_SIDE} to {MOST_SIDE} pixels a side.")
    if quick:
        return Plan(wanted or QUICK_SIZE, wanted or SOFTWARE_SIZE, rounds or QUICK_ROUNDS, rows.QUICK_SIDES, clock)
    return Plan(wanted, wanted or LAYERS_SIZE, rounds or ROUNDS, rows.SIDES, clock)


def load(names: list[str] | None, adapter: str | None) -> tuple[list[TimedDriver], dict[str, str]]:
    """The drivers asked for, and name -> reason for those that are missing. Raises UserError where none is left."""
    for name in names or []:
        if name not in DRIVERS:
            why = "its times would hold upload and read-back" if name in drivers.NAMES else "no such driver"
            raise UserError(f"--driver {name}: {why}. Give one of {', '.join(DRIVERS)}.")
    return terminal.pick_drivers(dict.fromkeys(names or DEFAULT_DRIVERS), adapter)
