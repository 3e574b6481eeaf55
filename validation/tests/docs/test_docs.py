"""The documents against the code: tables and names are those of the code, links lead somewhere.

The README's snippets are run by test_paste.py.
"""

import re
from math import atan, exp, inf, tan
from pathlib import Path

import pytest

from bokeh_validation import paths
from bokeh_validation.frame import fetches, methods


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


def test_fetches_of_the_readme():
    """Those of a hexagon at 1920 x 1080 by `exact` and `layered`, with each preset of the library."""
    readme = (paths.ROOT / "README.md").read_text(encoding="utf-8")
    shown = re.findall(r"^\| `BOKEH_PRESET_(\w+)` \| (\d+) \| (\d+) \|$", readme, re.MULTILINE)
    assert [name.lower() for name, *_ in shown] == list(methods.PRESETS)
    for name, *numbers in shown:
        for number, method in zip(numbers, ("exact", "layered"), strict=True):
            settings = methods.Settings(method, preset=name.lower())
            counts = fetches.of_frame(methods.plan(settings, (1920, 1080)).passes)
            assert int(number) == round(counts["color"] + counts["depth"]), (name, settings.method)


def test_results_of_the_readme():
    """The README's FLIP of three scenes and light kept are those of docs/results.md, fetches those of the presets."""

    def rows(text: str, after: str) -> dict[str, list[str]]:
        lines = re.findall(r"^\| ([^|].*) \|$", text.split(after, 1)[1].split("\n## ")[0], re.MULTILINE)
        cells = [line.split(" | ") for line in lines]
        return {label: others for label, *others in cells}

    text = (paths.ROOT / "README.md").read_text(encoding="utf-8")
    readme = rows(text, "## Beside others")
    results = rows((paths.ROOT / "docs/results.md").read_text(encoding="utf-8"), "## Ray-traced scenes")
    assert rows(text, "## Presets")["`BOKEH_PRESET_MEDIUM`"][1] == readme["layered medium"][0]
    for label, (_, *shown) in readme.items():
        (cells,) = [cells for name, cells in results.items() if re.fullmatch(rf"{label}( [\d.]+)?", name)]
        (flip, _, light), *others = (cell.split("/") for cell in cells[:3])
        assert shown == [flip, *(other[0] for other in others), light], label


def test_pitfalls_name_tests():
    """Every test that docs/troubleshooting.md names is there."""
    text = (paths.ROOT / "docs/troubleshooting.md").read_text(encoding="utf-8")
    named = re.findall(r"`(test_\w+\.py)(?:::(test_\w+))?`", text)
    assert named
    for file, name in named:
        source = next((paths.VALIDATION / "tests").rglob(file)).read_text(encoding="utf-8")
        assert not name or re.search(rf"^(?:    )?def {name}\(", source, re.MULTILINE), f"{file}::{name}"


# ----------------------------------------------------------------------------------------------------------------------
# docs/lens.md: its code, run
# ----------------------------------------------------------------------------------------------------------------------

LENS_PAGE = (paths.ROOT / "docs/lens.md").read_text(encoding="utf-8")
SENSOR = 0.024


def run(code: str, **names: float) -> dict[str, float]:
    """The names after a block of the page, which is C and, without types and semicolons, Python."""
    names |= {"tan": tan, "exp": exp, "max": max}
    exec(code.replace("float ", "").replace(";", ""), names)
    return names


LENS, PULL = re.findall(r"^```c\n(.*?)^```", LENS_PAGE, re.MULTILINE | re.DOTALL)


def test_formulas():
    """f gives the field of view back, A / f is 1 / N, and the matrix's element gives the same f."""
    lens = run(LENS, fovy=1.0, fStop=2.8, sensorHeight=SENSOR)
    assert 2.0 * atan(0.5 * SENSOR / lens["focalLength"]) == pytest.approx(1.0)
    assert lens["apertureDiameter"] * 2.8 == pytest.approx(lens["focalLength"])
    assert "0.5 * sensorHeight * abs(P[1][1])" in LENS_PAGE
    assert 0.5 * SENSOR / tan(0.5) == pytest.approx(lens["focalLength"])


@pytest.mark.parametrize("rate", [24, 60, 144])
def test_pull(rate):
    """The way left is exp(-t / tau) at any frame rate, the nearest wins, and the sky is no trouble."""
    pulled, tau = 1 / 10.0, 0.25
    for _ in range(rate):
        pulled = run(PULL, dt=1 / rate, tau=tau, d0=inf, d1=2.0, d2=5.0, pulled=pulled)["pulled"]
    assert 1 / 2.0 - pulled == pytest.approx((1 / 2.0 - 1 / 10.0) * exp(-1 / tau))
    assert f"After 3 tau {100 * exp(-3):.0f} % is left" in LENS_PAGE
