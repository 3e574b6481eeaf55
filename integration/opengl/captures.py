"""Write the captures of OpenGL, raylib and Panda3D. For validation/run engines only: your renderer does not need this.

A capture is a folder with color.f16, depth.f32 (the values of the depth buffer), metres.f32, a .f16 file with the
result of each shot, and a .written file with all targets of each layered shot. All of these contain raw rows, beginning
at v = 0. capture.json describes them.
"""

import json
from math import radians

# Rotation in degrees of the shot whose name ends with "rotated"
CLOCKWISE = 10.0


def shots():
    """Return shot -> passes, for samples with tables of passes (Panda3D's has none)."""
    from apertures import EXACT_HEXAGON, EXACT_OCTAGON, OCTAGON, PAPER_HEXAGON, PAPER_OCTAGON
    from depth_of_field import HEXAGON

    return {
        "layered-hexagon": HEXAGON,
        "layered-octagon": OCTAGON,
        "exact-hexagon": EXACT_HEXAGON,
        "exact-octagon": EXACT_OCTAGON,
        "exact-octagon-rotated": EXACT_OCTAGON,
        "paper-hexagon": PAPER_HEXAGON,
        "paper-octagon": PAPER_OCTAGON,
    }


def angle(name):
    """Return BokehAngle of a shot, radians. In OpenGL, v grows upwards, so a negative angle is clockwise on the screen."""
    return -radians(CLOCKWISE) if name.endswith("rotated") else 0.0


def write_shot(folder, name, result, targets):
    """Write a shot, and return its entry in capture.json.

    result   its pixels, as bytes
    targets  pixels of the targets of all its passes, as bytes each
    """
    (folder / f"{name}.f16").write_bytes(result)
    method, aperture = name.split("-")[:2]
    shot = {"name": name, "method": method, "aperture": aperture, "result": f"{name}.f16"}
    if name.endswith("rotated"):
        shot["clockwise"] = CLOCKWISE
    if method == "layered":
        shot["written"] = f"{name}.written"
        (folder / shot["written"]).write_bytes(b"".join(targets))
    if method == "paper":
        # capture.json has no preset for paper: give the values of MEDIUM instead
        shot |= {"depth": "metres.f32", "stored": None, "samples": 9, "spacing": 1.5}
    return shot


def pull(pull_focus, size, focus, depths):
    """Return a record of 12 frames of the autofocus: "pull" in capture.json.

    pull_focus  of the sample
    size        (width, height) of the image
    focus       focus distance before the first frame, metres
    depths      pixel (x, y) -> depth there, metres
    """
    found = {"frame": 1 / 30, "seconds": 0.2, "from": focus, "distances": []}
    found["points"] = [[(x + 0.5) / size[0], (y + 0.5) / size[1], depth] for (x, y), depth in depths.items()]
    for _ in range(12):
        focus = pull_focus(focus, depths.values(), found["frame"], found["seconds"])
        found["distances"].append(focus)
    return found


def write_description(folder, size, planes, parameters, focus, more):
    """Write capture.json.

    size        (width, height) of the image
    planes      (near, far) of the camera, metres
    parameters  name -> value; it has the lens
    focus       focus distance, metres
    more        "engine", "device", "shots" and "pull"
    """
    lens = {
        "aperture_diameter": parameters["BokehApertureDiameter"],
        "focal_length": parameters["BokehFocalLength"],
        "focus_distance": focus,
        "sensor_height": parameters["BokehSensorHeight"],
        "max_coc": parameters["BokehMaxCoC"],
    }
    capture = {"width": size[0], "height": size[1], "color": "color.f16", "depth": "depth.f32", "camera": lens}
    capture["stored"] = {"kind": 1, "near": planes[0], "far": planes[1]}
    (folder / "capture.json").write_text(json.dumps(capture | more, indent=1), encoding="utf-8")
