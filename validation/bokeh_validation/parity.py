"""The three languages as three columns: the libraries must read as one, and this is what checks it.

A line that has to deviate carries `// differs: reason` behind it. The statement it stands on is then exempt, and the
reason must be found in docs/paper.md. Everything else that is not porting (listing/normal.py) is a difference.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from os import PathLike, fspath

from rich.console import Console
from rich.table import Table
from rich.text import Text

from bokeh_validation import paths
from bokeh_validation.errors import UserError
from bokeh_validation.listing import configuration, normal, passes, rules
from bokeh_validation.listing.difference import Difference, first_unequal
from bokeh_validation.listing.normal import Function, Statement
from bokeh_validation.listing.rows import agree, is_marked, rows
from bokeh_validation.listing.syntax import Item, Section, items, marked_reason, sections, tokenize

LANGUAGES = paths.LANGUAGES
PAPER = "docs/paper.md"
LIBRARY = {language: f"{language}/bokeh.{language}" for language in LANGUAGES}
PASSES = {language: f"{language}/bokeh_passes.{language}" for language in LANGUAGES}
NUMBERS = tuple(range(1, 10))
CONFIGURATION, PORTING = 1, 2

# The one thing that the comments of [1] may say in words of their own: how a value is set.
HOW_TO_SET = {
    "hlsl": "define it before this file",
    "glsl": "define it before this file",
    "wgsl": "an override constant",
}

Texts = Mapping[str | PathLike, str]


@dataclass(frozen=True)
class Deviation:
    """A line marked with `// differs: reason`."""

    file: str
    line: int
    reason: str


@dataclass(frozen=True)
class Library:
    """A parsed `bokeh.*`.

    others    section -> items that are neither functions nor comments
    comments  section -> comment lines that belong to no function
    """

    language: str
    header: tuple[str, ...]
    sections: tuple[Section, ...]
    functions: tuple[Function, ...]
    others: Mapping[int, tuple[Item, ...]]
    comments: Mapping[int, tuple[str, ...]]

    def named(self, name: str) -> Function | None:
        """The first function of a name."""
        return next((function for function in self.functions if function.name == name), None)


def check(texts: Texts | None = None) -> list[Difference]:
    """Every difference between the languages; empty where all is well.

    `texts`: path from the top of the checkout ('hlsl/bokeh.hlsl', ..., 'docs/paper.md') -> text that stands in for
    that file; files not named are read from the checkout.
    """
    files = _files(texts)
    libraries = {language: library(language, files[LIBRARY[language]]) for language in LANGUAGES}
    found = list(_rules(files))
    for compare in (_headers, _sections, _functions, _comments):
        found += compare(libraries)
    found += configuration.check(
        {language: one.others.get(CONFIGURATION, ()) for language, one in libraries.items()},
        {language: one.comments.get(CONFIGURATION, ()) for language, one in libraries.items()},
    )
    found += _passes(tuple(files[PASSES[language]] for language in LANGUAGES))
    found += _reasons(files)
    return found


def deviations(texts: Texts | None = None) -> list[Deviation]:
    """Every marked deviation, in the order of the files."""
    return _deviations(_files(texts))


def columns(function_name: str, texts: Texts | None = None) -> dict[str, str]:
    """Language -> text of a library function with its doc comment; empty where the language lacks it."""
    found = _named(function_name, texts)
    return {language: function.text if function else "" for language, function in found.items()}


def render_columns(function_name: str, console: Console | None = None, texts: Texts | None = None) -> None:
    """Print a library function in three columns, statement beside statement: differences red, marked lines yellow."""
    found = _named(function_name, texts)
    present = {language: function for language, function in found.items() if function}
    table = Table(title=function_name, show_lines=False, expand=True)
    for language in LANGUAGES:
        table.add_column(language.upper(), ratio=1, overflow="fold")
    docs = {language: "\n".join(function.doc) for language, function in present.items()}
    _add_row(table, docs, _style(len(set(docs.values())) == 1))
    heads = {language: function.signature for language, function in present.items()}
    _add_row(table, heads, _style(not list(_signatures(function_name, present)), _any_reason(present.values())))
    for row in rows({language: function.statements for language, function in present.items()}):
        lines = {language: _with_reason(statement) for language, statement in row.items() if statement}
        _add_row(table, lines, _style(agree(row), _any_reason(row.values())))
    _add_row(table, {language: "}" for language in present}, "")
    (console or Console()).print(table)


def _with_reason(statement: Statement) -> str:
    return statement.source + (f" // differs: {statement.reason}" if is_marked(statement) else "")


def _any_reason(found: Iterable[Function | Statement | None]) -> bool:
    return any(one.reason is not None for one in found if one)


def _style(same: bool, marked: bool = False) -> str:
    return "" if same and not marked else ("yellow" if same else "red")


def _add_row(table: Table, cells: Mapping[str, str], style: str) -> None:
    table.add_row(*(Text(cells.get(language, ""), style=style) for language in LANGUAGES))


# ----------------------------------------------------------------------------------------------------------------------
# reading
# ----------------------------------------------------------------------------------------------------------------------


def _files(texts: Texts | None) -> dict[str, str]:
    """All six shader files and docs/paper.md by their path, from `texts` or the checkout."""
    given = {fspath(key).replace("\\", "/"): text for key, text in (texts or {}).items()}
    known = [*LIBRARY.values(), *PASSES.values(), PAPER]
    unknown = sorted(set(given) - set(known))
    if unknown:
        raise UserError(f"{unknown[0]}: not a file of the parity check. It knows {', '.join(known)}.")
    return {key: given[key] if key in given else _read(key) for key in known}


def _read(key: str) -> str:
    path = paths.ROOT / key
    if not path.exists() and key == PAPER:
        return ""
    try:
        # As it is: what is not UTF-8, and every kind of line end, is the rules' business.
        return path.read_bytes().decode("utf-8", errors="surrogateescape")
    except OSError as error:
        raise UserError(f"{key}: cannot be read ({error.strerror}). Run this in a complete checkout.") from error


@lru_cache(maxsize=256)
def library(language: str, text: str) -> Library:
    """A library file parsed."""
    header, found = sections(tokenize(text))
    functions: list[Function] = []
    others: dict[int, tuple[Item, ...]] = {}
    comments: dict[int, tuple[str, ...]] = {}
    for section in found:
        rest: list[Item] = []
        lines: list[str] = []
        for item in section.items:
            function = normal.function(item, language, section.number, text) if item.kind == "function" else None
            if function:
                functions.append(function)
            elif item.kind == "comment":
                lines += [token.text for token in item.tokens]
            else:
                rest.append(item)
                lines += [token.text for token in item.doc]
        others[section.number] = (*others.get(section.number, ()), *rest)
        comments[section.number] = (*comments.get(section.number, ()), *lines)
    return Library(language, tuple(token.text for token in header), tuple(found), tuple(functions), others, comments)


def _named(name: str, texts: Texts | None) -> dict[str, Function | None]:
    files = _files(texts)
    libraries = {language: library(language, files[LIBRARY[language]]) for language in LANGUAGES}
    names = list(dict.fromkeys(function.name for one in libraries.values() for function in one.functions))
    if name not in names:
        raise UserError(f"no function {name!r} in the libraries. There are: {', '.join(names)}.")
    return {language: one.named(name) for language, one in libraries.items()}


def _at(line: int, text: str) -> str:
    return f"line {line}: {' '.join(text.split())}"


# ----------------------------------------------------------------------------------------------------------------------
# rules of each file
# ----------------------------------------------------------------------------------------------------------------------


# The tests change one file a thousand times over: what was found in the others is kept.
KEPT = 64


def _rules(files: Mapping[str, str]) -> Iterator[Difference]:
    for language in LANGUAGES:
        yield from _library_rules(language, files[LIBRARY[language]])
        yield from _passes_rules(language, files[PASSES[language]])


@lru_cache(maxsize=KEPT)
def _library_rules(language: str, text: str) -> tuple[Difference, ...]:
    one = library(language, text)
    later = [function for function in one.functions if function.section > PORTING]
    findings = [
        *rules.text_findings(text),
        *rules.token_findings(tokenize(text)),
        *rules.name_findings([item for part in one.sections for item in part.items], language),
        *(finding for function in later for finding in rules.sampling_findings(function)),
        *(finding for function in later for finding in rules.portable_findings(function)),
        *((line, what, function.name) for function in later for line, what in function.problems),
    ]
    key = LIBRARY[language]
    return tuple(Difference(f"{key}:{line}", what, {language: line_text}) for line, what, line_text in findings)


@lru_cache(maxsize=KEPT)
def _passes_rules(language: str, text: str) -> tuple[Difference, ...]:
    tokens = tokenize(text)
    top = items(tokens)
    entries = [normal.function(item, language, 0, text) for item in top if item.kind == "function"]
    findings = [
        *rules.text_findings(text),
        *rules.token_findings(tokens),
        *rules.name_findings(top, language, exempt=("main",) if language == "glsl" else ()),
        *(finding for entry in entries if entry for finding in rules.sampling_findings(entry)),
    ]
    key = PASSES[language]
    return tuple(Difference(f"{key}:{line}", what, {language: line_text}) for line, what, line_text in findings)


@lru_cache(maxsize=KEPT)
def _passes(texts: tuple[str, ...]) -> tuple[Difference, ...]:
    return tuple(passes.check(dict(zip(LANGUAGES, texts, strict=True))))


def _deviations(files: Mapping[str, str]) -> list[Deviation]:
    return [one for key in (*LIBRARY.values(), *PASSES.values()) for one in _marked(key, files[key])]


@lru_cache(maxsize=KEPT)
def _marked(key: str, text: str) -> tuple[Deviation, ...]:
    return tuple(
        Deviation(key, token.line, reason) for token in tokenize(text) if (reason := marked_reason(token)) is not None
    )


def _reasons(files: Mapping[str, str]) -> Iterator[Difference]:
    """Every reason for a deviation stands in docs/paper.md (its line breaks do not matter)."""
    told = " ".join(files[PAPER].split())
    for deviation in _deviations(files):
        where = f"{deviation.file}:{deviation.line}"
        if not deviation.reason:
            yield Difference(where, "a '// differs:' without a reason")
        elif " ".join(deviation.reason.split()) not in told:
            yield Difference(where, f"the reason of this deviation is not in {PAPER}", {PAPER: deviation.reason})


# ----------------------------------------------------------------------------------------------------------------------
# libraries
# ----------------------------------------------------------------------------------------------------------------------


def _headers(libraries: Mapping[str, Library]) -> Iterator[Difference]:
    """The header says the same in each language, but for its name and the paste block."""
    told = {}
    for language, one in libraries.items():
        kept, paste = [], False
        for line in one.header:
            paste = line.startswith("// PASTE") or (paste and line != "//")
            if not paste:
                kept.append(line.replace(language.upper(), "LANGUAGE").replace(f".{language}", ".LANGUAGE"))
        told[language] = kept
    yield from first_unequal("[0] header", "not the same", told)


def _sections(libraries: Mapping[str, Library]) -> Iterator[Difference]:
    for language, one in libraries.items():
        numbers = tuple(section.number for section in one.sections)
        if numbers != NUMBERS:
            shown = " ".join(f"[{number}]" for number in numbers)
            yield Difference(LIBRARY[language], "sections are not [1] to [9] in this order", {language: shown})
    titles = {
        language: [f"[{section.number}] {section.title}" for section in one.sections]
        for language, one in libraries.items()
    }
    yield from first_unequal("headings", "not the same", titles)


def _comments(libraries: Mapping[str, Library]) -> Iterator[Difference]:
    """Comments that belong to no function: the table of [1], pictures and explanations of the others."""
    for number in NUMBERS:
        if number == PORTING:
            continue
        lines = {
            language: [
                line.replace(HOW_TO_SET[language], "(how to set it)") if number == CONFIGURATION else line
                for line in one.comments.get(number, ())
            ]
            for language, one in libraries.items()
        }
        yield from first_unequal(f"[{number}] comments", "not the same", lines)


def _functions(libraries: Mapping[str, Library]) -> Iterator[Difference]:
    order = {
        language: list(dict.fromkeys(function.name for function in one.functions))
        for language, one in libraries.items()
    }
    everything = list(dict.fromkeys(name for names in order.values() for name in names))
    common = [name for name in everything if all(name in names for names in order.values())]
    shared = {language: [name for name in names if name in common] for language, names in order.items()}
    yield from first_unequal("functions", "not in the same order", shared)
    for language, one in libraries.items():
        yield from _strangers(one)
        yield from _repeated(language, one.functions)
    for name in everything:
        there = {language: one.named(name) for language, one in libraries.items()}
        present = {language: function for language, function in there.items() if function}
        if len(present) < len(LANGUAGES):
            text = {
                language: _at(function.line, function.signature) if function else "(nothing)"
                for language, function in there.items()
            }
            yield Difference(name, "not in every language", text)
        yield from _one_function(name, present)


def _strangers(one: Library) -> Iterator[Difference]:
    """Sections [3] to [9] hold functions only."""
    for number, found in one.others.items():
        for item in found:
            if number > PORTING and item.reason is None:
                text = " ".join(token.text for token in item.tokens)
                yield Difference(f"[{number}]", "not a function", {one.language: _at(item.line, text)})


def _repeated(language: str, functions: Sequence[Function]) -> Iterator[Difference]:
    """No overloads. In [2] a function may stand in several branches of an #if, with the same parameters."""
    seen: dict[str, Function] = {}
    for function in functions:
        first = seen.setdefault(function.name, function)
        branches = first.section == function.section == PORTING and first.parameters == function.parameters
        if first is not function and not branches:
            text = {language: _at(function.line, function.signature)}
            yield Difference(f"[{function.section}] {function.name}", "there already: no overloads", text)


