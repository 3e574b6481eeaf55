"""What a mutant is, and its edits carried out on the text of the shaders."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

from bokeh_validation import paths, shaders
from bokeh_validation.errors import UserError
from bokeh_validation.mutants import killers
from bokeh_validation.shaders import parity
from bokeh_validation.shaders.passes import PARAMETERS

KINDS = (
    *("sign", "axis", "dropped sample", "off-by-one", "one language", "min for max", "angle", "aspect", "guard"),
    *("condition", "constant", "configuration", "porting", "binding", "vertex shader", "pass"),
)
# Names that GLSL has for what the other languages call otherwise
SPELLINGS = {
    "glsl": (),
    "hlsl": ((r"\bvec([234])\b", r"float\1"),),
    "wgsl": ((r"\bvec([234])\(", r"vec\1f("), (r"\bfloat\(", "f32("), (r"\bint\(", "i32(")),
}
# Parameters of the passes are members of a block in WGSL, unless they already are
BLOCK = re.compile(rf"(?<![\w.])({'|'.join(PARAMETERS)})\b")
FILES = {"library": parity.LIBRARY, "layers": parity.LAYERS, "passes": parity.PASSES}


@dataclass(frozen=True)
class Mutant:
    """Shaders with one mistake, written as in GLSL where the three languages differ (spelled).

    file      'library', 'layers' or 'passes'
    within    name of a function, or of an entry without _PS and _VS, less its 'Bokeh': only its body; None: all
    edits     (old, new) one after the other; any white space of `old` is a space
    killers   the tests that are asked first, in this order (killers.py)
    count     how often each `old` stands there, else the table is out of date
    argument  why it makes no difference that any test could see; no more than the killers is asked then
    """

    name: str
    kind: str
    file: str
    within: str | None
    edits: tuple[tuple[str, str], ...]
    killers: tuple[str, ...]
    languages: tuple[str, ...] = paths.LANGUAGES
    count: int = 1
    argument: str = ""

    @property
    def everywhere(self) -> bool:
        """The same mistake in all languages: the parity check is blind to it."""
        return self.languages == paths.LANGUAGES

    @property
    def place(self) -> str:
        """The function, entry or file that it changes."""
        return f"Bokeh{self.within}" if self.within else self.file

    @property
    def change(self) -> str:
        """Its edits in a line."""
        (old, new), *more = self.edits
        if more:
            return f"{old.strip()} <-> {more[0][0].strip()}"
        return f"{' '.join(old.split())} -> {' '.join(new.split()) or '(nothing)'}"


def row(
    file: str,
    name: str,
    kind: str,
    within: str | None,
    old: str,
    new: str,
    *named: str,
    count: int = 1,
    argument: str = "",
) -> Mutant:
    """A mutant of one edit in all languages; its function's killers, unless others are named."""
    return Mutant(
        name, kind, file, within, ((old, new),), named or killers.first(within), count=count, argument=argument
    )


@cache
def originals() -> Mapping[str, str]:
    """Path in the shaders' folder -> text, of the nine files."""
    keys = [keys[language] for keys in FILES.values() for language in paths.LANGUAGES]
    return {key: (paths.shaders() / key).read_text(encoding="ascii") for key in keys}


def mutated(mutant: Mutant) -> dict[str, str]:
    """Path -> text of the files that a mutant changes. Raises UserError where an edit does not fit them."""
    changed = {FILES[mutant.file][language]: language for language in mutant.languages}
    return {key: _edited(originals()[key], mutant, key, language) for key, language in changed.items()}


def _edited(text: str, mutant: Mutant, key: str, language: str) -> str:
    for edit in mutant.edits:
        old, new = (spelled(part, language, mutant.file) for part in edit)
        # where a line ends is not the same in each language
        wanted = re.compile(r"\s+".join(re.escape(word) for word in old.split(" ")))
        where = [(0, len(text))] if mutant.within is None else _bodies(text, mutant.file, language, mutant.place)
        found = sum(len(wanted.findall(text[start:end])) for start, end in where)
        if found != mutant.count or old == new:
            raise UserError(
                f"mutant {mutant.name}: {old!r} stands {found} times in {mutant.place} of {key}, not {mutant.count}. "
                "Bring bokeh_validation/mutants up to date with the shaders."
            )
        for start, end in reversed(where):
            text = text[:start] + wanted.sub(lambda _, new=new: new, text[start:end]) + text[end:]
    return text


def spelled(text: str, language: str, file: str) -> str:
    """An expression in GLSL as another language writes it."""
    for old, new in SPELLINGS[language]:
        text = re.sub(old, new, text)
    return BLOCK.sub(r"bokehParameters.\1", text) if language == "wgsl" and file == "passes" else text


def _bodies(text: str, file: str, language: str, name: str) -> list[tuple[int, int]]:
    """(start, end) of the bodies of a function or entry; in HLSL two of one name stand in two branches of an #if."""
    if file == "passes" and language == "glsl":
        branch = re.search(rf"^#(?:el)?if BOKEH_PASS == {shaders.glsl_pass(name)}\n\n", text, re.MULTILINE)
        if branch:
            return [shaders.FUNCTION.search(text, branch.end()).span("body")]
    names = {name, f"{name}_PS", f"{name}_VS"} if file == "passes" else {name}
    return [one.span("body") for one in shaders.FUNCTION.finditer(text) if one["name"] in names]
