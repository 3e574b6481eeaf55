"""Shader text in pieces: sections, functions and statements, in any of the three languages.

The layout is fixed, which is what makes this short: heads of functions begin in the first column, the braces of a body
have lines of their own. parity.py refuses what is laid out otherwise.
"""

import re
from dataclasses import dataclass, replace

RULE = "// " + "-" * 97 + "\n"
HEADING = re.compile(rf"^{RULE}// \[(\d+)\] (.+)\n{RULE}", re.MULTILINE)
FUNCTION = re.compile(
    r"^(?P<doc>(?://[^\n]*\n)*)(?P<head>(?:@\w+ )?\w+ (?P<name>\w+)\([^{};]*)\n(?P<body>\{\n.*?^\})$",
    re.MULTILINE | re.DOTALL,
)
COMMENT = re.compile(r"//[^\n]*")
HEAD_COMMENT = re.compile(r"(?://[^\n]*\n)*")
MARK = re.compile(r"// differs:(.*)")


@dataclass(frozen=True)
class Section:
    """A numbered section: [1] to [9] of a library, [10] and up of the layers; text without heading, from `line` on."""

    number: int
    title: str
    line: int
    text: str


@dataclass(frozen=True)
class Function:
    """A function; doc is the comment above it; start and end are character offsets of the body with its braces."""

    name: str
    doc: str
    head: str
    body: str
    line: int
    start: int
    end: int

    @property
    def text(self) -> str:
        """As the file has it."""
        return f"{self.doc}{self.head}\n{self.body}"


@dataclass(frozen=True)
class Statement:
    """A statement, the head of a loop, branch or function, a brace, a comment, a directive, or an empty line.

    words   without the spaces and line breaks that mean nothing
    source  as it stands there
    reason  of a deviation, from a `// differs: reason` at its end
    """

    words: str
    source: str
    line: int
    reason: str | None = None


def line_of(text: str, offset: int) -> int:
    """Number of the line, from 1."""
    return text.count("\n", 0, offset) + 1


def header(text: str) -> str:
    """What stands before the first section."""
    first = HEADING.search(text)
    return text[: first.start()] if first else text


def sections(text: str) -> list[Section]:
    """In the order of the text."""
    found = list(HEADING.finditer(text))
    ends = [*(heading.start() for heading in found[1:]), len(text)]
    return [
        Section(int(heading[1]), heading[2], line_of(text, heading.end()), text[heading.end() : end])
        for heading, end in zip(found, ends, strict=True)
    ]


def functions(text: str) -> list[Function]:
    """In the order of the text; in HLSL two of one name may stand in two branches of an #if."""
    return [
        Function(
            found["name"],
            found["doc"],
            found["head"],
            found["body"],
            line_of(text, found.start("head")),
            found.start("body"),
            found.end(),
        )
        for found in FUNCTION.finditer(text)
    ]


def code(text: str) -> str:
    """Without comments; the lines stay."""
    return COMMENT.sub("", text)


def statements(text: str, line: int = 1) -> list[Statement]:
    """All of a text, of which the first line has the number `line`; several empty lines are one."""
    found: list[Statement] = []
    parts: list[str] = []
    begun, depth, reason = line, 0, None
    for number, whole in enumerate(text.split("\n"), line):
        own = whole.strip()
        if not own or own.startswith(("//", "#")):
            if own or not found or found[-1].words:
                mark = MARK.search(own) if own.startswith("#") else None
                kept = own[: mark.start()] if mark else own
                found.append(Statement(" ".join(kept.split()), whole, number, mark[1].strip() if mark else None))
            continue
        comment = COMMENT.search(whole)
        for piece in re.findall(r"[^;{}()\[\]]+|.", code(whole)):
            if not parts and not piece.strip():
                continue
            begun = begun if parts else number
            parts.append(piece)
            depth += (piece in "([") - (piece in ")]")
            if piece in ";{}" and depth == 0:
                found.append(_statement(parts, begun, reason))
                parts, reason = [], None
        parts += ["\n"] if parts else []
        mark = MARK.match(comment[0]) if comment else None
        if mark and parts:
            reason = mark[1].strip()
        elif mark and found[-1].words != "}":
            found[-1] = replace(found[-1], reason=mark[1].strip())
        elif comment:
            found.append(Statement(comment[0], comment[0], number))
    if parts:
        found.append(_statement(parts, begun, reason))
    return found


def _statement(parts: list[str], line: int, reason: str | None) -> Statement:
    source = "".join(parts)
    return Statement(re.sub(r"\s*([^\w\s])\s*", r"\1", " ".join(source.split())), source, line, reason)
