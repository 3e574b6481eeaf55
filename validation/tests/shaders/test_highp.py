"""Test that the libraries use float throughout, also in a program that begins with mediump."""

import re

import pytest
from support import disassembled

from bokeh_validation import paths, shaders
from bokeh_validation.compilers import glslang


def test_libraries_have_no_half():
    """Check that no language uses a word for 16-bit variables, except to define the types of BOKEH_HALF_PRECISION;
    comments may.
    """
    for language in paths.LANGUAGES:
        for stem in paths.STEMS:
            code = re.sub(r"//.*|#define BOKEH_(?:TO_)?HALF\d .*", "", shaders.file_text(language, stem))
            halves = re.findall(r"\b(?:half\d?|min\w+float\d?|float16_t\d?|mediump|lowp|f16|vec\dh)\b", code)
            assert not halves, f"{language}, {stem}: {halves}"


@pytest.mark.parametrize("entry", ["BokehDepthOfField", "BokehComposite"])
def test_highp_wins_over_mediump(entry):
    """Check that `precision mediump float;` before the library has no effect; without the library's own lines it
    would.
    """
    head = f"#version 310 es\nprecision mediump float;\n#define BOKEH_PASS {shaders.glsl_pass(entry)}\n"
    text = shaders.text("glsl")
    without_highp = re.sub(r"^precision highp \w+;\n", "", text, flags=re.MULTILINE)
    for library, is_relaxed in ((text, False), (without_highp, True)):
        compiled = glslang.spirv(head + library, "frag", glslang.VULKAN)
        assert compiled.ok and ("RelaxedPrecision" in disassembled(compiled.binary)) == is_relaxed, compiled.messages
