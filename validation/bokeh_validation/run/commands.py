"""Define the commands that run a part of the suite: `validation/run probes`, `compile` and `engines`."""

import os
from typing import Annotated

import typer

from bokeh_validation import terminal
from bokeh_validation.compile_matrix import Compilation
from bokeh_validation.engines import ENGINES, SLOW
from bokeh_validation.errors import UserError
from bokeh_validation.probes import PROBES, REAL, outcomes
from bokeh_validation.run import session
from bokeh_validation.run.session import check_adapter
from bokeh_validation.shaders.variants import load


def probes(driver: terminal.SeveralDrivers = None, adapter: terminal.Adapter = None) -> None:
    """Draw the probes on the drivers, and check each against the reference and against what it must show."""
    names = tuple(driver or REAL)
    for name in names:
        terminal.check_driver(name)
    check_adapter(names, adapter)
    tests = [session.probe(probe.name, name) for probe in PROBES for name in names]
    with terminal.progress("probe", len(tests)) as step:
        handed_over, errors = session.run(tests, step, adapter=adapter)
    results = outcomes.merged(handed_over.values())
    outcomes.print_grid(results)
    outcomes.print_details(results, True)
    terminal.end(_told(session.unexplained(handed_over, errors)) and all(result.ok for result in results))


def compile_all(json_file: terminal.JsonFile = None) -> None:
    """Compile every shader program with every compiler."""
    terminal.check_writable(json_file)
    tests = [session.variant(name) for name in dict.fromkeys(program.variant for program in load())]
    with terminal.progress("compile", len(tests)) as step:
        handed_over, errors = session.run(tests, step)
    compilation = Compilation([row for compiled in handed_over.values() for row in compiled.rows])
    terminal.console.print(compilation.table())
    terminal.tell(compilation.summary, *compilation.failures())
    terminal.tell_missing(compilation.missing)
    terminal.write_json(json_file, compilation.as_json())
    terminal.end(_told(session.unexplained(handed_over, errors)) and compilation.passed)


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
    samples = names or [name for name in ENGINES if everything or name not in SLOW]
    with terminal.progress("engine", len(samples)) as step:
        handed_over, errors = session.run([session.sample(name) for name in samples], step)
    for outcome in handed_over.values():
        shows = outcome.shows or terminal.NOT_RUN
        terminal.console.print(f"{outcome.name}: {outcome.title}, {shows}", highlight=False)
        outcomes.print_details([outcome], True)
    absent = os.environ.get("CI") and any(outcome.missing for outcome in handed_over.values())
    passed = all(outcome.ok for outcome in handed_over.values()) and not absent
    terminal.end(_told(session.unexplained(handed_over, errors)) and passed)


def _told(errors: dict[str, str]) -> bool:
    """Print the tests that failed without a result that says so; returns whether there were none."""
    terminal.tell(*(f"{name}: {error}" for name, error in errors.items()))
    return not errors
