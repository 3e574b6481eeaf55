"""Every shader program through every compiler, and proof that the compilers would notice."""

import dataclasses
import io
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from functools import partial

import pytest
from rich.console import Console

from bokeh_validation import matrix, paths, shaders, variants
from bokeh_validation.compilers import chain, dxc, fxc, glslang, mesa, naga, places, spirv, tool
from bokeh_validation.compilers.result import CompileResult, accepted
from bokeh_validation.errors import Unavailable, UserError

ROWS = matrix.load()
CELLS = list(dict.fromkeys((row.id, column) for row in ROWS for column in row.compilers))
PAPER = [row for row in ROWS if row.entry == "BokehDepthOfField" and row.samples == 13]
# One row of each variant is enough where all would say the same: the paper's, where a variant has it.
SAMPLE = list({row.id: row for row in [*ROWS, *PAPER]}.values())
SAMPLERS = ("BokehLinearClamp",)


def misspelled(source: str) -> str:
    """A mistake as it happens: a name that is not declared."""
    assert "samplePixel * weight" in source
    return source.replace("samplePixel * weight", "samplePixel * weigth")


def says(result: CompileResult, text: str) -> bool:
    """Refused, with this text in the messages; glslang's HLSL puts spaces between the words of #error anew."""
    return not result.ok and text.replace(" ", "") in result.messages.replace(" ", "")


def missing(message: str) -> None:
    """A compiler that is not here: a failure under CI, else a skip with the line that installs it."""
    if os.environ.get("CI"):
        pytest.fail(message)
    pytest.skip(message)


def compiled(step: Callable[[], CompileResult]) -> CompileResult:
    """Result of a compiler, if it is here."""
    try:
        return step()
    except Unavailable as error:
        missing(str(error))


@pytest.fixture(scope="session")
def runtimes() -> matrix.Runtimes:
    """The in-process compilers, made once for all tests; DXC is fetched here where it never was."""
    made = matrix.Runtimes()
    for name in ("gl", "wgpu", "dxc", "fxc"):
        try:
            made.get(name)
        except Unavailable:
            pass  # the cells tell
    return made


@pytest.fixture(scope="session")
def whole(runtimes) -> matrix.Matrix:
    """The matrix as it is."""
    return matrix.run(ROWS, runtimes=runtimes)


@pytest.fixture(scope="session")
def broken(runtimes) -> matrix.Matrix:
    """One row of each variant with a mistake in it."""
    return matrix.run(SAMPLE, runtimes=runtimes, edit=misspelled)


@pytest.fixture(scope="session")
def module() -> bytes:
    """A SPIR-V module that is right."""
    return compiled(lambda: glslang.glsl(shaders.glsl("BokehDebug", "450"), "frag", "450")).binary


def chosen(result: matrix.Matrix, name: str, column: str) -> list[tuple[str, matrix.Cell]]:
    """(row name, cell) of a variant's rows in one column."""
    return [(row.name, row.cells[column]) for row in result.rows if row.variant == name]


def bindings(module: bytes) -> dict[str, int]:
    """Name -> binding of the textures and samplers of a SPIR-V module, as spirv-cross finds them. All are in set 0."""
    if not (program := shutil.which("spirv-cross")):
        missing(spirv.INSTALL_CROSS)
    done = tool.run(program, ["m.spv", "--reflect", "--output", "out.json"], {"m.spv": module}, ["out.json"])
    told = json.loads(done.files["out.json"])
    found = [item for kind in ("textures", "separate_images", "separate_samplers") for item in told.get(kind, [])]
    assert all(item["set"] == 0 for item in found)
    return {item["name"]: item["binding"] for item in found}


