"""The documents against the code: tables and names are those of the code, links lead somewhere.

The README's snippets are run by test_paste.py.
"""

import re
from pathlib import Path

from bokeh_validation import paths
from bokeh_validation.frame import methods


def prose(document: Path) -> str:
    """A document without its code."""
    return re.sub(r"^ *```.*?^ *```", "", document.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)


def anchors(document: Path) -> set[str]:
    """What a link may name of its headings, as GitHub makes it of them."""
    heads = re.findall(r"^#+ (.*)$", prose(document), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


def test_links_exist():
    """Every relative link leads to a file, and to a heading in it; what looks like a link in code is none."""
    documents = [
        path for folder in ("docs", "integration", "validation") for path in (paths.ROOT / folder).rglob("*.md")
    ]
    for document in (paths.ROOT / "README.md", paths.ROOT / "CHANGELOG.md", *documents):
        for target, anchor in re.findall(r"\]\(([^)#]*)#?([^)]*)\)", prose(document)):
            if not re.match(r"[a-z]+:", target):
                file = document.parent / target if target else document
                assert file.exists(), f"{document.name}: {target}"
                assert not anchor or anchor in anchors(file), f"{document.name}: {target}#{anchor}"


def test_costs_of_the_readme():
    """The README's fetches and times are those of docs/performance.md, which test_isa.py holds to the compilers."""
    readme = (paths.ROOT / "README.md").read_text(encoding="utf-8")
    page = (paths.ROOT / "docs/performance.md").read_text(encoding="utf-8")
    presets = re.findall(r"^\| `BOKEH_PRESET_(\w+)` \| (.*) \|$", readme, re.MULTILINE)
    assert [name.lower() for name, _ in presets] == list(methods.PRESETS)
    for name, cells in presets:
        wanted = []
        for method in ("exact", "layered"):
            row = rf"^\| {method} hexagon {name} \| \d+ \| (\d+) \| [^|]* \| ([\d.]+) [^|]* \| ([\d.]+) "
            fetches, *times = re.search(row, page, re.MULTILINE).groups()
            wanted += [fetches, *(f"{time} ms" for time in times)]
        assert cells.split(" | ") == wanted, name


def test_pitfalls_name_tests():
    """Every test that docs/pitfalls.md names is there."""
    text = (paths.ROOT / "docs/pitfalls.md").read_text(encoding="utf-8")
    named = re.findall(r"`(test_\w+\.py)(?:::(test_\w+))?`", text)
    assert named
    for file, name in named:
        source = next((paths.VALIDATION / "tests").rglob(file)).read_text(encoding="utf-8")
        assert not name or re.search(rf"^(?:    )?def {name}\(", source, re.MULTILINE), f"{file}::{name}"
