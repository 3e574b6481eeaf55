"""Write everything that the shaders read and wrote into a folder, for validation/run engines: python capture.py FOLDER

Your program does not need this file. ../opengl/captures.py says what it writes.
"""

import sys
from pathlib import Path

import raylib as rl
from depth_of_field import depth_of_field
from raylib import ffi
from sample import PAPER, PARAMETERS, focus_at, focus_on, pull_focus, read, start
from scene import DRUM, FAR, NEAR, SIZE, Scene

# at the end, because the other modules of that folder have the names of those here
sys.path.append(str(Path(__file__).resolve().parent.parent / "opengl"))
import captures  # noqa: E402

RENDERER, GL_VERSION = 0x1F01, 0x1F02
# Pixels at which the autofocus measures depth
POINTS = ((150, 215), (5, 250))


def gl_string(name):
    """Return a string of OpenGL: calls glGetString."""
    function = ffi.cast("const char *(*)(unsigned int)", rl.rlGetProcAddress(b"glGetString"))
    return ffi.string(function(name)).decode()


def main(folder):
    """Draw every shot with the same frame, focused on the drums, and write the files."""
    start()
    scene = Scene()
    scene.draw()
    focus = focus_on(DRUM)
    shots = []
    for name, table in captures.shots().items():
        passes, result = depth_of_field(scene.color, scene.depth, table)
        for step in passes:
            step.draw(BokehFocusDistance=focus, BokehAngle=captures.angle(name), **PARAMETERS, **PAPER)
        written = [target for step in passes for target in step.targets] if name.startswith("layered") else []
        shots.append(captures.write_shot(folder, name, read(result, 8), [read(target, 8) for target in written]))
    (folder / "color.f16").write_bytes(read(scene.color, 8))
    # the last shot is one of paper, whose first pass converts depth to metres
    metres = passes[0].targets[0]
    (folder / "metres.f32").write_bytes(read(metres, 4))
    found = {(x, y): focus_at(metres, x, y) for x, y in POINTS}
    # depth kind 0 means metres, so the same pass now copies the values of the depth buffer unchanged
    passes[0].draw(**PARAMETERS | {"BokehDepthKind": 0.0})
    (folder / "depth.f32").write_bytes(read(metres, 4))
    more = {
        "engine": f"raylib {rl.RAYLIB_VERSION}, OpenGL {gl_string(GL_VERSION)}",
        "device": gl_string(RENDERER),
        "pull": captures.pull(pull_focus, SIZE, focus, found),
        "shots": shots,
    }
    captures.write_description(folder, SIZE, (NEAR, FAR), PARAMETERS, focus, more)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
