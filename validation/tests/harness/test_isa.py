"""What the GPUs' compilers count: against the fetches that the shaders' loops say, and against earlier counts.

The compiler of AMD's driver comes with the system's Mesa. Another version counts otherwise, so the table is for one:
`validation/run isa --table validation/tests/harness/isa_stock.tsv` makes it anew.
"""

import re
from collections import defaultdict
from dataclasses import astuple, replace
from pathlib import Path

import pytest
from support import called, load

from bokeh_validation import bench, paths
from bokeh_validation.frame import fetches
from bokeh_validation.frame.methods import Settings, plan
from bokeh_validation.isa import compiled, estimate, isa_command
from bokeh_validation.isa.targets import STOCK, Count
from bokeh_validation.isa.unrolled import unrolled
from bokeh_validation.shaders.entries import EXACT

TABLE = Path(__file__).with_name("isa_stock.tsv")
# of a count in the table: a compiler may order instructions otherwise, and moves a few copies with it
TOLERANCE = 0.05
# Fetches that a compiler leaves out, since the program has made them already: the middle sample of a line of the
# paper's is the pixel itself, colour and depth; LayerSizes looks at its tile's reach twice, LayerSplit at four pixels
# three times
AGAIN = {"BokehDepthOfField": 2, "BokehDepthOfFieldFinal": 2, "BokehLayerSizes": 1, "BokehLayerSplit": 8}


@pytest.fixture(scope="module")
def stock() -> isa_command.Counts:
    """All programs on the system's own compiler."""
    counts = isa_command.count(compiled.all_methods(), [target.name for target in STOCK])
    if not counts.found:
        pytest.skip(f"no compiler of AMD's driver: {counts.missing}")
    return counts


def known() -> dict[str, dict[str, Count]]:
    """Target and version -> program -> count, of the table."""
    found = defaultdict(dict)
    for line in TABLE.read_text(encoding="ascii").splitlines():
        target, version, name, *values = line.split("\t")
        found[target, version][name] = Count(*map(int, values))
    return found


def test_counts_of_the_table(stock):
    """As before, within TOLERANCE; fetches, and that nothing spills, exactly."""
    table = known()
    if not any((target, version) in table for target, version in stock.mesa.items()):
        pytest.skip(f"the table is of another Mesa than {sorted(set(stock.mesa.values()))}")
    for target, found in stock.found.items():
        before = table[target, stock.mesa[target]]
        assert before.keys() == {name for name in found if not name.endswith(compiled.PATH)}, "make the table anew"
        for name, was in before.items():
            now = found[name]
            assert (now.texture, now.spills) == (was.texture, 0), (target, name)
            pairs = zip(astuple(now), astuple(was), strict=True)
            assert all(abs(one - other) <= TOLERANCE * other for one, other in pairs), (target, name, now, was)


def test_estimates_of_the_document(stock):
    """docs/performance.md: the milliseconds of the GPU whose compiler is here, of the same Mesa."""
    if stock.mesa["navi21"] != "22.3.6":
        pytest.skip(f"the page is of another Mesa than {stock.mesa['navi21']}")
    page = (paths.ROOT / "docs/performance.md").read_text(encoding="utf-8")
    row = re.compile(r"^\| (\w+ \w+ [A-Z]+) \| \d+ \| (\d+) \| (.+?) \|", re.MULTILINE)
    shown = {name.lower(): cells for name, *cells in row.findall(page)}
    assert len(shown) > 10
    for method in compiled.all_methods():
        if cells := shown.pop(method.name, None):
            cost = estimate.cost(method, stock.found["navi21"], estimate.DEVICES[0])
            assert cells == [f"{method.fetches:.0f}", cost.text((1920, 1080))], method.name
    assert not shown


