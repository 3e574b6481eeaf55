"""The documents against the code: tables and names are those of the code, links lead somewhere.

The README's snippets are run by test_paste.py.
"""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support import load

from bokeh_validation import paths
from bokeh_validation.frame import methods
from bokeh_validation.probes.model import Case, depth_of, flat
from bokeh_validation.shaders import passes

PARAMETERS_PAGE = (paths.ROOT / "docs/parameters.md").read_text(encoding="utf-8")


def library(language: str) -> str:
    """The library's text."""
    return paths.library(language).read_text(encoding="ascii")


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


def test_texture_table():
    """docs/parameters.md lists the textures with the bindings and registers that the drivers use."""
    rows = re.findall(r"^\| Bokeh(\w+Samp\w?) \| uniform \| (\d+) \| s(\d+) / t(\d+) \|", PARAMETERS_PAGE, re.MULTILINE)
    assert rows == [(slot, str(passes.BINDINGS[slot]), str(i), str(i)) for i, slot in enumerate(passes.SLOTS)]
    assert f"the linear sampler at {passes.FIRST_SAMPLER}." in PARAMETERS_PAGE


def test_parameter_buffer(monkeypatch):
    """A buffer as large as docs/parameters.md says holds all parameters, and is a whole number of 16 bytes.

    wgpu refuses one that ends before the last parameter, and says so.
    """
    size = int(re.search(r"The buffer is (\d+) bytes", PARAMETERS_PAGE)[1])
    driver = load("wgpu")
    case = Case("", methods.Settings("exact"), flat((8, 6), 1.0), depth_of((8, 6), 5.0))
    whole = driver.device.create_bind_group

    def run(bytes_bound: int) -> np.ndarray:
        def bound(*, entries: list, **others):
            assert entries[0]["binding"] == 0
            entries[0]["resource"]["size"] = bytes_bound
            return whole(entries=entries, **others)

        monkeypatch.setattr(driver.device, "create_bind_group", bound)
        return driver.run(case.plan.passes, case.textures(), case.size)["result"]

    needed = 4 * len(passes.PARAMETERS)
    assert needed <= size < needed + 16 and size % 16 == 0
    assert (run(size)[..., :3] > 0.0).all()
    with pytest.raises(driver.wgpu.GPUValidationError, match=f"size {needed - 4} where the shader expects {needed}"):
        run(needed - 4)


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


def test_peers_of_the_readme():
    """The README's five rows are those of docs/peers.md: fetches, FLIP on three scenes, light on the first."""
    readme, page = (
        dict(re.findall(r"^\| (.+?) \| (.*) \|$", (paths.ROOT / name).read_text(encoding="utf-8"), re.MULTILINE))
        for name in ("README.md", "docs/peers.md")
    )
    rows = {name: cells for name, cells in readme.items() if re.fullmatch(r"0\.\d+ \| .*", cells.partition(" | ")[2])}
    assert len(rows) == 5
    for name, shown in rows.items():
        (expected,) = (cells.split(" | ") for label, cells in page.items() if label.startswith(name))
        scenes = [cell.split("/") for cell in expected[2:5]]
        assert shown.split(" | ") == [expected[0], *(scene[0] for scene in scenes), scenes[0][2]], name


def test_paper_names_exist():
    """Every function and struct that docs/paper.md names is in all three libraries."""
    text = (paths.ROOT / "docs/paper.md").read_text(encoding="utf-8")
    names = set(re.findall(r"`(Bokeh[A-Z]\w+)`", text))
    assert names
    for language in paths.LANGUAGES:
        for name in names:
            assert re.search(rf"\b{name}\(|\bstruct {name}\b", library(language)), f"{name} in {language}"


def test_pitfalls_name_tests():
    """Every test that docs/pitfalls.md names is there."""
    text = (paths.ROOT / "docs/pitfalls.md").read_text(encoding="utf-8")
    named = re.findall(r"`(test_\w+\.py)(?:::(test_\w+))?`", text)
    assert named
    for file, name in named:
        source = next((paths.VALIDATION / "tests").rglob(file)).read_text(encoding="utf-8")
        assert not name or re.search(rf"^(?:    )?def {name}\(", source, re.MULTILINE), f"{file}::{name}"


def test_jitter_as_stated():
    """docs/parameters.md: how the mean of n frames comes near to a sample a pixel, within one of its figures."""
    frames, errors = (
        [float(cell) for cell in re.search(rf"^\| {row} \| (.*) \|$", PARAMETERS_PAGE, re.MULTILINE)[1].split(" | ")]
        for row in ("frames", r"error \(%\)")
    )
    assert frames == [1, 4, 16, 64]
    driver, size = load("egl"), (96, 96)
    color = flat(size, 0.5)
    color[44:52, 44:52, :3] = 50.0
    base = methods.Settings("exact", "hexagon", camera=methods.Camera(max_coc=1.0), coc=0.6, spacing=1.0)

    def run(**changes) -> np.ndarray:
        case = Case("", replace(base, **changes), color, depth_of(size, 5.0))
        return driver.run(case.plan.passes, case.textures(), size, "float")["result"][..., 1].astype(np.float64)

    truth = run()
    plain = np.abs(run(samples=5) - truth).mean()
    noisy = [run(samples=5, jitter=1.0, frame=frame) for frame in range(64)]
    for count, stated in zip(frames, errors, strict=True):
        off = np.abs(np.mean(noisy[: int(count)], axis=0) - truth).mean()
        assert 100 * off / plain == pytest.approx(stated, abs=1.0), count
