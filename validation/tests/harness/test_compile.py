"""Compile every shader program with its compilers, and prove that the compilers would notice mistakes.

By default with the main compilers of each language, with --all by all.
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
# One program per variant, for checks that do not depend on the program
SAMPLE = list({program.variant: program for program in PROGRAMS}.values())
# Compilers of an entry to SPIR-V, by source language
SPIRV = {
    "GLSL": lambda entry: glslang.spirv(shaders.glsl(entry, "450"), "frag", glslang.VULKAN),
    "HLSL": lambda entry: glslang.hlsl(shaders.hlsl(5), "frag", f"{entry}_PS"),
    "HLSL, dxc": lambda entry: dxc.build(shaders.hlsl(6), "frag", f"{entry}_PS"),
    "HLSL, Slang": lambda entry: slang.build(shaders.hlsl(None), "frag", f"{entry}_PS", "spirv"),
}


def cells_of(result: Compilation, variant: str) -> list[tuple[Program, str, Cell]]:
    """Return (program, compiler, outcome) for a variant; skips the test if a compiler is missing."""
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
    """Compile all programs of a variant; for a brief report only a few. A program that is as it was when it was
    accepted is compiled only with --all.
    """
    report = request.config.getoption("--report")
    brief = report == BRIEF
    programs = load(quick=brief, main=brief or not (report or request.config.getoption("--all")))
    kept = not (report or request.config.getoption("--all"))
    result = compile_programs((one for one in programs if one.variant == variant), kept=kept)
    hand_over(result)
    cells = cells_of(result, variant)
    assert cells and [(program.name, name, cell) for program, name, cell in cells if cell.status != OK] == []


@pytest.mark.parametrize("program", SAMPLE, ids=lambda program: program.variant)
def test_an_undeclared_name_is_noticed(program):
    """Check that every compiler that receives the text rejects an undeclared name, with its position in the package's
    file.
    """
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
    """Check that no sample uses derivatives: in a loop or branch that is an error in HLSL and WGSL. SPIR-V shows it."""
    for build in SPIRV.values():
        text = disassembled(compiled(partial(build, entry)).binary)
        assert "OpImageSampleExplicitLod" in text and "ImplicitLod" not in text


def test_depth_and_kernel_need_no_filtering_sampler():
    """Check that filtering depth fails: naga's layout declares depth as unfilterable."""
    direct = "BokehFetchDepth(DepthSamp, BokehToTexture(sampleCoords)).x"
    linear = "BokehFetch(DepthSamp, sampleCoords, BokehLinearClamp).r"
    programs = [
        hlsl_program
        for hlsl_program in PROGRAMS
        if (hlsl_program.variant, hlsl_program.entry) == ("wgsl", "BokehDepthOfField")
    ]
    result = compile_programs(programs, edit=lambda source: source.replace(direct, linear))
    assert all("filterable" in cell.message.lower() for _, name, cell in cells_of(result, "wgsl") if name == "naga")


def test_slang_bindings():
    """Check that Slang's options in own-engine.md are the harness's, and give the bindings that the page states."""
    assert " ".join(slang.SHIFTS) in (paths.ROOT / "docs/own-engine.md").read_text(encoding="utf-8")
    text = disassembled(compiled(partial(SPIRV["HLSL, Slang"], "BokehComposite")).binary)
    bound = {name: int(place) for name, place in re.findall(r"OpDecorate %(\w+) Binding (\d+)", text)}
    read = [*ENTRIES["BokehComposite"].textures]
    expected = {f"Bokeh{slot}": list(passes.BINDINGS).index(slot) + 1 for slot in read}
    assert bound == {**expected, "BokehLinearClamp": 9, "BokehParameters": 0}


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
    """Check that a missing entry point, and a truncated module, are noticed."""
    assert not compiled(build).ok


def test_nothing_installed(monkeypatch):
    """Check that every missing compiler is reported with how to install it."""

    def absent():
        raise Unavailable("no driver; apt-get install -y driver")

    monkeypatch.setenv("PATH", "/nonexistent")
    monkeypatch.setattr(tool, "WHEELS", Path("/nonexistent"))
    for place, name in ((mesa, "driver"), (naga, "driver"), (registry.angle_tint.browser, "session")):
        monkeypatch.setattr(place, name, absent)
    result = compile_programs([program for program in SAMPLE if program.profile in ("450", "wgsl")])
    assert {cell.status for row in result.rows for cell in row.cells.values()} == {MISSING}
    # glslang, mesa, naga and tint; the others take glslang's output
    assert len(result.missing) == 4 and all("apt-get install -y" in text for text in result.missing.values())
    assert not result.failures()
