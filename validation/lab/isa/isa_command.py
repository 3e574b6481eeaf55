"""Define the command `validation/run isa`."""

from dataclasses import fields
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from bokeh_validation import files, terminal
from bokeh_validation.errors import Unavailable
from lab.isa import compiled, radv

# How each language is compiled to SPIR-V
WAYS = {"glsl": "GLSL by glslang", "hlsl": "HLSL by DXC", "wgsl": "WGSL by naga"}
COLUMNS = tuple(field.name for field in fields(radv.Count))


def isa(
    table: Annotated[Path | None, typer.Option(metavar="FILE.tsv", help="Write the table here as well.")] = None,
) -> None:
    """Count instructions, registers and latency of every pass with the compiler for AMD's RDNA 2; the GPU is not
    needed.
    """
    terminal.check_writable(table)
    passes, found, missing, mesa = compiled.all_passes(), {}, {}, ""
    with terminal.progress("isa", len(WAYS)) as step:
        for language, way in WAYS.items():
            try:
                mesa, found[language] = radv.counts(compiled.code(passes, language))
            except Unavailable as error:
                missing[way] = str(error)
            step(way)
    rows = [
        [name, *(" / ".join(str(getattr(way[name], column)) for way in found.values()) for column in COLUMNS)]
        for name in (passes if found else ())
    ]
    if rows:
        shown = Table(title=f"{radv.TITLE}, Mesa {mesa}: {' / '.join(WAYS[language] for language in found)}")
        for heading in ("pass", *COLUMNS):
            shown.add_column(heading, justify="left" if heading == "pass" else "right")
        for row in rows:
            shown.add_row(*row)
        # a file or a pipe has no width
        Console(width=None if terminal.console.is_terminal else 130).print(shown)
    for way, reason in missing.items():
        terminal.console.print(f"{terminal.NOT_RUN} {way}: {reason}", highlight=False)
    if table is not None:
        lines = "".join("\t".join(row) + "\n" for row in rows)
        files.whole(table, lambda partial: partial.write_text(lines, encoding="ascii"))
    if not rows:
        terminal.end(False)
