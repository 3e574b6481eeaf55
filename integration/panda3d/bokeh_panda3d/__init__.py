"""Depth of field with polygonal bokeh for Panda3D: a FilterManager whose quads run the passes."""

from math import exp, radians, tan

from direct.filter.FilterManager import FilterManager
from direct.task.TaskManagerGlobal import taskMgr
from panda3d.core import ATS_none, FrameBufferProperties, GraphicsOutput, LVecBase4f, SamplerState, Shader, Texture

from bokeh_panda3d.frames import EXACT, LAYERED, PAPER, PARAMETERS
from bokeh_panda3d.shaders import GLSL

# A pass: its entry, textures for SLOTS ("-": not this one), its targets, their size (1 / n of the image, rounded up),
# parameters of its own. What frames.py has for a polygon comes after these:
BEGIN = [("SIGNED_COC_MAP", "color", "coc", 1, {})]
PAPER_BEGIN = [("LINEAR_DEPTH", "", "metres", 1, {}), ("COC_MAP", "color", "coc", 1, {})]
DEBUG = {sides: [("DEBUG", "coc", "result", 1, {})] for sides in LAYERED}
METHODS = {"layered": (BEGIN, LAYERED), "exact": (BEGIN, EXACT), "paper": (PAPER_BEGIN, PAPER), "debug": (BEGIN, DEBUG)}
PRESETS = ("MOBILE", "LOW", "MEDIUM", "HIGH", "ULTRA")
SLOTS = ["BokehColorSamp", *(f"BokehColorSamp{letter}" for letter in "BCDEF")]

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
# The last quad, until you give it another shader: what is above 1 too becomes a colour of the screen
TONE_MAPPING = """
#version 330
uniform sampler2D image;
in vec2 BokehUV;
out vec4 color;
void main()
{
    vec3 hdr = textureLod(image, BokehUV, 0.0).rgb;
    color = vec4(pow(hdr / (1.0 + hdr), vec3(1.0 / 2.2)), 1.0);
}
"""


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
    # what Config.prc may ask for the window is wrong here
    properties.setMultisamples(0)
    properties.setSrgbColor(False)
    return properties


