"""Depth of field for an OpenGL 3.3 renderer: an exact hexagon. Two files of shaders are the rest."""

from functools import partial
from pathlib import Path

from renderer import FullScreenPass, texture

# the folder with the two files
GLSL = Path(__file__).resolve().parents[2] / "glsl"
LIBRARY, PASSES = (GLSL / "bokeh.glsl").read_text(), (GLSL / "bokeh_passes.glsl").read_text()


def shader(name):
    """Text of a shader; `name` without BOKEH_ is one of the table in bokeh_passes.glsl."""
    return f"#version 330\n#define BOKEH_PASS BOKEH_{name}\n#define BOKEH_NUM_SAMPLES 33\n{LIBRARY}{PASSES}"


def exact_hexagon(context, color, depth):
    """The passes, to be drawn in their order each frame, and the texture that the last one writes."""
    metres = texture(context, color.size, "R32F")
    coc, t2, t3, result = (texture(context, color.size, "RGBA16F") for _ in range(4))
    full_screen = partial(FullScreenPass, context, shader("FULL_SCREEN"))
    return [
        full_screen(shader("LINEAR_DEPTH"), {"BokehDepthSamp": depth}, [metres]),
        full_screen(shader("SIGNED_COC_MAP"), {"BokehColorSamp": color, "BokehDepthSamp": metres}, [coc]),
        full_screen(shader("HEXAGON_FIRST"), {"BokehColorSamp": coc}, [t2, t3]),
        full_screen(shader("HEXAGON_SECOND"), {"BokehColorSamp": t2, "BokehColorSampB": t3}, [result]),
    ], result
