"""A mutant's edits carried out on the text of the shaders."""

import re
from collections.abc import Mapping
from functools import cache

from bokeh_validation import parity, paths, shaders
from bokeh_validation.errors import UserError
from bokeh_validation.listing import rules
from bokeh_validation.listing.syntax import Item, items, sections, tokenize
from bokeh_validation.mutants.model import Edit, Mutant

# Names that GLSL has for what the other languages call otherwise
SPELLINGS = {
    "glsl": (),
    "hlsl": ((r"\bvec([234])\b", r"float\1"), (r"\bmat4\b", "float4x4")),
    "wgsl": (
        (r"\bvec([234])\(", r"vec\1f("),
        (r"\bmat4\(", "mat4x4f("),
        (r"\bfloat\(", "f32("),
        (r"\bint\(", "i32("),
    ),
}
FILES = {"library": parity.LIBRARY, "passes": parity.PASSES}


def spelt(text: str, language: str) -> str:
    """An expression in GLSL as another language writes it."""
    for old, new in SPELLINGS[language]:
        text = re.sub(old, new, text)
    return text


@cache
def originals() -> Mapping[str, str]:
    """Path from the top of the checkout -> text of the six shader files."""
    keys = [FILES[file][language] for file in FILES for language in paths.LANGUAGES]
    return {key: (paths.ROOT / key).read_text(encoding="ascii") for key in keys}


def mutated(mutant: Mutant, texts: Mapping[str, str] | None = None) -> dict[str, str]:
    """Path -> text of the files that a mutant changes. Raises UserError where an edit does not fit them."""
    before = originals() if texts is None else texts
    changed: dict[str, str] = {}
    for language in mutant.languages:
        for edit in mutant.edits:
            key = FILES[edit.file][language]
            changed[key] = _edited(changed.get(key, before[key]), edit, language, mutant.name)
    return changed


def described(mutant: Mutant) -> str:
    """Its edits in a line."""
    return "; ".join(f"{one_line(edit.old)} -> {one_line(edit.new) or '(nothing)'}" for edit in mutant.edits)


def one_line(text: str) -> str:
    """Any text without its line breaks and indents."""
    return " ".join(text.split())


def _edited(text: str, edit: Edit, language: str, name: str) -> str:
    old, new = spelt(edit.old, language), spelt(edit.new, language)
    where = [(0, len(text))] if edit.within is None else bodies(text, edit.file, language, edit.within)
    found = sum(text.count(old, start, end) for start, end in where)
    if found != edit.count or old == new:
        place = f"{edit.within or 'the text'} of {FILES[edit.file][language]}"
        raise UserError(
            f"mutant {name}: {one_line(old)!r} stands {found} times in {place}, not {edit.count}. "
            "Bring bokeh_validation/mutants up to date with the shaders."
        )
    for start, end in reversed(where):
        text = text[:start] + text[start:end].replace(old, new) + text[end:]
    return text


def functions(language: str) -> dict[str, int]:
    """Name -> section of every function of a library."""
    text = originals()[parity.LIBRARY[language]]
    return {function.name: function.section for function in parity.library(language, text).functions}


def bodies(text: str, file: str, language: str, name: str) -> list[tuple[int, int]]:
    """(start, end) of the bodies of a function or entry; in HLSL two of one name stand in two branches of an #if."""
    if file == "library":
        return [_body(item) for item in _library_items(text) if _named(item, language, {name})]
    if language == "glsl":
        return [_body(item) for branch, item in _branches(text) if branch == shaders.glsl_pass(name)]
    return [_body(i) for i in items(tokenize(text)) if _named(i, language, {f"{name}_PS", f"{name}_VS"})]


def _library_items(text: str) -> list[Item]:
    return [item for section in sections(tokenize(text))[1] for item in section.items]


def _named(item: Item, language: str, names: set[str]) -> bool:
    return item.kind == "function" and not names.isdisjoint(token.text for token in rules.declared(item, language))


def _branches(text: str) -> list[tuple[str, Item]]:
    """GLSL: every main() with the value of BOKEH_PASS that it is compiled for."""
    branch, found = "", []
    for item in items(tokenize(text)):
        chosen = re.fullmatch(r"#(?:el)?if BOKEH_PASS == (\w+)", " ".join(item.tokens[0].text.split()))
        if chosen:
            branch = chosen[1]
        elif _named(item, "glsl", {"main"}):
            found.append((branch, item))
    return found


def _body(item: Item) -> tuple[int, int]:
    opening = next(token for token in item.tokens if token.text == "{")
    return opening.start, item.tokens[-1].end
