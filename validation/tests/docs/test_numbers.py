"""Numbers of the documents are those of docs/data: a digit that is changed on a page alone fails here.

truth.json is what `validation/run truth --json` wrote; test_truth.py measures some of its rows anew. peers.json and
printed.json say in `source` where theirs come from. README's table is held to docs/results.md by test_docs.py.
"""

import hashlib
import json
import re

from bokeh_validation import paths, truth
from lab.other_effects.effects import FOUND

PRINTED = ("results.md", "cost.md")
KNOWN = truth.METHODS
Table = list[list[str]]


def tables(text: str) -> list[Table]:
    """The tables of a page, each its rows of cells; the line under the header is left out."""
    found: list[Table] = []
    inside = False
    for line in text.splitlines():
        if not line.startswith("|"):
            inside = False
            continue
        cells = [cell.strip() for cell in line.strip().removeprefix("|").removesuffix("|").split("|")]
        if not inside:
            found.append([])
        inside = True
        if not all(re.fullmatch(r":?-+:?", cell) for cell in cells):
            found[-1].append(cells)
    return found


def numeric(table: Table) -> bool:
    """Whether any cell but those of the header and of the first column begins with a digit."""
    return any(re.match(r"[.\d]", cell) for _, *cells in table[1:] for cell in cells)


def data(name: str) -> dict:
    """A file of docs/data."""
    return json.loads((paths.ROOT / f"docs/data/{name}.json").read_text(encoding="utf-8"))


def digests() -> dict[str, str]:
    """'scene, effect' -> hash of the parameters that it was measured with."""
    found = {}
    for scene, effects in FOUND.items():
        for effect, parameters in effects.items():
            text = json.dumps(parameters, sort_keys=True)
            found[f"{scene}, {effect}"] = hashlib.sha256(text.encode()).hexdigest()[:16]
    return found


def ray_traced() -> Table:
    """The table of all methods and effects on the ray-traced scenes."""
    page = (paths.ROOT / "docs/results.md").read_text(encoding="utf-8")
    (found,) = [table for table in tables(page) if table[0][1:2] == ["market_7"]]
    return found


def test_ray_traced_scenes():
    """Each cell of docs/results.md is truth.json's, or peers.json's, rounded as truth.markdown() does."""
    recorded = {(row["label"], row["scene"]): row for name in ("truth", "peers") for row in data(name)["rows"]}
    (_, *scenes, last), *rows = ray_traced()
    assert last == "one light" and {label for label, *_ in rows} == {label for label, _ in recorded}
    for label, *cells in rows:
        for scene, cell in zip(scenes, cells[:-1], strict=True):
            wanted = "{flip:.4f}/{psnr:.2f}/{light:.3f}".format_map(recorded[label, scene])
            assert cell == wanted, (label, scene)
    assert {label: cells[-1] for label, *cells in rows if cells[-1]} == data("peers")["one light"]


def test_effects_have_the_parameters_that_were_measured():
    """A parameter of found.json that is changed needs the effect measured anew, and with it this digest."""
    assert data("peers")["parameters"] == digests()


def test_tables():
    """All other tables with numbers of results.md and cost.md are printed.json's."""
    for name in PRINTED:
        page = (paths.ROOT / "docs" / name).read_text(encoding="utf-8")
        shown = [table for table in tables(page) if numeric(table) and table[0][1:2] != ["market_7"]]
        assert [[" | ".join(row) for row in table] for table in shown] == data("printed")["tables"][name], name
