"""The sample's scene: a tower of drums in focus on a checkered ground, with lamps in front of it and behind it.

Lengths are in metres. y points up, and the camera looks along -z.
"""

from math import cos, radians, sin, tan

import raylib as rl
from depth_of_field import FLOAT, HALF, texture
from raylib import ffi

SIZE = (384, 256)
NEAR, FAR = 0.1, 60.0
FIELD_OF_VIEW = 27.0  # degrees, vertical: that of a 50 mm lens on a sensor 24 mm high
EYE, TARGET = (0.0, 1.5, 0.0), (0.0, 1.1, -5.0)
DRUM = (-0.35, 1.2, -4.65)

VERTEX = b"""
#version 330
in vec3 vertexPosition;
in vec3 vertexNormal;
uniform mat4 mvp, matModel;
out vec3 world, normal;
void main()
{
    world = (matModel * vec4(vertexPosition, 1.0)).xyz;
    normal = mat3(matModel) * vertexNormal;
    gl_Position = mvp * vec4(vertexPosition, 1.0);
}
"""
# raylib clamps colDiffuse to 1, so the brightness is a uniform of its own
FRAGMENT = b"""
#version 330
uniform vec3 radiance;
uniform float cell, glow;
in vec3 world, normal;
out vec4 color;
void main()
{
    vec3 place = floor(world / cell + 0.001);
    float checker = mod(place.x + place.y + place.z, 2.0);
    float light = 0.25 + 0.75 * max(dot(normalize(normal), normalize(vec3(-0.5, 0.7, 0.5))), 0.0);
    color = vec4(radiance * mix(light * mix(0.3, 1.0, checker), 1.0, glow), 1.0);
}
"""


class Scene:
    """Draws the scene into the textures `color` (RGBA16F, linear HDR) and `depth` (0 near .. 1 far)."""

    def __init__(self):
        width, height = SIZE
        # LoadRenderTexture would give colour with 8 bits per channel, and depth that no shader can read
        self.color = texture(width, height, HALF)
        depth = rl.rlLoadTextureDepth(width, height, False)
        self.depth = ffi.new("Texture *", (depth, width, height, 1, FLOAT))[0]
        framebuffer = rl.rlLoadFramebuffer()
        to_texture = rl.RL_ATTACHMENT_TEXTURE2D
        rl.rlFramebufferAttach(framebuffer, self.color.id, rl.RL_ATTACHMENT_COLOR_CHANNEL0, to_texture, 0)
        rl.rlFramebufferAttach(framebuffer, depth, rl.RL_ATTACHMENT_DEPTH, to_texture, 0)
        assert rl.rlFramebufferComplete(framebuffer)
        self.target = ffi.new("RenderTexture *", (framebuffer, self.color, self.depth))[0]
        self.material = rl.LoadMaterialDefault()
        self.material.shader = rl.LoadShaderFromMemory(VERTEX, FRAGMENT)
        self.ball = rl.GenMeshSphere(1.0, 24, 32)
        self.drum = rl.GenMeshCylinder(0.35, 0.5, 40)
        self.ground = rl.GenMeshPlane(40.0, 40.0, 1, 1)
        self.camera = ffi.new("Camera3D *", (EYE, TARGET, (0.0, 1.0, 0.0), FIELD_OF_VIEW, rl.CAMERA_PERSPECTIVE))[0]

    def draw(self):
        """Draw a frame."""
        rl.rlSetClipPlanes(NEAR, FAR)
        rl.BeginTextureMode(self.target)
        rl.ClearBackground((0, 0, 0, 255))
        rl.BeginMode3D(self.camera)
        self.thing(self.ground, (0.0, 0.0, -15.0), 1.0, (0.34, 0.3, 0.27), cell=0.5)
        for level, color in enumerate(((0.7, 0.2, 0.1), (0.85, 0.6, 0.2), (0.2, 0.5, 0.45))):
            self.thing(self.drum, (-0.35, 0.5 * level, -5.0), 1.0, color, cell=0.125)
        self.thing(self.ball, (-0.3, 1.62, -2.5), 0.1, (0.7, 0.6, 0.5), cell=0.04)
        for place, radius, color in lamps():
            self.thing(self.ball, place, radius, color, glow=1.0)
        rl.EndMode3D()
        rl.EndTextureMode()

    def thing(self, mesh, place, scale, radiance, cell=1.0, glow=0.0):
        """Draw a mesh."""
        for name, value in (("radiance", radiance), ("cell", (cell,)), ("glow", (glow,))):
            kind = rl.SHADER_UNIFORM_VEC3 if len(value) == 3 else rl.SHADER_UNIFORM_FLOAT
            where = rl.GetShaderLocation(self.material.shader, name.encode())
            rl.SetShaderValue(self.material.shader, where, ffi.new("float[]", value), kind)
        matrix = (scale, 0, 0, place[0], 0, scale, 0, place[1], 0, 0, scale, place[2], 0, 0, 0, 1)
        rl.DrawMesh(mesh, self.material, matrix)


def lamps():
    """Yield the position, radius and colour of each lamp."""
    warm, cold, red, green = (1.0, 0.5, 0.2), (0.3, 0.55, 1.0), (1.0, 0.15, 0.1), (0.2, 1.0, 0.45)
    yield (0.35, 1.55, -2.2), 0.012, tuple(30.0 * channel for channel in cold)
    for index in range(18):
        # the golden angle spreads the lamps evenly, and they are the same each time
        depth, angle, reach = 11.0 + index % 5, 2.39996 * index, ((index + 1) / 18) ** 0.5
        half = depth * tan(radians(0.5 * FIELD_OF_VIEW))
        place = (1.3 * half * reach * cos(angle), 1.6 + 0.55 * half * (1.0 + reach * sin(angle)) - 0.09 * depth, -depth)
        strength = 20.0 + 10.0 * (index % 3)
        yield place, 0.05, tuple(strength * channel for channel in (warm, cold, red, green)[index % 4])
