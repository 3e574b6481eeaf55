"""Describe the shape that a method blurs into, and compute the same blur by a brute-force gather."""

from dataclasses import replace

import numpy as np

from bokeh_validation.drivers.base import Driver
from bokeh_validation.frame import aperture_shapes, geometry, methods
from bokeh_validation.probes.model import Case
from bokeh_validation.shaders.passes import Pass

# Lattice points across the CoC; a hexagon or octagon then contains at least 900.
BRUTE_CELLS = 38


def outline(settings: methods.Settings) -> np.ndarray:
    """Return the corners of the shape that a method blurs into, (N, 2), for a CoC of 1, not mirrored."""
    if settings.method == "exact":
        return aperture_shapes.even_polygon(methods.EXACT[settings.aperture], settings.rotation)
    if settings.aperture in aperture_shapes.POLYGONS:
        return aperture_shapes.rotated(
            aperture_shapes.regular_polygon(aperture_shapes.POLYGONS[settings.aperture]), settings.rotation
        )
    shapes = [shape.corners(settings.rotation) for shape in aperture_shapes.PARALLELOGRAMS[settings.aperture]]
    return shapes[0] if len(shapes) == 1 else geometry.clip_convex(*shapes)


def brute_force(driver: Driver, case: Case, cells: int = BRUTE_CELLS) -> np.ndarray:
    """Gather the polygon of a case with the naive pass, with `cells` samples across; returns (H, W, 4).

    The gather reads the case's own CoC map without its signs, since the methods' maps differ next to lights.
    """
    corners = outline(case.settings)
    # points of a square lattice, mirrored as a gather needs them
    table = -aperture_shapes.lattice_kernel(cells, lambda x, y: geometry.inside(corners, x, y))
    inputs = {"ColorSamp": "coc", "DepthSamp": "depth", "KernelSamp": "kernel"}
    naive = methods.plan(replace(case.settings, method="naive", aperture="hexagon", spacing=0.0, samples=3), case.size)
    gather = Pass("BokehNaiveGather", inputs, "result", naive.passes[1].parameters, len(table))
    coc = driver.run(case.plan.passes[:1], case.textures(), case.size, keep=("coc",))["coc"]
    coc[..., 3] = np.abs(coc[..., 3])
    textures = {**case.textures(), "coc": coc, "kernel": methods.kernel_texture(table)}
    return driver.run([gather], textures, case.size)["result"]
