"""Define the command `validation/run mutants`."""

import random
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Annotated

import typer

from bokeh_validation import terminal
from bokeh_validation.errors import UserError
from lab.mutants import by_hand, operators, run_mutants
from lab.mutants.mutant import BAD, OUTCOMES, Mutant


def mutants(
    only: Annotated[list[str] | None, typer.Option(metavar="NAME", help="This mutant; may be given again.")] = None,
    sample: Annotated[
        int | None, typer.Option(metavar="N", help="Number of mutants of each kind, always the same ones.")
    ] = None,
    json_file: terminal.JsonFile = None,
) -> None:
    """Break the shaders, one mistake at a time: each must show."""
    selected = chosen(all_mutants(), only, sample)
    terminal.check_writable(json_file)
    started = time.monotonic()
    with terminal.progress("mutants", len(selected)) as step:
        results = run_mutants.run(selected, step)
    run_data = as_json(selected, results, time.monotonic() - started)
    terminal.write_json(json_file, run_data)
    terminal.tell(*lines(run_data))
    terminal.end(not any(outcome in BAD for outcome, _ in results))


def all_mutants() -> list[Mutant]:
    """Return the mutants made by operators and those written by hand."""
    return [*operators.mutants(), *by_hand.mutants()]


def chosen(everything: Sequence[Mutant], only: Sequence[str] | None, sample: int | None) -> list[Mutant]:
    """Return the mutants with these names, at most `sample` of each kind. Raises UserError for an unknown name."""
    if unknown := set(only or ()) - {mutant.name for mutant in everything}:
        raise UserError(f"--only {min(unknown)}: no such mutant. Their names are in the file that --json writes.")
    if sample is not None and sample < 1:
        raise UserError(f"--sample {sample}: at least 1.")
    selected = [mutant for mutant in everything if not only or mutant.name in only]
    if sample is None:
        return selected
    seeded, kinds = random.Random(0), dict.fromkeys(mutant.kind for mutant in selected)
    by_kind = [[mutant for mutant in selected if mutant.kind == kind] for kind in kinds]
    return [mutant for group in by_kind for mutant in seeded.sample(group, min(sample, len(group)))]


def as_json(selected: Sequence[Mutant], results: Sequence[tuple[str, str]], seconds: float) -> dict:
    """Return the data of a run for JSON."""
    rows = [
        {"name": mutant.name, "change": mutant.change, "outcome": outcome, "detail": detail}
        for mutant, (outcome, detail) in zip(selected, results, strict=True)
    ]
    return {"seconds": round(seconds, 1), "mutants": rows}


def lines(run_data: dict) -> Iterator[str]:
    """Yield a line for every mutant that is alive or broken, and one with the totals."""
    for row in run_data["mutants"]:
        if row["outcome"] in BAD:
            yield f"{row['name']} ({row['change']}): {row['outcome']}: {row['detail']}"
    count = Counter(row["outcome"] for row in run_data["mutants"])
    sums = ", ".join(f"{count[outcome]} {outcome}" for outcome in OUTCOMES)
    yield f"{len(run_data['mutants'])} mutants: {sums} ({run_data['seconds']:.0f} s)"
