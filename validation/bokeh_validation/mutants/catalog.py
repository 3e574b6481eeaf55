"""All mutants, and the choice of some of them."""

import random
from collections.abc import Sequence

from bokeh_validation.errors import UserError
from bokeh_validation.mutants.everywhere import EVERYWHERE
from bokeh_validation.mutants.layers import LAYERS
from bokeh_validation.mutants.model import KINDS, Mutant
from bokeh_validation.mutants.one_language import ONE_LANGUAGE

MUTANTS: tuple[Mutant, ...] = (*EVERYWHERE, *ONE_LANGUAGE, *LAYERS)


def chosen(
    only: Sequence[str] | None = None, kinds: Sequence[str] | None = None, sample: int | None = None
) -> list[Mutant]:
    """Those of these names and kinds, `sample` of them at random. Raises UserError for a name that is none."""
    names = [mutant.name for mutant in MUTANTS]
    for name in only or []:
        if name not in names:
            raise UserError(f"--only {name}: no such mutant. There are: {', '.join(names)}.")
    for kind in kinds or []:
        if kind not in KINDS:
            raise UserError(f"--kind {kind}: no such kind. There are: {', '.join(KINDS)}.")
    found = [m for m in MUTANTS if (not only or m.name in only) and (not kinds or m.kind in kinds)]
    if sample is not None and sample < 1:
        raise UserError(f"--sample {sample}: at least 1.")
    if not found:
        raise UserError(f"no mutant is called {', '.join(only or [])} and is of kind {', '.join(kinds or [])}.")
    return found if sample is None or sample >= len(found) else random.sample(found, sample)
