"""The command line of validation/run. Each command is in its feature's own module, loaded when it is called."""

import importlib
import os
import signal
import sys
from pathlib import Path
from typing import Annotated

import typer
from typer.core import TyperGroup
from typer.exceptions import TyperException

from bokeh_validation import __version__
from bokeh_validation.errors import Unavailable, UserError
from bokeh_validation.jobs import end_programs

EXIT_BAD_INPUT = 2

# name -> module and function
COMMANDS = {
    "doctor": ("doctor", "doctor"),
    "compile": ("compilers.compile", "compile_all"),
    "check": ("check", "check"),
    "render": ("render", "render"),
    "compare": ("compare", "compare"),
    "plan": ("frame.plan", "plan"),
    "aperture": ("frame.aperture", "aperture"),
    "truth": ("truth", "truth"),
    "gallery": ("truth.gallery", "gallery"),
    "peers": ("truth.peers", "peers"),
    "demo": ("demo", "demo"),
    "figures": ("figures", "figures"),
    "probes": ("probes", "probes"),
    "parity": ("shaders.parity", "parity"),
    "bench": ("bench", "bench"),
    "port": ("frame.port", "port"),
    "isa": ("isa.isa_command", "isa"),
    "mutants": ("mutants.mutants_command", "mutants"),
    "engines": ("engines", "engines"),
    "release": ("release", "release"),
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
    full: Annotated[
        bool, typer.Option("--full", help="Every driver, compiler, probe, scene and engine's sample: eleven minutes.")
    ] = False,
    adapter: Annotated[
        str | None, typer.Option("--adapter", help="Part of a device's name; a wrong one lists them.")
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE.html", help="The report; else in the cache folder.")
    ] = None,
) -> None:
    """Validate the polygonal bokeh shaders. Without a command: all languages in brief, in two minutes, and a report."""
    if version:
        print(__version__)
    elif context.invoked_subcommand is None:
        from bokeh_validation.run import validate

        validate.validate(full, adapter, output)


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
    end_programs()
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:  # closed by the caller
            stream.flush()
    os._exit(code if isinstance(code, int) else 0)


def _stop(*_) -> None:
    """A request to end is as an interruption from the keyboard; a second one does not disturb the first."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    raise KeyboardInterrupt


def _refuse(message: str) -> int:
    print(f"error: {message}", file=sys.stderr)
    return EXIT_BAD_INPUT
