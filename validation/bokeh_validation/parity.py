"""The three languages are one text, and this is what checks it.

HLSL and WGSL are rewritten to GLSL, word by word, with all that is porting taken away; then the three are compared
statement by statement and comment by comment. What cannot be rewritten, because it is not written as that language's
other text is, gets a '?' and so is a difference. A statement that has to deviate ends in `// differs: reason`, and the
reason must be found in docs/paper.md.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from difflib import SequenceMatcher
from functools import lru_cache
from itertools import combinations, zip_longest
from os import PathLike, fspath
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table
from rich.text import Text

from bokeh_validation import listing, paths, rules, shaders, terminal
from bokeh_validation.entries import ENTRIES as ALL_ENTRIES
from bokeh_validation.errors import UserError
from bokeh_validation.listing import Statement
from bokeh_validation.passes import PARAMETERS

LANGUAGES = paths.LANGUAGES
PAPER = "docs/paper.md"
LIBRARY = {language: f"{language}/bokeh.{language}" for language in LANGUAGES}
LAYERS = {language: f"{language}/bokeh_layers.{language}" for language in LANGUAGES}
PASSES = {language: f"{language}/bokeh_passes.{language}" for language in LANGUAGES}
NUMBERS = {"library": tuple(range(1, 10)), "layers": tuple(range(10, 14))}
CONFIGURATION, PORTING, LAYERED = 1, 2, 10
# Section [2] is each language's own business up to here, and so are the bodies of these functions
SHARED_PORTING = "// where the image lies in its textures"
FETCHES = ("BokehFetchTexture", "BokehFetchNearest", "BokehFetchTable")
# Section [10] is configuration up to here
SHARED_LAYERS = "// Layers: where the image lies"
# In the passes, the last heading: from here on are helpers and entries
ENTRIES = re.compile(r"^// (?:pixel|fragment) shaders\n// -+\n", re.MULTILINE)
TARGETS = ("BokehResult", "BokehResultB", "BokehResultC", "BokehResultD")

Texts = Mapping[str | PathLike, str]


@dataclass(frozen=True)
class Difference:
    """One thing that is not the same in the languages, or breaks a rule.

    where  section or function, or file and line
    text   language -> 'line n: text', or what stands for it
    """

    where: str
    what: str
    text: Mapping[str, str] = field(default_factory=dict)

    def __str__(self) -> str:
        lines = [f"{self.where}: {self.what}"]
        return "\n".join(lines + [f"    {language:5} {text}" for language, text in self.text.items()])


@dataclass(frozen=True)
class Deviation:
    """A line marked with `// differs: reason`."""

    file: str
    line: int
    reason: str


def check(texts: Texts | None = None) -> list[Difference]:
    """Every difference between the languages, and every broken rule; empty where all is well.

    `texts`: path from the top of the checkout ('hlsl/bokeh.hlsl', ..., 'docs/paper.md') -> text that stands in for
    that file; files not named are read from the checkout.
    """
    files = _files(texts)
    libraries, layers, passes = (
        {language: files[keys[language]] for language in LANGUAGES} for keys in (LIBRARY, LAYERS, PASSES)
    )
    found = []
    for language in LANGUAGES:
        found += _ruled(LIBRARY[language], libraries[language], language, True)
        found += _ruled(LAYERS[language], layers[language], language, True)
        found += _ruled(PASSES[language], passes[language], language, False)
    for kind, keys, texts in (("library", LIBRARY, libraries), ("layers", LAYERS, layers)):
        found += _unequal(f"[0] header of the {kind}", {key: _header(key, text) for key, text in texts.items()})
        for language, text in texts.items():
            numbers, wanted = [section.number for section in listing.sections(text)], NUMBERS[kind]
            if numbers != list(wanted):
                what = f"sections are not [{wanted[0]}] to [{wanted[-1]}] in this order"
                found.append(Difference(keys[language], what))
        sampled = {language: _sampled(language, text) for language, text in texts.items()}
        found += _unequal("functions", {key: sorted(sampled[key]) for key in ("hlsl", "wgsl")}, "with a sampler")
    found += _compared({key: _library(key, text) for key, text in libraries.items()})
    found += _compared({key: _library(key, text, libraries[key]) for key, text in layers.items()})
    found += _configuration(libraries, CONFIGURATION)
    found += _configuration(layers, LAYERED)
    filters = {key: libraries[key] + layers[key] for key in LANGUAGES}
    found += _compared({key: _passes(key, text, filters[key]) for key, text in passes.items()}, "passes, ")
    found += _interface(passes)
    found += _reasons(files)
    return found


def deviations(texts: Texts | None = None) -> list[Deviation]:
    """Every marked deviation, in the order of the files."""
    return [
        Deviation(key, line, mark[1].strip())
        for key, text in _files(texts).items()
        if key != PAPER
        for line, row in enumerate(text.split("\n"), 1)
        if (mark := listing.MARK.search(row)) and row[: mark.start()].strip()
    ]


def columns(name: str, texts: Texts | None = None) -> dict[str, str]:
    """Language -> text of a function of the library or the layers, with its doc comment; empty where it is missing."""
    files = _files(texts)
    found = {key: listing.functions(files[LIBRARY[key]] + files[LAYERS[key]]) for key in LANGUAGES}
    names = list(dict.fromkeys(function.name for one in found.values() for function in one))
    if name not in names:
        raise UserError(f"no function {name!r} in the libraries. There are: {', '.join(names)}.")
    return {key: next((function.text for function in one if function.name == name), "") for key, one in found.items()}


def render_columns(name: str, console: Console | None = None, texts: Texts | None = None) -> None:
    """Print such a function in three columns, statement beside statement: differences red, marked lines yellow."""
    files = _files(texts)
    table = Table(title=name, show_lines=False, expand=True)
    written, common = {}, {}
    for language, text in columns(name, texts).items():
        table.add_column(language.upper(), ratio=1, overflow="fold")
        written[language] = listing.statements(text)
        sampled = _sampled(language, files[LIBRARY[language]] + files[LAYERS[language]])
        common[language] = listing.statements(_to_glsl(language, text, sampled))
    for row, same in zip_longest(zip_longest(*written.values()), zip_longest(*common.values()), fillvalue=(None,) * 3):
        alike = len({one.words for one in same if one and one.reason is None}) < 2 and None not in same
        marked = any(one and one.reason is not None for one in same)
        style = ("yellow" if marked else "") if alike else "red"
        table.add_row(*(Text(one.source.rstrip() if one else "", style=style) for one in row))
    (console or Console()).print(table)


# ----------------------------------------------------------------------------------------------------------------------
# reading
# ----------------------------------------------------------------------------------------------------------------------


def _files(texts: Texts | None) -> dict[str, str]:
    """All nine shader files and docs/paper.md by their path, from `texts` or the checkout."""
    given = {fspath(key).replace("\\", "/"): text for key, text in (texts or {}).items()}
    known = [*LIBRARY.values(), *LAYERS.values(), *PASSES.values(), PAPER]
    unknown = sorted(set(given) - set(known))
    if unknown:
        raise UserError(f"{unknown[0]}: not a file of the parity check. It knows {', '.join(known)}.")
    return {key: given[key] if key in given else _read(key) for key in known}


def _read(key: str) -> str:
    try:
        # As it is: what is not UTF-8, and every kind of line end, is for the rules to see.
        folder = paths.ROOT if key == PAPER else paths.shaders()
        return (folder / key).read_bytes().decode("utf-8", errors="surrogateescape")
    except OSError as error:
        raise UserError(f"{key}: cannot be read ({error.strerror}). Run this in a complete checkout.") from error


# The tests change one file a thousand times over: what was found in the others is kept.
@lru_cache(maxsize=64)
def _ruled(key: str, text: str, language: str, is_library: bool) -> tuple[Difference, ...]:
    findings = rules.findings(text, language, is_library)
    return tuple(Difference(f"{key}:{line}", what, {language: row}) for line, what, row in findings)


def _reasons(files: Mapping[str, str]) -> Iterator[Difference]:
    """Every reason for a deviation stands in docs/paper.md (its line breaks do not matter)."""
    given = " ".join(files[PAPER].split())
    for deviation in deviations(files):
        where = f"{deviation.file}:{deviation.line}"
        if not deviation.reason:
            yield Difference(where, "a '// differs:' without a reason")
        elif " ".join(deviation.reason.split()) not in given:
            yield Difference(where, f"the reason of this deviation is not in {PAPER}", {PAPER: deviation.reason})


# ----------------------------------------------------------------------------------------------------------------------
# rewriting: every language to GLSL
# ----------------------------------------------------------------------------------------------------------------------


def _sampled(language: str, text: str) -> frozenset[str]:
    """Functions whose first parameter is a texture with a sampler of its own; GLSL has no such difference."""
    head = {"hlsl": r"(\w+)\(BOKEH_TEXTURE\(", "wgsl": r"fn (\w+)\((\w+): texture_2d<f32>,\s*\2Sampler: sampler"}
    return frozenset(found[1] for found in re.finditer(head.get(language, r"(?!)"), text))


def _to_glsl(language: str, text: str, sampled: Iterable[str]) -> str:
    """A text in GLSL, line for line. Comments stay as they are."""
    comments: list[str] = []

    def kept(found: re.Match) -> str:
        comments.append(found[0])
        return "//\0"

    text = listing.COMMENT.sub(kept, text)
    text = REWRITES[language](text, "|".join(sorted(sampled)) or "(?!)")
    following = iter(comments)
    return re.sub("//\0", lambda _: next(following), text)


def _strange(text: str, words: str) -> str:
    """Words of another language made strangers."""
    return re.sub(rf"\b({words})\b", r"?\1", text)


def _hlsl(text: str, sampled: str) -> str:
    text = _strange(text, r"vec[234]|mat[234]|sampler2D")

    def function(found: re.Match) -> str:
        own = re.search(r"BOKEH_TEXTURE\((\w+)\)", found["head"])

        def argument(call: re.Match) -> str:
            alone, one, other = call[2], call[3], call[4]
            right = alone and (own is None or alone == own[1]) or one and own and other == own[1] != one
            return f"{call[1]}({'' if right else '?'}{alone or one or call[5]}"

        call = rf"\b({sampled})\((?:BOKEH_ARGUMENT\((\w+)\)|BOKEH_SHARED\((\w+), (\w+)\)|(?!BOKEH_)(\w+))"
        return found["doc"] + found["head"] + "\n" + re.sub(call, argument, found["body"])

    text = listing.FUNCTION.sub(function, text)
    text = re.sub(r"BOKEH_(?:TEXTURE|TEXELS)\((\w+)\)", r"sampler2D \1", text)
    text = re.sub(r"(BOKEH_LOOP )?\bfor\b", lambda found: "for" if found[1] else "?for", text)
    text = re.sub(r"^static ", "", text, flags=re.MULTILINE)
    return re.sub(r"\bfloat([234])\b", r"vec\1", text)


def _wgsl(text: str, sampled: str) -> str:
    text = _strange(text, r"vec[234]|mat[234]|float|int|sampler2D")

    def function(found: re.Match) -> str:
        own = re.search(r"(\w+Sampler): sampler", found["head"])
        sampler = own[1] if own else "BokehLinearClamp"

        def argument(call: re.Match) -> str:
            if call[4] == sampler:
                return f"{call[1]}({call[2]}" + "\n" * call[3].count("\n")
            return f"{call[1]}(?{call[2]}{call[3]}{call[4]}"

        body = re.sub(rf"\b({sampled})\((\w+)(,\s*)(\w+)", argument, found["body"])
        head = re.sub(r"(\w+): texture_2d<f32>(,\s*\1Sampler: sampler)?", _texture, found["head"])
        head = re.sub(r"(\w+): (\w+)", r"\2 \1", head)
        head = re.sub(r"^fn (\w+\(.*\)) -> (\w+)$", r"\2 \1", head, flags=re.DOTALL)
        return found["doc"] + re.sub(r"^fn (\w+\(.*\))$", r"void \1", head, flags=re.DOTALL) + "\n" + body

    text = listing.FUNCTION.sub(function, text)
    text = re.sub(r"^(struct \w+\n\{\n)((?:    \w+: \w+,\n)+)\}$", _struct, text, flags=re.MULTILINE)
    text = re.sub(r"^( *)(?:let|var|var<private>) (\w+): (\w+)(;| =)", r"\1\3 \2\4", text, flags=re.MULTILINE)
    text = re.sub(r"\bfor \(var (\w+): (\w+) =", r"for (\2 \1 =", text)
    text = re.sub(r"\bvec([234])f\b", r"vec\1", text)
    return re.sub(r"\b[fi]32\b", lambda found: {"f32": "float", "i32": "int"}[found[0]], text)


def _texture(found: re.Match) -> str:
    return f"sampler2D {found[1]}" + "\n" * (found[2] or "").count("\n")


def _struct(found: re.Match) -> str:
    return found[1] + re.sub(r"(\w+): (\w+),", r"\2 \1;", found[2]) + "};"


REWRITES: Mapping[str, Callable[[str, str], str]] = {"hlsl": _hlsl, "glsl": lambda text, _: text, "wgsl": _wgsl}


def _library(language: str, text: str, before: str = "") -> list[Statement]:
    """All sections but [1], headings and all; of [2] what is not each language's own, of [10] no configuration.

    before  the text that stands before it in a program
    """
    return list(_library_of(language, text, before))


@lru_cache(maxsize=64)
def _library_of(language: str, text: str, before: str) -> tuple[Statement, ...]:
    common = _to_glsl(language, text, _sampled(language, before) | _sampled(language, text))
    found: list[Statement] = []
    for section in listing.sections(common):
        found.append(Statement(f"[{section.number}] {section.title}", "", section.line))
        line, part = section.line, section.text
        if section.number == PORTING and SHARED_PORTING in part:
            line += part.count("\n", 0, part.index(SHARED_PORTING))
            part = listing.FUNCTION.sub(_without_body, part[part.index(SHARED_PORTING) :])
        if section.number == LAYERED and SHARED_LAYERS in part:
            line += part.count("\n", 0, part.index(SHARED_LAYERS))
            part = part[part.index(SHARED_LAYERS) :]
        if section.number != CONFIGURATION:
            found += listing.statements(part, line)
    return tuple(found)


def _without_body(found: re.Match) -> str:
    """A function that fetches, to its head and the first line of its comment."""
    if found["name"] not in FETCHES:
        return found[0]
    first, _, rest = found["doc"].partition("\n")
    return f"{first}\n{found['head']};" + "\n" * (rest.count("\n") + found["body"].count("\n") + 1)


def _passes(language: str, text: str, filters: str) -> list[Statement]:
    """Helpers and entries. `filters`: library and layers."""
    start = ENTRIES.search(text)
    if not start:
        return []
    # the heads of entries are rewritten before they can be taken for functions
    body = ENTRY_HEADS[language](text[start.end() :])
    # WGSL has no preprocessor: there the layers are always in the program
    body = re.sub(r"^#ifdef BOKEH_LAYERS\n((?:(?!#).*\n)*)#endif\n", r"\n\1\n", body, flags=re.MULTILINE)
    sampled = _sampled(language, filters) | _sampled(language, body)
    common = _to_glsl(language, body, sampled)
    if language != "glsl":
        entry = re.compile(r"^(ENTRY \w+\(\)\n)(\{\n.*?^\})$", re.MULTILINE | re.DOTALL)
        common = entry.sub(lambda found: found[1] + _entry(found[2]), common)
    return listing.statements(common.strip("\n"), listing.line_of(text, start.end()) + 1)


def _entry(body: str) -> str:
    """The body of an entry as GLSL writes it: results are assigned."""
    body = re.sub(r"\b(?:input\.)?uv\b", "BokehUV", body)
    body = re.sub(r"\btarget(\d) =", lambda found: f"{TARGETS[int(found[1])]} =", body)
    body = re.sub(r"\breturn BokehTargets\d\(([^()]*)\);", lambda found: _assigned(found[1]), body)
    return re.sub(r"\breturn\b", f"{TARGETS[0]} =", body)


def _assigned(values: str) -> str:
    return " ".join(f"{name} = {value};" for name, value in zip(TARGETS, values.split(", "), strict=False))


def _glsl_heads(text: str) -> str:
    """The branches of BOKEH_PASS."""
    names = {shaders.glsl_pass(entry): entry for entry in ALL_ENTRIES}
    text = re.sub(
        r"^#(?:el)?if BOKEH_PASS == (\w+)\n\n((?://[^\n]*\n)*)void main\(\)$",
        lambda found: f"\n\n{found[2]}ENTRY {names.get(found[1], found[1])}()",
        text,
        flags=re.MULTILINE,
    )
    return re.sub(r"\n#endif\n#endif\n\Z", "\n\n\n", text)


def _hlsl_heads(text: str) -> str:
    """One result, or several out parameters."""
    text = re.sub(r"^float4 (Bokeh\w+)_PS\(BOKEH_INPUT\) : BOKEH_OUTPUT$", r"ENTRY \1()", text, flags=re.MULTILINE)
    several = r"^void (Bokeh\w+)_PS\(BOKEH_INPUT((?:,\s+out float4 target(\d) : BOKEH_TARGET\(\3\))+)\)$"
    return re.sub(several, lambda found: "\n" * found[2].count("\n") + f"ENTRY {found[1]}()", text, flags=re.MULTILINE)


def _wgsl_heads(text: str) -> str:
    """Structs of several results, and the block of parameters with its name."""
    struct = r"^struct BokehTargets\d\n\{\n(?:    @location\((\d)\) target\1: vec4f,\n)+\}\n"
    text = re.sub(struct, lambda found: "\n" * found[0].count("\n"), text, flags=re.MULTILINE)
    head = r"^@fragment fn (Bokeh\w+)_PS\(input: BokehVertex\) -> (?:@location\(0\) vec4f|BokehTargets\d)$"
    return re.sub(head, r"ENTRY \1()", text, flags=re.MULTILINE).replace("bokehParameters.", "")


ENTRY_HEADS = {"hlsl": _hlsl_heads, "glsl": _glsl_heads, "wgsl": _wgsl_heads}


# ----------------------------------------------------------------------------------------------------------------------
# comparing
# ----------------------------------------------------------------------------------------------------------------------


def _unequal(where: str, lines: Mapping[str, Sequence[str]], what: str = "not the same") -> Iterator[Difference]:
    """The first line that is not the same everywhere."""
    for row in zip_longest(*lines.values(), fillvalue="(nothing)"):
        if len(set(row)) > 1:
            yield Difference(where, what, dict(zip(lines, row, strict=True)))
            return


def _compared(found: Mapping[str, list[Statement]], where: str = "") -> Iterator[Difference]:
    """Each language with each other. A mark exempts its own statement, and one of the other language that it faces."""
    for one, other in combinations(found, 2):
        left, right = found[one], found[other]
        words = [[statement.words for statement in side] for side in (left, right)]
        for tag, i, j, k, m in SequenceMatcher(None, *words, autojunk=False).get_opcodes():
            if tag == "equal":
                continue
            parts = {one: left[i:j], other: right[k:m]}
            marked = {key: sum(statement.reason is not None for statement in part) for key, part in parts.items()}
            if j - i - marked[one] > marked[other] or m - k - marked[other] > marked[one]:
                shown = {key: _shown(part) for key, part in parts.items()}
                yield Difference(where + _place(left[:j]), "not the same", shown)


def _place(before: Sequence[Statement]) -> str:
    """Name of the last function that began, or of the section."""
    for statement in reversed(before):
        named = re.match(r"(?:ENTRY |\w+ |struct )(\w+)(?:\(.*)?$|(\[\d\])", statement.words)
        if named and not statement.words.startswith(("return", "else")) and "=" not in statement.words:
            return named[1] or named[2]
    return "[2]"


def _shown(part: Sequence[Statement]) -> str:
    if not part:
        return "(nothing)"
    return f"line {part[0].line}: {' '.join(' '.join(one.source.split()) or '(an empty line)' for one in part[:4])}"


def _header(language: str, text: str) -> list[str]:
    """It says the same in each language, but for its name and the paste block."""
    kept, paste = [], False
    for line in listing.header(text).split("\n"):
        paste = line.startswith("// PASTE") or (paste and not line.startswith("// CONTENTS"))
        if not paste:
            kept.append(line.replace(language.upper(), "LANGUAGE").replace(f".{language}", ".LANGUAGE"))
    return kept


# ----------------------------------------------------------------------------------------------------------------------
# sections [1] and [10]: configuration
# ----------------------------------------------------------------------------------------------------------------------


def _configuration(files: Mapping[str, str], number: int) -> Iterator[Difference]:
    """HLSL and GLSL are the same text. WGSL has the same comments, names and values, and no presets but their table."""
    where = f"[{number}]"
    texts = {
        language: next((part.text for part in listing.sections(text) if part.number == number), "")
        .partition(SHARED_LAYERS)[0]
        .replace(f".{language}", ".LANGUAGE")
        for language, text in files.items()
    }
    yield from _compared({key: listing.statements(texts[key]) for key in ("hlsl", "glsl")}, f"{where} ")
    comments = {key: [row for row in text.split("\n") if row.startswith("//")] for key, text in texts.items()}
    yield from _unequal(where, comments, "comments")
    values = {key: settings(key, text) for key, text in texts.items()}
    marked = {name for found in values.values() for name, _, reason in found if reason is not None}
    rows = {
        key: [name if name in marked else f"{name} {value}" for name, value, _ in found]
        for key, found in values.items()
    }
    yield from _unequal(where, rows, "values")
    table = re.findall(r"^//   (BOKEH_(?!PRESET)\w+) +(\S+)", texts["glsl"], re.MULTILINE)
    shown = [name if name in marked else f"{name} {value}" for name, value in table]
    yield from _unequal(where, {"table": shown, "code": rows["glsl"]}, "the table is not what the code does")
    table = [row.split() for row in re.findall(r"^//   BOKEH_PRESET_(\w+ +.*)", texts["glsl"], re.MULTILINE)]
    known = presets(texts["glsl"])
    known |= {row[0]: tuple(_plain(texts["glsl"]).values()) for row in table if row[-2:] == ["the", "default"]}
    shown = {
        "table": sorted(" ".join(row[: 1 + len(known.get(row[0], ()))]) for row in table),
        "code": sorted(" ".join((name, *values)) for name, values in known.items()),
    }
    yield from _unequal(where, shown, "the table is not what the presets are")
    for row in texts["wgsl"].split("\n"):
        if row and not row.startswith("//") and not WGSL_SETTING.match(row):
            yield Difference(where, "neither a const nor an override with type and value", {"wgsl": row})


# (name, value, reason of a deviation)
Setting = tuple[str, str, str | None]
WGSL_SETTING = re.compile(r"(?:const|override) (\w+): (?:i32 = (-?\d+)|f32 = (-?\d+\.\d+));(?: // differs:(.*))?$")


def settings(language: str, text: str) -> list[Setting]:
    """Of section [1]. HLSL and GLSL have three lines for each; a value of the presets is the one without a preset."""
    if language == "wgsl":
        lines = (WGSL_SETTING.match(row) for row in text.split("\n"))
        return [(one[1], one[2] or one[3], one[4]) for one in lines if one]
    plain = _plain(text)
    found = re.findall(r"^#ifndef (\w+)\n#define \1 ([^\s/]+)(?: // differs:(.*))?\n#endif$", text, re.MULTILINE)
    return [(name, plain.get(value, value), reason or None) for name, value, reason in found]


def _plain(text: str) -> dict[str, str]:
    """HLSL and GLSL: what the settings of the presets are without one."""
    return dict(re.findall(r"^#define (BOKEH_PRESET_\w+) (\S+)$", text.partition("#else\n")[2], re.MULTILINE))


def presets(text: str) -> dict[str, tuple[str, ...]]:
    """HLSL and GLSL: name -> values: BOKEH_NUM_SAMPLES and BOKEH_SPACING, of the layers rings, cells and cubic."""
    preset = r"defined\(BOKEH_PRESET_(\w+)\)\n((?:#define BOKEH_PRESET_\w+ \S+\n)+)"
    return {name: tuple(line.split()[2] for line in lines.splitlines()) for name, lines in re.findall(preset, text)}


# ----------------------------------------------------------------------------------------------------------------------
# passes: what a program outside sees of them
# ----------------------------------------------------------------------------------------------------------------------


def _interface(texts: Mapping[str, str]) -> Iterator[Difference]:
    """Entries and parameters are those that the harness knows; the tables in the headers say the same."""
    for language, text in texts.items():
        where = f"{language} passes"
        entries = re.findall(r"^ENTRY (\w+)\(\)", ENTRY_HEADS[language](text), re.MULTILINE)
        yield from _unequal(where, {language: entries, "harness": list(ALL_ENTRIES)}, "entry points")
        wanted = [f"{number} float {name}" for number, name in enumerate(PARAMETERS)]
        yield from _unequal(where, {language: _parameters(language, text), "harness": wanted}, "parameters")
    yield from _unequal("passes", {key: _table(key, text) for key, text in texts.items()}, "table in the header")
    named = re.findall(r"^#define (BOKEH_(?!TARGETS )\w+) (\d+)$", texts["glsl"], re.MULTILINE)
    numbers = [" ".join(pair) for pair in named]
    wanted = [f"{shaders.glsl_pass(entry)} {i}" for i, entry in enumerate((*ALL_ENTRIES, "BokehFullScreen"), 1)]
    yield from _unequal("glsl passes", {"glsl": numbers, "harness": wanted}, "values of BOKEH_PASS")


def _parameters(language: str, text: str) -> list[str]:
    """Index, type, name."""
    if language == "wgsl":
        block = text.partition("struct BokehParameters\n")[2].partition("}")[0]
        members = re.findall(r"^    (\w+): (\w+),$", block, re.MULTILINE)
        return [f"{number} {'float' if kind == 'f32' else kind} {name}" for number, (name, kind) in enumerate(members)]
    found = re.findall(r"^BOKEH_PARAMETER\((\w+), (\w+)(?:, (\d+))?\)$", text, re.MULTILINE)
    return [f"{index or number} {kind} {name}" for number, (kind, name, index) in enumerate(found)]


def _table(language: str, text: str) -> list[str]:
    """Pass, what it reads, what it writes; the row of the vertex shader is each language's own."""
    named = r"BOKEH_(?!PASS\b)\w+" if language == "glsl" else r"Bokeh\w+_PS"
    names = {shaders.glsl_pass(entry): entry for entry in ALL_ENTRIES}
    rows = re.findall(rf"^//   ({named})  +(\S.*)$", listing.HEAD_COMMENT.match(text)[0], re.MULTILINE)
    found = [(names.get(name, name.removesuffix("_PS")), re.sub(r"  +", " | ", rest)) for name, rest in rows]
    return [" | ".join(row) for row in found if row[0] != "BOKEH_FULL_SCREEN"]


def parity(
    function: Annotated[str | None, typer.Argument(help="Print this function in three columns.")] = None,
) -> None:
    """Compare the three libraries function by function."""
    if function is not None:
        render_columns(function, terminal.console)
        return
    differences = check()
    terminal.tell(*map(str, differences), f"{len(differences)} unmarked differences between HLSL, GLSL and WGSL")
    terminal.end(not differences)
