"""A wrong configuration stops with the package's own text, in every compiler, not with a riddle further down."""

import pytest
from support import compiled, says

from bokeh_validation import paths, shaders
from bokeh_validation.compilers import dxc, fxc, glslang, mesa

GLSL, GLSL_TEXT = shaders.glsl("BokehDebug"), shaders.text("glsl")
LIBRARY, LAYERS = (
    {language: file(language).read_text(encoding="ascii") for language in paths.LANGUAGES}
    for file in (paths.library, paths.layers)
)
WRONG_GLSL = {
    "no layers": (shaders.glsl("BokehComposite").replace(LAYERS["glsl"], ""), "put bokeh_layers.glsl before this file"),
    "no library": (GLSL.replace(LIBRARY["glsl"], ""), "put bokeh.glsl before bokeh_layers.glsl"),
    "no pass": ("#version 330\n" + GLSL_TEXT, "define BOKEH_PASS before this file"),
    "pass": (f"#version 330\n#define BOKEH_PASS BOKEH_FEILD\n{GLSL_TEXT}", "BOKEH_PASS is none of the names"),
    "one": (shaders.glsl("BokehDebug", values={"BOKEH_NUM_SAMPLES": 1}), "BOKEH_NUM_SAMPLES must be 2 or more"),
    "character": (shaders.glsl("BokehDebug", values={"BOKEH_CHARACTER": 3}), "BOKEH_CHARACTER must be 0, 1 or 2"),
    "120": (GLSL.replace("#version 330", "#version 120", 1), "needs GLSL 3.30 or later"),
    "100": (GLSL.replace("#version 330", "#version 100", 1), "needs GLSL ES 3.00 or later"),
}
WRONG_HLSL = {
    "no library": (shaders.hlsl(5).replace(LIBRARY["hlsl"], ""), "put bokeh.hlsl before bokeh_layers.hlsl"),
    "one": (shaders.hlsl(5, {"BOKEH_NUM_SAMPLES": 1}), "BOKEH_NUM_SAMPLES must be 2 or more"),
    "character": (shaders.hlsl(5, {"BOKEH_CHARACTER": 3}), "BOKEH_CHARACTER must be 0, 1 or 2"),
    "7": (shaders.hlsl(7), "BOKEH_HLSL_SM must be 3, 4, 5 or 6"),
}
# compilers by what they take: source, stage, entry
HLSL = {"glslang": glslang.hlsl, "dxc": dxc.build, "fxc": lambda *given: fxc.build(*given, 5)}


@pytest.mark.parametrize("case", ["right", "without layers", *WRONG_GLSL])
@pytest.mark.parametrize("compiler", ["glslang", "mesa"])
def test_glsl(compiler, case):
    right = {"right": (GLSL, ""), "without layers": (GLSL.replace(LAYERS["glsl"], ""), "")}
    source, words = (right | WRONG_GLSL)[case]
    if compiler == "glslang":
        result = compiled(lambda: glslang.parse(source, "frag"))
    else:
        result = compiled(lambda: mesa.build(shaders.glsl("BokehFullScreen"), source))
    assert says(result, words) if words else result.ok


@pytest.mark.parametrize("case", ["4", "5", "6", *WRONG_HLSL])
@pytest.mark.parametrize("compiler", HLSL)
def test_hlsl(compiler, case):
    """Right with and without the layers."""
    source, words = WRONG_HLSL.get(case) or (shaders.hlsl(int(case)), "")
    for text in (source,) if words else (source, source.replace(LAYERS["hlsl"], "")):
        result = compiled(lambda text=text: HLSL[compiler](text, "frag", "BokehDebug_PS"))
        assert says(result, words) if words else result.ok
