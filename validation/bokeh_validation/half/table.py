"""The error budget and whole methods by precision: what `validation/run precision` prints and precision.md shows."""

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from bokeh_validation import terminal
from bokeh_validation.half import domain, frames
from bokeh_validation.half.choice import ALLOWED, MAY_BE_HALF, WHOLE
from bokeh_validation.half.interpreter import ALL_FLOAT, ALL_HALF, Choice, Evaluator

INPUTS = 4000
SEED = 20120
STORAGES = {"half": "RGBA16F", "r11g11b10": "R11G11B10F, CoC elsewhere", "rgba8": "RGBA8"}
# the columns of the budget
CHOICES = {"float": ALL_FLOAT, "half": ALL_HALF, "allowed": ALLOWED}


def errors(function: str) -> Mapping[str, np.ndarray]:
    """By choice, (N,) of every input in the function's unit, the largest of its components; infinite where lost."""
    given = domain.arguments(function, np.random.default_rng(SEED), INPUTS)
    exact = _called(np.float64, ALL_FLOAT, function, given)
    scale = domain.scale(function, exact, given)
    found = {}
    for name, choice in CHOICES.items():
        with np.errstate(invalid="ignore"):
            off = np.abs(_called(np.float32, choice, function, given) - exact)
        found[name] = (np.where(np.isfinite(off), off, np.inf) * scale).max(axis=1)
    return found


def _called(wide: type, choice: Choice, function: str, arguments: list) -> np.ndarray:
    """Result (N, components) in float64, with as many samples as the domain has; members of a struct side by side."""
    found = Evaluator(wide, choice, {"BOKEH_NUM_SAMPLES": domain.MAX_SAMPLES}).call(function, *arguments)
    if isinstance(found, dict):
        found = np.concatenate(np.broadcast_arrays(*found.values()), axis=1)
    return found.astype(np.float64)


def measured(step: Callable[[str], None] = lambda _: None) -> tuple[list, list, list]:
    """(function, errors), (method, all half, half where allowed), (storage, outcome at the exposure of the scene)."""
    budget, methods = [], []
    for function in domain.UNITS:
        budget.append((function, errors(function)))
        step(function)
    for name in frames.METHODS:
        methods.append((name, frames.outcome(name, ALL_HALF), frames.outcome(name, ALLOWED)))
        step(name)
    storages = [(name, frames.outcome("exact", exposure=1.0, storage=name, wanted=None)) for name in STORAGES]
    return budget, methods, storages


def markdown(budget: list, methods: list, storages: list) -> Iterator[str]:
    """The tables, a line each."""
    yield "| function | error in | float | half | not finite | as allowed | may be half |"
    yield "|---|---|---|---|---|---|---|"
    for function, off in budget:
        float_, half, allowed = (_number(float(off[name][np.isfinite(off[name])].max())) for name in CHOICES)
        names = MAY_BE_HALF.get(function, ())
        may = "all" if names == WHOLE else ", ".join(names) or "nothing"
        lost = _share(float(np.isinf(off["half"]).mean()))
        yield f"| `{function}` | {domain.UNITS[function]} | {float_} | {half} | {lost} | {allowed} | {may} |"
    yield ""
    yield "| method | all half: PSNR | sample moved by | not finite | as allowed: PSNR | sample moved by |"
    yield "|---|---|---|---|---|---|"
    for name, half, allowed in methods:
        yield f"| {name} | {_moved(half)} | {_share(half.lost)} | {_moved(allowed)} |"
    yield ""
    yield "| targets between the passes | PSNR | sample moved by |"
    yield "|---|---|---|"
    for name, outcome in storages:
        yield f"| {STORAGES[name]} | {_moved(outcome)} |"


def _moved(outcome: frames.Outcome) -> str:
    return f"{outcome.psnr:.0f} dB | {_number(outcome.moved)} px"


def _number(x: float) -> str:
    """Two digits."""
    if x == 0.0:
        return "0"
    if 0.001 <= x < 1000.0:
        return f"{float(f'{x:.2g}'):g}"
    return f"{x:.1e}".replace("e-0", "e-").replace("e+0", "e")


def _share(x: float) -> str:
    """Percent."""
    return "0" if x == 0.0 else f"{_number(100.0 * x)} %"


def precision() -> None:
    """What half precision does to every function and pass, emulated: the tables of validation/precision.md."""
    with terminal.progress("precision", len(domain.UNITS) + len(frames.METHODS)) as step:
        found = measured(step)
    terminal.tell(*markdown(*found))
