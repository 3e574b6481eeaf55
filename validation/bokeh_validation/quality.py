"""How close a method comes to a brute-force gather of the same polygon with the same weights, on real input."""

from dataclasses import replace

import numpy as np

from bokeh_validation import apertures, methods, metrics
from bokeh_validation.drivers.base import Driver
from bokeh_validation.passes import Pass
from bokeh_validation.patterns.model import Case
from bokeh_validation.reference import polygons

# Lattice points across the CoC: 900 and more inside a hexagon and an octagon.
BRUTE_CELLS = 38


def outline(settings: methods.Settings) -> np.ndarray:
    """Corners of the shape that a method blurs into, (N, 2), for a CoC of 1, not mirrored."""
    if settings.method == "exact":
        return apertures.even_polygon(methods.EXACT[settings.aperture], settings.rotation)
    if settings.aperture in apertures.POLYGONS:
        return apertures.rotated(apertures.regular_polygon(apertures.POLYGONS[settings.aperture]), settings.rotation)
    shapes = [shape.corners(settings.rotation) for shape in apertures.PARALLELOGRAMS[settings.aperture]]
    return shapes[0] if len(shapes) == 1 else polygons.clip_convex(*shapes)


def brute_table(corners: np.ndarray, cells: int = BRUTE_CELLS) -> np.ndarray:
    """Midpoints of a square lattice inside a convex polygon, mirrored as a gather needs them, (N, 2), CoC of 1."""
    return -apertures.lattice_kernel(cells, lambda x, y: polygons.inside(corners, x, y))


def brute_force(driver: Driver, case: Case) -> np.ndarray:
    """The polygon of a case gathered by the naive pass with BRUTE_CELLS samples across, (H, W, 4)."""
    table = brute_table(outline(case.settings))
    coc = case.plan.passes[0]
    inputs = {"ColorSamp": "coc", "DepthSamp": "depth", "KernelSamp": "kernel"}
    naive = methods.plan(replace(case.settings, method="naive", aperture="hexagon", spacing=0.0, samples=3), case.size)
    gather = Pass("BokehNaiveGather", inputs, "result", naive.passes[1].parameters, len(table))
    textures = {**case.textures(), "kernel": methods.kernel_texture(table)}
    return driver.run([coc, gather], textures, case.size)["result"]


def distance(driver: Driver, case: Case, truth: np.ndarray | None = None) -> float:
    """Tone-mapped PSNR of a case against its brute force, dB."""
    truth = brute_force(driver, case) if truth is None else truth
    return metrics.psnr(driver.run(case.plan.passes, case.textures(), case.size)["result"], truth)
