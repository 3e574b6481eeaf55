"""What a mutant is: the shaders with one mistake."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

from bokeh_validation import paths
from bokeh_validation.shaders import parity

# `caught` by parity and by a pass of a frame; `equivalent`: no frame shows it, equivalents.txt has the reason;
# `refused` by the compiler; `alive`: one of the two does not show it; `broken`: it ended with another error, or not
OUTCOMES = CAUGHT, EQUIVALENT, REFUSED, ALIVE, BROKEN = "caught", "equivalent", "refused", "alive", "broken"
BAD = ALIVE, BROKEN


@dataclass(frozen=True)
class Mutant:
    """The shaders of a language with one mistake.

    place   the function or entry that it is in; an entry's name ends in _PS or _VS
    change  the statement with the mistake, or what has become of it
    texts   path in the shaders' folder -> text, of the file that is changed
    driver  the one that has to show it
    common  whether the parity check has to see it: the languages have the statement in common
    frames  those that are drawn; none: all that use the place
    argued  why none can show it
    """

    name: str
    kind: str
    place: str
    change: str
    texts: Mapping[str, str]
    driver: str = "egl"
    common: bool = True
    frames: tuple[str, ...] = ()
    argued: str = ""


@cache
def originals() -> Mapping[str, str]:
    """Path in the shaders' folder -> text, of all shader files."""
    keys = [keys[language] for keys in parity.FILES.values() for language in paths.LANGUAGES]
    return {key: (paths.shaders() / key).read_text(encoding="ascii") for key in keys}


def together(texts: Mapping[str, str], language: str) -> str:
    """All of a language, with these texts in place of their files."""
    return "".join(text for key, text in {**originals(), **texts}.items() if key.startswith(f"{language}/"))
