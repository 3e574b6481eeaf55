"""Every shader program through every compiler, and proof that the compilers would notice."""

import dataclasses
import io
import json
import re
import subprocess
import sys
import tempfile
from functools import partial

import pytest
from rich.console import Console
from support import compiled, needed, says

from bokeh_validation import paths, shaders
from bokeh_validation.compilers import dxc, glslang, matrix, mesa, naga, registry, spirv, tool
from bokeh_validation.compilers.registry import FAILED, MISSING, OK, Cell
from bokeh_validation.compilers.tool import accepted
from bokeh_validation.errors import Unavailable

ROWS = matrix.load()
CELLS = list(dict.fromkeys((row.variant, column) for row in ROWS for column in row.compilers))
# One row of each variant is enough where all would say the same: the paper's, where a variant has it.
PAPER = [row for row in ROWS if row.entry == "BokehDepthOfField" and row.samples == 13]
SAMPLE = list({row.variant: row for row in [*ROWS, *PAPER]}.values())
SAMPLERS = ("BokehLinearClamp",)


def misspelled(source: str) -> str:
    """A mistake as it happens: a name that is not declared."""
    assert "samplePixel * weight" in source
    return source.replace("samplePixel * weight", "samplePixel * weigth")


@pytest.fixture(scope="module")
def whole() -> matrix.Matrix:
    """The matrix as it is."""
    return matrix.run(ROWS)


@pytest.fixture(scope="module")
def broken() -> matrix.Matrix:
    """One row of each variant with a mistake in it."""
    return matrix.run(SAMPLE, edit=misspelled)


@pytest.fixture(scope="module")
def module() -> bytes:
    """A SPIR-V module that is right."""
    return compiled(lambda: glslang.spirv(shaders.glsl("BokehDebug", "450"), "frag", glslang.VULKAN)).binary


def chosen(result: matrix.Matrix, variant: str, column: str) -> list[tuple[matrix.Program, Cell]]:
    """A variant's rows with their cells in one column, which are there."""
    found = [(row, row.cells[column]) for row in result.rows if row.variant == variant]
    for _, cell in found:
        there(cell)
    return found


def there(cell: Cell) -> Cell:
    """The same, unless its compiler is missing."""
    with needed("compiler"):
        if cell.status == MISSING:
            raise Unavailable(cell.message)
    return cell


def bindings(module: bytes) -> dict[str, int]:
    """Name -> binding of the textures and samplers of a SPIR-V module, as spirv-cross finds them. All are in set 0."""
    done = spirv.CROSS.run(["m.spv", "--reflect", "--output", "out.json"], {"m.spv": module}, ["out.json"])
    told = json.loads(done.files["out.json"])
    found = [item for kind in ("textures", "separate_images", "separate_samplers") for item in told.get(kind, [])]
    assert all(item["set"] == 0 for item in found)
    return {item["name"]: item["binding"] for item in found}