class DepthOfField:
    """Draws what a camera sees into a float target, blurs it and shows it on the window.

    win, cam        base.win, base.cam. Make the window's own FilterManager or CommonFilters after this, or not at all.
    others          as in change()

    To be set at any time, they act from the next frame on:
    f_stop          of the lens, which is the camera's, and what it sees is a sensor of
    sensor_height   0.024 where your unit is a metre, 24 where it is a millimetre
    bokeh_scale     how many times wider the blur is than that lens's: 1 is the real lens; with 0 no pass is drawn
    focus_distance  depth along the view axis, your unit
    rotation        of the polygon, radians, clockwise on the screen
    parameters      all others by their names in docs/reference/parameters.md: BokehMaxCoC, BokehNearScale ..

    To be read: textures["color"], ["depth"], ["result"] (linear HDR; alpha is the circle of confusion) and those
    between. `quad` shows one of them, its input `image`: give it your own shader for another tone mapping.
    """

    def __init__(
        self, win, cam, method="layered", sides=6, preset="MEDIUM", f_stop=2.8, focus_distance=5.0, bokeh_scale=10.0
    ):
        # else a texture of 384 x 256 is made 512 x 256, and a quarter of it is left black
        Texture.setTexturesPower2(ATS_none)
        self.f_stop, self.focus_distance, self.sensor_height = f_stop, focus_distance, 0.024
        self.bokeh_scale, self.rotation = bokeh_scale, 0.0
        self.parameters = {**PARAMETERS, "BokehDepthKind": 1.0}
        self.manager = FilterManager(win, cam)
        self.scene = {"color": texture("color"), "depth": texture("depth")}
        hdr = float_target(16, 16, 16, 16)
        # else it has 16 bits where it is read back
        hdr.setFloatDepth(True)
        hdr.setDepthBits(32)
        self.quad = self.manager.renderSceneInto(
            colortex=self.scene["color"], depthtex=self.scene["depth"], fbprops=hdr
        )
        if self.quad is None:
            raise RuntimeError("this graphics card cannot render to float textures")
        self.quad.setShader(Shader.make(Shader.SL_GLSL, VERTEX, TONE_MAPPING))
        self.passes, self.buffers = [], []
        self.change(method, sides, preset)
        # before igLoop, which draws
        self.task = taskMgr.add(self.update, "polygonal-bokeh", sort=49)

    def change(self, method="layered", sides=6, preset="MEDIUM", defines=()):
        """Other passes in place of those before; their shaders are compiled at the next frame. Raises ValueError.

        method   "layered": near things spread over what is behind them; "exact": each pixel by its own circle of
                 confusion, fewer passes; "paper": the paper's lines; "debug": what BokehDebugMode says
        sides    4, 6, 8 or 10; of paper 6 or 8
        preset   "MOBILE", "LOW", "MEDIUM", "HIGH" or "ULTRA"
        defines  for the shaders, such as "BOKEH_LENS_SHAPE 1"
        """
        begin, frames = METHODS.get(method, ((), {}))
        if sides not in frames or preset not in PRESETS:
            raise ValueError(f"method {method!r}, sides {sides!r}, preset {preset!r} is not valid: see help(change)")
        manager = self.manager
        for buffer in self.buffers:
            index = manager.buffers.index(buffer)
            del manager.buffers[index], manager.sizes[index]
            buffer.clearRenderTextures()
            manager.engine.removeWindow(buffer)
            # FilterManager numbers its buffers in the order in which they are drawn
            manager.nextsort -= 1
        self.textures, self.passes, self.buffers, self.values = dict(self.scene), [], [], None
        self.method, self.blurs = method, None
        head = "".join(f"#define {line}\n" for line in (f"BOKEH_PRESET_{preset}", "BOKEH_FOCUS_CONTROLS 1", *defines))
        for name, reads, writes, scale, parameters in (*begin, *frames[sides]):
            # the tables have layers of half size, and those of MOBILE have a quarter
            scale = 4 if preset == "MOBILE" and scale == 2 else scale
            self._add(head, name, reads, writes, scale, parameters)
        self.update()

    def _add(self, head, name, reads, writes, scale, parameters):
        """One pass as a quad of the manager, which makes the targets anew when the window's size changes."""
        targets = {target: texture(target) for target in writes.split()}
        first, *others = targets.values()
        bits = (32, 0, 0, 0) if name == "LINEAR_DEPTH" else (16, 16, 16, 16)
        properties = float_target(*bits, targets=len(targets))
        quad = self.manager.renderQuadInto(name, div=scale, align=scale, colortex=first, fbprops=properties)
        if quad is None:
            raise RuntimeError(f"this graphics card cannot render to {len(targets)} float textures at once")
        self.buffers.append(self.manager.buffers[-1])
        for index, target in enumerate(others):
            plane = GraphicsOutput.RTPAuxHrgba0 + index
            self.buffers[-1].addRenderTexture(target, GraphicsOutput.RTMBindOrCopy, plane)
        fragment = f"#version 330\n#define BOKEH_PASS BOKEH_{name}\n{head}{GLSL}"
        quad.setShader(Shader.make(Shader.SL_GLSL, VERTEX, fragment))
        for slot, read in zip(SLOTS, reads.split()):
            if read != "-":
                quad.setShaderInput(slot, self.textures[read])
        # only the paper's lists make metres
        quad.setShaderInput("BokehDepthSamp", self.textures.get("metres", self.textures["depth"]))
        self.textures.update(targets)
        self.passes.append((quad, parameters, list(targets.values())))

    def update(self, task=None):
        """What changed of the settings, the camera's lens and the window's size, into the passes: runs each frame."""
        lens = self.manager.camera.node().getLens()
        width, height = self.manager.getScaledSize(1, 1, 1)
        focal_length = self.sensor_height / (2.0 * tan(0.5 * radians(lens.getVfov())))
        values = {
            **self.parameters,
            "BokehFocusDistance": self.focus_distance,
            "BokehApertureDiameter": focal_length / self.f_stop * self.bokeh_scale,
            "BokehFocalLength": focal_length,
            "BokehSensorHeight": self.sensor_height,
            "BokehNear": lens.getNear(),
            "BokehFar": lens.getFar(),
            "BokehAspectRatio": width / height,
            "BokehImageWidth": width,
            "BokehImageHeight": height,
            # v grows upwards, where the shaders' angle is counter-clockwise
            "BokehAngle": -self.rotation,
        }
        if values != self.values:
            for quad, parameters, _ in self.passes:
                # the paper's lines have angles of their own
                angle = values["BokehAngle"] + parameters.get("BokehAngle", 0.0)
                quad.setShaderInputs(**{**values, **parameters, "BokehAngle": angle})
            self.values = values
        blurs = self.bokeh_scale > 0.0 or self.method == "debug"
        if blurs != self.blurs:
            for buffer in self.buffers:
                buffer.setActive(blurs)
            self.quad.setShaderInput("image", self.textures["result" if blurs else "color"])
            self.blurs = blurs
        return task and task.cont

    def focus_on(self, node):
        """On a node's origin."""
        self.focus_distance = node.getPos(self.manager.camera).y

    def depth_at(self, x, y):
        """Depth at a pixel of the last frame, from the lower left. It waits for the GPU: on a click, not each frame."""
        self.manager.engine.extractTextureData(self.scene["depth"], self.manager.win.getGsg())
        found = LVecBase4f()
        self.scene["depth"].peek().fetchPixel(found, x, y)
        lens = self.manager.camera.node().getLens()
        return lens.getNear() * lens.getFar() / (lens.getFar() - found.x * (lens.getFar() - lens.getNear()))

    def pull_focus(self, depths, seconds, tau=0.2):
        """So many seconds more on the way to the nearest of the depths; tau is the time constant: docs/lens.md."""
        k = 1.0 - exp(-seconds / tau)
        self.focus_distance = 1.0 / ((1.0 - k) / self.focus_distance + k / min(depths))

    def remove(self):
        """Give the camera back to the window."""
        taskMgr.remove(self.task)
        self.manager.cleanup()
