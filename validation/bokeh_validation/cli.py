"""The command line of validation/run. Each command is in its feature's own module, loaded when it is called."""

import importlib
import os
import signal
import sys
from typing import Annotated

import typer
from typer.core import TyperGroup
from typer.exceptions import TyperException

from bokeh_validation import __version__
from bokeh_validation.errors import Unavailable, UserError

EXIT_BAD_INPUT = 2

# name -> module and function
COMMANDS = {
    "doctor": ("doctor", "doctor"),
    "compile": ("matrix", "compile_programs"),
    "sm3": ("sm3", "sm3"),
    "render": ("render", "render"),
    "plan": ("frame", "plan"),
    "aperture": ("aperture_command", "aperture"),
    "shapes": ("quality", "shapes"),
    "truth": ("likeness", "truth"),
    "figures": ("figures.command", "figures"),
    "patterns": ("suite", "patterns_command"),
    "parity": ("parity", "parity"),
    "precision": ("half.table", "precision"),
    "report": ("suite", "report"),
    "bench": ("bench.bench_command", "bench"),
    "mutants": ("mutants.mutants_command", "mutants"),
    "engines": ("engines.engines_command", "engines"),
}


class Commands(TyperGroup):
    """Loads a command's module when it is asked for: the start stays quick."""

    def list_commands(self, _):
        """In the order of COMMANDS."""
        return list(COMMANDS)

    def get_command(self, _, name):
        """The command, or None where there is none of that name."""
        if name not in COMMANDS:
            return None
        module, function = COMMANDS[name]
        one = typer.Typer(add_completion=False, rich_markup_mode=None, context_settings=HELP)
        one.command(name)(getattr(importlib.import_module(f"bokeh_validation.{module}"), function))
        return typer.main.get_command(one)


HELP = {"help_option_names": ["-h", "--help"]}
app = typer.Typer(
    cls=Commands, add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False, context_settings=HELP
)


@app.callback(invoke_without_command=True)
def default(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False,
    quick: Annotated[
        bool, typer.Option("--quick", help="One driver, few variants: a first answer within a minute.")
    ] = False,
    adapter: Annotated[
        str | None, typer.Option("--adapter", help="Part of a device's name, or its number; see doctor.")
    ] = None,
) -> None:
    """Validate the polygonal bokeh shaders. Without a command: doctor, compile, patterns and report."""
    if version:
        print(__version__)
    elif context.invoked_subcommand is None:
        from bokeh_validation import suite

        suite.validate(adapter, quick)


def main() -> None:
    """Run the command line; every refusal is one line on standard error and exit code 2."""
    signal.signal(signal.SIGTERM, _stop)
    try:
        code = app(standalone_mode=False)
    except UserError as error:
        code = _refuse(str(error))
    except Unavailable as error:
        code = _refuse(f"not on this machine: {error}")
    except TyperException as error:
        text = error.format_message() if hasattr(error, "format_message") else str(error)
        code = _refuse(f"{' '.join(text.split())} See validation/run --help.")
    except (KeyboardInterrupt, typer.Abort):
        code = _refuse("stopped")
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = 0
    _end_programs()
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:  # closed by the caller
            stream.flush()
    # Mesa's and wgpu's libraries tear down in an order of their own; nothing is left to save here.
    os._exit(code if isinstance(code, int) else 0)


def _stop(*_) -> None:
    """A request to end is as an interruption from the keyboard; a second one does not disturb the first."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    raise KeyboardInterrupt


def _end_programs() -> None:
    """os._exit() runs no exit handlers: end Wine and its display here, if they were used at all."""
    windows = sys.modules.get("bokeh_validation.windows.wine")
    if windows:
        windows.stop()


def _refuse(message: str) -> int:
    print(f"error: {message}", file=sys.stderr)
    return EXIT_BAD_INPUT
