"""What a mutant is, and what became of all: on the terminal, and as a file that the report shows."""

import datetime
import hashlib
import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import NamedTuple

from bokeh_validation import paths
from bokeh_validation.shaders import parity

CAUGHT, ALIVE, EQUIVALENT, BROKEN, REFUSED = "caught", "alive", "equivalent", "broken", "refused"
MEANINGS = {
    ALIVE: "a frame is missing, or equivalents.txt needs a reason why none can show it",
    BROKEN: "it proves nothing",
}


@dataclass(frozen=True)
class Mutant:
    """The shaders of a language with one mistake.

    place   the function or entry that it is in; an entry's name ends in _PS or _VS
    change  what stood there and what does now
    texts   path in the shaders' folder -> text, of the file that is changed
    driver  the one that has to show it; none where only the parity check has to see it
    common  whether the parity check has to see it: the languages have the statement in common
    frames  those that are asked; none: all that use the place
    argued  why none can show it
    """

    name: str
    kind: str
    language: str
    place: str
    change: tuple[str, str]
    texts: Mapping[str, str]
    driver: str = "egl"
    common: bool = True
    frames: tuple[str, ...] = ()
    argued: str = ""


class Verdict(NamedTuple):
    """What became of a mutant.

    outcome  caught: the parity check sees it, and a pass of a frame is not where it has to be. alive: not so.
             equivalent: no frame shows it, and equivalents.txt has the reason. refused: the compiler does not take it.
             broken: it ended with another error, or not at all.
    judge    the frame that shows it, or 'parity'
    detail   how, or why it is equivalent or broken
    """

    outcome: str
    judge: str
    detail: str


def row(mutant: Mutant, verdict: Verdict, seconds: float) -> dict:
    """Of the table of results."""
    told = {name: getattr(mutant, name) for name in ("name", "kind", "language", "place")}
    change = " -> ".join(" ".join(text.split()) or "(nothing)" for text in mutant.change)
    ok = verdict.outcome not in MEANINGS
    return {**told, "change": change, **verdict._asdict(), "ok": ok, "seconds": round(seconds, 2)}


def lines(rows: Sequence[dict], seconds: float) -> Iterator[str]:
    """Every mutant that is alive or broken, and the sums."""
    for item in rows:
        if not item["ok"]:
            said = f"{item['outcome']}: {MEANINGS[item['outcome']]}"
            yield f"{item['name']} ({item['change']}): {said} ({item['detail']})"
    count = Counter(item["outcome"] for item in rows)
    yield (
        f"{count[CAUGHT]} of {len(rows)} mutants caught, {count[EQUIVALENT]} equivalent, {count[REFUSED]} refused by "
        f"the compiler, {count[ALIVE]} alive, {count[BROKEN]} broken ({seconds:.0f} s)"
    )


@cache
def originals() -> Mapping[str, str]:
    """Path in the shaders' folder -> text, of the nine files."""
    keys = [keys[language] for keys in (parity.LIBRARY, parity.LAYERS, parity.PASSES) for language in paths.LANGUAGES]
    return {key: (paths.shaders() / key).read_text(encoding="ascii") for key in keys}


def default_path() -> Path:
    """Beside the report."""
    return paths.cache_folder() / "report" / "mutants.json"


def _digest() -> str:
    """Tells whether results are of the shaders that are here."""
    return hashlib.sha256("".join(originals().values()).encode()).hexdigest()


def as_json(rows: Sequence[dict], seconds: float) -> dict:
    """Everything of a run."""
    date = datetime.datetime.now().astimezone().strftime("%Y-%m-%d %H:%M %Z")
    return {"date": date, "seconds": round(seconds, 1), "shaders": _digest(), "mutants": rows}


def read() -> dict | None:
    """What was written, and `current`: whether it is of these shaders. None where there is none that can be read."""
    try:
        found = json.loads(default_path().read_text(encoding="utf-8"))
        return {**found, "current": found["shaders"] == _digest()}
    except (OSError, ValueError, KeyError):
        return None
