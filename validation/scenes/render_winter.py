"""Render winter_3: a toy train on a table on a winter evening, in front of a Christmas tree and a window.

python3.11 -m pip install bpy==5.0.1 OpenEXR
python3.11 render_winter.py [--width 960] [--samples 144] [--threads 2] [--only pin] [--output FOLDER]

It writes winter_3_pin.exr, the image through a pinhole with its depth, and winter_3_hex.exr, through a thin lens.
"""

import argparse
import math
import tempfile
import time
from pathlib import Path
from random import Random

import bpy
import numpy as np
import OpenEXR
from blender_shapes import (
    area_light,
    ball,
    box,
    cylinder,
    foliage,
    grained,
    group,
    lathe,
    light,
    point_light,
    shape,
    sprig,
    surface,
)
from mathutils import Vector
from toy_train import BLACK, BRASS, train

NAME, SEED = "winter_3", 3
FOCAL_LENGTH, SENSOR_HEIGHT, APERTURE, FOCUS = 0.05, 0.024, 0.044, 1.07  # metres
EYE, PITCH = Vector((0, 0, 0.25)), math.radians(-5.0)
SKY_DEPTH = 1000.0
WARM, GOLD = (1.0, 0.42, 0.11), (1.0, 0.58, 0.22)
# of the tree: colour and radiance
BULBS = [
    (WARM, 21), (GOLD, 26), (GOLD, 18), ((1, 0.05, 0.03), 24), ((0.06, 0.75, 0.16), 16), ((0.09, 0.25, 1), 29),
    ((1, 0.2, 0.02), 24), ((1, 0.12, 0.42), 19),
]  # fmt: skip
IVORY = surface((0.8, 0.68, 0.5), 0.45)
# bark, and three greens of needles
GREENS = [(0.008, 0.045, 0.016), (0.014, 0.07, 0.02), (0.02, 0.085, 0.035)]
FIR = [surface(color, 0.5) for color in [(0.05, 0.025, 0.012), *GREENS]]
# near the lens: root and tip in the picture, whose edges are at -1 and 1, and depth
TWIGS = (
    ((-1.25, 1.2), (-0.72, 0.86), 0.58), ((-1.25, 0.8), (-0.8, 0.42), 0.56), ((-1.3, 0.3), (-0.84, -0.04), 0.58),
    ((-1.25, -0.55), (-0.72, -0.78), 0.5), ((-1.1, -1.2), (-0.5, -1.02), 0.48), ((1.3, -0.3), (0.86, -0.5), 0.55),
    ((1.25, 1.1), (0.76, 0.88), 0.6), ((1.3, 0.62), (0.84, 0.3), 0.56), ((1.25, -0.75), (0.68, -0.88), 0.48),
)  # fmt: skip
# between them: place in the picture, depth, colour, radiance
NEAR_LIGHTS = (
    (-0.9, 0.74, 0.46, WARM, 17), (-0.67, 0.55, 0.49, GOLD, 15), (-0.94, 0.24, 0.45, GOLD, 18),
    (-0.74, 0.0, 0.53, WARM, 20), (-0.89, -0.66, 0.42, WARM, 16), (-0.66, -0.83, 0.43, GOLD, 14),
    (-0.42, 0.9, 0.54, WARM, 16), (0.88, 0.84, 0.52, GOLD, 16), (0.7, 0.68, 0.5, WARM, 18),
    (0.93, 0.36, 0.44, WARM, 15), (0.77, 0.16, 0.48, GOLD, 18), (0.93, -0.46, 0.46, GOLD, 15),
    (0.72, -0.8, 0.42, WARM, 17),
)  # fmt: skip


def at_view(u: float, v: float, depth: float) -> Vector:
    """Return the point at a place in the picture, -1 to 1 to the right and up, and a planar depth."""
    half = SENSOR_HEIGHT / FOCAL_LENGTH / 2
    forward, up = Vector((0, math.cos(PITCH), math.sin(PITCH))), Vector((0, -math.sin(PITCH), math.cos(PITCH)))
    return EYE + depth * (forward + Vector((u * half * 16 / 9, 0, 0)) + v * half * up)


def table(rnd: Random) -> None:
    """Add planks with a grain along the view."""
    wood = grained((0.055, 0.02, 0.008), (0.17, 0.075, 0.03), (46, 3.2, 46), 0.44)
    x = -1.3
    while x < 1.3:
        width = rnd.uniform(0.1, 0.15)
        back = 1.86 + rnd.uniform(-0.004, 0.004)
        height = rnd.uniform(-0.0004, 0.0004)
        box((width - 0.0012, back, 0.04), wood, (x + width / 2, back / 2, height - 0.02), bevel=0.001)
        x += width


