"""What the user asked `validation/run bench` for, checked."""

import re

from bokeh_validation import drivers
from bokeh_validation.bench import measure, session
from bokeh_validation.drivers.base import TimedDriver
from bokeh_validation.errors import Unavailable, UserError

LEAST_SIDE, MOST_SIDE = 16, 8192
LEAST_ROUNDS, MOST_ROUNDS = 3, 1000


def plan(size: str | None, rounds: int | None, quick: bool, clock: str | None = None) -> session.Plan:
    """A plan. Raises UserError for a size, a number of rounds or a clock that makes no sense."""
    if clock is not None and clock not in measure.CLOCKS:
        raise UserError(f"--clock {clock}: unknown. Give one of {', '.join(measure.CLOCKS)}.")
    if rounds is not None and not LEAST_ROUNDS <= rounds <= MOST_ROUNDS:
        raise UserError(f"--rounds {rounds}: not allowed. Give {LEAST_ROUNDS} to {MOST_ROUNDS}.")
    if size is None:
        return session.Plan(None, rounds, quick, clock)
    match = re.fullmatch(r"(\d{1,6})x(\d{1,6})", size)
    if match is None:
        raise UserError(f"--size {size}: not a size. Give width x height in pixels, for example 800x800.")
    wanted = int(match[1]), int(match[2])
    if not all(LEAST_SIDE <= side <= MOST_SIDE for side in wanted):
        raise UserError(f"--size {size}: not allowed. Give {LEAST_SIDE} to {MOST_SIDE} pixels a side.")
    return session.Plan(wanted, rounds, quick, clock)


def load(names: list[str] | None, adapter: str | None) -> tuple[list[TimedDriver], dict[str, str]]:
    """The drivers asked for, and name -> reason for those that are missing. Raises UserError where none is left."""
    found, missing = [], {}
    for name in names or []:
        if name not in drivers.NAMES:
            raise UserError(f"--driver {name}: no such driver. Give one of {', '.join(session.DRIVERS)}.")
        if name not in session.DRIVERS:
            raise UserError(
                f"--driver {name}: its times would hold upload and read-back. Give one of {', '.join(session.DRIVERS)}."
            )
    for name in dict.fromkeys(names or session.DEFAULT_DRIVERS):
        try:
            found.append(drivers.load(name, adapter))
        except Unavailable as error:
            missing[name] = str(error)
    if not found:
        reasons = "; ".join(f"{name}: {reason}" for name, reason in missing.items())
        raise UserError(f"none of the drivers is on this machine ({reasons}). See validation/run doctor.")
    return found, missing
