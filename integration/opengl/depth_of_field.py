"""Depth of field for an OpenGL 3.3 renderer: an exact hexagon. Two files of shaders are the rest."""

from functools import partial
from pathlib import Path

from renderer import FullScreenPass, texture

# the folder with the two files
GLSL = Path(__file__).resolve().parents[2] / "glsl"
LIBRARY, PASSES = (GLSL / "bokeh.glsl").read_text(), (GLSL / "bokeh_passes.glsl").read_text()

# what the depth texture holds, to metres along the view axis
METRES = """
uniform sampler2D BokehDepthSamp;
uniform float Near, Far;
out float metres;
void main() { metres = BokehDepthFromWindow(texelFetch(BokehDepthSamp, ivec2(gl_FragCoord.xy), 0).r, Near, Far); }
"""


def shader(name, body=PASSES):
    """Text of a shader; `name` without BOKEH_ is one of the table in bokeh_passes.glsl."""
    return f"#version 330\n#define BOKEH_PASS BOKEH_{name}\n#define BOKEH_NUM_SAMPLES 33\n{LIBRARY}{body}"


def exact_hexagon(context, color, depth):
    """The passes, to be drawn in their order each frame, and the texture that the last one writes."""
    metres = texture(context, color.size, "R32F nearest")
    coc, t2, t3, result = (texture(context, color.size, "RGBA16F linear") for _ in range(4))
    full_screen, common = partial(FullScreenPass, context, shader("FULL_SCREEN")), {"BokehDepthSamp": metres}
    return [
        full_screen(shader("METRES", METRES), {"BokehDepthSamp": depth}, [metres]),
        full_screen(shader("COC_MAP"), {**common, "BokehColorSamp": color}, [coc]),
        full_screen(shader("HEXAGON_FIRST"), {**common, "BokehColorSamp": coc}, [t2, t3]),
        full_screen(shader("HEXAGON_SECOND"), {**common, "BokehColorSamp": t2, "BokehColorSampB": t3}, [result]),
    ], result
