"""What a mutant is, how it is looked for, and what became of it."""

from dataclasses import dataclass, field

from bokeh_validation import paths

# What kinds of mistakes the mutants stand for; those of one language have `languages` of one, whatever their kind.
KINDS = {
    "sign": "a sign reversed",
    "axis": "x for y, one argument for another of its type",
    "dropped sample": "a sample or a weight left out",
    "off-by-one": "a count or an index one off",
    "one language": "a function edited in one language and forgotten in the others",
    "min for max": "min for max, or the other way round",
    "angle": "a wrong angle",
    "aspect": "the aspect ratio or the squeeze forgotten",
    "guard": "a guard against bad input removed",
    "condition": "a comparison reversed or its bound moved",
    "constant": "a wrong factor or constant",
    "configuration": "a wrong value in section [1]",
    "porting": "section [2] of one language",
    "binding": "a wrong register, sampler or parameter",
    "vertex shader": "the full-screen triangle",
    "pass": "a ready-made pass",
}


@dataclass(frozen=True)
class Selection:
    """Some of the tests: files of validation/tests, and what -k is to choose in them; '' takes all."""

    files: tuple[str, ...]
    keywords: str = ""

    def __str__(self) -> str:
        return f"{' '.join(self.files)}{f' -k {self.keywords!r}' if self.keywords else ''}"


@dataclass(frozen=True)
class Edit:
    """A replacement of text, written as in GLSL where the three languages differ (edits.spelled).

    file    'library', 'layers' or 'passes'
    within  name of a function, or of an entry without _PS and _VS: only its body; None: the whole file
    old     any white space is a space
    count   how often `old` stands there, else the catalog is out of date
    """

    file: str
    within: str | None
    old: str
    new: str
    count: int = 1


@dataclass(frozen=True)
class Mutant:
    """Shaders with one mistake.

    killers   the tests that should catch it, in the order in which they are tried
    argument  why it makes no difference that any test could see; no more than the killers is asked then
    """

    name: str
    kind: str
    edits: tuple[Edit, ...]
    killers: tuple[Selection, ...]
    languages: tuple[str, ...] = paths.LANGUAGES
    argument: str = ""

    @property
    def everywhere(self) -> bool:
        """The same mistake in all languages: the parity check is blind to it."""
        return self.languages == paths.LANGUAGES

    @property
    def places(self) -> tuple[str, ...]:
        """Functions, entries and files that it changes."""
        return tuple(dict.fromkeys(edit.within or edit.file for edit in self.edits))


CAUGHT, ALIVE, ARGUED, BROKEN, UNPROVEN = "caught", "alive", "argued", "broken", "unproven"


@dataclass(frozen=True)
class Result:
    """What became of a mutant.

    outcome  caught: a test failed that passes without the change. alive: none did. argued: none did, and the catalog
             has the reason why none can.
             broken: it does not compile, or it is no mistake of the kind that it says: it proves nothing.
             unproven: tests that should catch it do not pass, or were skipped, without the change.
    test     node id of the test that caught it
    detail   what that test said, or why it is argued, broken or unproven
    parity   whether the parity check finds it
    seconds  that all its tests took
    """

    name: str
    kind: str
    languages: tuple[str, ...]
    places: tuple[str, ...]
    change: str
    outcome: str
    parity: bool
    test: str = ""
    detail: str = ""
    seconds: float = field(default=0.0, compare=False)

    @property
    def ok(self) -> bool:
        """Caught, or argued."""
        return self.outcome in (CAUGHT, ARGUED)