class TestShaders:
    """The package's shaders."""

    @pytest.mark.parametrize(("variant", "column"), CELLS)
    def test_accepted(self, whole, variant, column):
        cells = chosen(whole, variant, column)
        bad = [f"{row.name}: {cell.status}: {cell.message}" for row, cell in cells if cell.status != OK]
        assert not bad, "\n".join(bad)

    def test_no_sample_takes_its_level_from_derivatives(self, whole):
        """Such a sample is an error in a loop or a branch in HLSL and WGSL."""
        facts = [(row.name, cell.facts) for row in whole.rows for cell in row.cells.values()]
        counted = [(name, known) for name, known in facts if "implicit_lod" in known]
        with needed("SPIR-V"):
            if not counted:
                raise Unavailable(glslang.GLSLANG.install)
        assert [name for name, known in counted if known["implicit_lod"]] == []
        assert any(known["samples"] for _, known in counted)

    def test_depth_and_kernel_need_no_filtering_sampler(self):
        """naga builds on a layout where they are unfilterable, so depth through a sampler has to fail there."""
        row = next(row for row in SAMPLE if row.variant == "wgsl" and row.entry == "BokehDepthOfField")

        def linear(source: str) -> str:
            direct = "Nearest(DepthSamp, sampleCoords)"
            return source.replace(direct, "(DepthSamp, ColorSampSampler, sampleCoords)")

        ((_, cell),) = chosen(matrix.run([row], edit=linear), "wgsl", "naga")
        assert cell.status == FAILED and "filterable" in cell.message.lower()

    @pytest.mark.parametrize(
        ("module", "samplers"),
        [
            (lambda entry: glslang.spirv(shaders.glsl(entry, "450"), "frag", glslang.VULKAN), ()),
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
        """docs/performance.md: entries over all sample counts, as fxc has them, the largest figures among them."""
        largest: dict[str, list[int]] = {}
        for row, cell in chosen(whole, "hlsl-sm3", "fxc"):
            found = [cell.facts[name] for name in ("slots", "temporaries", "constants", "samplers")]
            stem = row.entry.removeprefix("Bokeh")
            largest[stem] = list(map(max, largest.get(stem, found), found))
        text = (paths.ROOT / "docs/performance.md").read_text(encoding="utf-8")
        table = text[text.index("| ps_3_0, the largest") :].partition("\n\n")[0].splitlines()[2:]
        shown = {name: [int(n) for n in numbers] for name, *numbers in (row.strip("| ").split(" | ") for row in table)}
        assert shown.items() <= largest.items()
        assert list(map(max, *shown.values())) == list(map(max, *largest.values()))

    def test_slots_of_the_viewport(self, whole):
        """docs/performance.md: how many slots more BOKEH_VIEWPORT takes in shader model 3."""
        cells = [(row, cell) for row, cell in chosen(whole, "hlsl-sm3-viewport", "fxc") if "Layer" not in row.entry]
        without = matrix.run([dataclasses.replace(row, values={}, compilers=("fxc",)) for row, _ in cells]).rows
        more = [
            cell.facts["slots"] - row.cells["fxc"].facts["slots"] for (_, cell), row in zip(cells, without, strict=True)
        ]
        assert len(more) == 9
        text = (paths.ROOT / "docs/performance.md").read_text(encoding="utf-8")
        (told,) = re.findall(r"nine entries compiled with it\D*(\d+) to (\d+)\s+slots", text)
        assert told == (str(min(more)), str(max(more)))


class TestCompilersNotice:
    """A cell that is ok means something: each compiler reports what is wrong."""

    @pytest.mark.parametrize(("variant", "column"), CELLS)
    def test_undeclared_name(self, broken, variant, column):
        ((row, cell),) = chosen(broken, variant, column)
        assert cell.status == FAILED
        if cell.follows:
            assert cell.message == f"no input: {cell.follows} failed"
        else:
            lines = shaders.text(row.language).splitlines()
            first = next(index for index, line in enumerate(lines, 1) if "samplePixel * weight" in line)
            assert "weigth" in cell.message and f"bokeh.{row.language}:{first}" in cell.message

    @pytest.mark.parametrize("variant", ["glsl-330", "glsl-450"])
    def test_one_of_several(self, variant):
        """A tool that is given several at once: each is told what is its own."""
        rows = [row for row in ROWS if row.variant == variant][1:4]

        def second(source: str) -> str:
            return misspelled(source) if shaders.glsl_pass(rows[1].entry) + "\n" in source[:100] else source

        for row in matrix.run(rows, edit=second).rows:
            for column in row.compilers:
                cell = there(row.cells[column])
                assert cell.status == (FAILED if row.entry == rows[1].entry else OK), (row.name, column, cell)

    def test_places_in_the_second_file(self):
        source = shaders.glsl("BokehDebug", "330")
        library = sum(len(file("glsl").read_text().splitlines()) for file in (paths.library, paths.layers))
        message = f"ERROR: shader.frag:{library + 2 + 7}: 'x'\nERROR: shader.frag:1: 'y'"
        told = "ERROR: bokeh_passes.glsl:7: 'x'\nERROR: shader.frag:1: 'y'"
        assert registry.located(message, source, "glsl") == told

    def test_link_of_stages_that_do_not_fit(self):
        vertex = shaders.glsl("BokehFullScreen").replace("out vec2 BokehUV", "out vec3 BokehUV")
        vertex = vertex.replace("BokehUV = vec2(", "BokehUV = vec3(0.0, ").replace("BokehUV * 2.0", "BokehUV.xy * 2.0")
        result = compiled(lambda: mesa.build(vertex, shaders.glsl("BokehDebug")))
        assert not result.ok and result.messages.startswith("link: ") and "BokehUV" in result.messages

    @pytest.mark.parametrize(
        ("step", "words"),
        [
            (lambda: glslang.parse("#version 330\nvoid other() {}\n", "frag"), "entry point"),
            (lambda: glslang.hlsl(shaders.hlsl(5), "frag", "BokehNone_PS"), ""),
            (lambda: dxc.build(shaders.hlsl(6), "frag", "BokehNone_PS", True), ""),
            (lambda: dxc.build(shaders.hlsl(6), "frag", "BokehNone_PS", False), ""),
            (
                lambda: naga.build(
                    *(naga.Stage(shaders.wgsl(), name) for name in ("BokehFullScreen_VS", "BokehNone_PS"))
                ),
                "BokehNone_PS",
            ),
        ],
        ids=["glslang", "glslang HLSL", "dxc-spirv", "dxc-dxil", "naga"],
    )
    def test_no_entry_point(self, step, words):
        result = compiled(step)
        assert not result.ok and words in result.messages

    def test_a_program_with_dxc_ends_as_it_says(self):
        """Its own status, and what it printed: the library's clean-up is left out at the end."""
        compiled(lambda: dxc.build(shaders.hlsl(6), "frag", "BokehDebug_PS"))
        program = (
            "import sys; from bokeh_validation import shaders; from bokeh_validation.compilers import dxc; "
            "dxc.build(shaders.hlsl(6), 'frag', 'BokehDebug_PS'); print('printed'); sys.exit(3)"
        )
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
        assert (done.returncode, done.stdout, done.stderr) == (3, "printed\n", "")

    def test_spirv_of_another_environment(self):
        module = compiled(lambda: glslang.spirv(shaders.glsl("BokehDebug"), "frag", glslang.OPENGL)).binary
        assert compiled(lambda: spirv.validate(module, spirv.OPENGL_RULES)).ok
        assert says(compiled(lambda: spirv.validate(module, spirv.VULKAN_RULES)), "OriginLowerLeft")

    @pytest.mark.parametrize("step", [spirv.validate, *(partial(spirv.cross, target=name) for name in spirv.TARGETS)])
    def test_spirv_cut_short(self, module, step):
        assert compiled(lambda: step(module)).ok
        result = compiled(lambda: step(module[: len(module) // 2 & ~3]))
        assert not result.ok and result.messages

    def test_naga_takes_no_spirv_cut_short(self):
        source = shaders.hlsl(6)
        vertex = compiled(lambda: dxc.build(source, "vert", "BokehFullScreen_VS")).binary
        fragment = compiled(lambda: dxc.build(source, "frag", "BokehDebug_PS")).binary
        stages = [naga.Stage(vertex, "BokehFullScreen_VS"), naga.Stage(fragment[:400], "BokehDebug_PS")]
        result = compiled(lambda: naga.build(*stages))
        assert not result.ok and result.messages

    def test_essl_that_does_not_compile(self, module):
        text = compiled(lambda: spirv.cross(module, "essl300"))
        wrong = accepted("", text.binary.replace(b"texture", b"texturre"))
        right, mistaken = compiled(lambda: glslang.checked([(text, "frag"), (wrong, "frag")], "essl300"))
        assert right == text
        assert not mistaken.ok and "texturre" in mistaken.messages


class TestTools:
    """Command line compilers come to their ends in many ways."""

    @pytest.mark.parametrize(
        ("lines", "ok", "output"),
        [
            ("echo so far\nkill -SEGV $$", False, "compiler crashed: signal 11 (Segmentation fault)\nso far"),
            ("echo so far\nexec sleep 60", False, "compiler hung: stopped after 0.5 s\nso far"),
            ("echo in put\necho no >&2\nexit 3", False, "no"),
            ('cat "$1" > out\necho héllo', True, "héllo"),
            ("\0\1", False, "compiler could not be started: [Errno 8] Exec format error"),
        ],
        ids=["crash", "hang", "refusal", "files", "no program"],
    )
    def test_ends(self, tmp_path, lines, ok, output):
        program = tmp_path / "my tools" / "compiler"
        program.parent.mkdir()
        program.write_text(lines if "\0" in lines else "#!/bin/sh\n" + lines)
        program.chmod(0o755)
        done = tool.run(str(program), ["in put"], {"in put": b"text"}, ["out", "none"], timeout=0.5 if not ok else 30)
        assert done.ok == ok and done.output.partition(": '")[0] == output
        assert done.files == ({"out": b"text"} if ok else {})

    def test_space_in_the_temporary_folder(self, tmp_path, monkeypatch):
        folder = tmp_path / "with a space"
        folder.mkdir()
        monkeypatch.setattr(tempfile, "tempdir", str(folder))
        result = matrix.run([row for row in ROWS if row.name == "glsl-450 BokehDebug"])
        assert result.counts[FAILED] == 0
        assert not [path for path in folder.iterdir() if not path.name.startswith("bokeh-chromium")]

    def test_nothing_installed(self, monkeypatch):
        def absent():
            raise Unavailable("no driver; apt-get install -y driver")

        monkeypatch.setenv("PATH", "/nonexistent")
        monkeypatch.setattr(mesa, "driver", absent)
        monkeypatch.setattr(naga, "driver", absent)
        monkeypatch.setattr(registry.angle_tint.browser, "session", absent)
        result = matrix.run([row for row in SAMPLE if row.profile in ("450", "wgsl")])
        assert not result.ok and set(result.versions.values()) == {""}
        for row in result.rows:
            for column in row.compilers:
                assert row.cells[column].status == MISSING
                assert "apt-get install -y" in row.cells[column].message
        told = matrix.failures(result)
        assert any(glslang.GLSLANG.install in text for text in told)
        assert len(told) == 5  # glslang, glslc, mesa, naga, tint: the rest only waits for glslang


class TestOutput:
    """What the command line and the report page are given."""

    def test_json(self, whole):
        data = matrix.as_json(whole)
        assert json.loads(json.dumps(data)) == data
        assert len(data["rows"]) == len(ROWS) and data["ok"] == whole.ok
        assert set(data["rows"][0]["cells"]) == set(matrix.COLUMNS)
        assert sum(data["counts"].values()) == sum(len(row.compilers) for row in ROWS)

    def test_tables_in_80_columns(self, whole):
        console = Console(file=io.StringIO(), width=80)
        for part in matrix.tables(whole):
            console.print(part)
        text = console.file.getvalue()
        for name in {row.variant for row in ROWS}:
            assert sum(line.startswith(f"{name} ") for line in text.splitlines()) == 1
        for column in matrix.COLUMNS:
            assert text.split().count(column) == sum(column in row.compilers for row in SAMPLE)
        assert text.count("NaiveGather 2 13 127 576 ") == len(PAPER) - 1  # shader model 3 has counts of its own
        assert matrix.summary(whole) in text

    def test_failures_are_told_once(self, broken):
        told = matrix.failures(broken)
        assert broken.counts["ok"] == 0
        assert not any("no input" in text for text in told)
        assert len(told) <= len(CELLS)
        assert all(text.startswith(matrix.COLUMNS) for text in told)

    def test_partial_failure_in_the_table(self, whole):
        """One sample count of several fails: the table says how many, and counts the rest as ok."""
        rows = [row for row in whole.rows if (row.variant, row.entry) == ("wgsl", "BokehNaiveGather")]
        cells = {**rows[0].cells, "naga": Cell(FAILED, "[red] no")}
        result = dataclasses.replace(whole, rows=[dataclasses.replace(rows[0], cells=cells), *rows[1:]])
        console = Console(file=io.StringIO(), width=80)
        console.print(matrix.table(result, "wgsl"))
        assert f"failed 1/{len(rows)}" in console.file.getvalue()
        assert "naga: wgsl BokehNaiveGather 2\n    [red] no" in matrix.failures(result)

    def test_versions(self, whole):
        """Each compiler that is here says which it is."""
        with needed("compiler"):
            if not all(whole.versions.values()):
                raise Unavailable(str(whole.versions))
        assert "unknown" not in " ".join(whole.versions.values())