class TestShaders:
    """The package's shaders."""

    @pytest.mark.parametrize(("name", "column"), CELLS)
    def test_accepted(self, whole, name, column):
        cells = chosen(whole, name, column)
        absent = [cell.message for _, cell in cells if cell.status == chain.MISSING]
        if absent:
            missing(absent[0])
        bad = [f"{row}: {cell.status}: {cell.message}" for row, cell in cells if cell.status != chain.OK]
        assert not bad, "\n".join(bad)

    def test_every_entry_in_every_language(self):
        for language in paths.LANGUAGES:
            assert {row.entry for row in ROWS if row.language == language} == set(variants.ENTRIES)

    def test_no_sample_takes_its_level_from_derivatives(self, whole):
        """Such a sample is an error in a loop or a branch in HLSL and WGSL."""
        facts = [(row.name, cell.facts) for row in whole.rows for cell in row.cells.values()]
        counted = [(name, known) for name, known in facts if "implicit_lod" in known]
        if not counted:
            missing(f"no SPIR-V; {glslang.INSTALL}")
        assert [name for name, known in counted if known["implicit_lod"]] == []
        assert any(known["samples"] for _, known in counted)

    def test_depth_and_kernel_need_no_filtering_sampler(self, whole, runtimes):
        """naga builds on a layout where they are unfilterable, so depth through a sampler has to fail there."""
        row = next(row for row in SAMPLE if row.id == "wgsl" and row.entry == "BokehDepthOfField")

        def linear(source: str) -> str:
            direct = "Nearest(DepthSamp, sampleCoords)"
            return source.replace(direct, "(DepthSamp, ColorSampSampler, sampleCoords)")

        cell = matrix.run([row], runtimes=runtimes, edit=linear).rows[0].cells["naga"]
        if cell.status == chain.MISSING:
            missing(cell.message)
        assert cell.status == chain.FAILED and "filterable" in cell.message.lower()

    @pytest.mark.parametrize(
        ("module", "samplers"),
        [
            (lambda entry: glslang.glsl(shaders.glsl(entry, "450"), "frag", "450"), ()),
            (lambda entry: glslang.hlsl(shaders.hlsl(5), "frag", f"{entry}_PS"), SAMPLERS),
            (lambda entry: dxc.build(shaders.hlsl(6), "frag", f"{entry}_PS"), SAMPLERS),
        ],
        ids=["glslang GLSL", "glslang HLSL", "dxc"],
    )
    def test_bindings(self, module, samplers):
        """Those of WGSL, which naga and tint hold against their layout. The two entries read all textures."""
        found = {}
        for entry in ("BokehLayered", "BokehNaiveGather"):
            found |= bindings(compiled(partial(module, entry)).binary)
        text = paths.passes("wgsl").read_text(encoding="ascii")
        written = re.findall(r"^@group\(0\) @binding\((\d+)\) var (\w+): (\w+)", text, re.MULTILINE)
        assert found == {name: int(binding) for binding, name, kind in written if kind != "sampler" or name in samplers}

    def test_table_of_shader_model_3(self, whole):
        """docs/performance.md: the largest figures of each entry over its sample counts, as fxc has them."""
        largest: dict[str, list[int]] = {}
        for row in whole.rows:
            cell = row.cells.get("fxc")
            if row.variant != "hlsl-sm3" or cell is None:
                continue
            if cell.status == chain.MISSING:
                missing(cell.message)
            found = [cell.facts[name] for name in ("slots", "temporaries", "constants", "samplers")]
            known = largest.setdefault(row.name.split()[1].removeprefix("Bokeh"), found)
            largest[row.name.split()[1].removeprefix("Bokeh")] = list(map(max, known, found))
        text = (paths.ROOT / "docs/performance.md").read_text(encoding="utf-8")
        table = text[text.index("| ps_3_0, the largest") :].partition("\n\n")[0].splitlines()[2:]
        shown = {name: [int(n) for n in numbers] for name, *numbers in (row.strip("| ").split(" | ") for row in table)}
        del largest["FullScreen"]
        assert shown == largest

    def test_slots_of_the_viewport(self):
        """docs/performance.md and docs/inputs.md: how many slots more BOKEH_VIEWPORT takes in shader model 3."""
        more = []
        for row in (row for row in ROWS if row.id == "hlsl-sm3-viewport" and "Layer" not in row.entry):
            programs = [
                compiled(partial(fxc.build, variants.source(program), program.stage, program.function, 3))
                for program in (row, dataclasses.replace(row, values=()))
            ]
            more.append(programs[0].facts["slots"] - programs[1].facts["slots"])
        assert len(more) == 8
        for name in ("performance", "inputs"):
            text = (paths.ROOT / f"docs/{name}.md").read_text(encoding="utf-8")
            (told,) = re.findall(r"eight entries compiled with it\D*(\d+) to (\d+)\s+slots", text)
            assert told == (str(min(more)), str(max(more))), name

    def test_time(self, whole):
        """Half a second a program, on two cores that are busy otherwise too."""
        assert whole.seconds < 0.5 * len(ROWS)


