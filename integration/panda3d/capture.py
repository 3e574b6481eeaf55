"""For validation/run engines, not for your program: writes what the shaders read and wrote into a folder.

color.f16, depth.f32, metres.f32, a .f16 file for each shot, and the targets of the shots with layered (.written) are
raw rows, beginning with v = 0. capture.json describes them.
"""

import json
import sys
from array import array
from math import radians
from pathlib import Path
from struct import pack, unpack

import scene
from bokeh_panda3d import DepthOfField
from panda3d.core import PandaSystem
from sample import frames, start

SIDES = {"hexagon": 6, "octagon": 8}
SHOTS = ("layered-hexagon", "layered-octagon", "exact-hexagon", "exact-octagon", "paper-hexagon", "paper-octagon")
# Shots to draw a second time, rotated by CLOCKWISE degrees
ROTATED = ("exact-octagon-rotated", "paper-hexagon-rotated")
CLOCKWISE = 10.0
# A shot to draw a second time, with a weaker and limited blur
FOCUSED = ("exact-hexagon-focus",)
CONTROLS = {"BokehNearScale": 0.5, "BokehFarScale": 0.75, "BokehNearMaxCoC": 0.02, "BokehFarMaxCoC": 0.03}
# Pixels of the autofocus
POINTS = ((304, 82), (190, 128))


def pixels(base, texture, kind):
    """Return a texture's pixels as bytes, red first. `kind` is a format of struct: e for float16, f for float32.

    Panda3D stores blue first, and reads half floats back as floats. Raises ValueError if values do not fit `kind`.
    """
    base.graphicsEngine.extractTextureData(texture, base.win.getGsg())
    found = array("f", texture.getRamImageAs("RGBA" if texture.getNumComponents() == 4 else "R").getData())
    if len(found) != texture.getXSize() * texture.getYSize() * texture.getNumComponents():
        raise ValueError(f"{texture}: it has {len(found)} values, which does not match its size")
    packed = pack(f"<{len(found)}{kind}", *found)
    if array("f", unpack(f"<{len(found)}{kind}", packed)) != found:
        raise ValueError(f"{texture}: its values do not fit {kind!r}")
    return packed


def pull(effect, depths):
    """Run the autofocus frame by frame. Return its inputs and the focus distances."""
    found = {"frame": 1 / 30, "seconds": 0.2, "from": effect.focus_distance, "distances": []}
    found["points"] = [[(x + 0.5) / scene.SIZE[0], (y + 0.5) / scene.SIZE[1], depth] for (x, y), depth in depths.items()]
    for _ in range(12):
        effect.pull_focus(depths.values(), found["frame"], found["seconds"])
        found["distances"].append(effect.focus_distance)
    return found


def main(folder):
    """Draw all shots of the same frame, focused on the panda, and write them to the folder."""
    base = start()
    panda = scene.build(base)
    effect = DepthOfField(base.win, base.cam, f_stop=1.4, bokeh_scale=1.0)
    effect.parameters["BokehMaxCoC"] = 0.12
    effect.focus_on(panda)
    shots = []
    defaults = dict(effect.parameters)
    for name in SHOTS + FOCUSED + ROTATED:
        method, aperture = name.split("-")[:2]
        effect.rotation = radians(CLOCKWISE) if name in ROTATED else 0.0
        effect.parameters.update(CONTROLS if name in FOCUSED else defaults)
        effect.change(method, SIDES[aperture])
        frames(base)
        shot = {"name": name, "method": method, "aperture": aperture, "result": f"{name}.f16"}
        if name in ROTATED:
            shot["clockwise"] = CLOCKWISE
        if name in FOCUSED:
            near_scale, far_scale, *limits = CONTROLS.values()
            shot["focus"] = {"scale": [near_scale, far_scale], "limits": limits}
        (folder / shot["result"]).write_bytes(pixels(base, effect.textures["result"], "e"))
        if method == "layered":
            shot["written"] = f"{name}.written"
            targets = [target for _, _, written in effect.passes for target in written]
            (folder / shot["written"]).write_bytes(b"".join(pixels(base, target, "e") for target in targets))
        if method == "paper":
            # the reference has no presets for paper: give it the samples and the spacing of MEDIUM
            shot |= {"depth": "metres.f32", "stored": None, "samples": 9, "spacing": 1.5}
        shots.append(shot)
    effect.bokeh_scale = 0.0
    frames(base)
    shown = effect.quad.getShaderInput("image").getTexture()
    assert shown == effect.textures["color"] and not any(buffer.isActive() for buffer in effect.buffers)
    effect.bokeh_scale = 1.0
    frames(base)
    (folder / "color.f16").write_bytes(pixels(base, effect.textures["color"], "e"))
    (folder / "depth.f32").write_bytes(pixels(base, effect.textures["depth"], "f"))
    (folder / "metres.f32").write_bytes(pixels(base, effect.textures["metres"], "f"))
    capture = {
        "engine": f"Panda3D {PandaSystem.getVersionString()}",
        "device": base.win.getGsg().getDriverRenderer(),
        "width": scene.SIZE[0],
        "height": scene.SIZE[1],
        "color": "color.f16",
        "depth": "depth.f32",
        "stored": {"kind": 1, "near": scene.NEAR, "far": scene.FAR},
        "camera": {
            "aperture_diameter": effect.values["BokehApertureDiameter"],
            "focal_length": effect.values["BokehFocalLength"],
            "focus_distance": effect.focus_distance,
            "sensor_height": effect.sensor_height,
            "max_coc": effect.parameters["BokehMaxCoC"],
        },
        "pull": pull(effect, {(x, y): effect.depth_at(x, y) for x, y in POINTS}),
        "shots": shots,
    }
    (folder / "capture.json").write_text(json.dumps(capture, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
