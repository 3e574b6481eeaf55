"""The error budget: every function of the library that reads no texture, over its domain, by precision."""

from dataclasses import dataclass

import numpy as np

from bokeh_validation.half.domain import Domain
from bokeh_validation.half.evaluate import ALL_FLOAT, ALL_HALF, Choice, Evaluator
from bokeh_validation.half.numbers import FLOAT, HALF, Bounds, Rounded

INPUTS = 4000
SEED = 20120


@dataclass(frozen=True)
class Errors:
    """Errors of a function in its unit.

    each    (N,) of every input, the largest of its components; infinite where the result is not finite
    """

    each: np.ndarray

    @property
    def lost(self) -> float:
        """Share of the inputs whose result is not finite."""
        return float(np.isinf(self.each).mean())

    @property
    def largest(self) -> float:
        """Of those whose result is finite; 0 where there is none."""
        return float(np.max(self.each, where=np.isfinite(self.each), initial=0.0))

    @property
    def median(self) -> float:
        """Of all inputs."""
        return float(np.median(self.each))


@dataclass(frozen=True)
class Row:
    """A line of the budget.

    float32, half, flushed, chosen  measured; flushed: half without subnormals; chosen: half where allowed
    bound, float_bound              derived: for each input, half and float32 cannot be farther off
    """

    domain: Domain
    float32: Errors
    half: Errors
    flushed: Errors
    chosen: Errors
    bound: Errors
    float_bound: Errors


def row(domain: Domain, allowed: Choice, inputs: int = INPUTS) -> Row:
    """Measure a function on its domain, the same inputs for every precision."""
    arguments = domain.arguments(np.random.default_rng(SEED), inputs)
    exact = Evaluator(Rounded(np.float64), ALL_FLOAT).call(domain.function, *arguments)
    scale = domain.scale(exact, arguments)

    def measured(numbers: Rounded, choice: Choice) -> Errors:
        found = Evaluator(numbers, choice).call(domain.function, *arguments).astype(np.float64)
        with np.errstate(invalid="ignore"):
            return _errors(np.abs(found - exact), scale)

    def bound(precision: str) -> Errors:
        choice = ALL_HALF if precision == HALF else ALL_FLOAT
        return _errors(Evaluator(Bounds(precision), choice).call(domain.function, *arguments).error, scale)

    return Row(
        domain,
        measured(Rounded(), ALL_FLOAT),
        measured(Rounded(), ALL_HALF),
        measured(Rounded(flush=True), ALL_HALF),
        measured(Rounded(), allowed),
        bound(HALF),
        bound(FLOAT),
    )


def _errors(off: np.ndarray, scale: np.ndarray) -> Errors:
    off = np.where(np.isfinite(off), off, np.inf)
    scaled = np.where(scale > 0.0, off * np.where(scale > 0.0, scale, 1.0), 0.0)
    return Errors(scaled.max(axis=1))
