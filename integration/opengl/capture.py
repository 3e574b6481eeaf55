"""Write everything that the shaders read and wrote into a folder, for validation/run engines: python capture.py FOLDER

Your renderer does not need this file. It writes color.f16, depth.f32 (the values of the depth buffer), metres.f32, a
.f16 file with the result of each shot, and a .written file with all targets of each layered shot. All of these contain
raw rows, beginning at v = 0. capture.json describes them.
"""

import json
import sys
from math import radians
from pathlib import Path

import moderngl
from apertures import EXACT_HEXAGON, EXACT_OCTAGON, OCTAGON, PAPER_HEXAGON, PAPER_OCTAGON
from depth_of_field import HEXAGON, depth_of_field
from renderer import BALL, FAR, NEAR, SIZE, Renderer
from sample import BLUR, DEPTH, IMAGE, LENS, PAPER, focus_at, focus_on, pull_focus, start

SHOTS = {
    "layered-hexagon": HEXAGON,
    "layered-octagon": OCTAGON,
    "exact-hexagon": EXACT_HEXAGON,
    "exact-octagon": EXACT_OCTAGON,
    "paper-hexagon": PAPER_HEXAGON,
    "paper-octagon": PAPER_OCTAGON,
    "exact-octagon-rotated": EXACT_OCTAGON,
}
# Rotation in degrees of the shot whose name ends with "rotated". In OpenGL, v grows upwards, so a negative BokehAngle
# is clockwise on the screen.
CLOCKWISE = 10.0
# Pixels at which the autofocus measures depth
POINTS = ((304, 82), (190, 128))


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
    """Draw every shot with the same frame, focused on the ball, and write the files."""
    context = start()
    renderer = Renderer(context)
    renderer.draw()
    focus = focus_on(BALL)
    shots = []
    for name, table in SHOTS.items():
        passes, result = depth_of_field(context, renderer.color, renderer.depth, table)
        angle = -radians(CLOCKWISE) if name.endswith("rotated") else 0.0
        for step in passes:
            step.draw(BokehFocusDistance=focus, BokehAngle=angle, **LENS, **IMAGE, **DEPTH, **BLUR, **PAPER)
        (folder / f"{name}.f16").write_bytes(result.read())
        method, aperture = name.split("-")[:2]
        shot = {"name": name, "method": method, "aperture": aperture, "result": f"{name}.f16"}
        if name.endswith("rotated"):
            shot["clockwise"] = CLOCKWISE
        if method == "layered":
            shot["written"] = f"{name}.written"
            targets = [target for step in passes for target in step.framebuffer.color_attachments]
            (folder / shot["written"]).write_bytes(b"".join(target.read() for target in targets))
        if method == "paper":
            # capture.json has no preset for paper: give the values of MEDIUM instead
            shot |= {"depth": "metres.f32", "stored": None, "samples": 9, "spacing": 1.5}
            (folder / "metres.f32").write_bytes(passes[0].framebuffer.read(components=1, dtype="f4"))
        shots.append(shot)
    (folder / "color.f16").write_bytes(renderer.color.read())
    (folder / "depth.f32").write_bytes(renderer.framebuffer.read(components=1, attachment=-1, dtype="f4"))
    capture = {
        "engine": f"OpenGL {context.info['GL_VERSION']}, moderngl {moderngl.__version__}",
        "device": context.info["GL_RENDERER"],
        "width": SIZE[0],
        "height": SIZE[1],
        "color": "color.f16",
        "depth": "depth.f32",
        "stored": {"kind": 1, "near": NEAR, "far": FAR},
        "camera": {
            "aperture_diameter": LENS["BokehApertureDiameter"],
            "focal_length": LENS["BokehFocalLength"],
            "focus_distance": focus,
            "sensor_height": LENS["BokehSensorHeight"],
            "max_coc": BLUR["BokehMaxCoC"],
        },
        "pull": pull(focus, {(x, y): focus_at(renderer, x, y) for x, y in POINTS}),
        "shots": shots,
    }
    (folder / "capture.json").write_text(json.dumps(capture, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
