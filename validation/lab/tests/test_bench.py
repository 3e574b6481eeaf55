"""validation/run bench: its floors, its clock, what it writes, and the ratios that must hold."""

import json
import re
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from support import called, load

from bokeh_validation import shaders
from bokeh_validation.frame import methods
from lab import bench

SIZE = (72, 64)
COUNTERS = "float countColor = 0.0;\nfloat countDepth = 0.0;\nvec2 places = vec2(0.0, 0.0);\n"


def counting(item):
    """A pass that writes, instead of its result, how often it fetched colour and depth, and the sum of the places."""
    text = item.sources["glsl"] if item.sources else shaders.glsl(item.entry, "330", item.constants)
    for name, counter in (("BokehFetch", "countColor"), ("BokehFetchDepth", "countDepth")):
        head = rf"(?m)^(\w+ {name}\(\w+ tex, vec2 (\w+)\)\n{{\n)"
        text, found = re.subn(head, rf"\1    {counter} += 1.0;\n    places += \2;\n", text)
        assert found == 1
    text = text.replace("\n", f"\n{COUNTERS}", 1)
    text = re.sub(r"\bvoid main\(\)", "void counted()", text)
    result = "floor0" if item.sources else "BokehResult"
    text += f"\nvoid main()\n{{\n    counted();\n    {result} = vec4(countColor, countDepth, places);\n}}\n"
    return replace(item, sources={"glsl": text})


@pytest.mark.parametrize("row", [row for row in bench.table_one(SIZE, (4, 12)) if row.floor], ids=lambda row: row.key)
def test_a_floor_fetches_what_its_method_does(row):
    """Counted on the device, in every pixel of every pass: as many fetches of each, and the sum of their places."""
    driver, images = load("osmesa"), bench.textures(SIZE)
    for index, (item, floor) in enumerate(zip(row.passes, row.floor, strict=True)):
        if index > 0:
            passes, name = list(row.passes[:index]), item.outputs[0]
            method, alone = (
                driver.run([*passes, counting(each)], images, SIZE, "float", keep=(name,))[name]
                for each in (item, floor)
            )
            np.testing.assert_array_equal(alone[..., :2], method[..., :2], err_msg=item.entry)
            np.testing.assert_allclose(alone[..., 2:], method[..., 2:], rtol=2e-5, atol=1e-4, err_msg=item.entry)


@pytest.mark.parametrize("name", ["wgpu", "dxc"])
def test_floors_are_the_same_in_every_language(name):
    """The same sums as GLSL's, within what half floats and the bilinear filters of the two may differ."""
    for row in (row for row in bench.table_one(SIZE, (4,)) if row.floor):
        glsl, other = (load(d).run(row.floor, bench.textures(SIZE), SIZE)["result"] for d in ("osmesa", name))
        np.testing.assert_allclose(other.astype(float), glsl.astype(float), rtol=0.01, atol=0.01, err_msg=row.key)


@pytest.mark.alone
def test_command(tmp_path, monkeypatch):
    """A small run. Ratios are of the same round; bounds are broken where eight in ten rounds are beyond them."""
    file = tmp_path / "times.json"
    monkeypatch.setattr(bench, "table_one", partial(bench.table_one, sides=(12, 13, 24)))
    done = called("bench", "--driver", "osmesa", "--size", "192x192", "--rounds", "3", "--json", file)
    assert done.returncode == 0 and "layered medium" in done.stdout
    (result,) = json.loads(file.read_text())["drivers"]
    rows = {row["key"]: row for row in result["rows"]}
    passes = len(methods.plan(methods.Settings("layered"), (192, 192)).passes)
    assert result["software"] and result["clock"] == "cpu" and rows["layered medium"]["passes"] == passes
    own, paper = (np.array(rows[key]["seconds"]["rounds"]) for key in ("exact hexagon 144", "paper hexagon 144"))
    assert rows["exact hexagon 144"]["ratios"]["against"]["rounds"] == pytest.approx(own / paper)
    assert rows["paper hexagon 144"]["ratios"]["naive"]["high"] >= 62 / 24, "as in the paper's Table 1"
    assert rows["exact hexagon 576"]["ratios"]["against"]["low"] <= 0.5
    for key in ("paper hexagon 169", "exact hexagon 169", "exact octagon 169"):
        assert rows[key]["ratios"]["floor"]["low"] <= 1.3, key


# Time over that of `paper`, hexagon with 13 samples, on market_7 at this size
MOST_TIME, TIMED_SIZE = {"layered low": 1.3, "layered medium": 2.0}, (960, 540)


@pytest.mark.alone
@pytest.mark.parametrize("name", ("osmesa", "wgpu"))
def test_time(name):
    """Medians of rounds in which all are drawn, in CPU time."""
    rows = {row.key: row for row in bench.in_depth(TIMED_SIZE)}
    images, driver = bench.textures(TIMED_SIZE), load(name)
    # whole frames alone: bench.measured times every pass as well
    frames = {key: driver.prepared(rows[key].passes, images, TIMED_SIZE).timed for key in ("paper", *MOST_TIME)}
    _, seconds = bench.interleaved(frames, 9, True)
    ratios = {key: np.median(seconds[key] / seconds["paper"]) for key in MOST_TIME}
    assert all(ratios[key] <= most for key, most in MOST_TIME.items()), ratios
