"""Define the command `validation/run engines`."""

import os
from typing import Annotated

import typer

from bokeh_validation import terminal
from bokeh_validation.errors import UserError
from bokeh_validation.probes import outcomes
from bokeh_validation.run import session
from engines import ENGINES, QUICK


def engines(
    names: Annotated[list[str] | None, typer.Argument(metavar="[NAME]...", help="By default all quick ones.")] = None,
    everything: Annotated[
        bool, typer.Option("--all", help="Run the slow ones as well (Bevy builds for minutes).")
    ] = False,
) -> None:
    """Build and run the samples of integration/, each compared with the reference on its own colour and depth."""
    for name in names or []:
        if name not in ENGINES:
            raise UserError(f"engine {name}: no such sample. Give some of {', '.join(ENGINES)}.")
    samples = names or (ENGINES if everything else QUICK)
    with terminal.progress("engine", len(samples)) as step:
        handed_over, errors = session.run([session.sample(name) for name in samples], step)
    for outcome in handed_over.values():
        shows = outcome.shows or terminal.NOT_RUN
        terminal.console.print(f"{outcome.name}: {outcome.title}, {shows}", highlight=False)
        outcomes.print_details([outcome], True)
    absent = os.environ.get("CI") and any(outcome.missing for outcome in handed_over.values())
    passed = all(outcome.ok for outcome in handed_over.values()) and not absent
    terminal.end(session.told(handed_over, errors) and passed)
