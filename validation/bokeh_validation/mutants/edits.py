"""A mutant's edits carried out on the text of the shaders."""

import re
from collections.abc import Mapping
from functools import cache

from bokeh_validation import parity, paths, shaders
from bokeh_validation.entries import ENTRIES
from bokeh_validation.errors import UserError
from bokeh_validation.mutants.model import Edit, Mutant
from bokeh_validation.passes import PARAMETERS

# Names that GLSL has for what the other languages call otherwise
SPELLINGS = {
    "glsl": (),
    "hlsl": ((r"\bvec([234])\b", r"float\1"),),
    "wgsl": (
        (r"\bvec([234])\(", r"vec\1f("),
        (r"\bfloat\(", "f32("),
        (r"\bint\(", "i32("),
    ),
}
# Parameters of the passes are members of a block there, unless they already are
BLOCK = re.compile(rf"(?<![\w.])({'|'.join(PARAMETERS)})\b")
FILES = {"library": parity.LIBRARY, "layers": parity.LAYERS, "passes": parity.PASSES}


def spelled(text: str, language: str, file: str = "library") -> str:
    """An expression in GLSL as another language writes it."""
    for old, new in SPELLINGS[language]:
        text = re.sub(old, new, text)
    return BLOCK.sub(r"bokehParameters.\1", text) if language == "wgsl" and file == "passes" else text


@cache
def originals() -> Mapping[str, str]:
    """Path from the top of the checkout -> text of the nine shader files."""
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
    old, new = (spelled(part, language, edit.file) for part in (edit.old, edit.new))
    # where a line ends is not the same in each language
    wanted = re.compile(r"\s+".join(re.escape(word) for word in old.split(" ")))
    where = [(0, len(text))] if edit.within is None else bodies(text, edit.file, language, edit.within)
    found = sum(len(wanted.findall(text[start:end])) for start, end in where)
    if found != edit.count or old == new:
        place = f"{edit.within or 'the text'} of {FILES[edit.file][language]}"
        raise UserError(
            f"mutant {name}: {one_line(old)!r} stands {found} times in {place}, not {edit.count}. "
            "Bring bokeh_validation/mutants up to date with the shaders."
        )
    for start, end in reversed(where):
        text = text[:start] + wanted.sub(lambda _: new, text[start:end]) + text[end:]
    return text


def functions(language: str) -> dict[str, int]:
    """Name -> section of every function of a library and of its layers."""
    text = "".join(originals()[files[language]] for files in (parity.LIBRARY, parity.LAYERS))
    return {
        function["name"]: number
        for number, section in shaders.sections(text).items()
        for function in shaders.FUNCTION.finditer(section)
    }


def bodies(text: str, file: str, language: str, name: str) -> list[tuple[int, int]]:
    """(start, end) of the bodies of a function or entry; in HLSL two of one name stand in two branches of an #if."""
    names = {name, f"{name}_PS", f"{name}_VS"} if file == "passes" else {name}
    if file == "passes" and language == "glsl" and name in ("BokehFullScreen", *ENTRIES):
        branch = re.search(rf"^#(?:el)?if BOKEH_PASS == {shaders.glsl_pass(name)}\n\n", text, re.MULTILINE)
        found = [shaders.FUNCTION.search(text, branch.end())] if branch else []
    else:
        found = [one for one in shaders.FUNCTION.finditer(text) if one["name"] in names]
    return [one.span("body") for one in found]
