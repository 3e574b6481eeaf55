"""Compute the lines of an exact polygon in float64: a sample is weighted by its own CoC.

A cell is a piece of a line from `begin` to `end`, 0 and 1 at the ends of the line, with one sample. The lines of a
hexagon start at the pixel, so they are called rays.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from bokeh_validation.reference import sampling

# position of a sample relative to the pixel, texels; begin and end of its cell
Cell = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
# Behind the focus: how much denser than its surroundings a light may be. In front of it: the weight of a sharp sample
MOST_DENSITY, SHARP = 4.0, 0.5
# For lines that are no rays: ratio of a sample's CoC to the pixel's at which its blur begins and is complete
FADE = (0.2, 0.5)
# Below this weight, the pixel itself supplies the rest
LEAST_WEIGHT = 0.0625
# A little above 1, so that rounding does not darken an even colour
UNDIMMED = 1.000001
# A little above 1, so that rounding does not change a constant CoC
HANDED_ON = 1.001


@dataclass(frozen=True)
class Gathered:
    """Hold what one line gathers.

    samples  (N, H, W, C)
    cells    (N, H, W): the fraction of the line that each sample represents
    weights  (N, H, W)
    reached  (N, H, W): the weights without the density
    is_ray   whether the line is a ray
    """

    samples: np.ndarray
    cells: np.ndarray
    weights: np.ndarray
    reached: np.ndarray
    is_ray: bool

    @property
    def excess(self) -> np.ndarray:
        """Return by how much the weights exceed a ray, (H, W); the pixel's own surface gives that up."""
        return np.maximum(self.weights.sum(axis=0) - 1.0, 0.0) * self.is_ray

    def removed(self, center: np.ndarray) -> np.ndarray:
        """Return the colour times weight that the surface gives up, (H, W, 3), for centre pixels (H, W, C).

        The colour of the surface is taken for that of the pixel, or for the mean of the line if that is darker.
        """
        with np.errstate(invalid="ignore", divide="ignore"):
            mean = (self.samples[..., :3] * self.weights[..., None]).sum(axis=0) / self.weights.sum(axis=0)[..., None]
        return np.where(self.excess[..., None] > 0.0, np.minimum(center[..., :3], mean) * self.excess[..., None], 0.0)


def weights(sample_coc, center_coc, begin, end, nearest=None):
    """Return (weight, weight without density) of a cell.

    nearest  of a line that is no ray: its place that is nearest to the pixel, 0 to 1

    Behind the focus, the blur of a sample with CoC s covers s / c of the line of a pixel with CoC c, and `nearest`
    divides the rest of the line in the same proportion as the whole line. In front of the focus it covers all of it. On
    a ray, a sample is weighted by its size there, at least by half; the weight of a sample in front of the focus ramps
    to 1 until its CoC is an eighth of the pixel's.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        side = np.where(center_coc == 0.0, 1.0, sample_coc / center_coc)
    ratio = np.minimum(np.abs(side), 1.0)
    is_near = center_coc < 0.0
    first = 0.0 if nearest is None else nearest * (1.0 - ratio)
    covered = np.maximum(np.minimum(end, first + ratio) - np.maximum(begin, first), 0.0)
    if nearest is not None:
        covered = covered * np.clip((np.abs(side) - FADE[0]) / (FADE[1] - FADE[0]), 0.0, 1.0)
    size = np.maximum(ratio, np.clip(SHARP + 4.0 * side, SHARP, 1.0)) if nearest is None else 1.0
    reached = np.where(is_near, (end - begin) * size, covered)
    weight = reached * np.where(is_near, 1.0, np.minimum(1.0 / np.maximum(ratio, 1e-9), MOST_DENSITY))
    return weight, reached


def gathered(cells: Iterable[Cell], source: np.ndarray, center_coc: np.ndarray, nearest=None) -> Gathered:
    """Gather along a line through a texture (H, W, C) with the CoC in its last channel; `nearest` as in weights()."""
    row, column = np.mgrid[0 : len(source), 0 : source.shape[1]] + 0.5
    samples, cell_weights, widths = [], [], []
    for x, y, begin, end in cells:
        samples.append(sampling.bilinear(source, column + x, row + y))
        cell_weights.append(weights(samples[-1][..., -1], center_coc, begin, end, nearest))
        widths.append(np.broadcast_to(end - begin, center_coc.shape))
    weight, reached = np.moveaxis(np.array(cell_weights), 1, 0)
    return Gathered(np.array(samples), np.array(widths), weight, reached, nearest is None)


def target(lines: Sequence[tuple[Gathered, float | np.ndarray]], center: np.ndarray, hands_on: bool) -> np.ndarray:
    """Return the weighted mean of several lines. If they have little weight together, the pixel itself adds to it.

    lines     pairs of a line's gathered samples and its weight
    center    (H, W, C) centre pixels
    hands_on  reduce alpha below the pixel's CoC where brightness came from samples with a smaller one
    """
    color, total, light, reached = np.zeros_like(center[..., :3]), 0.0, 0.0, 0.0
    for line, share in lines:
        brightness = line.samples[..., :3].sum(axis=-1)
        removed = line.removed(center)
        gathered_color = (line.samples[..., :3] * line.weights[..., None]).sum(axis=0) - removed
        color = color + np.asarray(share)[..., None] * gathered_color
        total = total + share * (line.weights.sum(axis=0) - line.excess)
        light = light + share * gathered_color.sum(axis=-1)
        line_reached = (line.reached * brightness).sum(axis=0) - removed.sum(axis=-1)
        reached = reached + share * line_reached
    missing = np.maximum(LEAST_WEIGHT - total, 0.0)
    unblurred_color = center[..., :3] * missing[..., None]
    mean = (UNDIMMED * color + unblurred_color) / np.maximum(total, LEAST_WEIGHT)[..., None]
    # the same for the brightness
    unblurred = center[..., :3].sum(axis=-1) * missing
    light = light + unblurred
    with np.errstate(invalid="ignore", divide="ignore"):
        smaller = np.where(light > 0.0, np.clip((reached + unblurred) / light * HANDED_ON, 0.0, 1.0), 1.0)
    return np.concatenate([mean, (center[..., 3] * (smaller if hands_on else 1.0))[..., None]], axis=-1)
