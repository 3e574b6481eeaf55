"""Depth of field for an OpenGL 3.3 renderer: a hexagon in layers. Three files of shaders are the rest."""

from functools import partial
from pathlib import Path

from renderer import FullScreenPass, texture

# the folder with the three files
GLSL = Path(__file__).resolve().parents[2] / "glsl"
FILES = "".join((GLSL / name).read_text() for name in ("bokeh.glsl", "bokeh_layers.glsl", "bokeh_passes.glsl"))
SLOTS = ["BokehColorSamp", *(f"BokehColorSamp{letter}" for letter in "BCDEF")]

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


def shader(name):
    """Text of a shader; `name` without BOKEH_ is one of the table in bokeh_passes.glsl."""
    return f"#version 330\n#define BOKEH_PASS BOKEH_{name}\n#define BOKEH_NUM_SAMPLES 33\n{FILES}"


def depth_of_field(context, color, depth, table=HEXAGON):
    """The passes, to be drawn in their order each frame, and the texture that the last one writes."""
    full_screen = partial(FullScreenPass, context, shader("FULL_SCREEN"))
    metres = texture(context, color.size, "R32F")
    passes = [full_screen(shader("LINEAR_DEPTH"), {"BokehDepthSamp": depth}, [metres])]
    textures = {"color": color}
    for entry, reads, writes, scale, parameters in table:
        size = [-(-side // scale) for side in color.size]
        targets = {name: texture(context, size, "RGBA16F") for name in writes.split()}
        read = {slot: textures[name] for slot, name in zip(SLOTS, reads.split(), strict=False) if name != "-"}
        read["BokehDepthSamp"] = metres
        passes.append(full_screen(shader(entry), read, [*targets.values()], **parameters))
        textures |= targets
    return passes, textures["result"]
