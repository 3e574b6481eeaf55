"""A small renderer. It draws a table with lights into an RGBA16F texture and a depth texture, and tone-maps textures.

Lengths are in metres. y points up, and the camera looks along -z.
"""

from math import atan, cos, pi, sin, tan

import moderngl
import numpy as np

SIZE = (384, 256)
NEAR, FAR = 0.1, 50.0
# vertical field of view of an 85 mm lens on a sensor that is 24 mm high, radians
FIELD_OF_VIEW = 2.0 * atan(0.5 * 0.024 / 0.085)
EYE, PITCH = (0.0, 0.32, 0.0), -0.09
BALL = (-0.03, 0.06, -1.5)

SCENE_VERTEX = """
#version 330
uniform mat4 ViewProjection;
uniform vec3 Place, Scale;
in vec3 corner;
out vec3 world, normal;
void main()
{
    world = Place + Scale * corner;
    normal = corner / Scale;
    gl_Position = ViewProjection * vec4(world, 1.0);
}
"""
SCENE_FRAGMENT = """
#version 330
uniform vec3 Color;
uniform float Pattern, Glow;
in vec3 world, normal;
out vec4 color;
void main()
{
    vec3 cell = floor(world / Pattern + 0.001);
    float checker = mod(cell.x + cell.y + cell.z, 2.0);
    float light = 0.25 + 0.75 * max(dot(normalize(normal), normalize(vec3(0.4, 0.8, 0.5))), 0.0);
    color = vec4(Color * mix(light * mix(0.25, 1.0, checker), 1.0, Glow), 1.0);
}
"""
PICTURE_VERTEX = """
#version 330
out vec2 uv;
void main()
{
    uv = vec2(gl_VertexID == 1 ? 2.0 : 0.0, gl_VertexID == 2 ? 2.0 : 0.0);
    gl_Position = vec4(uv * 2.0 - 1.0, 0.0, 1.0);
}
"""
PICTURE_FRAGMENT = """
#version 330
uniform sampler2D Image;
in vec2 uv;
out vec4 color;
void main()
{
    vec3 hdr = textureLod(Image, uv, 0.0).rgb;
    color = vec4(pow(hdr / (1.0 + hdr), vec3(1.0 / 2.2)), 1.0);
}
"""


def texture(context, size, kind):
    """Create a texture with a linear filter and clamp.

    size  (width, height) in pixels
    kind  format: "RGBA8", "RGBA16F" or "R32F"
    """
    channels, dtype = {"RGBA8": (4, "f1"), "RGBA16F": (4, "f2"), "R32F": (1, "f4")}[kind]
    made = context.texture(size, channels, dtype=dtype)
    made.repeat_x = made.repeat_y = False
    return made


class FullScreenPass:
    """A pass that draws a triangle over the whole of its targets.

    vertex    text of the vertex shader
    fragment  text of the fragment shader
    textures  name of the sampler -> texture that the pass reads
    targets   textures that the pass writes
    uniforms  uniforms that differ from pass to pass
    """

    def __init__(self, context, vertex, fragment, textures, targets, **uniforms):
        self.context, self.textures, self.uniforms = context, textures, uniforms
        self.program = context.program(vertex_shader=vertex, fragment_shader=fragment)
        self.triangle = context.vertex_array(self.program, [])
        self.framebuffer = context.framebuffer(targets)

    def draw(self, **uniforms):
        """Draw the pass. Uniforms that the shader does not have are ignored."""
        for unit, (name, bound) in enumerate(self.textures.items()):
            bound.use(unit)
            uniforms[name] = unit
        for name, value in {**uniforms, **self.uniforms}.items():
            if name in self.program:
                self.program[name] = value
        # turn blending off, because alpha is the CoC
        self.context.disable(moderngl.DEPTH_TEST | moderngl.BLEND | moderngl.CULL_FACE)
        self.framebuffer.use()
        self.triangle.render(moderngl.TRIANGLES, vertices=3)


