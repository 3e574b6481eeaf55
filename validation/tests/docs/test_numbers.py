"""Compare the numbers in the documents with docs/data: a digit changed only on a page fails here.

truth.json was written by `validation/run truth --json`; test_truth.py measures some of its rows again. peers.json and
printed.json state their origin in `source`. `validation/run generate` writes the tables. test_docs.py compares
README's table with docs/data.
"""

import csv
import json
import re
from statistics import mean

import pytest

from bokeh_validation import generate, paths
from bokeh_validation.generate import results

Table = list[list[str]]


def tables(text: str) -> list[Table]:
    """Return the tables of a page as rows of cells, without the line under the header."""
    all_tables: list[Table] = []
    inside = False
    for line in text.splitlines():
        if not line.startswith("|"):
            inside = False
            continue
        cells = [cell.strip() for cell in line.strip().removeprefix("|").removesuffix("|").split("|")]
        if not inside:
            all_tables.append([])
        inside = True
        if not all(re.fullmatch(r":?-+:?", cell) for cell in cells):
            all_tables[-1].append(cells)
    return all_tables


def numeric(table: Table) -> bool:
    """Return whether a cell outside the header and the first column begins with a digit."""
    return any(re.match(r"[.\d]", cell) for _, *cells in table[1:] for cell in cells)


def data(name: str) -> dict:
    """Return the content of a JSON file of docs/data."""
    return json.loads((paths.ROOT / f"docs/data/{name}.json").read_text(encoding="utf-8"))


def page_tables(name: str) -> list[Table]:
    """Return the tables with numbers on a page of docs."""
    page = (paths.ROOT / "docs" / name).read_text(encoding="utf-8")
    return [table for table in tables(page) if numeric(table)]


@pytest.mark.parametrize(("place", "key", "digits"), [(0, "flip", 4), (1, "psnr", 2), (2, "light", 3)])
def test_ray_traced_scenes(place, key, digits):
    """Compare the first three tables of docs/results-data.md with truth.json and peers.json, rounded."""
    recorded = {(row["label"], row["scene"]): row for name in ("truth", "peers") for row in data(name)["rows"]}
    (_, *scenes), *rows = page_tables("results-data.md")[place]
    assert {(label, scene) for label, *_ in rows for scene in scenes} == set(recorded)
    for label, *cells in rows:
        expected = [f"{recorded[label, scene][key]:.{digits}f}" for scene in scenes]
        assert cells == expected, label


def test_comparison():
    """Compare the first table of docs/results.md with the FLIP of results-data.md; it also has the mean, in
    ascending order.
    """
    (_, *scenes, last), *rows = page_tables("results.md")[0]
    ((_, *others), *data_rows) = page_tables("results-data.md")[0]
    assert scenes == others and last == "mean"
    assert {label: cells[:-1] for label, *cells in rows} == {label: cells for label, *cells in data_rows}
    means = [float(cells[-1]) for _, *cells in rows]
    assert means == sorted(means)
    for _, *cells in rows:
        assert mean(map(float, cells[:-1])) == pytest.approx(float(cells[-1]), abs=1e-4)


@pytest.mark.parametrize("name", ["results.md", "results-data.md", "cost.md", "compilers.md"])
def test_tables(name):
    """Check that a page has the tables that follow from docs/data, and no other table with numbers."""
    assert sorted(page_tables(name)) == sorted(results.tables()[name].values())


def test_cells():
    """Check that a cell of a results table holds at most one number, and that docs/data/results.csv has each cell
    once.
    """
    listed = (paths.ROOT / results.CSV).read_text(encoding="utf-8").splitlines()
    shown = 0
    for name, named in results.tables().items():
        for header, *rows in named.values():
            labels = 2 if header[1] == "preset" else 1
            for row in rows:
                assert all(re.fullmatch(r"-?[\d.]+", cell) for cell in row[labels:]), (name, row)
                shown += len(row) - labels if name != "results.md" else 0
    assert len(listed) == shown + 1


def test_a_changed_digit_is_found():
    """Check that `generate --check` notices a number changed by hand on a page."""
    text = (paths.ROOT / "docs/results-data.md").read_text(encoding="utf-8")
    first = page_tables("results-data.md")[0][1][1]
    regions = dict(generate.rendered())["docs/results-data.md"]
    assert generate.replaced("page", text, regions) == text
    assert generate.replaced("page", text.replace(first, "0.9999", 1), regions) == text


# Numbers of prose that no file of docs/data has
WINTER = "winter_3 is measured by hand; its image is not in the repository's data"
VERSION_2 = "measured with version 0.2"
VERSIONS = "versions of three.js"
BEFORE = "exact on the random scenes, before squares, octagons and decagons weighted samples by their own CoC"
EXCEPTIONS = {
    "README.md": {"0.036": "the lens of an example"},
    "docs/results.md": {
        **dict.fromkeys(("0.173", "0.181", "0.233", "0.331", "0.994"), WINTER),
        **dict.fromkeys(("0.1390", "0.2671", "0.0415"), VERSION_2),
        "0.0031": "the FLIP of exact MEDIUM is measured by hand",
    },
    "CHANGELOG.md": {
        **dict.fromkeys(("0.172", "0.187"), VERSIONS),
        "0.107": BEFORE,
        "0.0001": "a bound",
    },
}
# A row of CHANGELOG.md: method, scene, FLIP of version 0.2 and of this one
CHANGED = re.compile(r"^\| `(\w+)`(.*?) \| ([\w ]+) \| (\d\.\d{3}) \| (\d\.\d{3}) \|$", re.MULTILINE)


def numbers() -> list[float]:
    """Return the measured numbers of docs/data, times excepted, and the means over the five scenes."""
    with open(paths.ROOT / results.CSV, encoding="utf-8", newline="") as file:
        listed = [float(row["value"]) for row in csv.DictReader(file) if not row["table"].startswith("times")]
    rows = results.ray_traced().values()
    return [
        *listed,
        *(row[key] for scenes in rows for row in scenes.values() for key in results.MEASURES),
        *(mean(scenes[name][key] for name in results.SCENES) for scenes in rows for key in results.MEASURES),
    ]


@pytest.mark.parametrize("name", EXCEPTIONS)
def test_prose(name):
    """Check that each number with three or four decimal places outside generated tables is in docs/data, rounded.

    It need not be the number that the sentence is about: of all numbers below 1, docs/data has a third of those with
    three places, and a twentieth of those with four.
    """
    text = (paths.ROOT / name).read_text(encoding="utf-8")
    text = CHANGED.sub("", re.sub(r"(?s)<!-- generated .*?begin -->.*?end -->", "", text))
    found = re.findall(r"(?<![\d.])\d\.\d{3,4}(?!\d|\.\d)", text)
    recorded = {f"{value:.{digits}f}" for value in numbers() for digits in (3, 4)}
    assert found and [one for one in found if one not in recorded and one not in EXCEPTIONS[name]] == []


def test_changelog():
    """Compare this version's FLIP in CHANGELOG.md with docs/data, rounded."""
    text = (paths.ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    recorded = {
        (label, scene): row["flip"] for label, rows in results.ray_traced().items() for scene, row in rows.items()
    }
    random = {
        label: float(flip)
        for label, flip, *_ in data("printed")["tables"]["results-data.md"]["random scenes, FLIP"][1:]
    }
    recorded |= {(label, "random scenes"): flip for label, flip in random.items()}
    rows = {(f"{method}{preset.lower()}", scene): flip for method, preset, scene, _, flip in CHANGED.findall(text)}
    assert len(rows) == 12 and rows == {key: f"{recorded[key]:.3f}" for key in rows}