class TestCompilersNotice:
    """A cell that is ok means something: each compiler reports what is wrong."""

    @pytest.mark.parametrize(("name", "column"), CELLS)
    def test_undeclared_name(self, broken, name, column):
        (_, cell), *_ = chosen(broken, name, column)
        if cell.status == chain.MISSING:
            missing(cell.message)
        assert cell.status == chain.FAILED
        if cell.follows:
            assert cell.message == f"no input: {cell.follows} failed"
        else:
            assert "weigth" in cell.message

    @pytest.mark.parametrize("row", SAMPLE, ids=lambda row: row.id)
    def test_places_are_those_of_the_files(self, broken, row):
        lines = shaders.text(row.language).splitlines()
        first = next(index for index, line in enumerate(lines, 1) if "samplePixel * weight" in line)
        cells = next(seen.cells for seen in broken.rows if seen.program == row)
        told = [cell for cell in cells.values() if cell.status == chain.FAILED and not cell.follows]
        if not told:
            missing("every compiler of this variant is missing")
        for cell in told:
            assert f"bokeh.{row.language}:{first}" in cell.message

    def test_places_in_the_second_file(self):
        source = shaders.glsl("BokehDebug", "330")
        library = sum(len(file("glsl").read_text().splitlines()) for file in (paths.library, paths.layers))
        message = f"ERROR: shader.frag:{library + 2 + 7}: 'x'\nERROR: shader.frag:1: 'y'"
        assert places.located(message, source, "glsl") == "ERROR: bokeh_passes.glsl:7: 'x'\nERROR: shader.frag:1: 'y'"

    def test_missing_main(self):
        result = compiled(lambda: glslang.parse("#version 330\nvoid other() {}\n", "frag"))
        assert not result.ok and "entry point" in result.messages

    def test_link_of_stages_that_do_not_fit(self, runtimes):
        vertex = shaders.glsl("BokehFullScreen").replace("out vec2 BokehUV", "out vec3 BokehUV")
        vertex = vertex.replace("BokehUV = vec2(", "BokehUV = vec3(0.0, ").replace("BokehUV * 2.0", "BokehUV.xy * 2.0")
        result = compiled(lambda: mesa.build(vertex, shaders.glsl("BokehDebug"), runtimes.get("gl")))
        assert not result.ok and result.messages.startswith("link: ") and "BokehUV" in result.messages

    def test_naga_misses_an_entry_point(self, runtimes):
        stages = [naga.Stage(shaders.wgsl(), name) for name in ("BokehFullScreen_VS", "BokehNone_PS")]
        result = compiled(lambda: naga.build(*stages, runtimes.get("wgpu")))
        assert not result.ok and "BokehNone_PS" in result.messages

    @pytest.mark.parametrize("to_spirv", [True, False])
    def test_dxc_misses_an_entry_point(self, to_spirv):
        assert not compiled(lambda: dxc.build(shaders.hlsl(6), "frag", "BokehNone_PS", to_spirv)).ok

    def test_a_program_with_dxc_ends_as_it_says(self):
        """Its own status, and what it printed: the library's clean-up is left out at the end."""
        compiled(lambda: dxc.build(shaders.hlsl(6), "frag", "BokehDebug_PS", True))
        program = (
            "import sys; from bokeh_validation import shaders; from bokeh_validation.compilers import dxc; "
            "dxc.build(shaders.hlsl(6), 'frag', 'BokehDebug_PS', True); print('printed'); sys.exit(3)"
        )
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
        assert (done.returncode, done.stdout, done.stderr) == (3, "printed\n", "")

    def test_glslang_misses_an_entry_point(self):
        assert not compiled(lambda: glslang.hlsl(shaders.hlsl(5), "frag", "BokehNone_PS")).ok

    def test_spirv_of_another_environment(self):
        module = compiled(lambda: glslang.glsl(shaders.glsl("BokehDebug"), "frag", "330")).binary
        assert compiled(lambda: spirv.validate(module, chain.OPENGL_RULES)).ok
        result = compiled(lambda: spirv.validate(module, chain.VULKAN_RULES))
        assert not result.ok and "OriginLowerLeft" in result.messages

    @pytest.mark.parametrize(
        "step",
        [
            spirv.validate,
            lambda data: spirv.cross_checked(data, "frag", "essl300"),
            lambda data: spirv.cross_checked(data, "frag", "essl310"),
            lambda data: spirv.cross(data, "msl"),
        ],
        ids=["spirv-val", "essl300", "essl310", "msl"],
    )
    def test_spirv_cut_short(self, module, step):
        assert compiled(lambda: step(module)).ok
        result = compiled(lambda: step(module[: len(module) // 2 & ~3]))
        assert not result.ok and result.messages

    def test_naga_takes_no_spirv_cut_short(self, runtimes):
        source = shaders.hlsl(6)
        vertex = compiled(lambda: dxc.build(source, "vert", "BokehFullScreen_VS")).binary
        fragment = compiled(lambda: dxc.build(source, "frag", "BokehDebug_PS")).binary
        stages = [naga.Stage(vertex, "BokehFullScreen_VS"), naga.Stage(fragment[:400], "BokehDebug_PS")]
        result = compiled(lambda: naga.build(*stages, runtimes.get("wgpu")))
        assert not result.ok and result.messages

    def test_essl_that_does_not_compile(self, module, monkeypatch):
        real = spirv.cross

        def mistaken(binary: bytes, target: str) -> CompileResult:
            return accepted("", real(binary, target).binary.replace(b"texture", b"texturre"))

        assert compiled(lambda: spirv.cross_checked(module, "frag", "essl300")).ok
        monkeypatch.setattr(spirv, "cross", mistaken)
        result = compiled(lambda: spirv.cross_checked(module, "frag", "essl300"))
        assert not result.ok and "texturre" in result.messages


class TestConfiguration:
    """A wrong configuration stops with our own text, not with a riddle further down."""

    @pytest.fixture(params=["glslang", "mesa"])
    def glsl(self, request, runtimes) -> Callable[[str], CompileResult]:
        """Compile a fragment shader."""
        if request.param == "glslang":
            return lambda source: compiled(lambda: glslang.parse(source, "frag"))
        vertex = shaders.glsl("BokehFullScreen")
        return lambda source: compiled(lambda: mesa.build(vertex, source, runtimes.get("gl")))

    @pytest.fixture(params=["glslang", "dxc", "fxc"])
    def hlsl(self, request) -> Callable[[str], CompileResult]:
        """Compile BokehDebug_PS."""
        if request.param == "glslang":
            return lambda source: compiled(lambda: glslang.hlsl(source, "frag", "BokehDebug_PS"))
        if request.param == "fxc":
            return lambda source: compiled(lambda: fxc.build(source, "frag", "BokehDebug_PS", 5))
        return lambda source: compiled(lambda: dxc.build(source, "frag", "BokehDebug_PS"))

    def test_compilers_take_the_right_ones(self, glsl):
        assert glsl(shaders.glsl("BokehDebug")).ok

    def test_hlsl_compilers_take_the_right_ones(self, hlsl):
        for model in (4, 5, 6):
            assert hlsl(shaders.hlsl(model)).ok

    @pytest.mark.parametrize("entry", ["BokehDebug", "BokehLayered"])
    def test_glsl_without_the_layers(self, glsl, entry):
        source = shaders.glsl(entry).replace(paths.layers("glsl").read_text(encoding="ascii"), "")
        result = glsl(source)
        assert result.ok if entry == "BokehDebug" else says(result, "put bokeh_layers.glsl before this file")

    def test_hlsl_without_the_layers(self, hlsl):
        for model in (4, 5, 6):
            assert hlsl(shaders.hlsl(model).replace(paths.layers("hlsl").read_text(encoding="ascii"), "")).ok

    def test_layers_without_the_library(self, glsl, hlsl):
        for name, compiler, source in (("glsl", glsl, shaders.glsl("BokehDebug")), ("hlsl", hlsl, shaders.hlsl(5))):
            result = compiler(source.replace(paths.library(name).read_text(encoding="ascii"), ""))
            assert says(result, f"put bokeh.{name} before bokeh_layers.{name}")

    def test_no_pass(self, glsl):
        result = glsl("#version 330\n" + shaders.text("glsl"))
        assert says(result, "define BOKEH_PASS before this file")

    def test_misspelled_pass(self, glsl):
        result = glsl("#version 330\n#define BOKEH_PASS BOKEH_DEPTH_OF_FEILD\n" + shaders.text("glsl"))
        assert says(result, "BOKEH_PASS is none of the names")

    def test_one_sample_glsl(self, glsl):
        result = glsl(shaders.glsl("BokehDebug", values={"BOKEH_NUM_SAMPLES": 1}))
        assert says(result, "BOKEH_NUM_SAMPLES must be 2 or more")

    def test_one_sample_hlsl(self, hlsl):
        result = hlsl(shaders.hlsl(5, {"BOKEH_NUM_SAMPLES": 1}))
        assert says(result, "BOKEH_NUM_SAMPLES must be 2 or more")

    def test_shader_model_7(self, hlsl):
        result = hlsl(shaders.hlsl(7))
        assert says(result, "BOKEH_HLSL_SM must be 3, 4, 5 or 6")

    @pytest.mark.parametrize(
        ("version", "text"), [("120", "needs GLSL 3.30 or later"), ("100", "needs GLSL ES 3.00 or later")]
    )
    def test_old_glsl(self, glsl, version, text):
        result = glsl(shaders.glsl("BokehDebug").replace("#version 330", f"#version {version}", 1))
        assert says(result, text)


class TestTools:
    """Command line compilers come to their ends in many ways."""

    @pytest.fixture
    def script(self, tmp_path):
        """Make a program of shell lines, in a folder with a space in its name."""

        def make(lines: str) -> str:
            folder = tmp_path / "my tools"
            folder.mkdir(exist_ok=True)
            program = folder / "compiler"
            program.write_text("#!/bin/sh\n" + lines)
            program.chmod(0o755)
            return str(program)

        return make

    def test_crash(self, script):
        done = tool.run(script("echo so far\nkill -SEGV $$\n"), [])
        assert not done.ok and done.output == "compiler crashed: signal 11 (SIGSEGV)\nso far"

    def test_hang(self, script):
        done = tool.run(script("echo so far\nexec sleep 60\n"), [], timeout=0.5)
        assert not done.ok and done.output == "compiler hung: stopped after 0.5 s\nso far"

    def test_refusal(self, script):
        done = tool.run(script("echo shader.frag\necho no >&2\nexit 3\n"), [], {"shader.frag": b""})
        assert not done.ok and done.output == "no"

    def test_not_a_program(self, tmp_path):
        program = tmp_path / "compiler"
        program.write_bytes(b"\x00\x01")
        program.chmod(0o755)
        done = tool.run(str(program), [])
        assert not done.ok and "compiler could not be started" in done.output

    def test_files(self, script):
        done = tool.run(script('cat "$1" > out\necho héllo\n'), ["in put"], {"in put": b"text"}, ["out", "none"])
        assert done.ok and done.files == {"out": b"text"} and done.output == "héllo"

    def test_space_in_the_temporary_folder(self, tmp_path, monkeypatch):
        folder = tmp_path / "with a space"
        folder.mkdir()
        monkeypatch.setattr(tempfile, "tempdir", str(folder))
        source = shaders.glsl("BokehDebug", "450")
        result = compiled(lambda: glslang.glsl(source, "frag", "450"))
        assert result.ok and result.messages == ""
        assert compiled(lambda: spirv.cross_checked(result.binary, "frag", "essl310")).ok
        assert list(folder.iterdir()) == []

    def test_nothing_installed(self, monkeypatch):
        monkeypatch.setenv("PATH", "/nonexistent")

        def absent():
            raise Unavailable("no driver; apt-get install -y driver")

        rows = [row for row in SAMPLE if row.profile in ("450", "wgsl")]
        result = matrix.run(rows, runtimes=matrix.Runtimes(gl=absent, wgpu=absent, chromium=absent))
        assert not result.ok and set(result.versions.values()) == {""}
        for row in result.rows:
            for column in row.program.compilers:
                assert row.cells[column].status == chain.MISSING
                assert "apt-get install -y" in row.cells[column].message
        told = matrix.failures(result)
        assert any(glslang.INSTALL in text for text in told)
        assert len(told) == 5  # glslang, glslc, mesa, naga, tint: the rest only waits for glslang


class TestOutput:
    """What the command line and the report page are given."""

    def test_json(self, whole):
        data = matrix.as_json(whole)
        assert json.loads(json.dumps(data)) == data
        assert len(data["rows"]) == len(ROWS) and data["ok"] == whole.ok
        assert set(data["rows"][0]["cells"]) == set(variants.COLUMNS)

    def test_tables_in_80_columns(self, whole):
        console = Console(file=io.StringIO(), width=80)
        for part in matrix.tables(whole):
            console.print(part)
        text = console.file.getvalue()
        for name in {row.id for row in ROWS}:
            assert sum(line.startswith(f"{name} ") for line in text.splitlines()) == 1
        for column in variants.COLUMNS:
            assert text.split().count(column) == sum(column in row.compilers for row in SAMPLE)
        assert text.count("DepthOfFieldFinal 2 13 ") == len(PAPER)
        assert text.count("NaiveGather 2 13 127 576 ") == len(PAPER) - 1  # shader model 3 has counts of its own
        assert matrix.summary(whole) in text

    def test_counts(self, whole, broken):
        assert sum(whole.counts.values()) == sum(len(row.compilers) for row in ROWS)
        assert broken.counts["ok"] == 0
        assert len(matrix.tables(broken)) == len(SAMPLE) + 1 + len(matrix.failures(broken))

    def test_failures_are_told_once(self, broken):
        told = matrix.failures(broken)
        assert not any("no input" in text for text in told)
        assert len(told) <= len(CELLS)
        assert all(text.startswith(variants.COLUMNS) for text in told)

    def test_partial_failure_in_the_table(self, whole):
        """One sample count of several fails: the table says how many, and counts the rest as ok."""
        rows = [row for row in whole.rows if (row.variant, row.entry) == ("wgsl", "BokehNaiveGather")]
        cells = {**rows[0].cells, "naga": matrix.Cell(chain.FAILED, "[red] no")}
        result = dataclasses.replace(whole, rows=[dataclasses.replace(rows[0], cells=cells), *rows[1:]])
        console = Console(file=io.StringIO(), width=80)
        console.print(matrix.table(result, "wgsl"))
        assert f"failed 1/{len(rows)}" in console.file.getvalue()
        assert "naga: wgsl BokehNaiveGather 2\n    [red] no" in matrix.failures(result)

    def test_progress(self, runtimes):
        seen = []
        rows = [row for row in SAMPLE if row.language == "glsl"]
        matrix.run(rows, seen.append, runtimes)
        assert seen == [row.name for row in rows]
        assert len(seen) == matrix.count(rows)

    def test_warnings_are_counted(self):
        assert accepted("").facts == {}
        assert accepted("WARNING: a\nWARNING: b\n").facts == {"warnings": 2}


GOOD = """
[sets.one]
entries = ["BokehDebug"]
[sets.two]
entries = ["BokehDepthOfField", "BokehNaiveGrid"]
samples = [2, 13]
[[variant]]
id = "web"
language = "wgsl"
profile = "wgsl"
sets = ["one", "two"]
compilers = ["naga"]
"""


class TestFile:
    """variants.toml."""

    def test_expansion(self, tmp_path):
        file = tmp_path / "variants.toml"
        file.write_text(GOOD)
        assert [row.name for row in matrix.load(file)] == [
            "web BokehDebug",
            "web BokehDepthOfField 2",
            "web BokehDepthOfField 13",
            "web BokehNaiveGrid 2",
            "web BokehNaiveGrid 13",
        ]

    def test_quick(self):
        quick = matrix.load(quick=True)
        assert len(quick) == len({(row.id, row.entry) for row in ROWS})
        # the exact polygons have no 13, so the first count of theirs
        assert {row.samples for row in quick} == {None, 13, 7}

    @pytest.mark.parametrize(
        ("old", "new", "words"),
        [
            ('"wgsl"\nprofile', '"cg"\nprofile', ["language 'cg'", "glsl, hlsl, wgsl"]),
            ('profile = "wgsl"', 'profile = "330"', ["[[variant]] web", "profile '330'", "one of: wgsl"]),
            ('"BokehDebug"', '"BokehBug"', ["[sets.one]", "entries 'BokehBug'", "BokehDebug"]),
            ("samples", "sample", ["[sets.two]", "key 'sample'", "samples"]),
            ('id = "web"', 'name = "web"', ["[[variant]] 1", "key 'name'"]),
            ('id = "web"\n', "", ["[[variant]] 1", "no 'id'"]),
            ('id = "web"', "id = 3", ["id must be a text"]),
            ("[2, 13]", "[1, 13]", ["[sets.two]", "whole numbers from 2 up"]),
            ("[2, 13]", "[2.5]", ["whole numbers from 2 up"]),
            ("[2, 13]", "[true]", ["whole numbers from 2 up"]),
            ("[2, 13]", "[]", ["whole numbers from 2 up"]),
            ("[2, 13]", "13", ["whole numbers from 2 up"]),
            ("[2, 13]", "[2, 2]", ["more than once", "web BokehDepthOfField 2"]),
            ('["one", "two"]', '["three"]', ["sets 'three'", "one, two"]),
            ('["one", "two"]', "[]", ["sets must be a list of names"]),
            ('["one", "two"]', '"one"', ["sets must be a list of names"]),
            ('["naga"]', '["mesa"]', ["compilers 'mesa'", "one of: naga"]),
            ('["naga"]', '["hlslcc"]', ["compilers 'hlslcc'", "one of: naga"]),
            ("[sets.one]", "[set.one]", ["key 'set'"]),
            ("[[variant]]", "[variant]", ["[[variant]]"]),
            ("[sets.two]", "[sets.two", ["not TOML"]),
            ("\n[[variant]]", GOOD[GOOD.index("\n[[variant]]") :] + "[[variant]]", ["two variants", "'web'"]),
        ],
    )
    def test_mistakes(self, tmp_path, old, new, words):
        assert GOOD.count(old) >= 1
        file = tmp_path / "variants.toml"
        file.write_text(GOOD.replace(old, new, 1))
        with pytest.raises(UserError) as caught:
            matrix.load(file)
        text = str(caught.value)
        assert "\n" not in text and "variants.toml" in text
        for word in words:
            assert word in text

    def test_no_file(self, tmp_path):
        with pytest.raises(UserError, match="No such file"):
            matrix.load(tmp_path / "none.toml")


def test_versions(whole):
    """Each compiler that is here says which it is."""
    absent = [column for column, version in whole.versions.items() if not version]
    if absent:
        missing(f"missing: {', '.join(absent)}")
    assert "unknown" not in " ".join(whole.versions.values())
    assert all(text for text in (glslang.version(), spirv.version(), dxc.version())), sys.platform