def candle(x: float, y: float, radius: float, height: float, rnd: Random) -> None:
    """Add a lit candle on a brass plate."""
    plate = [(0, 0), (radius * 1.9, 0), (radius * 2.2, 0.012), (radius * 2.1, 0.012), (radius * 1.7, 0.004), (0, 0.004)]
    lathe(plate, BRASS, (x, y, 0))
    rim = [(radius, 0.004), (radius, height - 0.004), (radius * 0.93, height), (radius * 0.8, height - 0.002)]
    wax = lathe([*rim, (radius * 0.3, height - 0.007), (0, height - 0.007)], IVORY.copy(), (x, y, 0))
    inputs = wax.data.materials[0].node_tree.nodes["Principled BSDF"].inputs
    inputs["Emission Color"].default_value, inputs["Emission Strength"].default_value = (1, 0.34, 0.08, 1), 0.16
    for _ in range(5):  # drops of wax that ran down
        angle, length = rnd.uniform(3, 6.5), rnd.uniform(0.012, 0.035)
        spot = (x + radius * math.cos(angle), y + radius * math.sin(angle), height - length)
        ball(0.003, wax.data.materials[0], spot, length / 0.0035)
    cylinder(0.001, 0.012, BLACK, (x, y, height - 0.002), bevel=0.0004)
    flame = [(0.0006, 0), (0.0042, 0.006), (0.0052, 0.011), (0.004, 0.019), (0.0016, 0.029), (0, 0.035)]
    lathe(flame, light((1, 0.56, 0.18), 22), (x, y, height + 0.003), (0.05, 0.08, 0))
    point_light((x, y, height + 0.018), 0.008, (1, 0.5, 0.18), 0.7)


def bauble(radius: float, material, location, rnd: Random) -> None:
    """Add a glossy ball with a metal cap, tilted at random."""
    tilt = (rnd.uniform(-0.4, 0.4), rnd.uniform(-0.4, 0.4), 0)
    parent = group(location, rnd.uniform(0, 6))
    parent.rotation_euler = tilt
    ball(radius, material, (0, 0, 0), parent=parent)
    cylinder(radius * 0.22, radius * 0.3, BRASS, (0, 0, radius * 1.08), parent=parent, bevel=radius * 0.04)


def still_life(rnd: Random) -> None:
    """Add what lies around the train: candles, baubles, berries and sprigs."""
    candle(-0.325, 1.27, 0.024, 0.15, rnd)
    candle(-0.395, 1.36, 0.021, 0.095, rnd)
    bauble(0.034, surface((0.8, 0.42, 0.1), 0.16, 1.0), (0.2, 0.99, 0.034), rnd)
    bauble(0.026, surface((0.03, 0.1, 0.42), 0.12, 0.6, 1.0), (0.268, 1.045, 0.026), rnd)
    sprigs, pieces = near_sprigs(rnd), []
    for x, y, heading, length in ((0.4, 1.13, 2.9, 0.2), (0.4, 1.05, 2.6, 0.16), (-0.16, 0.93, 3.3, 0.15)):
        direction = Vector((math.cos(heading), math.sin(heading), 0.03))
        pieces.append((rnd.choice(sprigs), (x, y, 0.013), direction, length, rnd.uniform(0, 6)))
    foliage(pieces, FIR)
    berry = surface((0.5, 0.01, 0.012), 0.2, 0.0, 1.0)
    for x, y in ((0.15, 1.05), (0.163, 1.038), (0.16, 1.062), (-0.2, 0.93), (-0.188, 0.943), (0.32, 1.0)):
        ball(rnd.uniform(0.005, 0.0068), berry, (x, y, 0.006))


def near_sprigs(rnd: Random) -> list:
    """Return three fir sprigs with needles of a real size, for a length of 0.15 m."""
    return [sprig(340, 0.13, 0.013, len(FIR) - 1, rnd) for _ in range(3)]


def twig(root: Vector, tip: Vector, sprigs, rnd: Random) -> list:
    """Return the pieces of a fir twig with side shoots from `root` to `tip`."""
    along = tip - root
    pieces = [(rnd.choice(sprigs), root, along, along.length, rnd.uniform(0, 6))]
    across = along.cross(Vector((0, 1, 0.3))).normalized()
    for k in range(6):
        part = 0.12 + 0.13 * k
        direction = along.normalized() + (1 if k % 2 else -1) * rnd.uniform(0.7, 1.0) * across
        direction += Vector((0, rnd.uniform(0, 0.3), rnd.uniform(-0.15, 0.05)))
        length = along.length * (0.75 - part * 0.6) * rnd.uniform(0.85, 1.1)
        pieces.append((rnd.choice(sprigs), root + part * along, direction, length, rnd.uniform(0, 6)))
    return pieces


