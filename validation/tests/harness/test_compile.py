"""Every shader program through its compilers, and proof that the compilers would notice.

By the main compilers of each language, by all with --all.
"""

import re
from functools import partial
from pathlib import Path

import pytest
from support import compiled, disassembled, needed
from support_inputs import COMPILED

from bokeh_validation import paths, shaders
from bokeh_validation.compile_matrix import (
    FAILED,
    MISSING,
    OK,
    Cell,
    Compilation,
    compile_programs,
    mesa,
    naga,
    registry,
)
from bokeh_validation.compilers import dxc, glslang, slang, spirv, tool
from bokeh_validation.errors import Unavailable
from bokeh_validation.run.session import BRIEF
from bokeh_validation.shaders import passes
from bokeh_validation.shaders.entries import ENTRIES
from bokeh_validation.shaders.variants import Program, load

PROGRAMS = load()
VARIANTS = list(dict.fromkeys(program.variant for program in PROGRAMS))
# One program of each variant is enough where all would say the same
SAMPLE = list({program.variant: program for program in PROGRAMS}.values())
# What makes SPIR-V of an entry, by the language that it is given
SPIRV = {
    "GLSL": lambda entry: glslang.spirv(shaders.glsl(entry, "450"), "frag", glslang.VULKAN),
    "HLSL": lambda entry: glslang.hlsl(shaders.hlsl(5), "frag", f"{entry}_PS"),
    "HLSL, dxc": lambda entry: dxc.build(shaders.hlsl(6), "frag", f"{entry}_PS"),
    "HLSL, Slang": lambda entry: slang.build(shaders.hlsl(None), "frag", f"{entry}_PS", "spirv"),
}


def cells_of(result: Compilation, variant: str) -> list[tuple[Program, str, Cell]]:
    """(program, compiler, what it said) of a variant, or the end of the test where a compiler is missing."""
    rows = [row for row in result.rows if row.program.variant == variant]
    cells = [(row.program, name, cell) for row in rows for name, cell in row.cells.items()]
    with needed("compiler"):
        for _, _, cell in cells:
            if cell.status == MISSING:
                raise Unavailable(cell.message)
    return cells


@pytest.mark.inputs(*COMPILED)
@pytest.mark.parametrize("variant", VARIANTS)
def test_accepted(variant, request, hand_over):
    """All programs of a variant; few of them for a brief report."""
    report = request.config.getoption("--report")
    brief = report == BRIEF
    programs = load(quick=brief, main=brief or not (report or request.config.getoption("--all")))
    result = compile_programs(one for one in programs if one.variant == variant)
    hand_over(result)
    cells = cells_of(result, variant)
    assert cells and [(program.name, name, cell) for program, name, cell in cells if cell.status != OK] == []


@pytest.mark.parametrize("program", SAMPLE, ids=lambda program: program.variant)
def test_an_undeclared_name_is_noticed(program):
    """By every compiler that is given the text, with its place in the package's file."""
    right, wrong = "samplePixel * weight", "samplePixel * weigth"
    result = compile_programs([program], edit=lambda source: source.replace(right, wrong))
    lines = shaders.file_text(program.language, "bokeh_paper").splitlines()
    first = next(index for index, line in enumerate(lines, 1) if right in line)
    own = set(program.compilers)
    takes_text = own - {one.name for one in registry.COMPILERS if own & set(one.takes)}
    assert {name for _, name, _ in cells_of(result, program.variant)} == takes_text
    for _, _, cell in cells_of(result, program.variant):
        assert cell.status == FAILED
        assert "weigth" in cell.message and f"bokeh_paper.{program.language}:{first}" in cell.message


@pytest.mark.parametrize("entry", ["BokehComposite", "BokehNaiveGather", "BokehHexagonFirst", "BokehPrefilter"])
def test_no_sample_takes_its_level_from_derivatives(entry):
    """Such a sample is an error in a loop or a branch in HLSL and WGSL; SPIR-V says it."""
    for build in SPIRV.values():
        text = disassembled(compiled(partial(build, entry)).binary)
        assert "OpImageSampleExplicitLod" in text and "ImplicitLod" not in text


def test_depth_and_kernel_need_no_filtering_sampler():
    """naga builds on a layout where they are unfilterable, so depth through a sampler has to fail there."""
    direct = "BokehFetchDepth(DepthSamp, BokehToTexture(sampleCoords))"
    linear = "BokehFetch(DepthSamp, sampleCoords, BokehLinearClamp).r"
    programs = [one for one in PROGRAMS if (one.variant, one.entry) == ("wgsl", "BokehDepthOfField")]
    result = compile_programs(programs, edit=lambda source: source.replace(direct, linear))
    assert all("filterable" in cell.message.lower() for _, name, cell in cells_of(result, "wgsl") if name == "naga")


def test_slang_bindings():
    """Slang's options in own-engine.md are those of the harness, and bind as the page says."""
    assert " ".join(slang.SHIFTS) in (paths.ROOT / "docs/own-engine.md").read_text(encoding="utf-8")
    text = disassembled(compiled(partial(SPIRV["HLSL, Slang"], "BokehComposite")).binary)
    bound = {name: int(place) for name, place in re.findall(r"OpDecorate %(\w+) Binding (\d+)", text)}
    read = [*ENTRIES["BokehComposite"].textures]
    wanted = {f"Bokeh{slot}": list(passes.BINDINGS).index(slot) + 1 for slot in read}
    assert bound == {**wanted, "BokehLinearClamp": 9, "BokehParameters": 0}


@pytest.mark.parametrize(
    "build",
    [
        lambda: glslang.parse("#version 330\nvoid other() {}\n", "frag"),
        lambda: SPIRV["HLSL"]("BokehNone"),
        lambda: SPIRV["HLSL, dxc"]("BokehNone"),
        lambda: SPIRV["HLSL, Slang"]("BokehNone"),
        lambda: spirv.validate(SPIRV["GLSL"]("BokehDebug").binary[:400]),
        lambda: spirv.msl(SPIRV["GLSL"]("BokehDebug").binary[:400]),
    ],
    ids=["glslang", "glslang HLSL", "dxc", "slang", "spirv-val", "spirv-cross"],
)
def test_what_is_missing_is_noticed(build):
    """An entry point, the end of a module."""
    assert not compiled(build).ok


def test_nothing_installed(monkeypatch):
    def absent():
        raise Unavailable("no driver; apt-get install -y driver")

    monkeypatch.setenv("PATH", "/nonexistent")
    monkeypatch.setattr(tool, "WHEELS", Path("/nonexistent"))
    for place, name in ((mesa, "driver"), (naga, "driver"), (registry.angle_tint.browser, "session")):
        monkeypatch.setattr(place, name, absent)
    result = compile_programs([program for program in SAMPLE if program.profile in ("450", "wgsl")])
    assert {cell.status for row in result.rows for cell in row.cells.values()} == {MISSING}
    # glslang, mesa, naga, tint: the rest takes glslang's output
    assert len(result.missing) == 4 and all("apt-get install -y" in text for text in result.missing.values())
    assert not result.failures()
