"""Times of many jobs, interleaved: every round draws each once, in another order."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import ceil

import numpy as np

from bokeh_validation.drivers.base import Job

CLOCKS = ("wall", "cpu", "query")
# A shorter measurement is repeated until it is this long, seconds.
SHORTEST = 0.02
MOST_REPEATS = 10000
# The device's timer is believed where it shows this share of the time on the clock: command buffers that are queued
# one behind the other leave little besides, and a timer that misses deferred work or counts another unit shows.
AGREES = (0.8, 1.05)


@dataclass(frozen=True)
class Times:
    """Seconds for one draw.

    clocks   'wall', 'cpu', 'query' -> key -> (rounds,); the query NaN where the device has no timer
    clock    which of them is used
    why      a line about the choice
    """

    clocks: Mapping[str, Mapping[str, np.ndarray]]
    clock: str
    why: str

    def spread(self, key: str, over: str | None = None) -> dict[str, float]:
        """Median of all rounds and what a tenth of them is below and above: of a job, or of its ratio to another's."""
        used = self.clocks[self.clock]
        low, median, high = np.percentile(used[key] / used[over] if over else used[key], (10, 50, 90))
        return {"median": float(median), "low": float(low), "high": float(high)}

    def raw(self, key: str) -> dict[str, list]:
        """By clock as JSON has it: None where there is no number."""
        return {
            name: [None if np.isnan(value) else float(value) for value in times[key]]
            for name, times in self.clocks.items()
        }


def chosen_clock(clocks: Mapping[str, Mapping[str, np.ndarray]], software: bool) -> tuple[str, str]:
    """Name of the clock to use and why: CPU time in software, else the query where it agrees with the wall clock."""
    share = np.concatenate([clocks["query"][key] / clocks["wall"][key] for key in clocks["wall"]])
    if software:
        return "cpu", "CPU time of the process: the device is a program on these cores"
    if np.isnan(share).any():
        return "wall", "wall time around finished frames: the device has no timer"
    low, high = np.percentile(share, (5, 95))
    seen = f"the timer query shows {low:.2f} to {high:.2f} of the wall time"
    if AGREES[0] <= low and high <= AGREES[1]:
        return "query", f"timer query: {seen}"
    return "wall", f"wall time around finished frames: {seen}"


def interleaved(
    jobs: Mapping[str, Job],
    rounds: int,
    software: bool,
    step: Callable[[str], None] = lambda _: None,
    clock: str | None = None,
) -> Times:
    """Time all jobs `rounds` times, each round in another order; before that a round that does not count.

    software  whether the device is a program on this machine's cores
    step      called after every round, the one that does not count included
    clock     'wall', 'cpu' or 'query'; None: see chosen_clock
    """
    repeats = {}
    for key, job in jobs.items():
        job.timed(1)  # compiles what the runtime compiles on first use
        repeats[key] = min(MOST_REPEATS, ceil(SHORTEST / max(job.timed(1).wall, 1e-9)))
    step("warm-up")
    random = np.random.default_rng(1)
    clocks = {name: {key: np.full(rounds, np.nan) for key in jobs} for name in CLOCKS}
    for index in range(rounds):
        for key in random.permutation(list(jobs)):
            timing = jobs[key].timed(repeats[key])
            for name in CLOCKS:
                value = getattr(timing, name)
                clocks[name][key][index] = np.nan if value is None else value
        step(f"round {index + 1}")
    return Times(clocks, *((clock, "as asked for") if clock else chosen_clock(clocks, software)))
