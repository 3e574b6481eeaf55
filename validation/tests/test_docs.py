"""The documents against the code: README snippets compile, tables name what exists."""

import re

import numpy as np
import pytest
from conftest import load

from bokeh_validation import methods, passes, paths, shaders
from bokeh_validation.compilers import dxc, fxc, glslang, naga
from bokeh_validation.patterns.model import Case, depth_of, flat

README = (paths.ROOT / "README.md").read_text(encoding="utf-8")


def snippets(language: str, count: int = 1) -> list[str]:
    """The fenced blocks of a language in the README."""
    found = re.findall(rf"^```{language}\n(.*?)^```", README, re.MULTILINE | re.DOTALL)
    assert len(found) == count, f"{len(found)} blocks of {language}"
    return found


def library(language: str) -> str:
    """The library's text."""
    return paths.library(language).read_text(encoding="ascii")


@pytest.mark.parametrize("profile", ["330", "300es"])
@pytest.mark.parametrize("index", [0, 1])
def test_readme_glsl_compiles(profile, index):
    """Pasted as the README says, first and second pass."""
    shown = snippets("glsl", 2)[index]
    result = glslang.parse(f"{shaders.GLSL_VERSIONS[profile]}\n{library('glsl')}{shown}", "frag")
    assert result.ok, result.messages


@pytest.mark.parametrize("entry", ["first", "second"])
def test_readme_hlsl_compiles(entry):
    """Shader model 6 by DXC; 3, 4 and 5 by Microsoft's compiler."""
    (shown,) = snippets("hlsl")
    result = dxc.build(f"#define BOKEH_HLSL_SM 6\n{library('hlsl')}{shown}", "frag", entry)
    assert result.ok, result.messages
    (old,) = snippets("hlsl3")
    assert fxc.bytecode(library("hlsl") + old, "ps_3_0", entry)
    for model in (4, 5):
        assert fxc.bytecode(f"#define BOKEH_HLSL_SM {model}\n{library('hlsl')}{shown}", f"ps_{model}_0", entry)


def test_readme_wgsl_compiles():
    """By naga, which raises what it has against a module."""
    naga.driver().device.create_shader_module(code=library("wgsl") + snippets("wgsl")[0])


def test_readme_links_exist():
    """Every relative link leads somewhere."""
    for document in (
        paths.ROOT / "README.md",
        *(paths.ROOT / "docs").glob("*.md"),
        paths.ROOT / "integration/README.md",
    ):
        for target in re.findall(r"\]\(([^)#]+)\)", document.read_text(encoding="utf-8")):
            assert (document.parent / target).exists(), f"{document.name}: {target}"


def test_parameter_table():
    """docs/inputs.md lists the parameters with the indices and offsets that the drivers use."""
    text = (paths.ROOT / "docs/inputs.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (\d+) \| (\d+) \| (Bokeh\w+) \|", text, re.MULTILINE)
    assert rows == [(str(i), str(4 * i), name) for i, name in enumerate(passes.PARAMETERS)]


def test_parameter_buffer(monkeypatch):
    """The buffer is as large as docs/inputs.md says: wgpu refuses one that is four bytes shorter, and says so."""
    text = (paths.ROOT / "docs/inputs.md").read_text(encoding="utf-8")
    size = int(re.search(r"The buffer is (\d+) bytes", text)[1])
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

    assert (run(size)[..., :3] > 0.0).all()
    with pytest.raises(driver.wgpu.GPUValidationError, match=f"size {size - 4} where the shader expects {size}"):
        run(size - 4)


def test_paper_names_exist():
    """Every function that docs/paper.md names is in all three libraries."""
    text = (paths.ROOT / "docs/paper.md").read_text(encoding="utf-8")
    names = set(re.findall(r"`(Bokeh[A-Z]\w+)`", text))
    assert len(names) > 8
    for language in paths.LANGUAGES:
        for name in names:
            assert re.search(rf"\b{name}\(", library(language)), f"{name} in {language}"


def test_pitfalls_name_tests():
    """Every test that docs/pitfalls.md names is there, and every row has its four cells."""
    text = (paths.ROOT / "docs/pitfalls.md").read_text(encoding="utf-8")
    named = re.findall(r"`(test_\w+\.py)(?:::(test_\w+))?`", text)
    assert len(named) > 40
    for file, name in named:
        source = (paths.VALIDATION / "tests" / file).read_text(encoding="utf-8")
        assert not name or re.search(rf"^(?:    )?def {name}\(", source, re.MULTILINE), f"{file}::{name}"
    for row in re.findall(r"^\| .* \|$", text, re.MULTILINE):
        assert row.count(" | ") == 3, row
