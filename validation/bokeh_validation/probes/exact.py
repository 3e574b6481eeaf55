"""The exact polygons: shape, light and flatness for every rotation."""

from functools import partial

import numpy as np

from bokeh_validation.frame import methods, polygons
from bokeh_validation.probes.highlight import AMBIENT, HALF_LIGHT, PEAK, Bokeh, block, polygon_of
from bokeh_validation.probes.model import Case, Check, Outputs, Probe, depth_of, flat, pixel_center

SIZE = (144, 112)  # not square, so that a missing aspect ratio shows
COC = 80  # pixels
CENTER = (72, 56)
# Rotations in degrees, of the bright pixel and of the wide highlight; one for a first answer: no polygon has an edge
# along the pixels
ROTATIONS, ONE_TURN = ((0.0, 7.0, 22.5, 45.0), (0.0, 22.5)), ((7.0,), (7.0,))
BLOCK, BLOCK_LEVEL = 9, PEAK / 16  # the wide highlight: its side in pixels, and its brightness

# What is asked of the overlap with the analytic polygon at a sample a pixel. The samples of one pixel are tents on a
# lattice that is not aligned with the pixels: in the square their sum ripples most.
OVERLAP = {"square": 0.86, "hexagon": 0.92, "octagon": 0.92, "decagon": 0.92}
FLATNESS = 0.05


def settings(aperture: str, rotation: float, size: tuple[int, int] = SIZE, coc: float = COC) -> methods.Settings:
    """The exact method at a sample a pixel, with a CoC of `coc` pixels everywhere."""
    dense = {"coc": coc / size[1], "spacing": 1.0, "samples": 2 * COC + 1}
    return methods.Settings("exact", aperture, rotation=rotation, camera=methods.Camera(max_coc=1.0), **dense)


def bokeh(aperture: str, rotation: float) -> Bokeh:
    """Of a bright pixel in the middle; its area is the same to the bit at every rotation."""
    area = abs(polygons.signed_area(polygon_of(aperture, 0.0, COC)))
    return Bokeh(polygon_of(aperture, rotation, COC), SIZE, pixel_center(*CENTER), area)


def impulse_case(aperture: str, rotation: float) -> Case:
    """One bright pixel."""
    return bokeh(aperture, rotation).case(f"{rotation:g} degrees", settings(aperture, rotation))


def block_case(aperture: str, rotation: float) -> Case:
    """A bright square of BLOCK pixels."""
    image = flat(SIZE, AMBIENT)
    image[block(CENTER, BLOCK)][..., :3] += BLOCK_LEVEL
    label, exposure = f"wide highlight, {rotation:g} degrees", bokeh(aperture, 0.0).exposure(BLOCK_LEVEL * BLOCK**2)
    return Case(label, settings(aperture, rotation), image, depth_of(SIZE, 10.0), exposure=exposure)


def shape_checks(aperture: str, rotation: float, value: np.ndarray, light_tolerance: float) -> list[Check]:
    """Light and overlap of a bright pixel, (H, W) float64 without the ambient light."""
    return bokeh(aperture, rotation).checks(f"{rotation:g} degrees", value / PEAK, light_tolerance, OVERLAP[aperture])


def flatness_check(aperture: str, rotation: float, value: np.ndarray) -> Check:
    """Largest distance from flat inside the blur of the block, (H, W) float64 without the ambient light."""
    shape = bokeh(aperture, rotation)
    # inside for every pixel of the block, and 2 pixels from the edge
    margin = BLOCK / 2 * np.sqrt(2.0) + 2.0
    apothem = COC / 2 * np.cos(np.pi / methods.EXACT[aperture])
    inner = polygons.coverage(shape.corners * (1 - margin / apothem), SIZE, shape.middle) == 1
    off = np.abs(value[inner] / (BLOCK_LEVEL * BLOCK**2 / shape.area) - 1).max()
    return Check(f"wide highlight off from flat by, {rotation:g} degrees", off, 0.0, FLATNESS, "no seam: asked for")


def _judge(aperture: str, turns: tuple, outputs: dict[str, Outputs]) -> list[Check]:
    values = [textures["result"][..., 1] - AMBIENT for textures in outputs.values()]
    points, checks = len(turns[0]), []
    for turn, value in zip(turns[0], values[:points], strict=True):
        checks += shape_checks(aperture, turn, value, HALF_LIGHT)
    wide = zip(turns[1], values[points:], strict=True)
    return checks + [flatness_check(aperture, turn, value) for turn, value in wide]


def probe(aperture: str, turns: tuple = ROTATIONS) -> Probe:
    """The probe of one polygon."""
    points, blocks = turns
    cases = [impulse_case(aperture, turn) for turn in points] + [block_case(aperture, turn) for turn in blocks]
    degrees = ", ".join(f"{turn:g}" for turn in points)
    title = f"One bright pixel becomes a {aperture} of the same light"
    shows = f"A {aperture} of CoC {COC} pixels at {degrees} degrees, of the right brightness, and flat without a seam."
    return Probe(f"exact-{aperture}", title, shows, tuple(cases), partial(_judge, aperture, turns))


PROBES = tuple(probe(aperture) for aperture in methods.EXACT)
QUICK_PROBES = tuple(probe(aperture, ONE_TURN) for aperture in methods.EXACT)
