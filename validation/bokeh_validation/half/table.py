"""What `validation/run precision` prints and validation/precision.md shows."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from bokeh_validation import terminal
from bokeh_validation.half import budget, frames
from bokeh_validation.half.choice import ALLOWED, MAY_BE_HALF, WHOLE
from bokeh_validation.half.domain import DOMAINS
from bokeh_validation.half.evaluate import ALL_FLOAT, ALL_HALF

STORAGES = ("half", "r11g11b10", "rgba8")
STORAGE_NAMES = {"half": "RGBA16F", "r11g11b10": "R11G11B10F, CoC elsewhere", "rgba8": "RGBA8"}


@dataclass(frozen=True)
class Findings:
    """All that is measured.

    budget     a row for each of DOMAINS
    methods    (name, all half, half where allowed) of each of frames.METHODS
    storages   (name, outcome) of each of STORAGES at display exposure
    """

    budget: list[budget.Row]
    methods: list[tuple[str, frames.Outcome, frames.Outcome]]
    storages: list[tuple[str, frames.Outcome]]


def steps() -> int:
    """How often measured() calls `step`."""
    return len(DOMAINS) + len(frames.METHODS)


def measured(step: Callable[[str], None] = lambda _: None) -> Findings:
    """Measure everything: some seconds."""
    rows = []
    for item in DOMAINS:
        rows.append(budget.row(item, ALLOWED))
        step(item.function)
    methods = []
    for name in frames.METHODS:
        frame = frames.frame(name)
        methods.append((name, frame.outcome(ALL_HALF), frame.outcome(ALLOWED)))
        step(name)
    displayed = frames.frame("exact", frames.LARGE, 1.0, None)
    storages = [(name, displayed.outcome(ALL_FLOAT, storage=name)) for name in STORAGES]
    return Findings(rows, methods, storages)


def markdown(findings: Findings) -> Iterator[str]:
    """The tables, a line each."""
    yield from _budget(findings.budget)
    yield ""
    yield from _methods(findings.methods)
    yield ""
    yield from _storages(findings.storages)


def _budget(rows: list[budget.Row]) -> Iterator[str]:
    yield "| function | error in | float | half | median | flushed | not finite | as allowed | may be half |"
    yield "|---|---|---|---|---|---|---|---|---|"
    for row in rows:
        item = row.domain
        name = f"`{item.function}`" + (f", {item.note}" if item.note else "")
        names = MAY_BE_HALF.get(item.function, ())
        allowed = "all" if names == WHOLE else ", ".join(names) or "nothing"
        cells = [number(row.float32.largest), number(row.half.largest), number(row.half.median)]
        cells += [number(row.flushed.largest), share(row.half.lost), number(row.chosen.largest)]
        yield f"| {name} | {item.unit} | {' | '.join(cells)} | {allowed} |"


def _methods(rows: list[tuple[str, frames.Outcome, frames.Outcome]]) -> Iterator[str]:
    yield "| method | all half: PSNR | sample moved by | not finite | as allowed: PSNR | sample moved by |"
    yield "|---|---|---|---|---|---|"
    for name, half, chosen in rows:
        yield (
            f"| {name} | {half.psnr:.0f} dB | {number(half.moved)} px | {share(half.lost)} | {chosen.psnr:.0f} dB | "
            f"{number(chosen.moved)} px |"
        )


def _storages(rows: list[tuple[str, frames.Outcome]]) -> Iterator[str]:
    yield "| targets between the passes | PSNR | sample moved by |"
    yield "|---|---|---|"
    for name, outcome in rows:
        yield f"| {STORAGE_NAMES[name]} | {_decibel(outcome)} | {number(outcome.moved)} px |"


def _decibel(outcome: frames.Outcome) -> str:
    return "same" if outcome.psnr == float("inf") else f"{outcome.psnr:.0f} dB"


def number(x: float) -> str:
    """Two digits."""
    if x == 0.0:
        return "0"
    if 0.001 <= x < 1000.0:
        return f"{float(f'{x:.2g}'):g}"
    return f"{x:.1e}".replace("e-0", "e-").replace("e+0", "e")


def share(x: float) -> str:
    """Percent."""
    return "0" if x == 0.0 else f"{number(100.0 * x)} %"


def precision() -> None:
    """What half precision does to every function and pass, emulated: the tables of validation/precision.md."""
    with terminal.progress("precision", steps()) as step:
        findings = measured(step)
    terminal.tell(*markdown(findings))
