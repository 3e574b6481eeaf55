"""Probe two bright pixels (Figures 12 and 13): the paper's min and max must show their known artefacts."""

from functools import partial

import numpy as np

from bokeh_validation.frame import aperture_shapes, geometry
from bokeh_validation.probes import impulse
from bokeh_validation.probes.highlight import AMBIENT
from bokeh_validation.probes.model import Check, Outputs, Probe, pixel_center

SIZE = (160, 128)
# Second point relative to the first, pixels, for a CoC of 36: chosen so that a corner discarded by min around one
# point falls on a corner discarded around the other. Found by scanning the analytic shapes for the most light in false
# shapes.
OFFSETS = {"hexagon": (0, 38), "octagon": (38, 16), "star": (36, 16)}


def ripple(aperture: str) -> float:
    """Return how far the sum of the bilinear samples of a parallelogram's two lines departs from a constant, relative.

    A wide blur of a point is a lattice of tent filters, one for each pair of samples. If the lattice is not aligned
    with the pixels, their sum varies: by 34 % at one sample per pixel and 45 degrees, by 5 % at two.
    """
    spacing = impulse.COC / (impulse.SAMPLES - 1)
    shape = aperture_shapes.PARALLELOGRAMS[aperture][-1]
    along, across = (aperture_shapes.direction(np.radians(angle)) for angle in (shape.first, shape.second))
    steps = np.arange(-10.0, 10.0 + spacing, spacing)
    i, j = np.meshgrid(steps, steps)
    lattice = i[..., None] * along + j[..., None] * across
    cell = spacing**2 * abs(along[0] * across[1] - along[1] * across[0])
    places = np.stack(np.meshgrid(*[np.linspace(0.0, 1.0, 11)] * 2), axis=-1).reshape(-1, 2)
    sums = [np.maximum(0.0, 1.0 - np.abs(lattice - pixel)).prod(axis=-1).sum() * cell for pixel in places]
    return float(np.abs(np.array(sums) - 1.0).max())


def points(aperture: str) -> tuple[tuple[int, int], tuple[int, int]]:
    """Return both pixels, (column, row) each, around the middle of the image."""
    dx, dy = OFFSETS[aperture]
    first = ((SIZE[0] - dx) // 2, (SIZE[1] - dy) // 2)
    return first, (first[0] + dx, first[1] + dy)


def _analytic(aperture: str) -> tuple[np.ndarray, np.ndarray]:
    """Return two images (H, W) in units of the plateau: the sum of both apertures, and the result of the paper's
    method.

    In the paper's method each parallelogram's blur contains both points before min or max combines them.
    """
    combine = np.maximum if aperture in aperture_shapes.USES_MAX else np.minimum
    first, second = (
        [geometry.coverage(shape, SIZE, pixel_center(*point)) for shape in impulse.parallelograms(aperture, 0.0)]
        for point in points(aperture)
    )
    return combine(*first) + combine(*second), combine(first[0] + second[0], first[1] + second[1])


def _judge_min(aperture: str, outputs: dict[str, Outputs]) -> list[Check]:
    value = (outputs["two points"]["result"][..., 1] - AMBIENT) / impulse.plateau(aperture)
    truth, predicted = _analytic(aperture)
    # a pixel away from the true shapes, so that their soft edges are not taken for false light
    outside = grown(truth > 0) == 0
    light = truth.sum() / 2
    false_light, predicted_light = value[outside].sum() / light, predicted[outside].sum() / light
    border = 0.5 * _boundary_pixels(predicted * outside) / light
    light_minimum, light_maximum = max(predicted_light - border, 0.25 * predicted_light), predicted_light + border
    why = "the analytic false shape, its boundary known to half a pixel; it must not be zero"
    bright = "both blurs have light 1, within the ripple of their samples"
    return [
        Check("light in false shapes (fraction of one highlight)", false_light, light_minimum, light_maximum, why),
        Check("brightest false pixel (plateaus)", value[outside].max(), 0.5, 1 + ripple(aperture), bright),
    ]


def _judge_max(aperture: str, outputs: dict[str, Outputs]) -> list[Check]:
    value = (outputs["two points"]["result"][..., 1] - AMBIENT) / impulse.plateau(aperture)
    truth, predicted = _analytic(aperture)
    # where the formula predicts that one of two highlights is missing, without a border of one pixel
    missing = truth - predicted > 0.5
    inner, ripple_bound = ~grown(~missing), ripple(aperture)
    light_shown, predicted_fraction = (image[inner].mean() / truth[inner].mean() for image in (value, predicted))
    why = f"the analytic shapes give {predicted_fraction:.3f}, within the ripple of the samples"
    low, high = predicted_fraction - ripple_bound, predicted_fraction + ripple_bound
    return [
        Check("area with light missing (pixels)", float(missing.sum()), 10.0, float("inf"), "the artefact must show"),
        Check("light shown there, fraction of the correct sum", light_shown, low, high, why),
    ]


def grown(mask: np.ndarray) -> np.ndarray:
    """Return a mask (H, W) grown by one pixel."""
    return np.lib.stride_tricks.sliding_window_view(np.pad(mask, 1), (3, 3)).any(axis=(2, 3))


def _boundary_pixels(image: np.ndarray) -> float:
    """Return the length of the boundaries in an image (H, W) of plateaus, as the number of pixels where it changes."""
    across, down = (np.abs(np.diff(image, axis=axis)) > 0.01 for axis in (1, 0))
    return float((across[:-1] | down[:, :-1]).sum())


def _paper_probe(aperture: str, name: str, figure: str, title: str, shows: str) -> Probe:
    case = impulse.point_case("two points", impulse.constant_coc(aperture, 0.0, SIZE), points(aperture), SIZE)
    judge = _judge_max if aperture in aperture_shapes.USES_MAX else _judge_min
    title, brief = f"{title} (Figure {figure})", name != "octagon"
    return Probe(f"two-points-{name}", title, shows, (case,), partial(judge, aperture), brief)


FALSE = (
    "Two highlights make false ones under min",
    "Beside the two shapes lies light of discarded corners that met.",
)
LOST = "Two highlights that do not add up under max", "Where the stars overlap max shows once what should be twice."
PROBES = (
    _paper_probe("hexagon", "hexagon", "12a", *FALSE),
    _paper_probe("octagon", "octagon", "12b", *FALSE),
    _paper_probe("star", "max", "13", *LOST),
)