def near_twigs(rnd: Random) -> None:
    """Add fir twigs with small lights near the lens, at the left and the right of the picture."""
    sprigs, pieces = near_sprigs(rnd), []
    for start, end, depth in TWIGS:
        pieces += twig(at_view(*start, depth + 0.03), at_view(*end, depth), sprigs, rnd)
    foliage(pieces, FIR)
    for u, v, depth, color, radiance in NEAR_LIGHTS:
        radius, tilt = rnd.uniform(0.0034, 0.0045), (rnd.uniform(-1, 1), 0.4, 0)
        ball(radius, light(color, radiance), at_view(u, v, depth), 1.25, tilt)


def tree_radius(height: float) -> float:
    """Return the radius of the tree at a height over its foot, metres."""
    return 1.02 * (1 - height / 2.75) ** 0.85 if height < 2.75 else 0.0


def tree(rnd: Random) -> None:
    """Add a Christmas tree with lights and baubles, left of the middle behind the table."""
    foot = Vector((-0.95, 4.3, -0.8))
    sprigs, pieces = [sprig(64, 0.2, 0.02, len(FIR) - 1, rnd) for _ in range(3)], []
    lathe([(0.45 * tree_radius(0.1 * k), 0.1 * k) for k in range(28)], surface((0.004, 0.02, 0.008), 0.9), foot)
    for _ in range(1900):
        height = 2.7 * (1 - math.sqrt(rnd.random()))
        angle = rnd.uniform(0, math.tau)
        outward = Vector((math.cos(angle), math.sin(angle), rnd.uniform(-0.35, 0.1)))
        root = foot + Vector((0, 0, height)) + tree_radius(height) * rnd.uniform(0.45, 0.72) * outward
        outward += Vector((rnd.uniform(-0.7, 0.7), rnd.uniform(-0.7, 0.7), rnd.uniform(-0.2, 0.1)))
        length = rnd.uniform(0.22, 0.38) * (1.1 - height / 4)
        pieces.append((rnd.choice(sprigs), root, outward, length, rnd.uniform(0, 6)))
    foliage(pieces, FIR)
    hang_up(foot, rnd)


def hang_up(foot: Vector, rnd: Random) -> None:
    """Add the tree's lights and baubles, on the side that is seen and not too near each other."""
    gloss = [surface((0.6, 0.02, 0.03), 0.1, 0.7, 1.0), surface((0.8, 0.45, 0.12), 0.15, 1.0)]
    gloss.append(surface((0.7, 0.7, 0.75), 0.1, 1.0))
    taken: list[Vector] = []
    for k in range(4000):
        height, angle = 2.6 * (1 - math.sqrt(rnd.random())), rnd.uniform(-0.97, -0.03) * math.pi
        is_bauble = k % 4 == 0
        reach = tree_radius(height) * (0.98 if is_bauble else 1.1) + 0.03
        spot = foot + Vector((reach * math.cos(angle), reach * math.sin(angle), height))
        if len(taken) > 230 or any((spot - other).length < 0.108 for other in taken):
            continue
        taken.append(spot)
        if is_bauble:
            bauble(rnd.uniform(0.03, 0.046), rnd.choice(gloss), spot, rnd)
        else:
            color, radiance = rnd.choice(BULBS)
            radius, tilt = rnd.uniform(0.0105, 0.0145), (rnd.uniform(-1, 1), rnd.uniform(-1, 1), 0)
            ball(radius, light(color, radiance), spot, 1.3, tilt)


def curtain(left: float, right: float, material) -> None:
    """Add a curtain with folds beside the window."""
    columns = [left + (right - left) * k / 120 for k in range(121)]
    fold = [(x, 6.02 + 0.05 * math.sin(41 * x) + 0.022 * math.sin(97 * x + 1)) for x in columns]
    vertices = [(x, y, z) for z in (-0.8, 2.4) for x, y in fold]
    shape(vertices, [(k, k + 1, k + 122, k + 121) for k in range(120)], material)


