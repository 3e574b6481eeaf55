"""Define the command line of validation/run. Each command is a function of its name in its feature's own module."""

import importlib
import os
import signal
import sys
from pathlib import Path
from typing import Annotated

import typer
from typer.exceptions import TyperException

from bokeh_validation import __version__, terminal
from bokeh_validation.errors import Unavailable, UserError
from bokeh_validation.process import end_programs

# Name of a command -> the module with its function. The modules of the lab and of the samples are named only here: the
# core runs without them.
COMMANDS = {
    "doctor": "bokeh_validation.doctor",
    "compile": "bokeh_validation.run.commands",
    "check": "bokeh_validation.check",
    "render": "bokeh_validation.render",
    "compare": "bokeh_validation.compare",
    "plan": "bokeh_validation.plan",
    "aperture": "bokeh_validation.frame.decomposition",
    "probes": "bokeh_validation.run.commands",
    "parity": "bokeh_validation.shaders.parity",
    "generate": "bokeh_validation.generate",
    "engines": "engines.engines_command",
    "demo": "lab.demo",
    "truth": "lab.truth_command",
    "pictures": "lab.documents.pictures_command",
    "peers": "lab.other_effects",
    "bench": "lab.bench",
    "isa": "lab.isa.isa_command",
    "mutants": "lab.mutants.mutants_command",
}
# The shell's exit code for an interrupted command; typer uses it too
INTERRUPTED = 130
# Commands whose function has another name
FUNCTIONS = {"compile": "compile_all", "pictures": "draw_pictures"}


def application() -> typer.Typer:
    """Return the command line with the command that was named, or with all commands for --help.

    Importing only the module of that command keeps the start quick.
    """
    app = typer.Typer(
        add_completion=False,
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    app.callback(invoke_without_command=True)(default)
    named_command = [word for word in sys.argv[1:] if word in COMMANDS][:1]
    for name in named_command or (COMMANDS if {"-h", "--help"} & set(sys.argv) else ()):
        module = importlib.import_module(COMMANDS[name])
        app.command(name)(getattr(module, FUNCTIONS.get(name, name)))
    return app


def default(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False,
    full: Annotated[
        bool, typer.Option("--full", help="Every driver, compiler, probe and engine's sample: twelve minutes.")
    ] = False,
    adapter: terminal.Adapter = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="FILE.html", help="Where to write the report. Default: the cache folder."
        ),
    ] = None,
) -> None:
    """Validate the polygonal bokeh shaders. Without a command: all languages in brief, in a minute, and a report."""
    if version:
        print(__version__)
    elif context.invoked_subcommand is None:
        from bokeh_validation.run import validate

        # only the full run needs the samples
        samples = importlib.import_module("engines").QUICK if full else ()
        validate.validate(full, adapter, output, samples)


def main() -> None:
    """Run the command line; a refused input ends it with one line on standard error and exit code 2."""
    signal.signal(signal.SIGTERM, _stop)
    try:
        code = application()(standalone_mode=False)
    except (UserError, Unavailable) as error:
        code = _refuse(str(error))
    except TyperException as error:
        text = error.format_message() if hasattr(error, "format_message") else str(error)
        code = _refuse(f"{' '.join(text.split())} See validation/run --help.")
    except (KeyboardInterrupt, typer.Abort):
        code = INTERRUPTED
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = 0
    if code == INTERRUPTED:
        _refuse("stopped")
    end_programs()
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:  # closed by the caller
            stream.flush()
    os._exit(code if isinstance(code, int) else 0)


def _stop(*_) -> None:
    """Treat SIGTERM like an interruption from the keyboard, and ignore further ones while the program ends."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    raise KeyboardInterrupt


def _refuse(message: str) -> int:
    print(f"error: {message}", file=sys.stderr)
    return 2
