"""Write everything that the shaders read and wrote into a folder, for validation/run engines: python capture.py FOLDER

Your program does not need this file. It writes color.f16, depth.f32 (the values of the depth buffer), metres.f32, a
.f16 file with the result of each shot, and a .written file with all targets of each layered shot. All of these contain
raw rows, beginning at v = 0. capture.json describes them.
"""

import json
import sys
from math import radians
from pathlib import Path

import raylib as rl
from apertures import EXACT_HEXAGON, EXACT_OCTAGON, OCTAGON, PAPER_HEXAGON, PAPER_OCTAGON
from depth_of_field import HEXAGON, depth_of_field
from raylib import ffi
from sample import PAPER, PARAMETERS, focus_at, focus_on, pull_focus, read, start
from scene import DRUM, FAR, NEAR, SIZE, Scene

SHOTS = {
    "layered-hexagon": HEXAGON,
    "layered-octagon": OCTAGON,
    "exact-hexagon": EXACT_HEXAGON,
    "exact-octagon": EXACT_OCTAGON,
    "exact-octagon-rotated": EXACT_OCTAGON,
    "paper-hexagon": PAPER_HEXAGON,
    "paper-octagon": PAPER_OCTAGON,
}
# Rotation in degrees of the shot whose name ends with "rotated". In OpenGL, v grows upwards, so a negative BokehAngle
# is clockwise on the screen.
CLOCKWISE = 10.0
RENDERER, GL_VERSION = 0x1F01, 0x1F02
# Pixels at which the autofocus measures depth
POINTS = ((150, 215), (5, 250))


def gl_string(name):
    """Return a string of OpenGL: calls glGetString."""
    function = ffi.cast("const char *(*)(unsigned int)", rl.rlGetProcAddress(b"glGetString"))
    return ffi.string(function(name)).decode()


def pull(focus, depths):
    """Return a record of 12 frames of the autofocus: "pull" in capture.json.

    focus   focus distance before the first frame, metres
    depths  pixel (x, y) -> depth there, metres
    """
    found = {"frame": 1 / 30, "seconds": 0.2, "from": focus, "distances": []}
    found["points"] = [[(x + 0.5) / SIZE[0], (y + 0.5) / SIZE[1], depth] for (x, y), depth in depths.items()]
    for _ in range(12):
        focus = pull_focus(focus, depths.values(), found["frame"], found["seconds"])
        found["distances"].append(focus)
    return found


def main(folder):
    """Draw every shot with the same frame, focused on the drums, and write the files."""
    start()
    scene = Scene()
    scene.draw()
    focus = focus_on(DRUM)
    shots = []
    for name, table in SHOTS.items():
        passes, result = depth_of_field(scene.color, scene.depth, table)
        angle = -radians(CLOCKWISE) if name.endswith("rotated") else 0.0
        for step in passes:
            step.draw(BokehFocusDistance=focus, BokehAngle=angle, **PARAMETERS, **PAPER)
        (folder / f"{name}.f16").write_bytes(read(result, 8))
        method, aperture = name.split("-")[:2]
        shot = {"name": name, "method": method, "aperture": aperture, "result": f"{name}.f16"}
        if name.endswith("rotated"):
            shot["clockwise"] = CLOCKWISE
        if method == "layered":
            shot["written"] = f"{name}.written"
            targets = [target for step in passes for target in step.targets]
            (folder / shot["written"]).write_bytes(b"".join(read(target, 8) for target in targets))
        if method == "paper":
            # capture.json has no preset for paper: give the values of MEDIUM instead
            shot |= {"depth": "metres.f32", "stored": None, "samples": 9, "spacing": 1.5}
        shots.append(shot)
    (folder / "color.f16").write_bytes(read(scene.color, 8))
    metres = passes[0].targets[0]
    (folder / "metres.f32").write_bytes(read(metres, 4))
    found = {(x, y): focus_at(metres, x, y) for x, y in POINTS}
    # depth kind 0 means metres, so the same pass now copies the values of the depth buffer unchanged
    passes[0].draw(**PARAMETERS | {"BokehDepthKind": 0.0})
    (folder / "depth.f32").write_bytes(read(metres, 4))
    capture = {
        "engine": f"raylib {rl.RAYLIB_VERSION}, OpenGL {gl_string(GL_VERSION)}",
        "device": gl_string(RENDERER),
        "width": SIZE[0],
        "height": SIZE[1],
        "color": "color.f16",
        "depth": "depth.f32",
        "stored": {"kind": 1, "near": NEAR, "far": FAR},
        "camera": {
            "aperture_diameter": PARAMETERS["BokehApertureDiameter"],
            "focal_length": PARAMETERS["BokehFocalLength"],
            "focus_distance": focus,
            "sensor_height": PARAMETERS["BokehSensorHeight"],
            "max_coc": PARAMETERS["BokehMaxCoC"],
        },
        "pull": pull(focus, found),
        "shots": shots,
    }
    (folder / "capture.json").write_text(json.dumps(capture, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
