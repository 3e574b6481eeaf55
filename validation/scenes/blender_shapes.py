"""Materials and meshes for scenes that Blender's Cycles renders. Metres; +Z is up."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from random import Random

import bpy
import numpy as np
from mathutils import Matrix, Vector

Color = tuple[float, float, float]
Point = Sequence[float]
ALONG_X = (0, math.pi / 2, 0)  # rotations that turn a lathe's axis from +Z to +X and to -Y
ALONG_Y = (math.pi / 2, 0, 0)


@cache
def surface(color: Color, roughness: float = 0.5, metallic: float = 0.0, coat: float = 0.0) -> bpy.types.Material:
    """Return an opaque material of one colour; `coat` adds a layer of clear lacquer or glaze."""
    material, inputs = _principled("surface")
    inputs["Base Color"].default_value = (*color, 1)
    inputs["Roughness"].default_value = roughness
    inputs["Metallic"].default_value = metallic
    inputs["Coat Weight"].default_value = coat
    inputs["Coat Roughness"].default_value = 0.04
    return material


@cache
def light(color: Color, radiance: float) -> bpy.types.Material:
    """Return a material that only emits, for small bulbs: shadow rays do not look for it."""
    material, inputs = _principled("light")
    inputs["Base Color"].default_value = (0, 0, 0, 1)
    inputs["Specular IOR Level"].default_value = 0
    inputs["Emission Color"].default_value = (*color, 1)
    inputs["Emission Strength"].default_value = radiance
    material.cycles.emission_sampling = "NONE"
    return material


def grained(dark: Color, bright: Color, stretch: Point, roughness: float) -> bpy.types.Material:
    """Return a material with noise between two colours, stretched along the object's axes and new for every object.

    stretch  frequency along X, Y and Z, 1/m: wood has a low one along its grain
    """
    material, inputs = _principled("grained")
    nodes, link = material.node_tree.nodes, material.node_tree.links.new
    place, scaled, noise = (nodes.new(f"ShaderNode{kind}") for kind in ("TexCoord", "Mapping", "TexNoise"))
    ramp, bump, item = (nodes.new(f"ShaderNode{kind}") for kind in ("ValToRGB", "Bump", "ObjectInfo"))
    scaled.inputs["Scale"].default_value = stretch
    noise.noise_dimensions = "4D"
    noise.inputs["Scale"].default_value, noise.inputs["Detail"].default_value = 1, 6
    noise.inputs["Distortion"].default_value = 0.6
    shift = nodes.new("ShaderNodeMath")
    shift.operation, shift.inputs[1].default_value = "MULTIPLY", 50
    ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[1].color = (*dark, 1), (*bright, 1)
    ramp.color_ramp.elements[0].position, ramp.color_ramp.elements[1].position = 0.32, 0.68
    bump.inputs["Strength"].default_value, bump.inputs["Distance"].default_value = 0.25, 0.001
    link(place.outputs["Object"], scaled.inputs["Vector"])
    link(scaled.outputs[0], noise.inputs["Vector"])
    link(item.outputs["Random"], shift.inputs[0])
    link(shift.outputs[0], noise.inputs["W"])
    link(noise.outputs[0], ramp.inputs[0])
    link(noise.outputs[0], bump.inputs["Height"])
    link(ramp.outputs[0], inputs["Base Color"])
    link(bump.outputs[0], inputs["Normal"])
    inputs["Roughness"].default_value, inputs["Specular IOR Level"].default_value = roughness, 0.25
    return material


def _principled(name: str) -> tuple[bpy.types.Material, bpy.types.NodeInputs]:
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    return material, material.node_tree.nodes["Principled BSDF"].inputs


def group(location: Point, heading: float) -> bpy.types.Object:
    """Return an invisible parent for shapes, rotated around +Z by `heading` radians."""
    return _placed(None, location, (0, 0, heading), None)


def _placed(mesh, location: Point, rotation: Point, parent) -> bpy.types.Object:
    placed = bpy.data.objects.new("shape", mesh)
    placed.location, placed.rotation_euler, placed.parent = location, rotation, parent
    bpy.context.scene.collection.objects.link(placed)
    return placed


def shape(vertices, faces, material, location=(0, 0, 0), rotation=(0, 0, 0), parent=None, sharp_degrees=35.0):
    """Place a mesh of its own, smooth except for edges sharper than `sharp_degrees`."""
    mesh = bpy.data.meshes.new("shape")
    mesh.from_pydata(vertices, [], faces)
    mesh.materials.append(material)
    mesh.shade_smooth()
    mesh.set_sharp_from_angle(angle=math.radians(sharp_degrees))
    return _placed(mesh, location, rotation, parent)


def lathe(profile: Sequence[tuple[float, float]], material, location=(0, 0, 0), rotation=(0, 0, 0), parent=None):
    """Place a body of revolution around Z; the profile is (radius, z) from one end to the other."""
    turns = 48
    vertices = [
        (max(radius, 1e-5) * math.cos(math.tau * k / turns), max(radius, 1e-5) * math.sin(math.tau * k / turns), z)
        for radius, z in profile
        for k in range(turns)
    ]
    faces = [
        (row + k, row + (k + 1) % turns, row + turns + (k + 1) % turns, row + turns + k)
        for row in range(0, turns * (len(profile) - 1), turns)
        for k in range(turns)
    ]
    return shape(vertices, faces, material, location, rotation, parent)


def cylinder(radius: float, length: float, material, location, rotation=(0, 0, 0), parent=None, bevel=0.0015):
    """Place a cylinder with beveled rims, centred at `location`."""
    half, flat = length / 2, radius - bevel
    profile = [(0, -half), (flat, -half), (radius, bevel - half), (radius, half - bevel), (flat, half), (0, half)]
    return lathe(profile, material, location, rotation, parent)


def box(size: Point, material, location, rotation=(0, 0, 0), parent=None, bevel=0.002):
    """Place a box with beveled edges, centred at `location`."""
    x, y, z = (side / 2 for side in size)
    corners = [(-x, -y), (x, -y), (x, y), (-x, y)]
    return extrusion(corners, 2 * z, material, location, rotation, parent, bevel)


def extrusion(outline, length: float, material, location, rotation=(0, 0, 0), parent=None, bevel=0.002):
    """Place a prism with beveled edges: an outline (x, y), counterclockwise, extruded along Z around `location`."""
    count = len(outline)
    vertices = [(x, y, side * length / 2) for side in (-1, 1) for x, y in outline]
    faces = [tuple(reversed(range(count))), tuple(range(count, 2 * count))]
    faces += [(k, (k + 1) % count, (k + 1) % count + count, k + count) for k in range(count)]
    made = shape(vertices, faces, material, location, rotation, parent)
    rounded = made.modifiers.new("bevel", "BEVEL")
    rounded.width, rounded.segments, rounded.harden_normals = bevel, 3, True
    return made


def tube(points: Sequence[Point], radius: float, material, parent=None):
    """Place a round bar through points; for rails and wires."""
    curve = bpy.data.curves.new("tube", "CURVE")
    curve.dimensions, curve.bevel_depth, curve.bevel_resolution, curve.use_fill_caps = "3D", radius, 3, True
    spline = curve.splines.new("POLY")
    spline.points.add(len(points) - 1)
    for point, place in zip(spline.points, points, strict=True):
        point.co = (*place, 1)
    curve.materials.append(material)
    return _placed(curve, (0, 0, 0), (0, 0, 0), parent)


@cache
def _ball_mesh(material) -> bpy.types.Mesh:
    ball = lathe([(math.sin(math.pi * k / 24), -math.cos(math.pi * k / 24)) for k in range(25)], material)
    mesh = ball.data
    bpy.data.objects.remove(ball)
    return mesh


def ball(radius: float, material, location, stretch: float = 1.0, rotation=(0, 0, 0), parent=None):
    """Place a sphere, or an egg whose Z axis is `stretch` times longer."""
    made = _placed(_ball_mesh(material), location, rotation, parent)
    made.scale = (radius, radius, radius * stretch)
    return made


@dataclass(frozen=True)
class Sprig:
    """Hold a fir sprig 1 long along +X: triangles, and the index of the material of each."""

    vertices: np.ndarray
    faces: np.ndarray
    materials: np.ndarray


def sprig(needles: int, needle_length: float, width: float, colors: int, rnd: Random) -> Sprig:
    """Return a stem, of material 0, with needles of materials 1 to `colors` all around.

    needle_length, width  fractions of the sprig's length
    """
    vertices, faces, materials = [], [], []

    def spike(root: Vector, tip: Vector, thickness: float, material: int) -> None:
        across = (tip - root).orthogonal().normalized() * thickness / 2
        turn = Matrix.Rotation(math.tau / 3, 3, tip - root)
        first = len(vertices)
        vertices.extend([root + across, root + turn @ across, root + turn @ (turn @ across), tip])
        faces.extend([(first + k, first + (k + 1) % 3, first + 3) for k in range(3)])
        materials.extend([material] * 3)

    spike(Vector((-0.02, 0, 0)), Vector((1, 0, 0)), 2 * width, 0)
    for k in range(needles):
        along = (k + rnd.random()) / needles
        around, lean = rnd.uniform(0, math.tau), math.radians(rnd.uniform(38, 62) * (1 - 0.6 * along**4))
        direction = Vector((math.cos(lean), math.sin(lean) * math.cos(around), math.sin(lean) * math.sin(around)))
        root = Vector((along, 0, 0))
        length = needle_length * rnd.uniform(0.75, 1.1) * (1 - 0.35 * along)
        spike(root, root + length * direction, width, 1 + k % colors)
    return Sprig(np.array(vertices), np.array(faces), np.array(materials))


def foliage(pieces: Sequence[tuple[Sprig, Point, Vector, float, float]], materials: Sequence) -> None:
    """Place sprigs as one mesh, which is traced faster than instances that overlap.

    pieces  (sprig, root, direction, length, roll around the stem in radians)
    """
    vertices, faces, indices, count = [], [], [], 0
    for shoot, root, direction, length, roll in pieces:
        turn = direction.to_track_quat("X", "Z").to_matrix() @ Matrix.Rotation(roll, 3, "X")
        vertices.append(shoot.vertices @ (np.array(turn) * length).T + np.array(root))
        faces.append(shoot.faces + count)
        indices.append(shoot.materials)
        count += len(shoot.vertices)
    mesh = bpy.data.meshes.new("foliage")
    mesh.from_pydata(np.concatenate(vertices), [], np.concatenate(faces))
    for material in materials:
        mesh.materials.append(material)
    mesh.polygons.foreach_set("material_index", np.concatenate(indices))
    _placed(mesh, (0, 0, 0), (0, 0, 0), None)


def area_light(location: Point, target: Point, size: float, color: Color, watts: float) -> None:
    """Place a square area light that faces a point; it is not seen by the camera."""
    lamp = bpy.data.lights.new("area", "AREA")
    lamp.size, lamp.color, lamp.energy = size, color, watts
    placed = _placed(lamp, location, (0, 0, 0), None)
    placed.rotation_euler = (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
    placed.visible_camera = False


def point_light(location: Point, radius: float, color: Color, watts: float) -> None:
    """Place a lamp that shines in all directions; it is not seen by the camera."""
    lamp = bpy.data.lights.new("point", "POINT")
    lamp.shadow_soft_size, lamp.color, lamp.energy = radius, color, watts
    _placed(lamp, location, (0, 0, 0), None).visible_camera = False
