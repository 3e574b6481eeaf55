"""The command `validation/run mutants`."""

import random
import time
from collections.abc import Sequence
from typing import Annotated

import typer

from bokeh_validation import paths, terminal
from bokeh_validation.errors import UserError
from bokeh_validation.mutants import by_hand, hunt, mutant, operators
from bokeh_validation.mutants.mutant import Mutant


def mutants(
    only: Annotated[list[str] | None, typer.Option(metavar="NAME", help="This mutant; may be given again.")] = None,
    kind: Annotated[list[str] | None, typer.Option(help="Those of a kind, such as sign; may be given again.")] = None,
    sample: Annotated[int | None, typer.Option(metavar="N", help="So many of each kind, always the same.")] = None,
    json_file: terminal.JsonFile = None,
) -> None:
    """Break the shaders, one mistake at a time: each must show. A complete run goes into the report."""
    everything = all_mutants()
    some = chosen(everything, only, kind, sample)
    terminal.check_writable(json_file)
    started = time.monotonic()
    with terminal.progress("mutants", len(some)) as step:
        rows = hunt.run(some, step)
    found = mutant.as_json(rows, time.monotonic() - started)
    terminal.write_json(json_file, found)
    if len(some) == len(everything):
        paths.ensured(mutant.default_path().parent)
        terminal.write_json(mutant.default_path(), found)
    terminal.tell(*mutant.lines(rows, found["seconds"]))
    terminal.end(all(item["ok"] for item in rows))


def all_mutants() -> list[Mutant]:
    """Those of the operators, and those by hand."""
    return [*operators.mutants(), *by_hand.mutants()]


def chosen(
    everything: Sequence[Mutant], only: Sequence[str] | None, kinds: Sequence[str] | None, sample: int | None
) -> list[Mutant]:
    """Those of these names and kinds, `sample` of each kind. Raises UserError for a name that is none."""
    names, known = [item.name for item in everything], list(dict.fromkeys(item.kind for item in everything))
    for name in only or []:
        if name not in names:
            raise UserError(f"--only {name}: no such mutant. Their names are in the file that --json writes.")
    for name in kinds or []:
        if name not in known:
            raise UserError(f"--kind {name}: no such kind. There are: {', '.join(known)}.")
    if sample is not None and sample < 1:
        raise UserError(f"--sample {sample}: at least 1.")
    some = [item for item in everything if (not only or item.name in only) and (not kinds or item.kind in kinds)]
    if not some:
        raise UserError(f"no mutant is called {', '.join(only or [])} and is of kind {', '.join(kinds or [])}.")
    if sample is None:
        return some
    by_kind = [[item for item in some if item.kind == name] for name in known]
    seeded = random.Random(0)
    return [item for group in by_kind for item in seeded.sample(group, min(sample, len(group)))]
