"""Define a mutant: the shaders with one mistake."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

from bokeh_validation import paths
from bokeh_validation.shaders import parity

# `caught` by parity and by a pass of a frame; `equivalent`: no frame can show it, and equivalents.txt has the reason;
# `refused` by the compiler; `alive`: parity or frames do not show it; `broken`: it ended with another error, or hung
OUTCOMES = CAUGHT, EQUIVALENT, REFUSED, ALIVE, BROKEN = "caught", "equivalent", "refused", "alive", "broken"
BAD = ALIVE, BROKEN


@dataclass(frozen=True)
class Mutant:
    """Hold the shaders of a language with one mistake.

    place   function or entry with the mistake; an entry's name ends in _PS or _VS
    change  the statement with the mistake, or what it has become
    texts   path in the shaders' folder -> text of the changed file
    driver  name of the driver that must show the mistake
    common  whether parity must notice it, because the languages share the statement
    frames  labels of the frames to draw; empty: all that use the function or entry
    argued  reason why no frame can show it; '' if one can
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
    """Return path in the shaders' folder -> text of every shader file."""
    keys = [keys[language] for keys in parity.FILES.values() for language in paths.LANGUAGES]
    return {key: (paths.shaders() / key).read_text(encoding="ascii") for key in keys}


def together(texts: Mapping[str, str], language: str) -> str:
    """Return all files of a language as one text, with some replaced by these texts."""
    return "".join(text for key, text in {**originals(), **texts}.items() if key.startswith(f"{language}/"))
