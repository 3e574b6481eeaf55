"""Panda3D with depth of field: python sample.py picture.png"""

import sys
from math import exp, inf

import scene
from bokeh_panda3d import DepthOfField, float_target, texture
from bokeh_panda3d.apertures import DEBUG, EXACT_OCTAGON
from direct.filter.FilterManager import FilterManager
from direct.showbase.ShowBase import ShowBase
from panda3d.core import LVecBase4f, PNMImage, Shader, loadPrcFileData

PARAMETERS = {
    "BokehDepthKind": 1.0,
    "BokehNear": scene.NEAR,
    "BokehFar": scene.FAR,
    # f/1.4
    "BokehApertureDiameter": scene.FOCAL_LENGTH / 1.4,
    "BokehFocalLength": scene.FOCAL_LENGTH,
    "BokehSensorHeight": scene.FILM[1],
    "BokehMaxCoC": 0.12,
    "BokehAspectRatio": scene.SIZE[0] / scene.SIZE[1],
    "BokehImageWidth": scene.SIZE[0],
    "BokehImageHeight": scene.SIZE[1],
    "BokehBleedingBias": 0.02,
    "BokehBleedingMult": 30.0,
    "BokehBlurCoC": 1.0,
    "BokehUseMax": 0.0,
    "BokehSqueeze": 1.0,
    "BokehLineLength": 1.0,
    "BokehLineCenterX": 0.0,
    "BokehLineCenterY": 0.0,
    # the preset's
    "BokehSpacing": 0.0,
    "BokehDebugMode": 3.0,
}

TONE_MAPPING_VERTEX = """
#version 330
in vec4 p3d_Vertex;
out vec2 uv;
void main()
{
    gl_Position = vec4(p3d_Vertex.xz, 0.0, 1.0);
    uv = 0.5 * p3d_Vertex.xz + 0.5;
}
"""
TONE_MAPPING = """
#version 330
uniform sampler2D image;
in vec2 uv;
out vec4 color;
void main()
{
    vec3 hdr = textureLod(image, uv, 0.0).rgb;
    color = vec4(pow(hdr / (1.0 + hdr), vec3(1.0 / 2.2)), 1.0);
}
"""


def start():
    """Panda3D without a window."""
    # else a texture of 384 x 256 is made 512 x 256, and a quarter of it is left black
    loadPrcFileData("", "textures-power-2 none")
    loadPrcFileData("", f"win-size {scene.SIZE[0]} {scene.SIZE[1]}")
    # not where there is a screen
    loadPrcFileData("", "load-display p3headlessgl\nwindow-type offscreen\naudio-library-name null\nmodel-cache-dir")
    return ShowBase()


class Frame:
    """The scene in HDR, and the quad that shows a texture on the window, tone-mapped."""

    def __init__(self, base):
        self.base = base
        self.manager = FilterManager(base.win, base.cam)
        self.color = texture("color")
        self.depth = texture("depth")
        hdr = float_target(16, 16, 16, 16)
        # else it has 16 bits where it is read back
        hdr.setFloatDepth(True)
        hdr.setDepthBits(32)
        self.quad = self.manager.renderSceneInto(colortex=self.color, depthtex=self.depth, fbprops=hdr)
        self.quad.setShader(Shader.make(Shader.SL_GLSL, TONE_MAPPING_VERTEX, TONE_MAPPING))
        self.quad.setShaderInput("image", self.color)

    def picture(self, image):
        """What the window shows of a texture."""
        self.quad.setShaderInput("image", image)
        self.base.graphicsEngine.renderFrame()
        self.base.graphicsEngine.renderFrame()
        shot = PNMImage()
        self.base.win.getScreenshot(shot)
        return shot


def focus_on(base, node):
    """Focus distance for a node: its depth along the view axis, metres."""
    return node.getPos(base.cam).y


def focus_at(base, depth, x, y):
    """Focus distance for a pixel, counted from the lower left: one texel of the depth buffer, in metres."""
    base.graphicsEngine.extractTextureData(depth, base.win.getGsg())
    found = LVecBase4f()
    depth.peek().fetchPixel(found, x, y)
    return scene.NEAR * scene.FAR / (scene.FAR - found.x * (scene.FAR - scene.NEAR))


def pull_focus(distance, depths, seconds, tau=0.2):
    """Autofocus: the distance after so many seconds more on its way to the nearest of the depths: docs/lens.md."""
    k = 1.0 - exp(-seconds / tau)
    return 1.0 / ((1.0 - k) / distance + k / min(depths))


def main(path):
    """Four pictures in one: the input, exact hexagon, near and far field, exact octagon with the focus elsewhere."""
    base = start()
    panda = scene.build(base)
    frame = Frame(base)
    focus = focus_on(base, panda)

    hexagon = DepthOfField(frame.manager, frame.color, frame.depth)
    hexagon.set(BokehFocusDistance=focus, **PARAMETERS)

    fields = DepthOfField(frame.manager, frame.color, frame.depth, DEBUG)
    fields.set(BokehFocusDistance=focus, **PARAMETERS)

    octagon = DepthOfField(frame.manager, frame.color, frame.depth, EXACT_OCTAGON)
    octagon.set(BokehFocusDistance=focus, **PARAMETERS)
    base.graphicsEngine.renderFrame()
    # several points, and no pull: where it ends
    picked = pull_focus(focus, [focus_at(base, frame.depth, 304, 82), focus_at(base, frame.depth, 5, 250)], inf)
    octagon.set(BokehFocusDistance=picked)

    width, height = scene.SIZE
    sheet = PNMImage(2 * width, 2 * height)
    for index, image in enumerate(
        (frame.color, hexagon.textures["result"], fields.textures["result"], octagon.textures["result"])
    ):
        sheet.copySubImage(frame.picture(image), index % 2 * width, index // 2 * height)
    sheet.write(path)
    print(base.win.getGsg().getDriverRenderer(), focus, picked)


if __name__ == "__main__":
    main(sys.argv[1])
