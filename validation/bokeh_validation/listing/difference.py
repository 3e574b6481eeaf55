"""What the parity check reports."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import zip_longest


@dataclass(frozen=True)
class Difference:
    """One thing that is not the same in the languages, or breaks a rule.

    where  section and function, or file and line
    what   what is wrong
    text   language -> 'line n: text', or what stands for it
    """

    where: str
    what: str
    text: Mapping[str, str] = field(default_factory=dict)

    def __str__(self) -> str:
        lines = [f"{self.where}: {self.what}"]
        return "\n".join(lines + [f"    {language:5} {text}" for language, text in self.text.items()])


def first_unequal(where: str, what: str, lines: Mapping[str, Sequence[str]]) -> Iterator[Difference]:
    """The first line that is not the same everywhere."""
    for row in zip_longest(*lines.values(), fillvalue="(nothing)"):
        if len(set(row)) > 1:
            yield Difference(where, what, dict(zip(lines, row, strict=True)))
            return