def _one_function(name: str, present: Mapping[str, Function]) -> Iterator[Difference]:
    numbers = {language: function.section for language, function in present.items()}
    if len(set(numbers.values())) > 1:
        yield Difference(name, "not in the same section", {key: f"[{number}]" for key, number in numbers.items()})
    if set(numbers.values()) == {PORTING}:
        names = {language: [p.name for p in function.parameters] for language, function in present.items()}
        yield from first_unequal(f"[{PORTING}] {name}", "names or order of parameters", names)
        return
    where = f"[{min(numbers.values())}] {name}"
    yield from _signatures(where, present)
    docs = {language: function.doc for language, function in present.items()}
    yield from first_unequal(where, "tag line", {language: doc[:1] for language, doc in docs.items()})
    yield from first_unequal(where, "doc comment", {language: doc[1:] for language, doc in docs.items()})
    for row in rows({language: function.statements for language, function in present.items()}):
        if not agree(row):
            text = {
                language: _at(statement.line, statement.source) if statement else "(nothing)"
                for language, statement in row.items()
            }
            yield Difference(where, "statement", text)


def _signatures(where: str, present: Mapping[str, Function]) -> Iterator[Difference]:
    unmarked = {language: function for language, function in present.items() if function.reason is None}
    parts: dict[str, Callable[[Function], object]] = {
        "names or order of parameters": lambda function: [parameter.name for parameter in function.parameters],
        "types of parameters": lambda function: [parameter.type for parameter in function.parameters],
        "type of the result": lambda function: function.returns,
    }
    for what, part in parts.items():
        if len({str(part(function)) for function in unmarked.values()}) > 1:
            text = {language: _at(function.line, function.signature) for language, function in present.items()}
            yield Difference(where, what, text)
            return
