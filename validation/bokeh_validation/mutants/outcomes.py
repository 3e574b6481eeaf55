"""What became of the mutants: as a file in the cache folder, which the report shows, and on the terminal."""

import datetime
import hashlib
import json
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from bokeh_validation import paths
from bokeh_validation.mutants.mutant import originals

CAUGHT, ALIVE, ARGUED, BROKEN = "caught", "alive", "argued", "broken"
MEANINGS = {ALIVE: "no test fails: a test is missing", ARGUED: "no test can fail", BROKEN: "it proves nothing"}


@dataclass
class Result:
    """What became of a mutant.

    outcome  caught: a test failed that passes without the change. alive: none did. argued: none did, and the table
             has the reason why none can. broken: a test ended with an error or fails without the change as well, or
             the mistake is not the same in all languages.
    test     the one that failed
    detail   what that test said, or why it is argued or broken
    parity   whether the parity check finds it
    """

    name: str
    kind: str
    languages: Sequence[str]
    place: str
    change: str
    outcome: str = ALIVE
    parity: bool = False
    test: str = ""
    detail: str = ""
    seconds: float = 0.0

    @property
    def ok(self) -> bool:
        """Caught, or argued."""
        return self.outcome in (CAUGHT, ARGUED)


def lines(results: Sequence[Result], seconds: float) -> Iterator[str]:
    """Every mutant that was not caught, what caught the others, and the sum."""
    for result in results:
        if result.outcome != CAUGHT:
            said = " ".join(part for part in (result.test, result.detail) if part)[:500]
            became = f"{result.outcome}, {MEANINGS[result.outcome]}"
            yield f"{result.name} ({result.place}: {result.change}): {became} ({said})"
    caught = [result for result in results if result.outcome == CAUGHT]
    for file, count in Counter(result.test.partition("::")[0] for result in caught).most_common():
        yield f"caught by {file}: {count}"
    count = Counter(result.outcome for result in results)
    yield (
        f"{len(caught)} of {len(results)} mutants caught, {count[ARGUED]} argued, {count[ALIVE]} alive, "
        f"{count[BROKEN]} broken ({seconds:.0f} s)"
    )


def default_path() -> Path:
    """Beside the report."""
    return paths.cache_folder() / "report" / "mutants.json"


def _digest() -> str:
    """Tells whether results are of the shaders that are here."""
    return hashlib.sha256("".join(originals().values()).encode()).hexdigest()


def as_json(results: Sequence[Result], seconds: float) -> dict:
    """Everything of a run."""
    return {
        "date": datetime.datetime.now().astimezone().strftime("%Y-%m-%d %H:%M %Z"),
        "seconds": round(seconds, 1),
        "shaders": _digest(),
        "mutants": [asdict(result) for result in results],
    }


def read() -> dict | None:
    """What was written, `mutants` as Result, `current`: whether it is of these shaders. None where there is none.

    A file that cannot be read is none: it is made again by a run.
    """
    try:
        found = json.loads(default_path().read_text(encoding="utf-8"))
        mutants = [Result(**one) for one in found["mutants"]]
        return {**found, "mutants": mutants, "current": found["shaders"] == _digest()}
    except (OSError, ValueError, KeyError, TypeError):
        return None
