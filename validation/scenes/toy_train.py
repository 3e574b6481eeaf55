"""A toy train of lacquered metal and its track, for render_winter.py. Metres; a car's +X is ahead."""

import math
from random import Random

from blender_shapes import ALONG_X, ALONG_Y, box, cylinder, extrusion, grained, group, lathe, light, surface, tube
from mathutils import Vector

BRASS = surface((0.85, 0.55, 0.2), 0.22, 1.0)
STEEL = surface((0.5, 0.5, 0.52), 0.3, 1.0)
BLACK = surface((0.012, 0.012, 0.014), 0.32, 0.0, 0.4)
CRIMSON = surface((0.42, 0.012, 0.016), 0.35, 0.0, 1.0)
GREEN = surface((0.012, 0.11, 0.06), 0.35, 0.0, 1.0)
LAMPLIGHT = (1, 0.55, 0.2)
START, HEADING, TRACK_RADIUS = Vector((-0.03, 1.115, 0)), math.radians(211), 1.5  # of the track, at the engine
RAIL_TOP, GAUGE = 0.014, 0.06


def on_track(distance: float) -> tuple[Vector, float]:
    """Return the point of the track's middle and the train's heading, `distance` metres in front of the engine."""
    turn = distance / TRACK_RADIUS
    side = Vector((-math.sin(HEADING), math.cos(HEADING), 0))
    ahead = Vector((math.cos(HEADING), math.sin(HEADING), 0))
    return START + TRACK_RADIUS * (math.sin(turn) * ahead - (1 - math.cos(turn)) * side), HEADING - turn


def wheel(x: float, side: int, radius: float, spokes: int, parent) -> None:
    """Add a spoked wheel of a car; side -1 or 1."""
    place, rim = (x, side * GAUGE / 2, RAIL_TOP + radius), radius * 0.8
    thickness = 0.008
    lathe([(rim, -thickness / 2), (radius * 1.06, -thickness / 2), (radius, 0), (radius, thickness / 2),
           (rim, thickness / 2), (rim, -thickness / 2)], STEEL, place, (side * math.pi / 2, 0, 0), parent)  # fmt: skip
    cylinder(radius * 0.24, 0.012, BRASS, place, ALONG_Y, parent)
    for k in range(spokes):
        angle = math.pi * k / spokes
        box((2 * rim + 0.001, 0.004, 0.004), CRIMSON, place, (0, angle, 0), parent, 0.001)


def boiler(parent) -> None:
    """Add the engine's boiler with its bands, domes, chimney and lamp; +X is ahead."""
    cylinder(0.04, 0.16, CRIMSON, (0.025, 0, 0.11), ALONG_X, parent)
    cylinder(0.043, 0.04, BLACK, (0.118, 0, 0.11), ALONG_X, parent, 0.003)
    lathe([(0, 0.012), (0.02, 0.009), (0.033, 0.002), (0.036, 0)], BLACK, (0.138, 0, 0.11), ALONG_X, parent)
    lathe([(0.034, 0), (0.037, 0.003), (0.04, 0)], BRASS, (0.138, 0, 0.11), ALONG_X, parent)
    cylinder(0.005, 0.01, BRASS, (0.151, 0, 0.11), ALONG_X, parent)
    box((0.003, 0.026, 0.004), BRASS, (0.152, 0, 0.11), (0.6, 0, 0), parent, 0.001)
    for x in (-0.035, 0.015, 0.055, 0.096):
        cylinder(0.0412, 0.005, BRASS, (x, 0, 0.11), ALONG_X, parent)
    chimney = [(0.02, 0), (0.014, 0.008), (0.0125, 0.03), (0.016, 0.044), (0.021, 0.048), (0.021, 0.054)]
    chimney.append((0.012, 0.054))
    lathe(chimney, BLACK, (0.118, 0, 0.149), parent=parent)
    lathe([(0.0205, 0), (0.0225, 0.002), (0.0225, 0.005), (0.019, 0.006)], BRASS, (0.118, 0, 0.198), parent=parent)
    dome = [(0.024, 0), (0.018, 0.006), (0.017, 0.02), (0.014, 0.029), (0.008, 0.034), (0, 0.036)]
    lathe(dome, BRASS, (0.035, 0, 0.145), parent=parent)
    lathe([(r * 0.72, z * 0.75) for r, z in dome], CRIMSON, (0.077, 0, 0.147), parent=parent)
    whistle = [(0.004, 0), (0.003, 0.018), (0.006, 0.02), (0.006, 0.03), (0, 0.034)]
    lathe(whistle, BRASS, (-0.02, 0, 0.148), parent=parent)
    cylinder(0.013, 0.02, BRASS, (0.134, 0, 0.165), ALONG_X, parent)
    lathe([(0.0105, 0), (0.007, 0.003), (0, 0.004)], light((1, 0.72, 0.38), 9), (0.144, 0, 0.165), ALONG_X, parent)
    for side in (-1, 1):
        tube([(-0.05, side * 0.043, 0.126), (0.09, side * 0.046, 0.126)], 0.0018, BRASS, parent)


def arched(width: float, length: float, rise: float, material, location, parent) -> None:
    """Add a curved roof with its ridge along X."""
    across = [width * (k / 12 - 0.5) for k in range(13)]
    top = [(-rise * (1 - (2 * y / width) ** 2), y) for y in across]
    extrusion([(0.004, -width / 2), (0.004, width / 2), *top[::-1]], length, material, location, ALONG_X, parent, 0.001)


