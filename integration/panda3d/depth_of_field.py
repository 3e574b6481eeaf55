"""Depth of field for Panda3D: a FilterManager whose quads run the passes of bokeh_passes.glsl."""

from math import radians
from pathlib import Path

from panda3d.core import FrameBufferProperties, SamplerState, Shader, Texture

# where the two files are
GLSL = Path(__file__).resolve().parents[2] / "glsl"
LIBRARY = (GLSL / "bokeh.glsl").read_text()
PASSES = (GLSL / "bokeh_passes.glsl").read_text()
HEAD = "#version 330\n#define BOKEH_NUM_SAMPLES 33\n"
# FilterManager's quad has corners at -1 and 1 in x and z
VERTEX = """
#version 330
in vec4 p3d_Vertex;
out vec2 BokehUV;
void main()
{
    gl_Position = vec4(p3d_Vertex.xz, 0.0, 1.0);
    BokehUV = 0.5 * p3d_Vertex.xz + 0.5;
}
"""
# what the depth texture holds, to metres along the view axis
METRES = """
uniform sampler2D BokehDepthSamp;
uniform vec2 NearFar;
in vec2 BokehUV;
out float metres;
void main()
{
    metres = BokehDepthFromWindow(textureLod(BokehDepthSamp, BokehUV, 0.0).r, NearFar.x, NearFar.y);
}
"""
SLOTS = ("BokehDepthSamp", "BokehColorSamp", "BokehColorSampB", "BokehColorSampC")
# name of BOKEH_PASS, angle in degrees, textures for SLOTS, targets
INPUTS = [
    ("METRES", 0, ["depth"], ["metres"]),
    ("COC_MAP", 0, ["metres", "color"], ["coc"]),
]
EXACT_HEXAGON = [
    ("HEXAGON_FIRST", 0, ["metres", "coc"], ["t2", "t3"]),
    ("HEXAGON_SECOND", 0, ["metres", "t2", "t3"], ["result"]),
]


def texture(name, filtering=SamplerState.FT_linear):
    """A texture to render into: clamped."""
    made = Texture(name)
    made.setWrapU(SamplerState.WM_clamp)
    made.setWrapV(SamplerState.WM_clamp)
    made.setMinfilter(filtering)
    made.setMagfilter(filtering)
    return made


def float_target(*bits, targets=1):
    """Frame buffer properties: (16, 16, 16, 16) is RGBA16F, (32, 0, 0, 0) R32F; more targets are RGBA16F."""
    properties = FrameBufferProperties()
    properties.setFloatColor(True)
    properties.setRgbaBits(*bits)
    properties.setAuxHrgba(targets - 1)
    return properties


class DepthOfField:
    """Reads the textures of renderSceneInto, leaves textures["result"]."""

    def __init__(self, manager, color, depth, passes=EXACT_HEXAGON):
        self.textures = {"color": color, "depth": depth}
        self.quads = [self.add(manager, *step) for step in INPUTS + passes]

    def add(self, manager, name, angle, reads, writes):
        """One pass as a quad of the manager."""
        bits = (32, 0, 0, 0) if name == "METRES" else (16, 16, 16, 16)
        filtering = SamplerState.FT_nearest if name == "METRES" else SamplerState.FT_linear
        targets = [texture(target, filtering) for target in writes]
        slots = dict(zip(("colortex", "auxtex0", "auxtex1"), targets, strict=False))
        quad = manager.renderQuadInto(name, fbprops=float_target(*bits, targets=len(targets)), **slots)
        fragment = f"{HEAD}#define BOKEH_PASS BOKEH_{name}\n{LIBRARY}{METRES if name == 'METRES' else PASSES}"
        quad.setShader(Shader.make(Shader.SL_GLSL, VERTEX, fragment))
        for slot, read in zip(SLOTS, reads, strict=False):
            quad.setShaderInput(slot, self.textures[read])
        quad.setShaderInput("BokehAngle", radians(angle))
        self.textures.update(zip(writes, targets, strict=True))
        return quad

    def set(self, **parameters):
        """Give parameters to all passes."""
        for quad in self.quads:
            quad.setShaderInputs(**parameters)
