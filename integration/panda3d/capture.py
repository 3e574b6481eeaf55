"""For validation/run engines, not for your program: writes what the shaders read and wrote into a folder.

../opengl/captures.py says what it writes.
"""

import sys
from array import array
from math import radians
from pathlib import Path
from struct import pack, unpack

import scene
from bokeh_panda3d import DepthOfField
from panda3d.core import PandaSystem
from sample import frames, start

# at the end, because another module of that folder has the name of the one here
sys.path.append(str(Path(__file__).resolve().parent.parent / "opengl"))
import captures  # noqa: E402

SIDES = {"hexagon": 6, "octagon": 8}
SHOTS = ("layered-hexagon", "layered-octagon", "exact-hexagon", "exact-octagon", "paper-hexagon", "paper-octagon")
# Shots to draw a second time, rotated
ROTATED = ("exact-octagon-rotated", "paper-hexagon-rotated")
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
        effect.rotation = radians(captures.CLOCKWISE) if name in ROTATED else 0.0
        effect.parameters.update(CONTROLS if name in FOCUSED else defaults)
        effect.change(method, SIDES[aperture])
        frames(base)
        written = [target for _, _, targets in effect.passes for target in targets] if method == "layered" else []
        result, *targets = (pixels(base, target, "e") for target in [effect.textures["result"], *written])
        shots.append(captures.write_shot(folder, name, result, targets))
        if name in FOCUSED:
            near_scale, far_scale, *limits = CONTROLS.values()
            shots[-1]["focus"] = {"scale": [near_scale, far_scale], "limits": limits}
    effect.bokeh_scale = 0.0
    frames(base)
    shown = effect.quad.getShaderInput("image").getTexture()
    assert shown == effect.textures["color"] and not any(buffer.isActive() for buffer in effect.buffers)
    effect.bokeh_scale = 1.0
    frames(base)
    (folder / "color.f16").write_bytes(pixels(base, effect.textures["color"], "e"))
    (folder / "depth.f32").write_bytes(pixels(base, effect.textures["depth"], "f"))
    (folder / "metres.f32").write_bytes(pixels(base, effect.textures["metres"], "f"))

    def pull_focus(_, depths, seconds, tau):
        effect.pull_focus(depths, seconds, tau)
        return effect.focus_distance

    focus, depths = effect.focus_distance, {(x, y): effect.depth_at(x, y) for x, y in POINTS}
    more = {
        "engine": f"Panda3D {PandaSystem.getVersionString()}",
        "device": base.win.getGsg().getDriverRenderer(),
        "pull": captures.pull(pull_focus, scene.SIZE, focus, depths),
        "shots": shots,
    }
    captures.write_description(folder, scene.SIZE, (scene.NEAR, scene.FAR), effect.values, focus, more)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
