"""What a run says on the terminal."""

from collections import Counter
from collections.abc import Iterator

from bokeh_validation.mutants.model import ALIVE, ARGUED, BROKEN, CAUGHT, UNPROVEN, Result
from bokeh_validation.mutants.runner import Run

MEANINGS = {
    ALIVE: "no test fails: a test is missing",
    ARGUED: "no test can fail",
    BROKEN: "it proves nothing",
    UNPROVEN: "its tests do not pass without it",
}


def lines(run: Run, seconds: float) -> Iterator[str]:
    """Every mutant that was not caught, what caught the others, and the sum."""
    for result in run.results:
        if result.outcome != CAUGHT:
            yield f"{result.name} ({', '.join(result.places)}: {result.change}): {result.outcome}, {_why(result)}"
    for file, count in by_file(run.results).most_common():
        yield f"caught by {file}: {count}"
    caught = sum(result.outcome == CAUGHT for result in run.results)
    argued = sum(result.outcome == ARGUED for result in run.results)
    yield f"{caught} of {len(run.results)} mutants caught, {argued} argued ({seconds:.0f} s)"


def by_file(results: list[Result]) -> Counter[str]:
    """Test file -> how many it caught."""
    return Counter(result.test.partition("::")[0] for result in results if result.outcome == CAUGHT)


def _why(result: Result) -> str:
    said = " ".join(part for part in (result.test, result.detail) if part)
    return f"{MEANINGS[result.outcome]}{f' ({said[:500]})' if said else ''}"
