"""The command `validation/run mutants`."""

import time
from typing import Annotated

import typer

from bokeh_validation import paths, terminal
from bokeh_validation.mutants import catalog, output, results, runner


def mutants(
    only: Annotated[list[str] | None, typer.Option(metavar="NAME", help="This mutant; may be given again.")] = None,
    kind: Annotated[list[str] | None, typer.Option(help="Those of a kind, such as sign; may be given again.")] = None,
    sample: Annotated[int | None, typer.Option(metavar="N", help="So many of them, at random.")] = None,
    json_file: terminal.JsonFile = None,
) -> None:
    """Break the shaders, one mistake at a time: the tests must catch each. A complete run goes into the report."""
    chosen = catalog.chosen(only, kind, sample)
    terminal.check_writable(json_file)
    started = time.monotonic()
    with terminal.progress("mutants", runner.steps(chosen)) as step:
        done = runner.run(chosen, step, runner.remaining())
    seconds = time.monotonic() - started
    targets = [json_file] if json_file else []
    if len(chosen) == len(catalog.MUTANTS):
        paths.ensured(results.default_path().parent)
        targets.append(results.default_path())
    for target in targets:
        results.write(target, done.results, seconds)
    terminal.tell(*output.lines(done, seconds))
    terminal.end(done.ok)
