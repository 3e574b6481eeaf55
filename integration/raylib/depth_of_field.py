"""Depth of field for raylib: full-screen passes by rlgl. The three files of shaders are the rest."""

from pathlib import Path

import raylib as rl
from raylib import ffi

# the folder with the three files
GLSL = Path(__file__).resolve().parents[2] / "glsl"
FILES = "".join((GLSL / name).read_text() for name in ("bokeh.glsl", "bokeh_layers.glsl", "bokeh_passes.glsl"))
SLOTS = ["BokehColorSamp", *(f"BokehColorSamp{letter}" for letter in "BCDEF")]
HALF, FLOAT = rl.PIXELFORMAT_UNCOMPRESSED_R16G16B16A16, rl.PIXELFORMAT_UNCOMPRESSED_R32

# Each pass: its entry, textures for the slots ("-": not this one), its targets, their size (1 / n of the image, rounded
# up), parameters of its own.
HEXAGON = [
    ("SIGNED_COC_MAP", "color", "coc", 1, {}),
    ("LAYER_TILES", "coc", "tiles", 8, {}),
    ("LAYER_REACH", "tiles", "rows", 8, {"BokehAxis": 0}),
    ("LAYER_REACH", "rows", "reach", 8, {"BokehAxis": 1}),
    ("LAYER_SPLIT", "coc reach", "near far sums leftovers", 2, {}),
    ("LAYER_KERNELS", "sums leftovers", "tile_leftovers tile_sums", 8, {}),
    ("LAYER_SPREAD", "tile_leftovers tile_sums reach", "row_leftovers row_sums", 8, {}),
    ("LAYER_SIZES", "row_leftovers row_sums reach", "reaches sizes", 8, {}),
    ("LAYER_HOLES", "coc reach", "middle_holes far_holes shares", 4, {}),
    ("LAYER_FILL", "middle_holes far_holes shares reach", "middle back", 4, {"BokehSides": 6}),
    ("HEXAGON_LAYER_FIRST", "near sizes", "near2 near3", 2, {"BokehLayer": 0}),
    ("HEXAGON_LAYER_SECOND", "near2 near3 - - sizes", "near_blurred", 2, {"BokehLayer": 0}),
    ("HEXAGON_LAYER_FIRST", "far sizes", "far2 far3", 2, {"BokehLayer": 1}),
    ("HEXAGON_LAYER_SECOND", "far2 far3 - - sizes", "far_blurred", 2, {"BokehLayer": 1}),
    ("LAYERED", "coc reaches near_blurred far_blurred middle back", "result", 1, {"BokehSides": 6}),
]


def texture(width, height, pixels):
    """A texture to render into. rlgl's default is the nearest texel, repeated; this one is linear and clamped."""
    name = rl.rlLoadTexture(ffi.NULL, width, height, pixels, 1)
    made = ffi.new("Texture *", (name, width, height, 1, pixels))[0]
    rl.SetTextureFilter(made, rl.TEXTURE_FILTER_BILINEAR)
    rl.SetTextureWrap(made, rl.TEXTURE_WRAP_CLAMP)
    return made


def shader(name):
    """Text of a shader; `name` without BOKEH_ is one of the table in bokeh_passes.glsl."""
    return f"#version 330\n#define BOKEH_PASS BOKEH_{name}\n#define BOKEH_NUM_SAMPLES 33\n{FILES}"


class FullScreenPass:
    """One triangle over all targets, reading textures (name of the sampler -> texture), with uniforms of its own."""

    def __init__(self, fragment, textures, targets, uniforms):
        self.textures, self.targets, self.uniforms = textures, targets, uniforms
        self.program = rl.LoadShaderFromMemory(shader("FULL_SCREEN").encode(), fragment.encode()).id
        # OpenGL draws nothing without one, though the triangle has no vertices in memory
        self.triangle = rl.rlLoadVertexArray()
        self.framebuffer = rl.rlLoadFramebuffer()
        for index, target in enumerate(targets):
            rl.rlFramebufferAttach(
                self.framebuffer, target.id, rl.RL_ATTACHMENT_COLOR_CHANNEL0 + index, rl.RL_ATTACHMENT_TEXTURE2D, 0
            )
        assert rl.rlFramebufferComplete(self.framebuffer)
        # only now: the two calls above leave no framebuffer bound
        rl.rlEnableFramebuffer(self.framebuffer)
        rl.rlActiveDrawBuffers(len(targets))
        rl.rlDisableFramebuffer()

    def draw(self, **uniforms):
        """Uniforms that the shader does not have are passed over."""
        rl.rlEnableFramebuffer(self.framebuffer)
        rl.rlViewport(0, 0, self.targets[0].width, self.targets[0].height)
        # raylib blends by default, and alpha is the CoC
        rl.rlDisableColorBlend()
        rl.rlDisableDepthTest()
        rl.rlDisableBackfaceCulling()
        rl.rlEnableShader(self.program)
        for unit, (name, bound) in enumerate(self.textures.items()):
            rl.rlActiveTextureSlot(unit)
            rl.rlEnableTexture(bound.id)
            self.set(name, ffi.new("int *", unit), rl.SHADER_UNIFORM_INT)
        for name, value in {**uniforms, **self.uniforms}.items():
            self.set(name, ffi.new("float *", value), rl.SHADER_UNIFORM_FLOAT)
        rl.rlEnableVertexArray(self.triangle)
        rl.rlDrawVertexArray(0, 3)
        rl.rlDisableVertexArray()
        rl.rlActiveTextureSlot(0)
        rl.rlDisableShader()
        rl.rlEnableBackfaceCulling()
        rl.rlEnableColorBlend()
        rl.rlDisableFramebuffer()

    def set(self, name, value, kind):
        place = rl.rlGetLocationUniform(self.program, name.encode())
        if place >= 0:
            rl.rlSetUniform(place, value, kind, 1)


def depth_of_field(color, depth, table=HEXAGON):
    """The passes, to be drawn in their order each frame, and the texture that the last one writes."""
    metres = texture(color.width, color.height, FLOAT)
    passes = [FullScreenPass(shader("LINEAR_DEPTH"), {"BokehDepthSamp": depth}, [metres], {})]
    textures = {"color": color}
    for entry, reads, writes, scale, parameters in table:
        size = [-(-side // scale) for side in (color.width, color.height)]
        targets = {name: texture(*size, HALF) for name in writes.split()}
        read = {slot: textures[name] for slot, name in zip(SLOTS, reads.split(), strict=False) if name != "-"}
        read["BokehDepthSamp"] = metres
        passes.append(FullScreenPass(shader(entry), read, [*targets.values()], parameters))
        textures |= targets
    return passes, textures["result"]