def test_character_of_the_document():
    """docs/character.md: instructions of `exact` plain, with a cat's eye, with axial colour; of the same Mesa.

    Axial colour is counted along the path, and fetches three times what one channel does; a compiler may keep the pixel
    itself from the first channel for the other two.
    """
    page = (paths.ROOT / "docs/character.md").read_text(encoding="utf-8")
    rows_shown = re.findall(r"^\| (\w+) \|" + r" (\d+) \|" * 3, page, re.MULTILINE)
    shown = {name: list(map(int, cells)) for name, *cells in rows_shown}
    assert len(shown) == 5
    for shape in EXACT:
        one = Settings("exact", shape, spacing=1.5, samples=9)
        kinds = (one, replace(one, cats_eye=0.5), replace(one, axial=(0.01, 0.01)))
        every = [compiled.Method(str(index), settings) for index, settings in enumerate(kinds)]
        counts = [isa_command.count([method], ["navi21"]) for method in every]
        if counts[0].mesa.get("navi21") != "22.3.6":
            pytest.skip(f"the page is of another Mesa than {counts[0].mesa}")
        for items in zip(*(method.passes[1:] for method in every), strict=True):
            found = [
                estimate.along_path(item, count.found["navi21"]) for item, count in zip(items, counts, strict=True)
            ]
            assert 3 * found[0].texture - found[2].texture in (0, 1, 2)
            name = items[0].entry.removeprefix("Bokeh")
            assert shown.get(name) in (None, [count.instructions for count in found]), name


def test_fetches_on_the_path(stock):
    """A program with its loops written out has as many fetches as its loops say, not one more or fewer."""
    found = stock.found["navi21"]
    for method in compiled.all_methods():
        for item in method.passes:
            count = estimate.along_path(item, found)
            said = sum(fetches.of_pass(item).values()) if item.spec.role != "copy" else 2
            # both sides of a branch are in the code: a polygon of a layer, or one fetch
            said += item.spec.layers and item.spec.sides > 0
            assert count.texture == said - AGAIN.get(item.entry, 0), (item.entry, count, said)


def test_registers_leave_room(stock):
    """On RDNA 2 every pass of `exact` runs with 24 waves or more, which hides the time of its fetches."""
    for name, one in stock.found["navi21"].items():
        if name.startswith(("Square", "Hexagon", "Octagon", "Decagon")) and not name.endswith(compiled.PATH):
            assert one.waves >= 24, (name, one)


def test_unrolled():
    """Loops within loops, bounds from outside and from the loop around; a loop of unknown length stays."""
    source = "for (int y = 0; y < N; y++)\n{ for (int i = 1; i <= 2; i++) { if (i >= n) { break; } f(y, i); } }\nrest"
    for y in range(2):
        assert f"const int y = {y};" in unrolled(source, {"N": 2})
    assert unrolled(source, {"N": 2}).count("f(y, i);") == 4
    assert "break" not in unrolled(source, {"N": 2}) and "for" not in unrolled(source, {"N": 2})
    unknown = unrolled(source, {})
    assert unknown.startswith("for (int y = 0; y < N; y++)") and unknown.count("f(y, i);") == 2


def test_bad_folder(tmp_path):
    """One line, exit code 2."""
    done = called("isa", "--against", tmp_path)
    assert done.returncode == 2 and len(done.stderr.splitlines()) == 1 and "no glsl/bokeh.glsl" in done.stderr


@pytest.mark.alone
def test_order_of_the_methods(stock):
    """A software driver has no texture units: by their arithmetic the methods come in the order of their time on it."""
    size, keys = (480, 270), ("paper hexagon", "layered low", "layered medium")
    wanted = [row for row in bench.in_depth(size) if row.key in keys]
    exact = Settings("exact", "hexagon", camera=bench.SCENE.camera)
    wanted.append(bench.Row("exact hexagon", exact, plan(exact, size).passes))
    _, measured = bench.measured(load("osmesa"), wanted, size, 5)
    times = {row["key"]: row["seconds"]["median"] for row in measured}
    every = [compiled.Method(row.key, row.settings) for row in wanted]
    counts = isa_command.count(every, ["navi21"]).found["navi21"]
    estimated = {one.name: estimate.cost(one, counts, estimate.DEVICES[0]).work["arithmetic"] for one in every}
    assert sorted(times, key=times.get) == sorted(estimated, key=estimated.get), (times, estimated)
