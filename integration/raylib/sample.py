"""Draw an image with raylib and depth of field: python sample.py picture.png"""

import sys
from math import exp, inf, radians, tan
from struct import unpack_from

import raylib as rl
from apertures import DEBUG, OCTAGON
from depth_of_field import FLOAT, FullScreenPass, depth_of_field, shader, texture
from raylib import ffi
from scene import DRUM, EYE, FAR, FIELD_OF_VIEW, NEAR, SIZE, TARGET, Scene

# the blur has the lens that belongs to the field of view, at f/2 with a bokeh scale of 10: docs/lens.md
FOCAL_LENGTH = 0.024 / (2.0 * tan(0.5 * radians(FIELD_OF_VIEW)))
PARAMETERS = {
    "BokehDepthKind": 1.0,
    "BokehNear": NEAR,
    "BokehFar": FAR,
    "BokehApertureDiameter": 10.0 * FOCAL_LENGTH / 2.0,
    "BokehFocalLength": FOCAL_LENGTH,
    "BokehSensorHeight": 0.024,
    "BokehMaxCoC": 0.1,
    "BokehAspectRatio": SIZE[0] / SIZE[1],
    "BokehImageWidth": SIZE[0],
    "BokehImageHeight": SIZE[1],
    "BokehSqueeze": 1.0,
    "BokehBleedingBias": 0.02,
    "BokehBleedingMult": 30.0,
}
# uniforms that only paper needs
PAPER = {"BokehBlurCoC": 1.0, "BokehLineLength": 1.0}

TONE_MAPPING = """
#version 330
uniform sampler2D image;
in vec2 BokehUV;
out vec4 color;
void main()
{
    vec3 hdr = textureLod(image, BokehUV, 0.0).rgb;
    color = vec4(pow(hdr / (1.0 + hdr), vec3(1.0 / 2.2)), 1.0);
}
"""


def start():
    """Open a hidden window, because raylib has no OpenGL context without a window."""
    rl.SetTraceLogLevel(rl.LOG_WARNING)
    rl.SetConfigFlags(rl.FLAG_WINDOW_HIDDEN)
    rl.InitWindow(*SIZE, b"bokeh")


def focus_on(place):
    """Return the focus distance for a point of the world: its depth along the view axis, metres."""
    forward = [target - eye for target, eye in zip(TARGET, EYE, strict=True)]
    length = sum(part * part for part in forward) ** 0.5
    return sum((there - eye) * part for there, eye, part in zip(place, EYE, forward, strict=True)) / length


def read(image, texel):
    """Return the bytes of a texture, row by row, beginning at v = 0. Waits for the GPU.

    texel  number of bytes per texel
    """
    pixels = rl.rlReadTexturePixels(image.id, image.width, image.height, image.format)
    found = bytes(ffi.buffer(pixels, image.width * image.height * texel))
    rl.MemFree(pixels)
    return found


def metres_of(depth):
    """Return a texture with the depth buffer in metres.

    A pass draws it, because raylib cannot read the depth buffer back.
    """
    step = FullScreenPass(shader("LINEAR_DEPTH"), {"BokehDepthSamp": depth}, [texture(*SIZE, FLOAT)], {})
    step.draw(**PARAMETERS)
    return step.targets[0]


def focus_at(metres, x, y):
    """Return the focus distance for a pixel, metres: one texel of metres_of(). Waits for the GPU.

    x, y  pixels, counted from the lower left
    """
    return unpack_from("f", read(metres, 4), 4 * (y * metres.width + x))[0]


def pull_focus(distance, depths, seconds, tau=0.2):
    """Return the new focus distance of an autofocus that moves smoothly to the nearest of several depths: docs/lens.md.

    distance  current focus distance, metres
    depths    metres along the view axis
    seconds   time since the last call; if it is infinite, the focus arrives at once
    tau       time constant, seconds
    """
    k = 1.0 - exp(-seconds / tau)
    return 1.0 / ((1.0 - k) / distance + k / min(depths))


def picture(image):
    """Return the bytes of a texture, tone-mapped for the screen: a list of rows, top row first."""
    shown = texture(*SIZE, rl.PIXELFORMAT_UNCOMPRESSED_R8G8B8A8)
    FullScreenPass(TONE_MAPPING, {"image": image}, [shown], {}).draw()
    pixels, row = read(shown, 4), 4 * SIZE[0]
    return [pixels[start : start + row] for start in range(len(pixels) - row, -1, -row)]


def main(path):
    """Write an image of four parts: the input, a hexagon, the near and far field, and an octagon with another focus.

    path  of the image file
    """
    start()
    scene = Scene()
    scene.draw()

    passes, result = depth_of_field(scene.color, scene.depth)
    for step in passes:
        step.draw(BokehFocusDistance=focus_on(DRUM), **PARAMETERS)

    fields, view = depth_of_field(scene.color, scene.depth, DEBUG)
    for step in fields:
        step.draw(BokehFocusDistance=focus_on(DRUM), BokehDebugMode=3.0, **PARAMETERS)

    metres = metres_of(scene.depth)
    # focus on the nearest of two points, at once
    picked = pull_focus(focus_on(DRUM), [focus_at(metres, 150, 215), focus_at(metres, 5, 250)], inf)
    octagon, other = depth_of_field(scene.color, scene.depth, OCTAGON)
    for step in octagon:
        step.draw(BokehFocusDistance=picked, **PARAMETERS)

    pairs = ((scene.color, result), (view, other))
    rows = [left + right for pair in pairs for left, right in zip(*map(picture, pair), strict=True)]
    sheet = ffi.from_buffer(b"".join(rows))
    form = (2 * SIZE[0], 2 * SIZE[1], 1, rl.PIXELFORMAT_UNCOMPRESSED_R8G8B8A8)
    if not rl.ExportImage(ffi.new("Image *", (sheet, *form))[0], path.encode()):
        sys.exit(f"cannot write {path}")
    print(f"{path}: focus at {focus_on(DRUM):.3f} m on the drum, at {picked:.3f} m by autofocus")


if __name__ == "__main__":
    main(sys.argv[1])
