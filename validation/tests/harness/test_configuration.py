"""Check that a wrong configuration stops with the package's own message in every compiler, not with an obscure error
later.
"""

import pytest
from support import compiled, load, says

from bokeh_validation import shaders
from bokeh_validation.compile_matrix import mesa
from bokeh_validation.compilers import dxc, fxc, glslang

GLSL, GLSL_TEXT = shaders.glsl("BokehDebug"), shaders.text("glsl")
# Files that only some of the passes need
LIBRARY, PAPER, LAYERS, LENS = ("bokeh", "bokeh_paper", "bokeh_layers", "bokeh_lens")
HIGH = {"BOKEH_PRESET_HIGH": 1}
PRESET, TWO = "define it or them, not both", "two presets are defined: keep one"


def without(text: str, language: str, *stems: str) -> str:
    """Return a program without some of the files."""
    for stem in stems:
        text = text.replace(shaders.file_text(language, stem), "")
    return text


WRONG = {
    **{name: ({name: 1}, f"{name} must be 2 or more") for name in ("BOKEH_NUM_SAMPLES", "BOKEH_PAPER_SAMPLES")},
    **{f"{name} too": (HIGH | {name: 9}, PRESET) for name in ("BOKEH_NUM_SAMPLES", "BOKEH_SPACING")},
    **{
        f"{name} too": (HIGH | {name: 1}, PRESET)
        for name in ("BOKEH_LAYER_RINGS", "BOKEH_LAYER_SAMPLES", "BOKEH_LAYER_SCALE")
    },
    **{f"HIGH, {name}": (HIGH | {f"BOKEH_PRESET_{name}": 1}, TWO) for name in ("LOW", "MEDIUM", "ULTRA")},
    "LOW, MOBILE": ({"BOKEH_PRESET_LOW": 1, "BOKEH_PRESET_MOBILE": 1}, TWO),
}
WRONG_GLSL = {
    **{name: (shaders.glsl("BokehDebug", values=values), words) for name, (values, words) in WRONG.items()},
    "no paper": (without(shaders.glsl("BokehCoCMap"), "glsl", PAPER), "put bokeh_paper.glsl before this file"),
    "no layers": (without(shaders.glsl("BokehComposite"), "glsl", LAYERS), "put bokeh_layers.glsl before this file"),
    "no lens": (without(shaders.glsl("BokehLateralColor"), "glsl", LENS), "put bokeh_lens.glsl before this file"),
    "no shape": (
        without(shaders.glsl("BokehDebug", values={"BOKEH_LENS_SHAPE": 1}), "glsl", LENS),
        "need bokeh_lens.glsl before this file",
    ),
    **{
        f"{stem} alone": (
            without(GLSL, "glsl", *{LIBRARY, PAPER, LAYERS, LENS} - {stem}),
            f"put bokeh.glsl before {stem}.glsl",
        )
        for stem in (PAPER, LAYERS, LENS)
    },
    "no pass": ("#version 330\n" + GLSL_TEXT, "define BOKEH_PASS before this file"),
    "pass": (f"#version 330\n#define BOKEH_PASS BOKEH_FEILD\n{GLSL_TEXT}", "BOKEH_PASS is none of the names"),
    "120": (GLSL.replace("#version 330", "#version 120", 1), "needs GLSL 3.30 or later"),
    "100": (GLSL.replace("#version 330", "#version 100", 1), "needs GLSL ES 3.00 or later"),
}
WRONG_HLSL = {
    **{name: (shaders.hlsl(5, values), words) for name, (values, words) in WRONG.items()},
    "no library": (without(shaders.hlsl(5), "hlsl", LIBRARY), "put bokeh.hlsl before bokeh_paper.hlsl"),
    "no shape": (
        without(shaders.hlsl(5, {"BOKEH_LENS_SHAPE": 1}), "hlsl", LENS),
        "need bokeh_lens.hlsl before this file",
    ),
    "7": (shaders.hlsl(7), "BOKEH_HLSL_SM must be 3, 4, 5 or 6"),
}
# compilers by name: source, stage, entry -> result
HLSL = {"glslang": glslang.hlsl, "dxc": dxc.build, "fxc": lambda *given: fxc.build(*given, 5)}


@pytest.mark.parametrize("case", ["right", "bokeh and the passes alone", *WRONG_GLSL])
@pytest.mark.parametrize("compiler", ["glslang", "mesa"])
def test_glsl(compiler, case):
    """Compile correct and wrong GLSL configurations, and check the messages."""
    alone = without(GLSL, "glsl", PAPER, LAYERS, LENS)
    source, words = ({"right": (GLSL, ""), "bokeh and the passes alone": (alone, "")} | WRONG_GLSL)[case]
    if compiler == "glslang":
        result = compiled(lambda: glslang.parse(source, "frag"))
    else:
        result = compiled(lambda: mesa.build(shaders.glsl("BokehFullScreen"), source))
    assert says(result, words) if words else result.ok


@pytest.mark.parametrize("case", ["4", "5", "6", *WRONG_HLSL])
@pytest.mark.parametrize("compiler", HLSL)
def test_hlsl(compiler, case):
    """Compile correct and wrong HLSL configurations; correct ones with all files, and with only the library and the
    passes.
    """
    source, words = WRONG_HLSL.get(case) or (shaders.hlsl(int(case)), "")
    for text in (source,) if words else (source, without(source, "hlsl", PAPER, LAYERS, LENS)):
        result = compiled(lambda text=text: HLSL[compiler](text, "frag", "BokehDebug_PS"))
        assert says(result, words) if words else result.ok


@pytest.mark.parametrize("kind", ["texture_multisampled_2d<f32>", "texture_depth_multisampled_2d", "texture_depth_2d"])
def test_other_depth_buffers(kind):
    """Compile for multisampled depth buffers in each language: BOKEH_DEPTH_MULTISAMPLED 1, in WGSL
    another alias type. The pass must accept the layout that docs/own-engine.md gives for a type of depth.
    """
    entry, values, text = "BokehSignedCoCMap", {"BOKEH_DEPTH_MULTISAMPLED": 1}, shaders.text("wgsl")
    alias = "alias BokehDepthTexture = texture_2d<f32>;"
    assert alias in text
    # naga raises an exception if the module is wrong, or does not fit the layout
    device, text = load("wgpu").device, text.replace(alias, f"alias BokehDepthTexture = {kind};")
    module = device.create_shader_module(code=text)
    sample = {"sample_type": "depth" if "depth" in kind else "unfilterable-float", "multisampled": "multi" in kind}
    bound = ({"buffer": {"type": "uniform"}}, {"texture": {}}, {"texture": sample})
    entries = [{"binding": index, "visibility": "FRAGMENT", **one} for index, one in enumerate(bound)]
    device.create_render_pipeline(
        layout=device.create_pipeline_layout(bind_group_layouts=[device.create_bind_group_layout(entries=entries)]),
        vertex={"module": module, "entry_point": "BokehFullScreen_VS"},
        fragment={"module": module, "entry_point": f"{entry}_PS", "targets": [{"format": "rgba16float"}]},
    )
    results = []
    if kind.endswith("2d<f32>"):
        results.append(compiled(lambda: glslang.parse(shaders.glsl(entry, values=values), "frag")))
        results.append(compiled(lambda: dxc.build(shaders.hlsl(6, values), "frag", f"{entry}_PS")))
        results.append(compiled(lambda: fxc.build(shaders.hlsl(5, values), "frag", f"{entry}_PS", 5)))
    assert all(result.ok for result in results), [result.messages for result in results]
