"""Probe a light that leaves the image.

Without a guard band it flashes: reads beyond the border return the last row or column again.
"""

from collections.abc import Mapping

from bokeh_validation.frame.methods import Camera, Settings
from bokeh_validation.probes.model import Case, Check, Outputs, Probe, depth_of, flat

SIZE, GUARD = (240, 160), 24
COC = 40  # pixels
LIGHT, SIDE = 100.0, 4
# two stores in half floats, and the linear filter's error for a position off by 1e-5 of a pixel
STEPS = 2.0**-9


def _case(label: str, guard: int, column: int) -> Case:
    """Return a case with a light of SIDE x SIDE pixels in the middle row.

    guard   pixels drawn beyond each border of the visible image
    column  first column of the light in the visible image
    """
    size = SIZE[0] + 2 * guard, SIZE[1] + 2 * guard
    color = flat(size)
    top, left = size[1] // 2, guard + column
    color[top : top + SIDE, left : left + SIDE, :3] = LIGHT
    settings = Settings("exact", "hexagon", 33, camera=Camera(max_coc=1.0), coc=COC / size[1], spacing=1.0)
    return Case(label, settings, color, depth_of(size, 5.0))


def _judge(outputs: Mapping[str, Outputs]) -> list[Check]:
    pixels = {
        label: outputs[label]["result"][guard : guard + SIZE[1], guard : guard + SIZE[0], 1]
        for label, guard in (("in the middle", 0), ("without", 0), ("with", GUARD))
    }
    # what the light in the middle shows to the right of its first column
    right_half = pixels["in the middle"][:, SIZE[0] // 2 :]
    peak, light = right_half.max(), right_half.sum()
    repeated = "the light's columns count again for each one that is read beyond the border"
    same_light = "beyond the border is what there is: the same light, moved by whole pixels"
    return [
        Check("peak at the border (of that in the middle)", pixels["without"].max() / peak, 2.0, 8.0, repeated),
        Check("light at the border", pixels["without"].sum() / light, 1.2, 4.0, repeated),
        Check("peak with a guard band", pixels["with"].max() / peak, 1.0 - STEPS, 1.0 + STEPS, same_light),
        Check("light with a guard band", pixels["with"].sum() / light, 1.0 - STEPS, 1.0 + STEPS, same_light),
    ]


PROBES = (
    Probe(
        "border",
        "A light that leaves the picture",
        "It flashes as it goes; where more is drawn than is shown, it does not.",
        (
            _case("in the middle", 0, SIZE[0] // 2),
            _case("without", 0, 0),
            _case("with", GUARD, 0),
        ),
        _judge,
        brief=False,
    ),
)
