"""What `validation/run precision` prints and docs/inputs.md shows."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from bokeh_validation.half import budget, frames, noise, sweep
from bokeh_validation.half.choice import ALLOWED, MAY_BE_HALF, WHOLE
from bokeh_validation.half.domain import DOMAINS
from bokeh_validation.half.evaluate import ALL_FLOAT, ALL_HALF

STORAGES = ("half", "r11g11b10", "rgba8")
STORAGE_NAMES = {"half": "RGBA16F", "r11g11b10": "R11G11B10F, CoC elsewhere", "rgba8": "RGBA8"}


@dataclass(frozen=True)
class Findings:
    """All that is measured.

    budget     a row for each of DOMAINS
    noise      see noise.measured
    methods    (name, all half, half where allowed) of each of frames.METHODS
    storages   (name, outcome) of each of STORAGES at display exposure
    variables  see sweep.measured
    """

    budget: list[budget.Row]
    noise: list[noise.Noise]
    methods: list[tuple[str, frames.Outcome, frames.Outcome]]
    storages: list[tuple[str, frames.Outcome]]
    variables: list[sweep.Variable]


def steps() -> int:
    """How often measured() calls `step`."""
    return len(DOMAINS) + len(frames.METHODS) + len(sweep.variables())


def measured(step: Callable[[str], None] = lambda _: None) -> Findings:
    """Measure everything: some 20 seconds."""
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
    return Findings(rows, noise.measured(), methods, storages, sweep.measured(step))


def markdown(findings: Findings) -> Iterator[str]:
    """The tables, a line each."""
    yield from _budget(findings.budget)
    yield ""
    yield from _noise(findings.noise)
    yield ""
    yield from _methods(findings.methods)
    yield ""
    yield from _variables(findings.variables)
    yield ""
    yield from _storages(findings.storages)


def _budget(rows: list[budget.Row]) -> Iterator[str]:
    yield "| function | error in | float | half | median | flushed | not finite | bound | as allowed | may be half |"
    yield "|---|---|---|---|---|---|---|---|---|---|"
    for row in rows:
        item = row.domain
        name = f"`{item.function}`" + (f", {item.note}" if item.note else "")
        names = MAY_BE_HALF.get(item.function, ())
        allowed = "all" if names == WHOLE else ", ".join(names) or "nothing"
        cells = [number(row.float32.largest), number(row.half.largest), number(row.half.median)]
        # a bound that is infinite everywhere is none
        bound = number(row.bound.largest) if row.bound.lost < 1.0 else "none"
        cells += [number(row.flushed.largest), share(row.half.lost), bound, number(row.chosen.largest)]
        yield f"| {name} | {item.unit} | {' | '.join(cells)} | {allowed} |"


def _noise(rows: list[noise.Noise]) -> Iterator[str]:
    yield f"| `BokehNoise`, corner of a 4K frame | precision | values of {noise.BLOCK**2} | correlation with float64 |"
    yield "|---|---|---|---|"
    for row in rows:
        yield f"| {row.where} | {row.precision} | {row.values} | {row.correlation:.2f} |"


def _methods(rows: list[tuple[str, frames.Outcome, frames.Outcome]]) -> Iterator[str]:
    yield "| method | all half: PSNR | sample moved by | not finite | as allowed: PSNR | sample moved by |"
    yield "|---|---|---|---|---|---|"
    for name, half, chosen in rows:
        yield (
            f"| {name} | {half.psnr:.0f} dB | {number(half.moved)} px | {share(half.lost)} | {chosen.psnr:.0f} dB | "
            f"{number(chosen.moved)} px |"
        )


def _variables(rows: list[sweep.Variable]) -> Iterator[str]:
    """The worst first; all that do no harm alone in one line."""
    yield "| half alone | in | PSNR | sample moved by | not finite |"
    yield "|---|---|---|---|---|"
    for row in sorted((row for row in rows if not row.harmless), key=lambda row: (row.name, row.function)):
        outcome = row.outcome
        cells = [_decibel(outcome), f"{number(outcome.moved)} px", share(outcome.lost)]
        yield f"| {row.name} | {row.function} | {' | '.join(cells)} |"
    rest = [row.outcome for row in rows if row.harmless]
    lowest, farthest = min(rest, key=lambda o: o.psnr), max(outcome.moved for outcome in rest)
    yield f"| each of {len(rest)} others | | {_decibel(lowest)} and more | {number(farthest)} px at most | 0 |"


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
