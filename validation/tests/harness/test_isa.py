"""What the GPUs' compilers count: against the fetches that the shaders' loops say, and against earlier counts.

The compiler of AMD's driver comes with the system's Mesa. Another version counts otherwise, so the table is for one:
`validation/run isa --table validation/tests/harness/isa_stock.tsv` makes it anew.
"""

import re
from collections import defaultdict
from dataclasses import astuple, replace
from pathlib import Path

import pytest
from support import load

from bokeh_validation import bench, paths
from bokeh_validation.frame import fetches
from bokeh_validation.frame.methods import Settings
from bokeh_validation.isa import compiled, estimate, isa_command
from bokeh_validation.isa.targets import STOCK, Count
from bokeh_validation.shaders.entries import EXACT

TABLE = Path(__file__).with_name("isa_stock.tsv")
MESA = "22.3.6"  # of the table and of the documents
# of a count in the table: a compiler may order instructions otherwise, and moves a few copies with it
TOLERANCE = 0.05
# Fetches that a compiler leaves out, since the program has made them already: the middle sample of a line of the
# paper's is the pixel itself, colour and depth; LayerSizes looks at its tile's reach twice, LayerSplit at four pixels
# three times
AGAIN = {"BokehDepthOfField": 2, "BokehDepthOfFieldFinal": 2, "BokehLayerSizes": 1, "BokehLayerSplit": 8}


@pytest.fixture(scope="module")
def stock(request) -> isa_command.Counts:
    """All programs on the system's own compiler: for one GPU, with --all for three."""
    names = [target.name for target in STOCK] if request.config.getoption("--all") else ["navi21"]
    counts = isa_command.count(compiled.all_methods(), names)
    if counts.mesa.get("navi21") != MESA:
        pytest.skip(f"no compiler of Mesa {MESA} for AMD: {counts.missing or counts.mesa}")
    return counts


def test_counts_of_the_table(stock):
    """As before, within TOLERANCE; fetches, and that nothing spills, exactly. GLSL's and HLSL's."""
    table = defaultdict(dict)
    for line in TABLE.read_text(encoding="ascii").splitlines():
        target, _, language, name, *numbers = line.split("\t")
        table[target, language][name] = Count(*map(int, numbers))
    for (target, language), programs in stock.found.items():
        before = table[target, language]
        assert before.keys() == {name for name in programs if not name.endswith(compiled.PATH)}, "make the table anew"
        for name, was in before.items():
            now = programs[name]
            assert (now.texture, now.spills) == (was.texture, 0), (target, language, name)
            pairs = zip(astuple(now), astuple(was), strict=True)
            assert all(abs(new - old) <= TOLERANCE * old for new, old in pairs), (target, language, name, now, was)


def test_figures_of_the_document(stock):
    """docs/performance.md: the milliseconds of the GPU whose compiler is here, and latencies of HLSL and GLSL on it."""
    page = (paths.ROOT / "docs/performance.md").read_text(encoding="utf-8")
    row = re.compile(r"^\| (\w+ \w+ [A-Z]+) \| \d+ \| (\d+) \| (.+?) \|", re.MULTILINE)
    shown = {name.lower(): cells for name, *cells in row.findall(page)}
    assert len(shown) > 10
    for method in compiled.all_methods():
        if cells := shown.pop(method.name, None):
            cost = estimate.cost(method, stock.found["navi21", "glsl"], estimate.DEVICES[0])
            assert cells == [f"{method.fetches:.0f}", cost.text((1920, 1080))], method.name
    assert not shown
    latencies = re.findall(r"(\d+) (?:cycles )?against (\d+)\s+for\s(\w+)", page)
    assert len(latencies) == 4
    for hlsl, glsl, name in latencies:
        assert stock.found["navi21", "hlsl"][name].latency == int(hlsl)
        assert stock.found["navi21", "glsl"][name].latency == int(glsl)


def test_character_of_the_document(stock):
    """docs/character.md: instructions of `exact` plain, with a cat's eye, with axial colour, along the path."""
    page = (paths.ROOT / "docs/character.md").read_text(encoding="utf-8")
    rows_shown = re.findall(r"^\| (\w+) \|" + r" (\d+) \|" * 3, page, re.MULTILINE)
    shown = {name: list(map(int, cells)) for name, *cells in rows_shown}
    assert len(shown) == 5
    for shape in EXACT:
        plain = Settings("exact", shape, spacing=1.5, samples=9)
        kinds = (plain, replace(plain, cats_eye=0.5), replace(plain, axial=(0.01, 0.01)))
        every = [compiled.Method(str(index), settings) for index, settings in enumerate(kinds)]
        # a program's name does not say its character
        counts = [isa_command.count([method], ["navi21"], ["glsl"]).found["navi21", "glsl"] for method in every]
        for items in zip(*(method.passes[1:] for method in every), strict=True):
            three = [estimate.along_path(item, count) for item, count in zip(items, counts, strict=True)]
            # a compiler may keep the pixel itself from the first channel for the other two
            assert 3 * three[0].texture - three[2].texture in (0, 1, 2)
            name = items[0].entry.removeprefix("Bokeh")
            assert shown.get(name) in (None, [count.instructions for count in three]), name


def test_fetches_on_the_path(stock):
    """A program with its loops written out has as many fetches as its loops say, not one more or fewer."""
    for method in compiled.all_methods():
        for item in method.passes:
            count = estimate.along_path(item, stock.found["navi21", "glsl"])
            expected = sum(fetches.of_pass(item).values()) if item.spec.role != "copy" else 2
            # both sides of a branch are in the code: a polygon of a layer, or one fetch
            expected += item.spec.layers and item.spec.sides > 0
            assert count.texture == expected - AGAIN.get(item.entry, 0), (item.entry, count, expected)


@pytest.mark.alone
def test_order_of_the_methods(stock):
    """A software driver has no texture units: by their arithmetic the methods come in the order of their time on it."""
    size, keys = (480, 270), ("paper hexagon", "exact hexagon", "layered low", "layered medium")
    chosen = [row for row in bench.in_depth(size) if row.key in keys]
    _, measured = bench.measured(load("osmesa"), chosen, size, 5)
    times = {row["key"]: row["seconds"]["median"] for row in measured}
    counts, device = stock.found["navi21", "glsl"], estimate.DEVICES[0]
    methods = [compiled.Method(row.key, row.settings) for row in chosen]
    estimated = {method.name: estimate.cost(method, counts, device).work["arithmetic"] for method in methods}
    assert sorted(times, key=times.get) == sorted(estimated, key=estimated.get), (times, estimated)
