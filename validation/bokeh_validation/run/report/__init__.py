"""One self-contained HTML page: a grid of probes by drivers, and the details that its cells lead to."""

import datetime
from pathlib import Path

import jinja2

from bokeh_validation import __version__, files
from bokeh_validation.mutants import mutants_command
from bokeh_validation.probes.sections import DIFFERENCE_STEPS, drivers_of


def write(path: Path, found) -> None:
    """Write the page of a validate.Everything."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("bokeh_validation.run.report", "."),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    page = environment.get_template("page.html").render(
        version=__version__,
        date=datetime.datetime.now().astimezone().strftime("%Y-%m-%d %H:%M %Z"),
        found=found,
        drivers=drivers_of(found.drawn),
        adapters={name: text for section in found.drawn for name, text in section.adapters.items()},
        mutants=mutants_command.read(),
        difference_steps=DIFFERENCE_STEPS,
    )
    files.whole(path, lambda partial: partial.write_text(page, encoding="utf-8"))
