"""Compare the RDNA 2 compiler's counts for every pass with recorded ones: the stock.

The compiler is part of the system's Mesa, and other versions count differently, so the stock is for one version:
`validation/run isa --table validation/lab/tests/isa_stock.tsv` renews it.
"""

import re
from pathlib import Path

import pytest
from support import called

from bokeh_validation import paths
from lab.isa import isa_command

STOCK = Path(__file__).with_name("isa_stock.tsv").read_text(encoding="ascii").splitlines()
MESA = "22.3.6"  # of the stock and of the documents
# Fraction by which a count may exceed the stock: a compiler may order instructions differently and add a few copies
TOLERANCE = 0.05


def numbers(lines: list[str]) -> dict[str, dict[str, list[int]]]:
    """Return pass -> column -> the numbers of GLSL, HLSL and, if naga is installed, WGSL."""
    return {
        name: dict(zip(isa_command.COLUMNS, ([int(n) for n in cell.split(" / ")] for cell in cells), strict=True))
        for name, *cells in (line.split("\t") for line in lines)
    }


def test_no_more_than_the_stock(tmp_path):
    """Check that instructions, registers and latency exceed the stock by at most TOLERANCE, with no fewer waves and no
    spills.
    """
    done = called("isa", "--table", tmp_path / "now.tsv")
    if f"Mesa {MESA}" not in done.stdout:
        pytest.skip(f"no compiler of Mesa {MESA} for AMD: {done.stdout}")
    found, stock = numbers((tmp_path / "now.tsv").read_text(encoding="ascii").splitlines()), numbers(STOCK)
    assert found.keys() == stock.keys(), "make the stock anew"
    assert "GLSL by glslang / HLSL by DXC" in done.stdout
    for name, before in stock.items():
        for column, now in found[name].items():
            for new, old in zip(now, before[column], strict=False):
                enough = new >= old if column == "waves" else new <= (1.0 + TOLERANCE) * old
                assert enough, (name, column, now, before[column])
        assert set(found[name]["spills"]) == {0}


def test_latencies_of_the_document():
    """Compare the latencies of HLSL, GLSL and WGSL in docs/compilers.md with the stock."""
    page = (paths.ROOT / "docs/compilers.md").read_text(encoding="utf-8")
    shown = re.findall(r"^\| (\w+) \| (\d+) \| (\d+) \| (\d+) \|$", page, re.MULTILINE)
    stock = numbers(STOCK)
    assert len(shown) == 4
    for name, *latencies in shown:
        assert [int(latency) for latency in latencies] == stock[name]["latency"], name
