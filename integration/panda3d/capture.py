"""For validation/run engines, not for your program: what the shaders read and wrote, into the folder given.

color.f16, depth.f32, metres.f32 and a .f16 for each shot are raw rows, v = 0 first; capture.json says what they are.
"""

import json
import sys
from array import array
from pathlib import Path
from struct import pack, unpack

import scene
from bokeh_panda3d import EXACT_HEXAGON, DepthOfField
from bokeh_panda3d.apertures import EXACT_OCTAGON, PAPER_HEXAGON, PAPER_OCTAGON
from panda3d.core import PandaSystem
from sample import PARAMETERS, Frame, focus_at, focus_on, pull_focus, start

SHOTS = {
    "exact-hexagon": EXACT_HEXAGON,
    "exact-octagon": EXACT_OCTAGON,
    "paper-hexagon": PAPER_HEXAGON,
    "paper-octagon": PAPER_OCTAGON,
}
# under which the autofocus looks
POINTS = ((304, 82), (190, 128))


def save(base, texture, path, kind):
    """Write a texture's pixels, red first; `kind` is struct's: e float16, f float32.

    Panda3D keeps blue first, and reads half floats back as floats. Raises ValueError for pixels of another kind.
    """
    base.graphicsEngine.extractTextureData(texture, base.win.getGsg())
    pixels = array("f", texture.getRamImageAs("RGBA" if texture.getNumComponents() == 4 else "R").getData())
    if len(pixels) != scene.SIZE[0] * scene.SIZE[1] * texture.getNumComponents():
        raise ValueError(f"{texture}: {len(pixels)} values")
    packed = pack(f"<{len(pixels)}{kind}", *pixels)
    if array("f", unpack(f"<{len(pixels)}{kind}", packed)) != pixels:
        raise ValueError(f"{texture}: not what was asked for, its values do not fit {kind!r}")
    path.write_bytes(packed)


def pull(focus, depths):
    """The autofocus, frame by frame."""
    found = {"frame": 1 / 30, "seconds": 0.2, "from": focus, "distances": []}
    found["points"] = [[(x + 0.5) / scene.SIZE[0], (y + 0.5) / scene.SIZE[1], depth] for (x, y), depth in depths.items()]
    for _ in range(12):
        focus = pull_focus(focus, depths.values(), found["frame"], found["seconds"])
        found["distances"].append(focus)
    return found


def main(folder):
    """Every shot of the same frame, focused on the panda."""
    base = start()
    panda = scene.build(base)
    frame = Frame(base)
    focus = focus_on(base, panda)
    effects = {}
    for name, passes in SHOTS.items():
        effects[name] = DepthOfField(frame.manager, frame.color, frame.depth, passes)
        effects[name].set(BokehFocusDistance=focus, **PARAMETERS)
    base.graphicsEngine.renderFrame()
    base.graphicsEngine.renderFrame()
    shots = []
    for name, effect in effects.items():
        save(base, effect.textures["result"], folder / f"{name}.f16", "e")
        method, aperture = name.split("-")
        shot = {"name": name, "method": method, "aperture": aperture, "result": f"{name}.f16"}
        if method == "paper":
            # what the preset MEDIUM stands for
            shot |= {"depth": "metres.f32", "stored": None, "samples": 9, "spacing": 1.5}
        shots.append(shot)
    save(base, frame.color, folder / "color.f16", "e")
    save(base, frame.depth, folder / "depth.f32", "f")
    save(base, effect.textures["metres"], folder / "metres.f32", "f")
    capture = {
        "engine": f"Panda3D {PandaSystem.getVersionString()}",
        "device": base.win.getGsg().getDriverRenderer(),
        "width": scene.SIZE[0],
        "height": scene.SIZE[1],
        "color": "color.f16",
        "depth": "depth.f32",
        "stored": {"kind": 1, "near": scene.NEAR, "far": scene.FAR},
        "camera": {
            "aperture_diameter": PARAMETERS["BokehApertureDiameter"],
            "focal_length": PARAMETERS["BokehFocalLength"],
            "focus_distance": focus,
            "sensor_height": PARAMETERS["BokehSensorHeight"],
            "max_coc": PARAMETERS["BokehMaxCoC"],
        },
        "pull": pull(focus, {(x, y): focus_at(base, frame.depth, x, y) for x, y in POINTS}),
        "shots": shots,
    }
    (folder / "capture.json").write_text(json.dumps(capture, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
