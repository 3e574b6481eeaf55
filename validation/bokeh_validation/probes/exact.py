"""Probe the exact polygons for shape, light and flatness. test_exact.py covers other rotations."""

from functools import partial

import numpy as np

from bokeh_validation.frame import geometry, methods
from bokeh_validation.probes.highlight import AMBIENT, HALF_LIGHT, PEAK, Bokeh, block, polygon_of
from bokeh_validation.probes.model import Case, Check, Outputs, Probe, depth_of, flat, pixel_center

SIZE = (144, 112)  # not square, so that a missing aspect ratio shows
COC = 80  # pixels
CENTER = (72, 56)
ROTATION = 7.0  # degrees: no polygon has an edge along the pixels
BLOCK, BLOCK_LEVEL = 9, PEAK / 16  # a wide highlight: its side in pixels, and its brightness

# Minimum overlap with the analytic polygon at one sample per pixel. The samples of a pixel are tents on a lattice that
# is not aligned with the pixels; in the square their sum ripples most.
OVERLAP = {"square": 0.86, "hexagon": 0.92, "octagon": 0.92, "decagon": 0.92}
FLATNESS = 0.05


def settings(
    aperture: str, rotation: float = ROTATION, size: tuple[int, int] = SIZE, coc: float = COC
) -> methods.Settings:
    """Return the exact method at one sample per pixel, with a CoC of `coc` pixels everywhere. `rotation` is in
    degrees.
    """
    dense = {"coc": coc / size[1], "spacing": 1.0, "samples": 2 * COC + 1}
    return methods.Settings("exact", aperture, rotation=rotation, camera=methods.Camera(max_coc=1.0), **dense)


def bokeh(aperture: str, rotation: float = ROTATION) -> Bokeh:
    """Return the bokeh of a bright pixel in the middle."""
    return Bokeh(polygon_of(aperture, rotation, COC), SIZE, pixel_center(*CENTER))


def _judge(aperture: str, outputs: dict[str, Outputs]) -> list[Check]:
    point, wide = (textures["result"][..., 1] - AMBIENT for textures in outputs.values())
    shape = bokeh(aperture)
    # every pixel of the block sees this area in full, and it ends 2 pixels before the edge
    margin = BLOCK / 2 * np.sqrt(2.0) + 2.0
    apothem = COC / 2 * np.cos(np.pi / methods.EXACT[aperture])
    inner = geometry.coverage(shape.corners * (1 - margin / apothem), SIZE, shape.middle) == 1
    unevenness = np.abs(wide[inner] / (BLOCK_LEVEL * BLOCK**2 / shape.area) - 1).max()
    return [
        *shape.checks("one pixel", point / PEAK, HALF_LIGHT, OVERLAP[aperture]),
        Check("wide highlight off from flat by", unevenness, 0.0, FLATNESS, "no seam: asked for"),
    ]


def probe(aperture: str) -> Probe:
    """Return the probe of one polygon: a single bright pixel, and a bright square of BLOCK pixels."""
    image, probe_settings = flat(SIZE, AMBIENT), settings(aperture)
    image[block(CENTER, BLOCK)][..., :3] += BLOCK_LEVEL
    wide = Case("wide highlight", probe_settings, image, depth_of(SIZE, 10.0))
    title = f"One bright pixel becomes a {aperture} of the same light"
    shows = f"A {aperture} of CoC {COC} pixels, of the right brightness, and flat without a seam."
    return Probe(
        f"exact-{aperture}",
        title,
        shows,
        (bokeh(aperture).case("one pixel", probe_settings), wide),
        partial(_judge, aperture),
        aperture not in ("octagon", "decagon"),
    )


PROBES = tuple(probe(aperture) for aperture in methods.EXACT)