class Renderer:
    """Draws the scene into the textures `color` (RGBA16F, linear HDR) and `depth` (0 near .. 1 far)."""

    def __init__(self, context):
        self.context = context
        self.color = texture(context, SIZE, "RGBA16F")
        self.depth = context.depth_texture(SIZE)
        self.depth.compare_func = ""
        self.framebuffer = context.framebuffer([self.color], self.depth)
        self.program = context.program(vertex_shader=SCENE_VERTEX, fragment_shader=SCENE_FRAGMENT)
        self.sphere = context.vertex_array(self.program, context.buffer(_sphere().tobytes()), "corner")
        self.shown = texture(context, SIZE, "RGBA8")

    def draw(self):
        """Draw a table, a wall, two balls, and lights in front of the balls and behind them."""
        self.framebuffer.use()
        self.framebuffer.clear(0.0, 0.0, 0.0, 1.0)
        self.context.enable(moderngl.DEPTH_TEST)
        self.program["ViewProjection"].write((projection() @ view()).T.astype("f4").tobytes())
        # the table and the wall are very flat spheres
        self.thing((0.0, -0.001, -3.0), (8.0, 0.001, 3.4), (0.42, 0.34, 0.26), pattern=0.1)
        self.thing((0.0, 0.0, -6.4), (8.0, 4.0, 0.01), (0.06, 0.08, 0.14), pattern=0.4)
        self.thing(BALL, (0.06,) * 3, (0.8, 0.75, 0.7), pattern=0.02)
        self.thing((0.13, 0.17, -1.05), (0.025,) * 3, (0.9, 0.7, 0.1), pattern=0.01)
        for place, radius, color in lights():
            self.thing(place, (radius,) * 3, color, glow=1.0)

    def thing(self, place, scale, color, pattern=1.0, glow=0.0):
        """Draw an ellipsoid."""
        values = {"Place": place, "Scale": scale, "Color": color, "Pattern": pattern, "Glow": glow}
        for name, value in values.items():
            self.program[name] = value
        self.sphere.render(moderngl.TRIANGLES)

    def picture(self, image):
        """Return a texture tone-mapped for the screen: (H, W, 3) uint8, top row first."""
        FullScreenPass(self.context, PICTURE_VERTEX, PICTURE_FRAGMENT, {"Image": image}, [self.shown]).draw()
        pixels = np.frombuffer(self.shown.read(), np.uint8).reshape(SIZE[1], SIZE[0], 4)
        return pixels[::-1, :, :3]


def lights():
    """Yield the position, radius and colour of each light."""
    warm, cold, red, green = (1.0, 0.55, 0.2), (0.35, 0.6, 1.0), (1.0, 0.12, 0.06), (0.2, 1.0, 0.4)
    before = [((-0.13, 0.2, -0.9), 0.006, cold, 30.0)]
    beside = [((0.12, 0.03, -1.5), 0.03, green, 12.0)]
    behind = [
        ((0.18 * across * distance, 0.02 * distance, -distance), 0.004 * distance, color, 40.0)
        for across, distance, color in (
            (-0.9, 3.0, red), (-0.55, 4.5, warm), (-0.25, 6.0, cold), (0.1, 3.5, warm), (0.45, 5.5, red),
            (0.65, 2.5, cold), (0.95, 5.0, warm), (-0.75, 5.8, green),
        )
    ]  # fmt: skip
    for place, radius, color, strength in before + beside + behind:
        yield place, radius, tuple(strength * channel for channel in color)


def view():
    """Return the matrix from world space to view space, (4, 4)."""
    move = np.eye(4)
    move[:3, 3] = [-value for value in EYE]
    turn = np.eye(4)
    turn[1:3, 1:3] = [[cos(PITCH), sin(PITCH)], [-sin(PITCH), cos(PITCH)]]
    return turn @ move


def projection():
    """Return the matrix from view space to OpenGL's clip space, (4, 4)."""
    scale = 1.0 / tan(0.5 * FIELD_OF_VIEW)
    return np.array(
        [
            [scale * SIZE[1] / SIZE[0], 0.0, 0.0, 0.0],
            [0.0, scale, 0.0, 0.0],
            [0.0, 0.0, (FAR + NEAR) / (NEAR - FAR), 2.0 * FAR * NEAR / (NEAR - FAR)],
            [0.0, 0.0, -1.0, 0.0],
        ]
    )


def _sphere(rings=24, segments=48):
    """Return the corners of triangles on a sphere of radius 1, (N, 3) float32."""
    polar, around = np.meshgrid(np.linspace(0, pi, rings + 1), np.linspace(0, 2 * pi, segments + 1), indexing="ij")
    points = np.stack([np.sin(polar) * np.cos(around), np.cos(polar), np.sin(polar) * np.sin(around)], axis=-1)
    a, b, c, d = points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]
    return np.stack([a, b, c, a, c, d], axis=2).reshape(-1, 3).astype("f4")
