"""For validation/run engines, not for your program: what the shaders read and wrote, into the folder given.

color.f16, depth.f32 (the buffer), metres.f32, a .f16 for each shot and the targets of the layered ones (.written) are raw
rows, v = 0 first; capture.json says what they are.
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
# degrees, of the one whose name says so: in OpenGL v grows upwards, so that a negative angle is clockwise on the screen
CLOCKWISE = 10.0
RENDERER, GL_VERSION = 0x1F01, 0x1F02
# under which the autofocus looks
POINTS = ((150, 215), (5, 250))


def gl_string(name):
    """What glGetString says."""
    function = ffi.cast("const char *(*)(unsigned int)", rl.rlGetProcAddress(b"glGetString"))
    return ffi.string(function(name)).decode()


def pull(focus, depths):
    """The autofocus, frame by frame."""
    found = {"frame": 1 / 30, "seconds": 0.2, "from": focus, "distances": []}
    found["points"] = [[(x + 0.5) / SIZE[0], (y + 0.5) / SIZE[1], depth] for (x, y), depth in depths.items()]
    for _ in range(12):
        focus = pull_focus(focus, depths.values(), found["frame"], found["seconds"])
        found["distances"].append(focus)
    return found


def main(folder):
    """Every shot of the same frame, focused on the drums."""
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
            # what the preset MEDIUM stands for
            shot |= {"depth": "metres.f32", "stored": None, "samples": 9, "spacing": 1.5}
        shots.append(shot)
    (folder / "color.f16").write_bytes(read(scene.color, 8))
    metres = passes[0].targets[0]
    (folder / "metres.f32").write_bytes(read(metres, 4))
    found = {(x, y): focus_at(metres, x, y) for x, y in POINTS}
    # the same pass leaves the buffer's own values as they are, if they are said to be metres
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