def room(rnd: Random) -> None:
    """Add the wall with its window, the curtains and a string of lights."""
    wall, frame = surface((0.11, 0.05, 0.035), 0.85), surface((0.5, 0.46, 0.4), 0.4)
    left, right, sill, top = 0.2, 2.1, -0.12, 1.7
    for x0, x1, z0, z1 in ((-6, left, -0.8, 3), (right, 6, -0.8, 3), (left, right, -0.8, sill), (left, right, top, 3)):
        box((x1 - x0, 0.2, z1 - z0), wall, ((x0 + x1) / 2, 6.3, (z0 + z1) / 2), bevel=0.004)
    for x in (left, (left + right) / 2, right):
        box((0.07, 0.1, top - sill), frame, (x, 6.24, (top + sill) / 2), bevel=0.01)
    for z in (sill, 0.62, top):
        box((right - left, 0.1, 0.06), frame, ((left + right) / 2, 6.24, z), bevel=0.01)
    box((right - left + 0.2, 0.3, 0.05), frame, ((left + right) / 2, 6.15, sill - 0.05), bevel=0.01)
    velvet = surface((0.16, 0.012, 0.018), 0.8)
    curtain(left - 0.35, left + 0.12, velvet)
    curtain(right - 0.12, right + 0.5, velvet)
    for k in range(10):
        x = left - 0.25 + (right - left + 0.1) * k / 9
        y, z = 5.9 + rnd.uniform(-0.05, 0.05), 0.93 + rnd.uniform(-0.02, 0.02)
        spot = (x, y, z - 0.2 * math.sin(math.pi * (2 * k / 9 % 1)))
        ball(rnd.uniform(0.011, 0.015), light(rnd.choice((WARM, GOLD)), rnd.choice((18, 24, 30))), spot, 1.3)
    box((12, 12, 0.1), grained((0.02, 0.01, 0.005), (0.05, 0.025, 0.012), (3, 20, 3), 0.5), (0, 4, -0.85))


def town(rnd: Random) -> None:
    """Add dark houses with lit windows and street lights behind the window."""
    dark = surface((0.01, 0.014, 0.03), 0.9)
    x = 0.0
    while x < 13:
        width, height = rnd.uniform(1.4, 2.6), rnd.uniform(0.2, 2.2)
        box((width * 0.97, 2, height + 6), dark, (x + width / 2, 32 + rnd.uniform(-2, 2), (height - 6) / 2))
        windows = [(row, column) for row in range(int(height / 0.5) + 2) for column in range(4)]
        for row, column in rnd.sample(windows, 4):
            spot = (x + (0.2 + 0.2 * column) * width, 29.8, height - 0.4 - 0.5 * row)
            box((0.22, 0.02, 0.3), light(rnd.choice((WARM, (1, 0.7, 0.4))), rnd.uniform(1, 3)), spot)
        x += width
    for _ in range(16):
        color = rnd.choice((WARM, (1, 0.7, 0.4), (1, 0.08, 0.03), (0.5, 0.7, 1)))
        radius, radiance = rnd.uniform(0.05, 0.075), rnd.uniform(18, 34)
        spot = (rnd.uniform(0.8, 10), rnd.uniform(22, 28), rnd.uniform(-0.9, 1.3))
        ball(radius, light(color, radiance), spot)


def illuminate() -> None:
    """Add the dusk and the soft lights of the room."""
    world = bpy.data.worlds.new("dusk")
    world.use_nodes = True
    background = world.node_tree.nodes["Background"].inputs
    background["Strength"].default_value = 0.6
    nodes, link = world.node_tree.nodes, world.node_tree.links.new
    place, split, ramp = (nodes.new(f"ShaderNode{kind}") for kind in ("TexCoord", "SeparateXYZ", "ValToRGB"))
    ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[0].position = (0.3, 0.17, 0.2, 1), 0.0
    ramp.color_ramp.elements[1].color, ramp.color_ramp.elements[1].position = (0.02, 0.055, 0.19, 1), 0.2
    ramp.color_ramp.elements.new(0.06).color = (0.075, 0.125, 0.32, 1)
    link(place.outputs["Generated"], split.inputs[0])
    link(split.outputs["Z"], ramp.inputs[0])
    link(ramp.outputs[0], background["Color"])
    world.cycles.sampling_method = "NONE"
    bpy.context.scene.world = world
    area_light((-1.1, 0.3, 1.35), (-0.03, 1.1, 0.08), 0.6, (1, 0.74, 0.48), 27)
    area_light((0.75, 0.1, 1.0), (0, 1.1, 0.1), 0.45, (1, 0.8, 0.58), 10)
    area_light((0.85, 1.7, 1.25), (0, 1.15, 0.1), 0.35, (0.35, 0.55, 1), 9)
    area_light((-0.7, 1.8, 1.1), (-0.1, 1.1, 0.1), 0.3, (1, 0.6, 0.3), 10)
    area_light((0.1, 1.4, 1.2), (0.05, 1.15, 0), 0.5, (1, 0.62, 0.34), 3.5)
    area_light((-1.2, 2.3, 1.8), (-0.95, 4.2, 0.1), 0.8, (1, 0.7, 0.4), 45)
    area_light((0.6, 3.6, 2.2), (1.2, 6.2, 0.3), 0.8, (1, 0.6, 0.35), 20)