def cabin(parent) -> None:
    """Add the engine's cabin, lit inside."""
    box((0.08, 0.088, 0.1), CRIMSON, (-0.092, 0, 0.117), (0, 0, 0), parent, 0.003)
    arched(0.108, 0.112, 0.016, BLACK, (-0.094, 0, 0.169), parent)
    glow = light(LAMPLIGHT, 1.6)
    for side in (-1, 1):
        for x in (-0.11, -0.074):
            box((0.028, 0.006, 0.036), BRASS, (x, side * 0.043, 0.137), (0, 0, 0), parent, 0.002)
            box((0.021, 0.006, 0.029), glow, (x, side * 0.0445, 0.137), (0, 0, 0), parent, 0.002)
        box((0.062, 0.003, 0.026), BRASS, (-0.092, side * 0.0435, 0.092), (0, 0, 0), parent, 0.001)
        box((0.057, 0.003, 0.021), CRIMSON, (-0.092, side * 0.0445, 0.092), (0, 0, 0), parent, 0.001)
        cylinder(0.011, 0.004, glow, (-0.052, side * 0.028, 0.15), ALONG_X, parent)


def engine(parent) -> None:
    """Add the steam engine: frame, wheels, rods and cylinders, buffers, and all above."""
    boiler(parent)
    cabin(parent)
    box((0.27, 0.05, 0.016), BLACK, (0, 0, 0.056), (0, 0, 0), parent)
    box((0.19, 0.098, 0.005), BLACK, (0.045, 0, 0.07), (0, 0, 0), parent, 0.001)
    box((0.008, 0.1, 0.024), CRIMSON, (0.139, 0, 0.058), (0, 0, 0), parent)
    for side in (-1, 1):
        tube([(-0.05, side * 0.0492, 0.07), (0.139, side * 0.0492, 0.07)], 0.0016, BRASS, parent)
        for x in (-0.098, -0.022, 0.054):
            wheel(x, side, 0.034, 5, parent)
        wheel(0.112, side, 0.019, 3, parent)
        box((0.16, 0.004, 0.008), STEEL, (-0.022, side * 0.039, 0.034), (0, 0, 0), parent, 0.001)
        box((0.085, 0.003, 0.005), STEEL, (0.04, side * 0.042, 0.042), (0, 0.1, 0), parent, 0.001)
        cylinder(0.017, 0.042, CRIMSON, (0.1, side * 0.044, 0.05), ALONG_X, parent)
        for x in (0.078, 0.122):
            cylinder(0.0175, 0.004, BRASS, (x, side * 0.044, 0.05), ALONG_X, parent)
        buffer = [(0.006, 0), (0.006, 0.012), (0.013, 0.014), (0.0125, 0.018), (0, 0.02)]
        lathe(buffer, BRASS, (0.143, side * 0.034, 0.058), ALONG_X, parent)


def car(distance: float, length: float, paint, rnd: Random) -> None:
    """Add a car behind the engine: a tender with coal if short, a coach with lit windows if long."""
    place, heading = on_track(distance)
    parent = group(place, heading)
    box((length, 0.05, 0.014), BLACK, (0, 0, 0.052), (0, 0, 0), parent)
    for side in (-1, 1):
        for x in (-length * 0.36, -length * 0.12, length * 0.12, length * 0.36):
            wheel(x, side, 0.019, 3, parent)
    coach = length > 0.15
    tall = 0.1 if coach else 0.06
    box((length * 0.97, 0.092, tall), paint, (0, 0, 0.06 + tall / 2), (0, 0, 0), parent, 0.004)
    for z in (0.066, 0.06 + tall * (0.42 if coach else 0.95)):
        box((length * 0.98, 0.0945, 0.004), BRASS, (0, 0, z), (0, 0, 0), parent, 0.001)
    if not coach:
        for _ in range(70):
            spot = (rnd.uniform(-0.4, 0.4) * length, rnd.uniform(-0.034, 0.034), 0.121 + rnd.uniform(0, 0.012))
            size = [rnd.uniform(0.01, 0.018) for _ in range(3)]
            box(size, BLACK, spot, [rnd.uniform(0, 3) for _ in range(3)], parent)
        return
    arched(0.106, length * 1.02, 0.018, BLACK, (0, 0, 0.162), parent)
    for k in range(4):
        x = length * (k - 1.5) * 0.23
        box((0.04, 0.0945, 0.04), BRASS, (x, 0, 0.132), (0, 0, 0), parent, 0.002)
        box((0.032, 0.097, 0.032), light(LAMPLIGHT, 1.5 + 0.3 * (k % 2)), (x, 0, 0.132), (0, 0, 0), parent, 0.002)


def train(rnd: Random) -> None:
    """Add the track, the engine and two cars."""
    sleeper = grained((0.03, 0.014, 0.006), (0.09, 0.045, 0.02), (12, 90, 90), 0.6)
    for k in range(-26, 26):
        place, heading = on_track(k * 0.036 + rnd.uniform(-0.002, 0.002))
        heading += rnd.uniform(-0.04, 0.04)
        box((0.014, 0.092, 0.006), sleeper, place + Vector((0, 0, 0.003)), (0, 0, heading), None, 0.0015)
    for side in (-1, 1):
        points = []
        for k in range(-48, 48):
            place, heading = on_track(k * 0.02)
            across = Vector((-math.sin(heading), math.cos(heading), 0))
            points.append(place + side * GAUGE / 2 * across + Vector((0, 0, RAIL_TOP - 0.004)))
        tube(points, 0.004, STEEL)
    place, heading = on_track(0)
    engine(group(place, heading))
    car(-0.215, 0.13, CRIMSON, rnd)
    car(-0.415, 0.24, GREEN, rnd)
