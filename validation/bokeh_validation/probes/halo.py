"""Probe a sharp object in front of a blurred background: how much of its light leaks onto the background."""

from dataclasses import replace
from functools import partial

import numpy as np

from bokeh_validation.frame import methods
from bokeh_validation.probes import two_points
from bokeh_validation.probes.model import Case, Check, Outputs, Probe, depth_of, flat

SIZE = (160, 126)
CAMERA = methods.Camera(aperture_diameter=0.1, focal_length=0.05, focus_distance=2.0, max_coc=0.2)
FAR = 20.0
# nearly in focus: a CoC of 0.0067, or 0.8 pixels here, to which Listing 3 gives a weight of 0.2
OBJECT = 2.0 / (1.0 - 0.0067 * CAMERA.sensor_height / 0.1 * (2.0 - 0.05) / 0.05)
# rows and columns of a block and of a bar
SHAPES = (
    (slice(40, 86), slice(30, 76)),
    (slice(20, 106), slice(110, 118)),
)
TURN = 7.0  # degrees: no edge of the polygon along an edge of the object
NAIVE_SAMPLES = 33  # 817 offsets in the hexagon, 848 in the octagon


def scene() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return colour (H, W, 4), depth (H, W) and where the object is, (H, W) bool. The object is red; the background
    has no red.
    """
    color, depth = flat(SIZE), depth_of(SIZE, FAR)
    y, x = np.mgrid[0 : SIZE[1], 0 : SIZE[0]]
    checker = 0.1 + 0.9 * ((x // 13 + y // 13) % 2)
    color[..., 0], color[..., 1], color[..., 2] = 0.0, 0.6 * checker, checker
    covered = np.zeros(depth.shape, bool)
    for shape in SHAPES:
        covered[shape] = True
    color[covered] = (1.0, 0.0, 0.0, 1.0)
    depth[covered] = OBJECT
    return color, depth, covered


def leaked(red: np.ndarray, covered: np.ndarray) -> float:
    """Return the red (H, W) on the background as a fraction of the object's; pixels next to the object are left out."""
    return float(red[~two_points.grown(covered)].sum() / covered.sum())


def _judge(covered: np.ndarray, outputs: dict[str, Outputs]) -> list[Check]:
    exact, naive, untested = (leaked(textures["result"][..., 0], covered) for textures in outputs.values())
    why = "exact approximates a gather in two dimensions with the same weights: no more than that may leak"
    must = "the object must have light to leak, or this probe shows nothing"
    return [
        Check("light of the object on the background, exact / naive", exact / naive, 0.0, 1.0, why),
        Check("the same, naive without the leakage test / naive with it", untested / naive, 2.0, float("inf"), must),
    ]


def probe(aperture: str) -> Probe:
    """Return the probe of one polygon: exact and the naive gather at one sample per pixel."""
    color, depth, covered = scene()
    dense = methods.Settings("exact", aperture, rotation=TURN, camera=CAMERA, spacing=1.0, samples=33)
    naive = methods.Settings("naive", aperture, NAIVE_SAMPLES, TURN, CAMERA)
    settings_by_label = {"exact": dense, "naive": naive, "naive, no test": replace(naive, leak_fix=False)}
    cases = tuple(Case(label, settings, color, depth) for label, settings in settings_by_label.items())
    title = f"A sharp object leaks no more than by a gather in two dimensions, {aperture}"
    shows = "A red object, nearly in focus, with no red around it but what its own small CoC spreads."
    return Probe(f"halo-{aperture}", title, shows, cases, partial(_judge, covered), aperture != "octagon")


PROBES = tuple(probe(aperture) for aperture in ("hexagon", "octagon"))
