"""Depth of field with polygonal bokeh for Panda3D. The quads of a FilterManager draw the passes."""

from math import exp, radians, tan

from direct.filter.FilterManager import FilterManager
from direct.task.TaskManagerGlobal import taskMgr
from panda3d.core import ATS_none, FrameBufferProperties, GraphicsOutput, LVecBase4f, SamplerState, Shader, Texture

from bokeh_panda3d.frames import EXACT, LAYERED, PAPER, PARAMETERS
from bokeh_panda3d.shaders import GLSL

# A pass is (entry, textures for SLOTS, with "-" for an unused slot, targets, divisor of their size, own parameters).
# The sizes are rounded up. These passes come first, and then those that frames.py has for the polygon:
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
# The shader of the last quad, until you give it another one. It also maps colours above 1 to colours of the screen.
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
    """Return a texture to render into, with a linear filter and clamping."""
    made = Texture(name)
    made.setWrapU(SamplerState.WM_clamp)
    made.setWrapV(SamplerState.WM_clamp)
    made.setMinfilter(SamplerState.FT_linear)
    made.setMagfilter(SamplerState.FT_linear)
    return made


def float_target(*bits, targets=1):
    """Return frame buffer properties for a float target.

    bits     of red, green, blue and alpha: (16, 16, 16, 16) for RGBA16F, (32, 0, 0, 0) for R32F
    targets  number of targets; those after the first are RGBA16F
    """
    properties = FrameBufferProperties()
    properties.setFloatColor(True)
    properties.setRgbaBits(*bits)
    properties.setAuxHrgba(targets - 1)
    # Config.prc may ask for these for the window, but here they would be wrong
    properties.setMultisamples(0)
    properties.setSrgbColor(False)
    return properties


class DepthOfField:
    """Draw what a camera sees into a float target, blur it, and show it in the window.

    win, cam        base.win and base.cam. If you use a FilterManager or CommonFilters, create it after this object.
    others          the settings below, and the arguments of change()

    You may set these attributes at any time; they take effect in the next frame:
    f_stop          f-stop of the lens; its focal length comes from the camera's lens and sensor_height
    sensor_height   height of the camera's sensor: 0.024 if one unit is a metre, 24 if it is a millimetre
    bokeh_scale     how many times as wide the blur is as that of a real lens; at 0, no pass is drawn
    focus_distance  depth along the view axis, in your unit
    rotation        angle of the polygon in radians, clockwise on the screen
    parameters      all other parameters, by their names in docs/reference/parameters.md, such as BokehMaxCoC

    You may read the textures: textures["color"], ["depth"], ["result"] (linear HDR, whose alpha is the circle of
    confusion), and those that the other passes write. `quad` shows one of them, its input `image`. For another tone
    mapping, give it a shader of your own.

    Raises RuntimeError if the graphics card cannot draw into float targets, and ValueError as change() does.
    """

    def __init__(
        self, win, cam, method="layered", sides=6, preset="MEDIUM", f_stop=2.8, focus_distance=5.0, bokeh_scale=10.0
    ):
        # otherwise, a texture of 384 x 256 becomes 512 x 256, and a quarter of it stays black
        Texture.setTexturesPower2(ATS_none)
        self.f_stop, self.focus_distance, self.sensor_height = f_stop, focus_distance, 0.024
        self.bokeh_scale, self.rotation = bokeh_scale, 0.0
        self.parameters = {**PARAMETERS, "BokehDepthKind": 1.0}
        self.manager = FilterManager(win, cam)
        self.scene = {"color": texture("color"), "depth": texture("depth")}
        hdr = float_target(16, 16, 16, 16)
        # otherwise, it has only 16 bits when it is read back
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
        # run before igLoop, which draws the frame
        self.task = taskMgr.add(self.update, "polygonal-bokeh", sort=49)

    def change(self, method="layered", sides=6, preset="MEDIUM", defines=()):
        """Replace the passes. The new shaders are compiled in the next frame.

        method   "layered": blurred near objects spread over the sharp background; "exact": each pixel is blurred by its
                 own circle of confusion, in fewer passes; "paper": the method of the paper, which blurs along lines;
                 "debug": shows what the parameter BokehDebugMode selects
        sides    number of sides of the polygon: 4, 6, 8 or 10; with "paper" only 6 or 8
        preset   number and spacing of samples: "MOBILE", "LOW", "MEDIUM", "HIGH" or "ULTRA"
        defines  macros for the shaders, such as "BOKEH_LENS_SHAPE 1"

        Raises ValueError if there are no passes for these arguments.
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
            # in the tables, layers have half the size of the image; with MOBILE, they have a quarter
            scale = 4 if preset == "MOBILE" and scale == 2 else scale
            self._add(head, name, reads, writes, scale, parameters)
        self.update()

    def _add(self, head, name, reads, writes, scale, parameters):
        """Add a pass as a quad of the manager, which creates its targets again when the size of the window changes."""
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
        # only the frames of paper have a texture in metres
        quad.setShaderInput("BokehDepthSamp", self.textures.get("metres", self.textures["depth"]))
        self.textures.update(targets)
        self.passes.append((quad, parameters, list(targets.values())))

    def update(self, task=None):
        """Pass changes of the settings, the camera's lens and the window's size to the passes. Runs in each frame."""
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
            # v grows upwards here, so the shaders' angle is counter-clockwise
            "BokehAngle": -self.rotation,
        }
        if values != self.values:
            for quad, parameters, _ in self.passes:
                # the passes of paper have angles of their own
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
        """Focus on the origin of a node."""
        self.focus_distance = node.getPos(self.manager.camera).y

    def depth_at(self, x, y):
        """Return the depth at a pixel of the last frame, in your unit. Pixel (0, 0) is at the lower left.

        It waits for the GPU, so call it on a click and not in each frame.
        """
        self.manager.engine.extractTextureData(self.scene["depth"], self.manager.win.getGsg())
        found = LVecBase4f()
        self.scene["depth"].peek().fetchPixel(found, x, y)
        lens = self.manager.camera.node().getLens()
        return lens.getNear() * lens.getFar() / (lens.getFar() - found.x * (lens.getFar() - lens.getNear()))

    def pull_focus(self, depths, seconds, tau=0.2):
        """Move the focus smoothly to the nearest of several depths. Call it in each frame.

        seconds  time since the last frame
        tau      time constant of the movement in seconds (docs/lens.md)
        """
        k = 1.0 - exp(-seconds / tau)
        self.focus_distance = 1.0 / ((1.0 - k) / self.focus_distance + k / min(depths))

    def remove(self):
        """Give the camera back to the window."""
        taskMgr.remove(self.task)
        self.manager.cleanup()
