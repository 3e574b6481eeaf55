"""Depth of field for Panda3D: a FilterManager whose quads run the passes of bokeh_passes.glsl."""

from math import radians
from pathlib import Path

from panda3d.core import FrameBufferProperties, SamplerState, Shader, Texture

# the two files are in a folder beside this file, or above it
GLSL = next(path / "glsl" for path in Path(__file__).resolve().parents if (path / "glsl/bokeh_passes.glsl").exists())
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
SLOTS = ("BokehColorSamp", "BokehColorSampB", "BokehColorSampC")
# name of BOKEH_PASS, angle in degrees, textures for SLOTS, targets
EXACT_INPUTS = [
    ("LINEAR_DEPTH", 0, [], ["metres"]),
    ("SIGNED_COC_MAP", 0, ["color"], ["coc"]),
]
EXACT_HEXAGON = [
    *EXACT_INPUTS,
    ("HEXAGON_FIRST", 0, ["coc"], ["t2", "t3"]),
    ("HEXAGON_SECOND", 0, ["t2", "t3"], ["result"]),
]


def texture(name):
    """A texture to render into: linear filter, clamped."""
    made = Texture(name)
    made.setWrapU(SamplerState.WM_clamp)
    made.setWrapV(SamplerState.WM_clamp)
    made.setMinfilter(SamplerState.FT_linear)
    made.setMagfilter(SamplerState.FT_linear)
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
        self.quads = [self.add(manager, *step) for step in passes]

    def add(self, manager, name, angle, reads, writes):
        """One pass as a quad of the manager."""
        bits = (32, 0, 0, 0) if name == "LINEAR_DEPTH" else (16, 16, 16, 16)
        targets = [texture(target) for target in writes]
        slots = dict(zip(("colortex", "auxtex0", "auxtex1"), targets, strict=False))
        quad = manager.renderQuadInto(name, fbprops=float_target(*bits, targets=len(targets)), **slots)
        fragment = f"{HEAD}#define BOKEH_PASS BOKEH_{name}\n{LIBRARY}{PASSES}"
        quad.setShader(Shader.make(Shader.SL_GLSL, VERTEX, fragment))
        for slot, read in zip(SLOTS, reads, strict=False):
            quad.setShaderInput(slot, self.textures[read])
        # only the passes that read depth take it
        quad.setShaderInput("BokehDepthSamp", self.textures.get("metres", self.textures["depth"]))
        quad.setShaderInput("BokehAngle", radians(angle))
        self.textures.update(zip(writes, targets, strict=True))
        return quad

    def set(self, **parameters):
        """Give parameters to all passes."""
        for quad in self.quads:
            quad.setShaderInputs(**parameters)
