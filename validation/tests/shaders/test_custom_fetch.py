"""Test BOKEH_CUSTOM_FETCH with integration/stereo, which reads texture arrays instead of using section [2]."""

import moderngl
import numpy as np
import pytest
from support import compiled, load

from bokeh_validation import paths, shaders
from bokeh_validation.compilers import dxc, fxc, glslang
from bokeh_validation.shaders.passes import Pass

BLOCKS = {
    language: (paths.ROOT / f"integration/stereo/stereo.{language}").read_text("ascii") for language in ("glsl", "hlsl")
}
ENTRIES = ("BokehSignedCoCMap", "BokehHexagonFirst", "BokehHexagonSecond", "BokehNaiveGather", "BokehComposite")
SIZE = (48, 32)


def stereo(entry: str) -> str:
    """Return a GLSL program with stereo.glsl in front of the library."""
    head, version, rest = shaders.glsl(entry).partition("#version 330\n")
    return f"{head}{version}{BLOCKS['glsl']}{rest}"


@pytest.mark.parametrize("entry", ENTRIES)
@pytest.mark.parametrize("compiler", ["glslang", "hlsl glslang", "dxc", "fxc"])
def test_compiles(compiler, entry):
    """Compile entries with each compiler of the two languages."""
    hlsl = {model: f"{BLOCKS['hlsl']}{shaders.hlsl(model)}" for model in (5, 6)}
    build = {
        "glslang": lambda: glslang.parse(stereo(entry), "frag"),
        "hlsl glslang": lambda: glslang.hlsl(hlsl[5], "frag", f"{entry}_PS"),
        "dxc": lambda: dxc.build(hlsl[6], "frag", f"{entry}_PS"),
        "fxc": lambda: fxc.build(hlsl[5], "frag", f"{entry}_PS", 5),
    }[compiler]
    result = compiled(build)
    assert result.ok, result.messages


def test_both_eyes():
    """Check that each eye's slice of the arrays gives a result bit-identical to that from a separate texture."""
    driver, random = load("egl"), np.random.default_rng(1)
    maps = random.random((2, SIZE[1], SIZE[0], 4)).astype(np.float16)
    maps[..., 3] = random.uniform(-0.2, 0.2, maps.shape[:3])
    given = {"BokehImageWidth": SIZE[0], "BokehImageHeight": SIZE[1], "BokehAspectRatio": SIZE[0] / SIZE[1]}
    render_pass = Pass(
        "BokehHexagonFirst", {"ColorSamp": "map"}, ("strip2", "strip3"), given, 9, {"BOKEH_SPACING": 1.5}
    )
    expected = [driver.run([render_pass], {"map": eye}, SIZE, "half", keep=render_pass.outputs) for eye in maps]
    driver.make_current()
    context = driver.context
    array = context.texture_array((*SIZE, 2), 4, maps.tobytes(), dtype="f2")
    array.repeat_x = array.repeat_y = False
    array.filter = moderngl.LINEAR, moderngl.LINEAR
    program = context.program(vertex_shader=shaders.glsl("BokehFullScreen"), fragment_shader=stereo(render_pass.entry))
    for name, value in render_pass.values().items():
        if name in program:
            program[name] = value
    for eye in (0, 1):
        targets = [context.texture(SIZE, 4, dtype="f2") for _ in render_pass.outputs]
        program["BokehEye"] = float(eye)
        array.use(0)
        context.sampler(repeat_x=False, repeat_y=False).use(0)
        context.framebuffer(targets).use()
        context.vertex_array(program, []).render(moderngl.TRIANGLES, vertices=3)
        for name, target in zip(render_pass.outputs, targets, strict=True):
            drawn = np.frombuffer(target.read(), np.float16).reshape(SIZE[1], SIZE[0], 4)
            np.testing.assert_array_equal(drawn, expected[eye][name].astype(np.float16))
