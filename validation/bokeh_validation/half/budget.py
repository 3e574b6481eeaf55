"""The error budget: every function of the library that reads no texture, over its domain, by precision."""

from dataclasses import dataclass

import numpy as np

from bokeh_validation.half.domain import MAX_SAMPLES, Domain
from bokeh_validation.half.evaluate import ALL_FLOAT, ALL_HALF, Choice, Evaluator
from bokeh_validation.half.numbers import Rounded

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

    float32, half, flushed, chosen  flushed: half without subnormals; chosen: half where allowed
    """

    domain: Domain
    float32: Errors
    half: Errors
    flushed: Errors
    chosen: Errors


def row(domain: Domain, allowed: Choice, inputs: int = INPUTS) -> Row:
    """Measure a function on its domain, the same inputs for every precision."""
    arguments = domain.arguments(np.random.default_rng(SEED), inputs)
    exact = called(Rounded(np.float64), ALL_FLOAT, domain.function, arguments)
    scale = domain.scale(exact, arguments)

    def measured(numbers: Rounded, choice: Choice) -> Errors:
        found = called(numbers, choice, domain.function, arguments)
        with np.errstate(invalid="ignore"):
            return _errors(np.abs(found - exact), scale)

    return Row(
        domain,
        measured(Rounded(), ALL_FLOAT),
        measured(Rounded(), ALL_HALF),
        measured(Rounded(flush=True), ALL_HALF),
        measured(Rounded(), allowed),
    )


def called(numbers: Rounded, choice: Choice, function: str, arguments: list) -> np.ndarray:
    """Result (N, components) in float64, with as many samples as the domain has; members of a struct side by side."""
    found = Evaluator(numbers, choice, {"BOKEH_NUM_SAMPLES": MAX_SAMPLES}).call(function, *arguments)
    if isinstance(found, dict):
        found = np.concatenate(np.broadcast_arrays(*found.values()), axis=1)
    return found.astype(np.float64)


def _errors(off: np.ndarray, scale: np.ndarray) -> Errors:
    off = np.where(np.isfinite(off), off, np.inf)
    scaled = np.where(scale > 0.0, off * np.where(scale > 0.0, scale, 1.0), 0.0)
    return Errors(scaled.max(axis=1))
