"""The command `validation/run engines`."""

import os
from typing import Annotated

import typer

from bokeh_validation.engines import ENGINES, Broken, Capture, run
from bokeh_validation.errors import Unavailable, UserError
from bokeh_validation.terminal import FAILED, NOT_RUN, OK, console, end, progress


def engines(
    names: Annotated[list[str] | None, typer.Argument(metavar="[NAME]...", help="By default all quick ones.")] = None,
    everything: Annotated[bool, typer.Option("--all", help="The slow ones as well (Bevy builds for minutes).")] = False,
) -> None:
    """Build and run the samples of integration/, each compared with the reference on its own colour and depth."""
    for name in names or []:
        if name not in ENGINES:
            raise UserError(f"engine {name}: no such sample. Give some of {', '.join(ENGINES)}.")
    _, passed = run_all(names or (list(ENGINES) if everything else quick_ones()))
    end(passed)


def quick_ones() -> list[str]:
    """Those that are built within a minute."""
    return [name for name, engine in ENGINES.items() if not engine.slow]


def run_all(names: list[str]) -> tuple[list[Capture], bool]:
    """Captures of the samples that ran, and whether none failed; under CI none may be missing either."""
    captures, passed = [], True
    with progress("engine", len(names)) as step:
        for name in names:
            capture, ok = _run(name)
            captures += [capture] if capture else []
            passed &= ok
            step(name)
    return captures, passed


def _run(name: str) -> tuple[Capture | None, bool]:
    """(capture, whether that is well), printed."""
    try:
        capture = run(name)
    except Unavailable as error:
        console.print(f"{NOT_RUN} {name}: {error}", highlight=False)
        return None, not os.environ.get("CI")
    except (RuntimeError, Broken) as error:
        console.print(f"{FAILED} {name}: {error}", highlight=False)
        return None, False
    console.print(f"{name}: {capture.engine} on {capture.device}", highlight=False)
    for shot in capture.shots:
        state = OK if shot.comparison.ok else FAILED
        where = "".join(f"; {name}: {count}" for name, count in shot.outside.items())
        console.print(f"  {shot.name}: {shot.comparison}{where} {state}", highlight=False)
    return capture, capture.ok