def prepare(width: int, threads: int) -> bpy.types.Camera:
    """Set the renderer up and return its camera."""
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.device = "CYCLES", "CPU"
    scene.cycles.use_denoising, scene.cycles.denoiser = True, "OPENIMAGEDENOISE"
    scene.cycles.max_bounces, scene.cycles.diffuse_bounces, scene.cycles.glossy_bounces = 3, 1, 3
    scene.cycles.sample_clamp_indirect = 2
    scene.cycles.use_adaptive_sampling = False
    scene.render.resolution_x, scene.render.resolution_y = width, width * 9 // 16
    scene.render.threads_mode, scene.render.threads = "FIXED", threads
    scene.view_settings.view_transform = "Raw"
    scene.view_layers[0].use_pass_z = True
    lens = bpy.data.cameras.new("camera")
    lens.sensor_fit, lens.sensor_height, lens.lens = "VERTICAL", SENSOR_HEIGHT * 1000, FOCAL_LENGTH * 1000
    lens.clip_start, lens.clip_end = 0.05, 300
    lens.dof.focus_distance, lens.dof.aperture_fstop, lens.dof.aperture_blades = FOCUS, FOCAL_LENGTH / APERTURE, 6
    scene.camera = bpy.data.objects.new("camera", lens)
    scene.camera.location, scene.camera.rotation_euler = EYE, (math.pi / 2 + PITCH, 0, 0)
    scene.collection.objects.link(scene.camera)
    return lens


def rendered(samples: int) -> dict[str, np.ndarray]:
    """Render the scene; return R, G, B and Z in metres."""
    scene = bpy.context.scene
    scene.cycles.samples = samples
    scene.render.image_settings.media_type = "MULTI_LAYER_IMAGE"
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    scene.render.image_settings.color_depth = "32"
    scene.render.image_settings.exr_codec = "ZIP"
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = f"{folder}/layers.exr"
        bpy.ops.render.render(write_still=True)
        parts = OpenEXR.File(scene.render.filepath, separate_channels=True).parts
        found = {name: channel.pixels.copy() for part in parts for name, channel in part.channels.items()}
    return {name: found[f"ViewLayer.{'Depth' if name == 'Z' else 'Combined'}.{name}"] for name in "RGBZ"}


def rounded(values: np.ndarray, bits: int, step: float) -> np.ndarray:
    """Round to `bits` significant bits, but not finer than `step`, so that the file compresses better.

    7 bits of linear light are less than one step of an 8-bit display apart.
    """
    exponent = np.frexp(values.astype(np.float64))[1]
    steps = np.maximum(np.ldexp(1.0, exponent - bits), step)
    return np.round(values / steps) * steps


def save(path: Path, channels: dict[str, np.ndarray], with_depth: bool) -> None:
    """Write colour as half floats and, through a pinhole, depth as float."""
    kept = {name: rounded(np.clip(channels[name], 0, 60), 7, 2.0**-12).astype(np.float16) for name in "RGB"}
    if with_depth:
        kept["Z"] = rounded(np.minimum(channels["Z"], SKY_DEPTH), 10, 2.0**-13).astype(np.float32)
    OpenEXR.File({"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}, kept).write(str(path))


def main() -> None:
    """Build the scene and render it through a pinhole and through the lens."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--width", type=int, default=960)
    parser.add_argument("--samples", type=int, default=144)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--only", choices=("pin", "hex"))
    parser.add_argument("--output", type=Path, default=Path(__file__).parent)
    given = parser.parse_args()
    for leftover in list(bpy.data.objects):  # Blender starts with a cube, a lamp and a camera
        bpy.data.objects.remove(leftover)
    for build in (table, train, still_life, near_twigs, tree, room, town):
        build(Random(SEED))
    illuminate()
    lens = prepare(given.width, given.threads)
    for kind in ("pin", "hex") if given.only is None else (given.only,):
        start = time.time()
        lens.dof.use_dof = kind == "hex"
        channels = rendered(given.samples if lens.dof.use_dof else given.samples * 3 // 5)
        save(given.output / f"{NAME}_{kind}.exr", channels, not lens.dof.use_dof)
        print(f"{kind}: {time.time() - start:.0f} s", flush=True)


if __name__ == "__main__":
    main()
