"""The command `validation/run mutants`."""

import random
import time
from collections.abc import Sequence
from typing import Annotated

import typer

from bokeh_validation import paths, terminal
from bokeh_validation.errors import UserError
from bokeh_validation.mutants import hunt, outcomes
from bokeh_validation.mutants.in_layers import IN_LAYERS
from bokeh_validation.mutants.in_library import IN_LIBRARY
from bokeh_validation.mutants.in_one_language import IN_ONE_LANGUAGE
from bokeh_validation.mutants.in_passes import IN_PASSES
from bokeh_validation.mutants.mutant import KINDS, Mutant

MUTANTS: tuple[Mutant, ...] = (*IN_LIBRARY, *IN_PASSES, *IN_LAYERS, *IN_ONE_LANGUAGE)


def mutants(
    only: Annotated[list[str] | None, typer.Option(metavar="NAME", help="This mutant; may be given again.")] = None,
    kind: Annotated[list[str] | None, typer.Option(help="Those of a kind, such as sign; may be given again.")] = None,
    sample: Annotated[int | None, typer.Option(metavar="N", help="So many of each kind, always the same.")] = None,
    json_file: terminal.JsonFile = None,
) -> None:
    """Break the shaders, one mistake at a time: the tests must catch each. A complete run goes into the report."""
    some = chosen(only, kind, sample)
    terminal.check_writable(json_file)
    started = time.monotonic()
    with terminal.progress("mutants", len(some)) as step:
        results = hunt.run(some, [killer for mutant in MUTANTS for killer in mutant.killers], step)
    found = outcomes.as_json(results, time.monotonic() - started)
    terminal.write_json(json_file, found)
    if len(some) == len(MUTANTS):
        paths.ensured(outcomes.default_path().parent)
        terminal.write_json(outcomes.default_path(), found)
    terminal.tell(*outcomes.lines(results, found["seconds"]))
    terminal.end(all(result.ok for result in results))


def chosen(only: Sequence[str] | None, kinds: Sequence[str] | None, sample: int | None) -> list[Mutant]:
    """Those of these names and kinds, `sample` of each kind. Raises UserError for a name that is none."""
    for option, given, known in (("only", only, [mutant.name for mutant in MUTANTS]), ("kind", kinds, list(KINDS))):
        for name in given or []:
            if name not in known:
                raise UserError(f"--{option} {name}: no such mutant or kind. There are: {', '.join(known)}.")
    if sample is not None and sample < 1:
        raise UserError(f"--sample {sample}: at least 1.")
    found = [m for m in MUTANTS if (not only or m.name in only) and (not kinds or m.kind in kinds)]
    if not found:
        raise UserError(f"no mutant is called {', '.join(only or [])} and is of kind {', '.join(kinds or [])}.")
    if sample is None:
        return found
    of_kind = {kind: [mutant for mutant in found if mutant.kind == kind] for kind in KINDS}
    seeded = random.Random(0)
    return [one for some in of_kind.values() for one in seeded.sample(some, min(sample, len(some)))]
