"""Statements of the languages beside each other, row by row, however many one of them lacks."""

from collections.abc import Mapping, Sequence
from itertools import zip_longest

from bokeh_validation.listing.normal import Statement

# Costs of an alignment. Two gaps are dearer than one unequal pair, so that a changed line stands beside its like.
UNEQUAL, GAP, MARKED_PAIR, MARKED_GAP = 1.0, 0.6, 0.1, 0.3

# language -> its statement, or None where it has none
Row = dict[str, Statement | None]


def rows(statements: Mapping[str, Sequence[Statement]]) -> list[Row]:
    """Statements of every language in rows: each language aligned with the first, what that one lacks in between."""
    base, *others = statements
    first = statements[base]
    beside: dict[str, list[Statement | None]] = {}
    inserted: dict[str, list[list[Statement]]] = {}
    for other in others:
        beside[other] = [None] * len(first)
        inserted[other] = [[] for _ in range(len(first) + 1)]
        gap = 0
        for left, right in _aligned(first, statements[other]):
            if left is None and right is not None:
                inserted[other][gap].append(statements[other][right])
            elif left is not None:
                beside[other][left] = None if right is None else statements[other][right]
                gap = left + 1
    found: list[Row] = []
    for index in range(len(first) + 1):
        for extra in zip_longest(*(inserted[other][index] for other in others)):
            found.append({base: None, **dict(zip(others, extra, strict=True))})
        if index < len(first):
            found.append({base: first[index], **{other: beside[other][index] for other in others}})
    return found


def agree(row: Row) -> bool:
    """Whether all that is not marked is the same, or is nowhere.

    A mark exempts its own statement from comparison with the others, not the others from comparison with each other.
    """
    unmarked = [statement for statement in row.values() if statement is None or not is_marked(statement)]
    return len({None if statement is None else statement.words for statement in unmarked}) < 2


def is_marked(statement: Statement) -> bool:
    """Whether it carries `// differs: reason`."""
    return statement.reason is not None


def _aligned(left: Sequence[Statement], right: Sequence[Statement]) -> list[tuple[int | None, int | None]]:
    """Pairs of indices with the least cost: equal ones free, marked ones beside anything or nothing nearly free."""
    if [one.words for one in left] == [one.words for one in right]:
        return [(index, index) for index in range(len(left))]
    costs = [[0.0] * (len(right) + 1) for _ in range(len(left) + 1)]
    steps: list[list[tuple[int, int]]] = [[(0, 0)] * (len(right) + 1) for _ in range(len(left) + 1)]
    for i in range(len(left) + 1):
        for j in range(len(right) + 1):
            ways = []
            if i and j:
                ways.append((costs[i - 1][j - 1] + _pair_cost(left[i - 1], right[j - 1]), (1, 1)))
            if i:
                ways.append((costs[i - 1][j] + _gap_cost(left[i - 1]), (1, 0)))
            if j:
                ways.append((costs[i][j - 1] + _gap_cost(right[j - 1]), (0, 1)))
            if ways:
                costs[i][j], steps[i][j] = min(ways)
    pairs: list[tuple[int | None, int | None]] = []
    i, j = len(left), len(right)
    while i or j:
        a, b = steps[i][j]
        pairs.append((i - 1 if a else None, j - 1 if b else None))
        i, j = i - a, j - b
    return pairs[::-1]


def _pair_cost(left: Statement, right: Statement) -> float:
    if left.words == right.words:
        return 0.0
    return MARKED_PAIR if is_marked(left) or is_marked(right) else UNEQUAL


def _gap_cost(statement: Statement) -> float:
    return MARKED_GAP if is_marked(statement) else GAP
