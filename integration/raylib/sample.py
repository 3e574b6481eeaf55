"""raylib with depth of field: python sample.py picture.png"""

import sys
from math import exp, inf, radians, tan
from struct import unpack_from

import raylib as rl
from apertures import DEBUG, OCTAGON
from depth_of_field import FLOAT, FullScreenPass, depth_of_field, shader, texture
from raylib import ffi
from scene import DRUM, EYE, FAR, FIELD_OF_VIEW, NEAR, SIZE, TARGET, Scene

# the lens of the blur is the lens of the picture, at f/2, its blur ten times as wide: docs/lens.md
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
# the paper's method has these as well
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
    """A window that is not shown. raylib has no OpenGL without one."""
    rl.SetTraceLogLevel(rl.LOG_WARNING)
    rl.SetConfigFlags(rl.FLAG_WINDOW_HIDDEN)
    rl.InitWindow(*SIZE, b"bokeh")


def focus_on(place):
    """Focus distance for a place in the world: its depth along the view axis, metres."""
    forward = [target - eye for target, eye in zip(TARGET, EYE, strict=True)]
    length = sum(part * part for part in forward) ** 0.5
    return sum((there - eye) * part for there, eye, part in zip(place, EYE, forward, strict=True)) / length


def read(image, texel):
    """Bytes of a texture with `texel` bytes a texel, v = 0 first."""
    pixels = rl.rlReadTexturePixels(image.id, image.width, image.height, image.format)
    found = bytes(ffi.buffer(pixels, image.width * image.height * texel))
    rl.MemFree(pixels)
    return found


def metres_of(depth):
    """The depth buffer in metres, by a pass of its own: raylib cannot read the buffer itself."""
    step = FullScreenPass(shader("LINEAR_DEPTH"), {"BokehDepthSamp": depth}, [texture(*SIZE, FLOAT)], {})
    step.draw(**PARAMETERS)
    return step.targets[0]


def focus_at(metres, x, y):
    """Focus distance for a pixel, counted from the lower left: one texel of metres_of()."""
    return unpack_from("f", read(metres, 4), 4 * (y * metres.width + x))[0]


def pull_focus(distance, depths, seconds, tau=0.2):
    """Autofocus: the distance after so many seconds more on its way to the nearest of the depths: docs/lens.md."""
    k = 1.0 - exp(-seconds / tau)
    return 1.0 / ((1.0 - k) / distance + k / min(depths))


def picture(image):
    """Rows of bytes of a texture, tone-mapped, first row on top."""
    shown = texture(*SIZE, rl.PIXELFORMAT_UNCOMPRESSED_R8G8B8A8)
    FullScreenPass(TONE_MAPPING, {"image": image}, [shown], {}).draw()
    pixels, row = read(shown, 4), 4 * SIZE[0]
    return [pixels[start : start + row] for start in range(len(pixels) - row, -1, -row)]


def main(path):
    """Four pictures in one: the input, hexagon, near and far field, octagon with the focus elsewhere."""
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
    # several points, and no pull: where it ends
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
    print(f"{path}: focus on the drum {focus_on(DRUM):.3f} m, picked {picked:.3f} m")


if __name__ == "__main__":
    main(sys.argv[1])
