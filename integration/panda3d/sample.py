"""Write an image of Panda3D with depth of field: python sample.py picture.png"""

import sys
from math import inf

import scene
from bokeh_panda3d import DepthOfField
from direct.showbase.ShowBase import ShowBase
from panda3d.core import PNMImage, loadPrcFileData


def start():
    """Start Panda3D without a window."""
    loadPrcFileData("", f"win-size {scene.SIZE[0]} {scene.SIZE[1]}")
    # leave this line out if you want a window
    loadPrcFileData("", "load-display p3headlessgl\nwindow-type offscreen\naudio-library-name null\nmodel-cache-dir")
    return ShowBase()


def frames(base, count=2):
    """Draw so many frames."""
    for _ in range(count):
        base.taskMgr.step()


def picture(base, effect, name="result"):
    """Return an image of the window while it shows a texture of the effect."""
    effect.quad.setShaderInput("image", effect.textures[name])
    frames(base)
    shot = PNMImage()
    base.win.getScreenshot(shot)
    return shot


def main(path):
    """Write four images into one file: the input, a hexagon, near and far field, and an octagon with another focus."""
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
    # the nearest of two points; after an infinite time, the focus has reached it
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
