"""Shader text to tokens, sections and top-level items. One tokenizer reads HLSL, GLSL and WGSL alike."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

TOKEN = re.compile(
    r"""
    (?P<comment>//[^\n]*|/\*.*?(?:\*/|\Z))
    |(?P<space>\s+)
    |(?P<number>0[xX][0-9a-fA-F]+[uUiI]?|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?[fFhHiIlLuU]*)
    |(?P<name>[A-Za-z_][A-Za-z0-9_]*)
    |(?P<operator><<=|>>=|->|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||\+=|-=|\*=|/=|%=|&=|\|=|\^=|[-+*/%<>=!&|^~?:;,.(){}\[\]@])
    """,
    re.VERBOSE | re.DOTALL | re.ASCII,
)
DIRECTIVE = re.compile(r"#(?:(?!//)[^\n])*")
# A heading is three comment lines: a rule, '// [3] Listing 1: circle of confusion', a rule.
RULE = re.compile(r"// -{40,}")
HEADING = re.compile(r"// \[(\d)\] (.+)")
MARKER = re.compile(r"// differs:(.*)", re.DOTALL)

OPENING, CLOSING = ("(", "[", "{"), (")", "]", "}")
# First words of top-level blocks that are no functions.
BLOCKS = ("struct", "cbuffer", "tbuffer", "uniform", "buffer", "in", "out")


@dataclass(frozen=True)
class Token:
    """A piece of shader text. `kind`: comment, directive, number, name, operator or unknown.

    line, end_line  1-based lines of its first and last character
    start, end      character offsets
    first           nothing but space stands before it on its line
    """

    kind: str
    text: str
    line: int
    end_line: int
    start: int
    end: int
    first: bool


@dataclass(frozen=True)
class Item:
    """What stands between functions or is one. `kind`: function, block, call, declaration, directive, comment, broken.

    doc     comment lines right above it
    reason  of a deviation, from a trailing `// differs: reason`
    """

    kind: str
    tokens: tuple[Token, ...]
    doc: tuple[Token, ...] = ()
    reason: str | None = None

    @property
    def line(self) -> int:
        """Line of its first token."""
        return self.tokens[0].line

    @property
    def code(self) -> tuple[Token, ...]:
        """Its tokens without comments and directives."""
        return tuple(token for token in self.tokens if token.kind not in ("comment", "directive"))


@dataclass
class Section:
    """A numbered section of a library: [1] to [9]."""

    number: int
    title: str
    line: int
    tokens: list[Token] = field(default_factory=list)

    @property
    def items(self) -> list[Item]:
        """Its top-level items."""
        return items(self.tokens)


# files, and every directive of theirs
@lru_cache(maxsize=512)
def tokenize(text: str) -> tuple[Token, ...]:
    """All tokens but space. Characters of no token become kind 'unknown', so that nothing is passed over in silence."""
    tokens: list[Token] = []
    position, line, line_start = 0, 1, True
    while position < len(text):
        found = DIRECTIVE.match(text, position) if line_start else None
        kind = "directive"
        if found is None:
            found = TOKEN.match(text, position)
            kind = (found.lastgroup or "unknown") if found else "unknown"
        piece = found.group() if found else text[position]
        end, end_line = position + len(piece), line + piece.count("\n")
        if kind == "space":
            line_start = line_start or "\n" in piece
        else:
            tokens.append(Token(kind, piece, line, end_line, position, end, line_start))
            line_start = False
        position, line = end, end_line
    return tuple(tokens)


def marked_reason(token: Token) -> str | None:
    """Reason of a trailing `// differs: reason`; None for every other token."""
    if token.kind != "comment" or token.first:
        return None
    found = MARKER.fullmatch(token.text)
    return found[1].strip() if found else None


def sections(tokens: Sequence[Token]) -> tuple[list[Token], list[Section]]:
    """Tokens before the first heading, and the sections in the order of the text."""
    header: list[Token] = []
    found: list[Section] = []
    index = 0
    while index < len(tokens):
        heading = _heading(tokens[index : index + 3])
        if heading:
            found.append(heading)
            index += 3
            continue
        (found[-1].tokens if found else header).append(tokens[index])
        index += 1
    return header, found


def _heading(three: Sequence[Token]) -> Section | None:
    if len(three) < 3 or any(token.kind != "comment" or not token.first for token in three):
        return None
    upper, title, lower = three
    named = HEADING.fullmatch(title.text)
    if not (named and RULE.fullmatch(upper.text) and RULE.fullmatch(lower.text)):
        return None
    return Section(int(named[1]), named[2], title.line)


def items(tokens: Sequence[Token]) -> list[Item]:
    """Top-level items in the order of the text."""
    found: list[Item] = []
    comments: list[Token] = []  # a block of comment lines that may turn out to be the doc comment of what follows

    def flush() -> None:
        if comments:
            found.append(Item("comment", tuple(comments)))
            comments.clear()

    index = 0
    while index < len(tokens):
        token = tokens[index]
        if token.kind == "comment":
            reason = marked_reason(token)
            if reason is not None and found and found[-1].tokens[-1].end_line == token.line and not comments:
                found[-1] = replace(found[-1], reason=reason)
            else:
                if comments and comments[-1].end_line + 1 != token.line:
                    flush()
                comments.append(token)
            index += 1
            continue
        attached = bool(comments) and comments[-1].end_line + 1 == token.line and token.kind != "directive"
        if not attached:
            flush()
        kind, end = ("directive", index + 1) if token.kind == "directive" else _extent(tokens, index)
        found.append(Item(kind, tuple(tokens[index:end]), tuple(comments)))
        comments.clear()
        index = end
    flush()
    return found


def _extent(tokens: Sequence[Token], start: int) -> tuple[str, int]:
    """Kind of the item that begins at `start`, and the index behind it."""
    if _text(tokens, start + 1) == "(" and tokens[start].kind == "name" and tokens[start].text != "layout":
        end = matching(tokens, start + 1)
        if end is None:
            return "broken", len(tokens)
        return "call", end + 2 if _text(tokens, end + 1) == ";" else end + 1
    index, assigned = start, False
    while index < len(tokens):
        text = tokens[index].text if tokens[index].kind == "operator" else ""
        assigned = assigned or text == "="
        if text == ";":
            return "declaration", index + 1
        if text in CLOSING:
            return "broken", index + 1
        if text in OPENING:
            end = matching(tokens, index)
            if end is None:
                return "broken", len(tokens)
            if text == "{" and not assigned:  # behind a `=` it is a list of values
                kind = "block" if _is_block(tokens[start:index]) else "function"
                semicolon = kind == "block" and _text(tokens, end + 1) == ";"
                return kind, end + 2 if semicolon else end + 1
            index = end
        index += 1
    return "broken", len(tokens)


def _is_block(head: Sequence[Token]) -> bool:
    """Whether the tokens before a `{` begin a struct, constant buffer or interface block."""
    code = [token for token in head if token.kind not in ("comment", "directive")]
    if code and code[0].text == "layout":
        code = code[(matching(code, 1) or 0) + 1 :]
    return bool(code) and code[0].text in BLOCKS and not any(token.text == "fn" for token in code)


def _text(tokens: Sequence[Token], index: int) -> str:
    return tokens[index].text if index < len(tokens) else ""


def matching(tokens: Sequence[Token], start: int) -> int | None:
    """Index of the bracket that closes the one at `start`; None where brackets do not match."""
    waiting: list[str] = []
    for index in range(start, len(tokens)):
        if tokens[index].kind != "operator":
            continue
        text = tokens[index].text
        if text in OPENING:
            waiting.append(CLOSING[OPENING.index(text)])
        elif text in CLOSING:
            if not waiting or waiting.pop() != text:
                return None
            if not waiting:
                return index
    return None
