"""What every guide in integration/NAME/ must keep to, so that none goes stale. For the tests of the samples.

A test of a guide is three lines:

    def test_guide():
        guides.assert_guide(FOLDER)
        guides.assert_quoted(FOLDER / "README.md", [FOLDER / "sample.py", ...])
"""

import ast
import re
import textwrap
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image

# The second-level headings of every guide, in this order
HEADINGS = (
    "Inputs",
    "Depth convention",
    "Colour space",
    "Orientation",
    "Where it goes",
    "Code",
    "What you should see",
    "Troubleshooting",
    "Take it out again",
)
# Languages of fenced blocks that are commands and their output, not code
COMMANDS = ("sh", "console")
PICTURE_BYTES = 300_000
_FENCE = re.compile(
    r"^(?P<indent> *)```(?P<language>[^\n`]*)\n(?P<text>.*?)^(?P=indent)```\s*$", re.MULTILINE | re.DOTALL
)


@dataclass(frozen=True)
class Block:
    """A fenced code block: its language as written, its text without common indentation, the line it begins at."""

    language: str
    text: str
    line: int


def blocks(readme: Path | str) -> list[Block]:
    """Every fenced block of a guide, or of a text, commands too."""
    text = readme.read_text(encoding="utf-8") if isinstance(readme, Path) else readme
    assert len(re.findall(r"^ *```", text, re.MULTILINE)) % 2 == 0, f"{readme}: a code block is not closed"
    return [
        Block(found["language"].strip(), _dedented(found["text"]), text.count("\n", 0, found.start()) + 2)
        for found in _FENCE.finditer(text)
    ]


def is_quoted(block: str, text: str) -> bool:
    """Whether lines that follow each other in `text` are the block's, ignoring the indentation that they share."""
    wanted = _lines(block)
    lines = text.splitlines()
    windows = (lines[start : start + len(wanted)] for start in range(len(lines) - len(wanted) + 1))
    return bool(wanted) and any(_lines("\n".join(window)) == wanted for window in windows)


def assert_quoted(readme: Path, files: Iterable[Path]) -> None:
    """Every block but commands is a verbatim piece of one of the files, which the sample runs or compiles."""
    texts = {path.name: path.read_text(encoding="utf-8") for path in files}
    code = [block for block in blocks(readme) if block.language not in COMMANDS]
    assert code, f"{readme}: no code"
    for block in code:
        found = any(is_quoted(block.text, text) for text in texts.values())
        assert found, f"{readme}:{block.line}: in none of {', '.join(texts)}:\n{block.text}"


def section(readme: Path, heading: str) -> str:
    """The text under a heading of any level, up to the next heading of that level or a higher one."""
    text = readme.read_text(encoding="utf-8")
    # no heading is looked for inside code
    marks = _FENCE.sub(lambda found: "".join("\n" if c == "\n" else " " for c in found[0]), text)
    found = re.search(rf"^(#+) {re.escape(heading)}[ \t]*$", marks, re.MULTILINE)
    assert found, f"{readme}: no heading {heading!r}"
    end = re.search(rf"^#{{1,{len(found[1])}}} ", marks[found.end() :], re.MULTILINE)
    return text[found.end() : found.end() + end.start() if end else len(text)]


def code_lines(text: str, comment: str = "//") -> list[str]:
    """The lines that count as written: not the empty ones, not comments; in Python (comment '#') no docstrings."""
    prose = _docstrings(text) if comment == "#" else set()
    lines = [line.strip() for number, line in enumerate(text.splitlines(), 1) if number not in prose]
    return [line for line in lines if line and not line.startswith(comment)]


def assert_headings(readme: Path) -> None:
    """The second-level headings are HEADINGS, in their order."""
    outside_code = _FENCE.sub("", readme.read_text(encoding="utf-8"))
    found = re.findall(r"^## (.*?)\s*$", outside_code, re.MULTILINE)
    assert found == list(HEADINGS), f"{readme}: {found}"


def assert_links(readme: Path) -> None:
    """Every relative link and picture leads somewhere."""
    outside_code = _FENCE.sub("", readme.read_text(encoding="utf-8"))
    for target in re.findall(r"\]\(([^)#]+)[^)]*\)", outside_code):
        if not re.match(r"[a-z]+:", target):
            assert (readme.parent / target).exists(), f"{readme}: {target}"


def assert_picture(path: Path) -> None:
    """A PNG that opens, of a size that a repository can bear."""
    assert path.stat().st_size < PICTURE_BYTES, f"{path}: {path.stat().st_size} bytes"
    with Image.open(path) as picture:
        assert picture.format == "PNG" and min(picture.size) >= 100, f"{path}: {picture.format} {picture.size}"


def assert_same_picture(drawn: Path, shown: Path) -> None:
    """A picture drawn again is the one that a guide shows, but for rounding: half a step of 255 on average."""
    with Image.open(drawn) as a, Image.open(shown) as b:
        assert a.size == b.size, f"{shown}: {b.size}, now {a.size}"
        off = np.abs(np.asarray(a.convert("RGB"), float) - np.asarray(b.convert("RGB"), float)).mean()
    assert off < 0.5, f"{shown} is not what the sample draws: {off:.2f} of 255 off on average"


def assert_guide(folder: Path) -> None:
    """Headings, links and picture of integration/NAME/, and that it shows its picture."""
    readme = folder / "README.md"
    assert_headings(readme)
    assert_links(readme)
    assert_picture(folder / "picture.png")
    assert "](picture.png)" in readme.read_text(encoding="utf-8"), f"{readme} does not show picture.png"


def _docstrings(text: str) -> set[int]:
    """Numbers of the lines that docstrings take."""
    numbers: set[int] = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(node) is not None:
            numbers.update(range(node.body[0].lineno, node.body[0].end_lineno + 1))
    return numbers


def _lines(text: str) -> list[str]:
    return [line.rstrip() for line in _dedented(text).splitlines()]


def _dedented(text: str) -> str:
    # empty lines around a block are no part of it
    return textwrap.dedent(text).strip("\n").rstrip()
