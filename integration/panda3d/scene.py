"""The scene of the sample: the panda and a smiley, with lights in front of and behind them.

Lengths are in metres, y points away from the camera, and z points up.
"""

from panda3d.core import CardMaker, PNMImage, SamplerState, Shader, Texture

SIZE = (384, 256)
# The camera has the lens that the depth of field imitates: 85 mm on film of 36 x 24 mm, here in metres
FILM, FOCAL_LENGTH = (0.036, 0.024), 0.085
NEAR, FAR = 0.1, 50.0

VERTEX = """
#version 330
uniform mat4 p3d_ModelViewProjectionMatrix;
uniform mat4 p3d_ModelMatrix;
in vec4 p3d_Vertex;
in vec3 p3d_Normal;
in vec2 p3d_MultiTexCoord0;
out vec3 normal;
out vec2 uv;
void main()
{
    gl_Position = p3d_ModelViewProjectionMatrix * p3d_Vertex;
    normal = mat3(p3d_ModelMatrix) * p3d_Normal;
    uv = p3d_MultiTexCoord0;
}
"""
LIT = """
#version 330
uniform sampler2D p3d_Texture0;
in vec3 normal;
in vec2 uv;
out vec4 color;
void main()
{
    float light = 0.3 + 0.7 * max(dot(normalize(normal), normalize(vec3(0.4, -0.5, 0.8))), 0.0);
    color = vec4(texture(p3d_Texture0, uv).rgb * light, 1.0);
}
"""
GLOWING = """
#version 330
uniform vec3 glow;
out vec4 color;
void main()
{
    color = vec4(glow, 1.0);
}
"""


def build(base):
    """Add the scene to base.render, and aim base.camera. Return the panda."""
    base.camLens.setFilmSize(*FILM)
    base.camLens.setFocalLength(FOCAL_LENGTH)
    base.camLens.setNearFar(NEAR, FAR)
    base.camera.setPosHpr(0.0, 0.0, 0.32, 0.0, -5.0, 0.0)
    base.render.setShader(Shader.make(Shader.SL_GLSL, VERTEX, LIT))
    panda = base.loader.loadModel("models/panda-model")
    panda.setScale(0.00026)
    panda.setPosHpr(-0.03, 1.5, 0.0, -25.0, 0.0, 0.0)
    panda.reparentTo(base.render)
    linear_textures(panda)
    smiley = base.loader.loadModel("models/smiley")
    smiley.setScale(0.025)
    smiley.setPosHpr(0.13, 1.05, 0.17, 10.0, 0.0, 0.0)
    smiley.reparentTo(base.render)
    linear_textures(smiley)
    card(base, "table", (0.42, 0.34, 0.26), 80, pos=(0.0, 4.0, 0.0), hpr=(0.0, -90.0, 0.0))
    card(base, "wall", (0.06, 0.08, 0.14), 20, pos=(0.0, 6.4, 0.0), hpr=(0.0, 0.0, 0.0))
    for place, radius, color in lights():
        light = base.loader.loadModel("models/misc/sphere")
        light.setScale(radius)
        light.setPos(*place)
        light.setShader(Shader.make(Shader.SL_GLSL, VERTEX, GLOWING))
        light.setShaderInput("glow", color)
        light.reparentTo(base.render)
    return panda


def linear_textures(model):
    """Give the textures of a model an sRGB format, so that shaders read linear colour from them."""
    for texture in model.findAllTextures():
        texture.setFormat(Texture.F_srgb)


def card(base, name, color, cells, pos, hpr):
    """Add a square of 8 x 8 m with a checkered texture."""
    image = PNMImage(2, 2)
    for x, y in ((0, 0), (1, 1)):
        image.setXel(x, y, *color)
        image.setXel(x, 1 - y, *(0.25 * channel for channel in color))
    pattern = Texture(name)
    pattern.load(image)
    pattern.setMagfilter(SamplerState.FT_nearest)
    maker = CardMaker(name)
    maker.setFrame(-4.0, 4.0, -4.0, 4.0)
    maker.setUvRange((0.0, 0.0), (0.5 * cells, 0.5 * cells))
    maker.setHasNormals(True)
    made = base.render.attachNewNode(maker.generate())
    made.setTexture(pattern)
    made.setPosHpr(*pos, *hpr)


def lights():
    """Yield position, radius and colour of each light."""
    warm, cold, red, green = (1.0, 0.55, 0.2), (0.35, 0.6, 1.0), (1.0, 0.12, 0.06), (0.2, 1.0, 0.4)
    near = [((-0.13, 0.9, 0.2), 0.006, cold, 30.0)]
    beside = [((0.12, 1.5, 0.03), 0.03, green, 12.0)]
    far = [
        ((0.18 * across * distance, distance, 0.02 * distance), 0.004 * distance, color, 40.0)
        for across, distance, color in (
            (-0.9, 3.0, red), (-0.55, 4.5, warm), (-0.25, 6.0, cold), (0.1, 3.5, warm), (0.45, 5.5, red),
            (0.65, 2.5, cold), (0.95, 5.0, warm), (-0.75, 5.8, green),
        )
    ]  # fmt: skip
    for place, radius, color, strength in near + beside + far:
        yield place, radius, tuple(strength * channel for channel in color)
