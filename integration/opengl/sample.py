"""Draw an image with depth of field, without a window: python sample.py picture.png"""

import sys
from math import exp, inf, tan

import moderngl
import numpy as np
from apertures import DEBUG, OCTAGON
from depth_of_field import depth_of_field
from PIL import Image
from renderer import BALL, FAR, FIELD_OF_VIEW, NEAR, SIZE, Renderer, view

# the blur has the lens that belongs to the field of view, at f/1.4 with a bokeh scale of 1: docs/lens.md
FOCAL_LENGTH = 0.024 / (2.0 * tan(0.5 * FIELD_OF_VIEW))
LENS = dict(BokehApertureDiameter=FOCAL_LENGTH / 1.4, BokehFocalLength=FOCAL_LENGTH, BokehSensorHeight=0.024)
IMAGE = dict(BokehAspectRatio=SIZE[0] / SIZE[1], BokehImageWidth=SIZE[0], BokehImageHeight=SIZE[1])
DEPTH = dict(BokehDepthKind=1.0, BokehNear=NEAR, BokehFar=FAR)
BLUR = dict(BokehMaxCoC=0.12, BokehSqueeze=1.0, BokehBleedingBias=0.02, BokehBleedingMult=30.0)
# uniforms that only paper needs
PAPER = dict(BokehBlurCoC=1.0, BokehLineLength=1.0)


def focus_on(world):
    """Return the focus distance for a point of the world: its depth along the view axis, metres."""
    return -(view() @ [*world, 1.0])[2]


def focus_at(renderer, x, y):
    """Return the focus distance for a pixel, metres: reads one texel of the depth buffer. Waits for the GPU.

    x, y  pixels, counted from the lower left
    """
    texel = renderer.framebuffer.read((x, y, 1, 1), components=1, attachment=-1, dtype="f4")
    return NEAR * FAR / (FAR - float(np.frombuffer(texel, "f4")[0]) * (FAR - NEAR))


def pull_focus(distance, depths, seconds, tau=0.2):
    """Return the new focus distance of an autofocus that moves smoothly to the nearest of several depths: docs/lens.md.

    distance  current focus distance, metres
    depths    metres along the view axis
    seconds   time since the last call; if it is infinite, the focus arrives at once
    tau       time constant, seconds
    """
    k = 1.0 - exp(-seconds / tau)
    return 1.0 / ((1.0 - k) / distance + k / min(depths))


def start():
    """Create an OpenGL context without a window."""
    return moderngl.create_context(standalone=True, require=330, backend="egl")


def main(path):
    """Write an image of four parts: the input, a hexagon, the near and far field, and an octagon with another focus.

    path  of the image file
    """
    context = start()
    renderer = Renderer(context)
    renderer.draw()

    passes, result = depth_of_field(context, renderer.color, renderer.depth)
    for step in passes:
        step.draw(BokehFocusDistance=focus_on(BALL), **LENS, **IMAGE, **DEPTH, **BLUR)
    hexagon = renderer.picture(result)

    # focus on the nearest of two points, at once
    picked = pull_focus(focus_on(BALL), [focus_at(renderer, 304, 82), focus_at(renderer, 190, 200)], inf)
    passes, result = depth_of_field(context, renderer.color, renderer.depth, OCTAGON)
    for step in passes:
        step.draw(BokehFocusDistance=picked, **LENS, **IMAGE, **DEPTH, **BLUR)
    octagon = renderer.picture(result)

    passes, result = depth_of_field(context, renderer.color, renderer.depth, DEBUG)
    for step in passes:
        step.draw(BokehFocusDistance=focus_on(BALL), BokehDebugMode=3.0, **LENS, **IMAGE, **DEPTH, **BLUR)
    fields = renderer.picture(result)

    rows = [[renderer.picture(renderer.color), hexagon], [fields, octagon]]
    Image.fromarray(np.vstack([np.hstack(row) for row in rows])).save(path, optimize=True)
    device = context.info["GL_RENDERER"]
    print(f"{path}: {device}; focus at {focus_on(BALL):.3f} m on the ball, at {picked:.3f} m by autofocus")


if __name__ == "__main__":
    main(sys.argv[1])
