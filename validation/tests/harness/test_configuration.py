"""A wrong configuration stops with the package's own text, in every compiler."""

from collections.abc import Callable

import pytest
from support import compiled, says

from bokeh_validation import paths, shaders
from bokeh_validation.compilers import dxc, fxc, glslang, mesa


def without(source: str, file: Callable, language: str) -> str:
    """A program that lacks one of the package's files."""
    return source.replace(file(language).read_text(encoding="ascii"), "")


GLSL, GLSL_TEXT = shaders.glsl("BokehDebug"), shaders.text("glsl")
ONE_SAMPLE, CHARACTER = {"BOKEH_NUM_SAMPLES": 1}, {"BOKEH_CHARACTER": 3}


class TestConfiguration:
    """A wrong configuration stops with our own text, not with a riddle further down."""

    @pytest.mark.parametrize("compiler", ["glslang", "mesa"])
    @pytest.mark.parametrize(
        ("source", "words"),
        [
            (GLSL, ""),
            (without(GLSL, paths.layers, "glsl"), ""),
            (without(shaders.glsl("BokehLayered"), paths.layers, "glsl"), "put bokeh_layers.glsl before this file"),
            (without(GLSL, paths.library, "glsl"), "put bokeh.glsl before bokeh_layers.glsl"),
            ("#version 330\n" + GLSL_TEXT, "define BOKEH_PASS before this file"),
            (f"#version 330\n#define BOKEH_PASS BOKEH_FEILD\n{GLSL_TEXT}", "BOKEH_PASS is none of the names"),
            (shaders.glsl("BokehDebug", values=ONE_SAMPLE), "BOKEH_NUM_SAMPLES must be 2 or more"),
            (shaders.glsl("BokehDebug", values=CHARACTER), "BOKEH_CHARACTER must be 0, 1 or 2"),
            (GLSL.replace("#version 330", "#version 120", 1), "needs GLSL 3.30 or later"),
            (GLSL.replace("#version 330", "#version 100", 1), "needs GLSL ES 3.00 or later"),
        ],
        ids=["right", "no layers", "layers missed", "no library", "no pass", "pass", "one", "character", "120", "100"],
    )
    def test_glsl(self, compiler, source, words):
        if compiler == "glslang":
            result = compiled(lambda: glslang.parse(source, "frag"))
        else:
            result = compiled(lambda: mesa.build(shaders.glsl("BokehFullScreen"), source))
        assert says(result, words) if words else result.ok

    @pytest.mark.parametrize(
        "compiler",
        [glslang.hlsl, dxc.build, lambda *arguments: fxc.build(*arguments, 5)],
        ids=["glslang", "dxc", "fxc"],
    )
    @pytest.mark.parametrize(
        ("source", "words"),
        [
            *((shaders.hlsl(model), "") for model in (4, 5, 6)),
            *((without(shaders.hlsl(model), paths.layers, "hlsl"), "") for model in (4, 5, 6)),
            (without(shaders.hlsl(5), paths.library, "hlsl"), "put bokeh.hlsl before bokeh_layers.hlsl"),
            (shaders.hlsl(5, ONE_SAMPLE), "BOKEH_NUM_SAMPLES must be 2 or more"),
            (shaders.hlsl(5, CHARACTER), "BOKEH_CHARACTER must be 0, 1 or 2"),
            (shaders.hlsl(7), "BOKEH_HLSL_SM must be 3, 4, 5 or 6"),
        ],
        ids=["4", "5", "6", "4 no layers", "5 no layers", "6 no layers", "no library", "one sample", "character", "7"],
    )
    def test_hlsl(self, compiler, source, words):
        result = compiled(lambda: compiler(source.replace("\r", ""), "frag", "BokehDebug_PS"))
        assert says(result, words) if words else result.ok
