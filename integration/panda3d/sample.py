"""Panda3D with depth of field: python sample.py picture.png"""

import sys
from math import inf

import scene
from bokeh_panda3d import DepthOfField
from direct.showbase.ShowBase import ShowBase
from panda3d.core import PNMImage, loadPrcFileData


def start():
    """Panda3D without a window."""
    loadPrcFileData("", f"win-size {scene.SIZE[0]} {scene.SIZE[1]}")
    # not where there is a screen
    loadPrcFileData("", "load-display p3headlessgl\nwindow-type offscreen\naudio-library-name null\nmodel-cache-dir")
    return ShowBase()


def frames(base, count=2):
    """Draw so many."""
    for _ in range(count):
        base.taskMgr.step()


def picture(base, effect, name="result"):
    """What the window shows of a texture."""
    effect.quad.setShaderInput("image", effect.textures[name])
    frames(base)
    shot = PNMImage()
    base.win.getScreenshot(shot)
    return shot


def main(path):
    """Four pictures in one: the input, a hexagon, near and far field, an octagon with the focus elsewhere."""
    base = start()
    panda = scene.build(base)

    effect = DepthOfField(base.win, base.cam, f_stop=1.4, bokeh_scale=1.0)
    effect.parameters["BokehMaxCoC"] = 0.12
    effect.focus_on(panda)
    shots = [picture(base, effect, "color"), picture(base, effect)]

    effect.change("debug")
    effect.parameters["BokehDebugMode"] = 3.0
    shots.append(picture(base, effect))

    effect.change(sides=8)
    # several points, and no pull: where it ends
    effect.pull_focus([effect.depth_at(304, 82), effect.depth_at(5, 250)], inf)
    shots.append(picture(base, effect))

    width, height = scene.SIZE
    sheet = PNMImage(2 * width, 2 * height)
    for index, shot in enumerate(shots):
        sheet.copySubImage(shot, index % 2 * width, index // 2 * height)
    sheet.write(path)
    print(base.win.getGsg().getDriverRenderer(), effect.focus_distance)


if __name__ == "__main__":
    main(sys.argv[1])
