"""The command `validation/run bench`."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from bokeh_validation import files, terminal
from bokeh_validation.bench import output, request, session


def bench(
    driver: Annotated[
        list[str] | None,
        typer.Option("--driver", help="osmesa, egl, wgpu or dxc; default: osmesa and wgpu. The others are not timed."),
    ] = None,
    adapter: terminal.Adapter = None,
    size: Annotated[
        str | None, typer.Option(metavar="WxH", help="Pixels. Default: 800x800; smaller in software.")
    ] = None,
    rounds: Annotated[int | None, typer.Option(help="Rounds that count, 3 or more.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Small, few counts, few rounds: within 40 s.")] = False,
    clock: Annotated[
        str | None,
        typer.Option(help="wall, query or cpu. Default: cpu in software, else query where it agrees with wall."),
    ] = None,
    json_file: Annotated[Path | None, typer.Option("--json", help="Write everything here, raw rounds too.")] = None,
    plot: Annotated[Path | None, typer.Option(metavar="FILE.png", help="Draw the curves and the floors.")] = None,
) -> None:
    """Table 1: time of the methods against naive, against each other and against a floor of the same fetches."""
    plan = request.plan(size, rounds, quick, clock)
    terminal.check_writable(json_file, plot)
    runtimes, missing = request.load(driver, adapter)
    with terminal.progress("bench", plan.steps * len(runtimes)) as step:
        results = [session.measure(one, plan, lambda text, name=one.name: step(f"{name}: {text}")) for one in runtimes]
    terminal.write_json(json_file, session.as_json(results, missing))
    if plot is not None:
        picture = output.plot(results)
        files.whole(plot, lambda partial: partial.write_bytes(picture))
    # a table in a file or a pipe needs a width of its own
    wide = terminal.console if terminal.console.is_terminal else Console(width=120)
    for result in results:
        for part in output.tables(result):
            wide.print(part)
    for name, reason in missing.items():
        terminal.console.print(f"{terminal.NOT_RUN} {name}: {reason}")
