"""Line numbers in compilers' messages, from those of the complete program back to those of the package's files."""

import re
from pathlib import Path

from bokeh_validation import paths

# how each compiler writes a place, up to the line number: glslang and glslc, mesa, DXC and fxc, naga
PLACE = re.compile(r"(?<![\w.])(?:shader\.(?:vert|frag|glsl)|0|bokeh\.hlsl|wgsl):(\d+)(?=[:(])")


def located(message: str, source: str, language: str) -> str:
    """Replace each place by one like bokeh.glsl:251. A message on the lines before the files is left as it is.

    source  the program that was compiled: lines of its own (version, defines), then the three files
    """
    files = [paths.library(language), paths.layers(language), paths.passes(language)]
    lengths = [len(_lines(file)) for file in files]
    head = len(source.splitlines()) - sum(lengths)

    def place(match: re.Match) -> str:
        line = int(match[1]) - head
        for file, length in zip(files, lengths, strict=True):
            if 1 <= line <= length:
                return f"{file.name}:{line}"
            line -= length
            if line < 1:
                break
        return match[0]

    return PLACE.sub(place, message) if head >= 0 else message


def _lines(file: Path) -> list[str]:
    return file.read_text(encoding="ascii").splitlines()
