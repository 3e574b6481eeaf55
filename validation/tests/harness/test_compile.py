"""Every shader program through its compilers, and proof that the compilers would notice.

By the main compilers of each language, by all with --all.
"""

import json
import re
import subprocess
import sys
from functools import partial

import pytest
from support import compiled, disassembled, needed

from bokeh_validation import paths, shaders
from bokeh_validation.compilers import dxc, glslang, mesa, naga, registry, spirv
from bokeh_validation.compilers.compile import FAILED, MISSING, OK, Cell, Compilation, compile_programs
from bokeh_validation.errors import Unavailable
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
}


@pytest.fixture(scope="module")
def whole(request) -> Compilation:
    """All programs as they are."""
    return compile_programs(load(main=not request.config.getoption("--all")))


def cells_of(result: Compilation, variant: str) -> list[tuple[Program, str, Cell]]:
    """(program, compiler, what it said) of a variant, or the end of the test where a compiler is missing."""
    rows = [row for row in result.rows if row.program.variant == variant]
    cells = [(row.program, name, cell) for row in rows for name, cell in row.cells.items()]
    with needed("compiler"):
        for _, _, cell in cells:
            if cell.status == MISSING:
                raise Unavailable(cell.message)
    return cells


def bindings(module: bytes) -> dict[str, int]:
    """Name -> binding of the textures and samplers of a SPIR-V module, as spirv-cross finds them. All are in set 0."""
    done = spirv.CROSS.run(["m.spv", "--reflect", "--output", "out.json"], {"m.spv": module}, ["out.json"])
    reflected = json.loads(done.files["out.json"])
    kinds = ("textures", "separate_images", "separate_samplers")
    return {item["name"]: item["binding"] for kind in kinds for item in reflected.get(kind, []) if item["set"] == 0}


@pytest.mark.parametrize("variant", VARIANTS)
def test_accepted(whole, variant):
    cells = cells_of(whole, variant)
    assert cells and [(program.name, name, cell) for program, name, cell in cells if cell.status != OK] == []


@pytest.mark.parametrize("program", SAMPLE, ids=lambda program: program.variant)
def test_an_undeclared_name_is_noticed(program):
    """By every compiler, with its place in the package's file; those that take another's output have none."""
    right, wrong = "samplePixel * weight", "samplePixel * weigth"
    result = compile_programs([program], edit=lambda source: source.replace(right, wrong))
    lines = shaders.text(program.language).splitlines()
    first = next(index for index, line in enumerate(lines, 1) if right in line)
    assert {name for _, name, _ in cells_of(result, program.variant)} == set(program.compilers)
    for _, _, cell in cells_of(result, program.variant):
        assert cell.status == FAILED
        if cell.follows:
            assert cell.message == f"no input: {cell.follows} failed"
        else:
            assert "weigth" in cell.message and f"bokeh.{program.language}:{first}" in cell.message
    assert not any("no input" in text for text in result.failures())


@pytest.mark.parametrize("entry", ["BokehLayered", "BokehNaiveGather", "BokehHexagonFirst", "BokehLayerSplit"])
def test_no_sample_takes_its_level_from_derivatives(entry):
    """Such a sample is an error in a loop or a branch in HLSL and WGSL; SPIR-V says it."""
    for build in SPIRV.values():
        text = disassembled(compiled(partial(build, entry)).binary)
        assert "OpImageSampleExplicitLod" in text and "ImplicitLod" not in text


def test_depth_and_kernel_need_no_filtering_sampler():
    """naga builds on a layout where they are unfilterable, so depth through a sampler has to fail there."""
    direct, linear = "Nearest(DepthSamp, sampleCoords)", "(DepthSamp, ColorSampSampler, sampleCoords)"
    programs = [one for one in PROGRAMS if (one.variant, one.entry) == ("wgsl", "BokehDepthOfField")]
    result = compile_programs(programs, edit=lambda source: source.replace(direct, linear))
    assert all("filterable" in cell.message.lower() for _, name, cell in cells_of(result, "wgsl") if name == "naga")


@pytest.mark.parametrize("name", SPIRV)
def test_bindings(name):
    """Those of WGSL, which naga and tint hold against their layout. The two entries read all textures."""
    known, samplers = {}, () if name == "GLSL" else ("BokehLinearClamp",)
    for entry in ("BokehLayered", "BokehNaiveGather"):
        known |= bindings(compiled(partial(SPIRV[name], entry)).binary)
    text = paths.passes("wgsl").read_text(encoding="ascii")
    written = re.findall(r"^@group\(0\) @binding\((\d+)\) var (\w+): (\w+)", text, re.MULTILINE)
    assert known == {slot: int(binding) for binding, slot, kind in written if kind != "sampler" or slot in samplers}


STAGES = ("BokehFullScreen_VS", "BokehNone_PS")
VERTEX = "#version 330\nout vec3 BokehUV;\nvoid main() { BokehUV = vec3(0.0); gl_Position = vec4(0.0); }\n"


@pytest.mark.parametrize(
    ("build", "words"),
    [
        (lambda: glslang.parse("#version 330\nvoid other() {}\n", "frag"), "entry point"),
        (lambda: SPIRV["HLSL"]("BokehNone"), ""),
        (lambda: SPIRV["HLSL, dxc"]("BokehNone"), ""),
        (lambda: dxc.build(shaders.hlsl(6), "frag", "BokehNone_PS", False), ""),
        (lambda: naga.build(*(naga.Stage(shaders.wgsl(), name) for name in STAGES)), "BokehNone_PS"),
        (lambda: mesa.build(VERTEX, shaders.glsl("BokehDebug")), "BokehUV"),
        (lambda: spirv.validate(SPIRV["GLSL"]("BokehDebug").binary[:400]), ""),
        (lambda: spirv.msl(SPIRV["GLSL"]("BokehDebug").binary[:400]), ""),
    ],
    ids=["glslang", "glslang HLSL", "dxc-spirv", "dxc-dxil", "naga", "mesa", "spirv-val", "spirv-cross"],
)
def test_what_is_missing_is_noticed(build, words):
    """An entry point, what the other stage gives, the end of a module."""
    result = compiled(build)
    assert not result.ok and words in result.messages


def test_a_program_with_dxc_ends_as_it_says():
    """Its own status, and what it printed: the library's clean-up is left out at the end."""
    compiled(lambda: dxc.build(shaders.hlsl(6), "frag", "BokehDebug_PS"))
    program = (
        "import sys; from bokeh_validation import shaders; from bokeh_validation.compilers import dxc; "
        "dxc.build(shaders.hlsl(6), 'frag', 'BokehDebug_PS'); print('printed'); sys.exit(3)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout, done.stderr) == (3, "printed\n", "")


def test_nothing_installed(monkeypatch):
    def absent():
        raise Unavailable("no driver; apt-get install -y driver")

    monkeypatch.setenv("PATH", "/nonexistent")
    for place, name in ((mesa, "driver"), (naga, "driver"), (registry.angle_tint.browser, "session")):
        monkeypatch.setattr(place, name, absent)
    result = compile_programs([program for program in SAMPLE if program.profile in ("450", "wgsl")])
    assert {cell.status for row in result.rows for cell in row.cells.values()} == {MISSING}
    assert set(result.as_json()["versions"].values()) == {""}
    # glslang, mesa, naga, tint: the rest only waits for glslang
    assert len(result.failures()) == 4 and all("apt-get install -y" in text for text in result.failures())
