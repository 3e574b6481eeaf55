"""Write everything that the shaders read and wrote into a folder, for validation/run engines: python capture.py FOLDER

Your renderer does not need this file. captures.py says what it writes.
"""

import sys
from pathlib import Path

import captures
import moderngl
from depth_of_field import depth_of_field
from renderer import BALL, FAR, NEAR, SIZE, Renderer
from sample import BLUR, DEPTH, IMAGE, LENS, PAPER, focus_at, focus_on, pull_focus, start

# Pixels at which the autofocus measures depth
POINTS = ((304, 82), (190, 128))


def main(folder):
    """Draw every shot with the same frame, focused on the ball, and write the files."""
    context = start()
    renderer = Renderer(context)
    renderer.draw()
    focus = focus_on(BALL)
    shots = []
    for name, table in captures.shots().items():
        passes, result = depth_of_field(context, renderer.color, renderer.depth, table)
        angle = captures.angle(name)
        for step in passes:
            step.draw(BokehFocusDistance=focus, BokehAngle=angle, **LENS, **IMAGE, **DEPTH, **BLUR, **PAPER)
        targets = [target.read() for step in passes for target in step.framebuffer.color_attachments]
        shots.append(captures.write_shot(folder, name, result.read(), targets))
    # the last shot is one of paper, whose first pass converts depth to metres
    (folder / "metres.f32").write_bytes(passes[0].framebuffer.read(components=1, dtype="f4"))
    (folder / "color.f16").write_bytes(renderer.color.read())
    (folder / "depth.f32").write_bytes(renderer.framebuffer.read(components=1, attachment=-1, dtype="f4"))
    depths = {(x, y): focus_at(renderer, x, y) for x, y in POINTS}
    more = {
        "engine": f"OpenGL {context.info['GL_VERSION']}, moderngl {moderngl.__version__}",
        "device": context.info["GL_RENDERER"],
        "pull": captures.pull(pull_focus, SIZE, focus, depths),
        "shots": shots,
    }
    captures.write_description(folder, SIZE, (NEAR, FAR), LENS | BLUR, focus, more)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
