"""Bound how far a pass may change a pixel from frame to frame, and draw a highlight smaller than a pixel.

The bound is for one line of a pass between two frames, with the leakage test off, in units of the image's pixels:

  * Its input changes: a mean of samples changes by at most the largest change of a texel that they read.
  * The CoC of the filter changes by d: a sample at middle + t half, |t| <= 1, in units of the CoC, moves by at most
    (|middle| + |half|) d on each axis, and reads a value at most that far along the steepest slope. With cells of a
    given length it moves no farther: they are counted from the line's beginning, and a last cell that grows keeps its
    middle.
  * The line has x cells and then x': the weights change by |x' - x| in total. With samples s and their mean M, M' - M
    = sum((w' - w)(s - M)) / x', at most |x' - x| / x' of the contrast.
  * On a ray of a hexagon a sample has the weight f instead of g, the size of its cell: f follows its own CoC relative
    to the pixel's, and both change in a focus pull, where samples also move. f' - f is (g' - g) plus (f' - g') - (f -
    g), and the sum of the weights is that of f'. So the change is (|x' - x| + D) / sum(f') of the contrast, where D is
    the sum of |(f' - g') - (f - g)|, and at most all of it. D is 0 if the CoC is the same everywhere.
    test_a_ray_has_no_step checks that f itself has no step.
  * Where the weights of a ray exceed its cells by e, the ray gives up e times a colour r, the minimum of the pixel's
    and the mean of the samples. That is one more sample with the weight -e, so D has |e' - e| too, and the weights add
    up to T = sum(f) - e. Their magnitudes add up to G T, with G = (sum(f) + e) / T; so a change of a texel counts G
    times, |x' - x| as well, and the result may leave the contrast by as much. r itself changes with the mean, which
    the change of the weights moves by at most (|x' - x| + D) / sum(f') of the contrast: that counts e' / T times.

Slope, contrast and change are the largest within the line's reach. If images are mixed, or combined by min or max, the
result changes by no more than the image that changes most.
"""

from collections.abc import Mapping

import numpy as np
import rays
from formulas import cells, filter_coc, is_exact, nearest
from lines import Line, Segment, lines

from bokeh_validation.numerics import precision
from bokeh_validation.shaders.entries import ADAPTIVE, LINE
from bokeh_validation.shaders.passes import Pass

Outputs = Mapping[str, np.ndarray]
# one store truncates by at most a step of 2^-10; the stores of two frames differ by as much
STORE_STEP = 2.0**-10


def allowed(render_pass: Pass, before: Outputs, after: Outputs) -> np.ndarray:
    """Return how far the colour that a pass writes may change from one frame to the next, (H, W, C - 1).

    before, after  name -> (H, W, C) float64, for everything that the pass reads; the last channel is the CoC
    """
    center = render_pass.inputs["ColorSamp"]
    # its magnitude, since the passes of exact have a signed CoC
    coc = (np.abs(before[center][..., -1]), np.abs(after[center][..., -1]))
    bounds = []
    for line in lines(render_pass):
        line_inputs = [frame[render_pass.inputs[line.slot]] for frame in (before, after)]
        weights = None
        if is_exact(render_pass):
            weights = _ray_weights(
                render_pass, line, line_inputs, [frame[center][..., -1] for frame in (before, after)]
            )
        bounds.append(_line_change(line.segment, render_pass, *line_inputs, coc, weights))
    if "ColorSampB" in render_pass.inputs and render_pass.spec.role in (LINE, ADAPTIVE):
        other = render_pass.inputs["ColorSampB"]
        bounds.append(np.abs(after[other] - before[other])[..., :-1])
    return np.max(bounds, axis=0)


def _ray_weights(render_pass: Pass, line: Line, read, coc) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return D, T and G of the module's docstring, (H, W) each; D and T in units of cells.

    D is larger by the factor 1 + e' / sum(f'), for what the mean in r moves.
    """
    frame_weights, sums = [], []
    for source, center in zip(read, coc, strict=True):
        ray = rays.gathered(cells(render_pass, line, center), source, center, nearest(render_pass, line))
        # the first cell has the full length
        frame_weights.append((ray.weights - ray.cells) / ray.cells[0])
        sums.append((ray.weights.sum(axis=0) / ray.cells[0], ray.excess / ray.cells[0]))
    count = max(map(len, frame_weights))
    before, after = (np.pad(more, ((0, count - len(more)), (0, 0), (0, 0))) for more in frame_weights)
    (_, old_excess), (total, excess) = sums
    moved = np.abs(after - before).sum(axis=0) + np.abs(excess - old_excess)
    rest = np.maximum(total - excess, 1e-9)
    return moved * (1.0 + excess / np.maximum(total, 1e-9)), rest, (total + excess) / rest


def _line_change(line: Segment, render_pass: Pass, before: np.ndarray, after: np.ndarray, coc, weights) -> np.ndarray:
    """Return the bound of the module's docstring for one line; `weights` are from _ray_weights, or None."""
    (height, width), spacing = before.shape[:2], render_pass.spacing
    line_coc = [filter_coc(c, height, spacing) * height for c in coc]
    moved = np.abs(line_coc[1] - line_coc[0])
    reach = np.abs(line.middle) + np.abs(line.half)
    # a sample reads the texels around it
    radius = [int(np.ceil(r * max(u.max() for u in line_coc))) + 1 for r in reach]
    count = [np.full(moved.shape, float(render_pass.samples))] * 2
    if spacing > 0.0:
        count = [np.clip(2 * line.half_length * u / spacing, 1.0, render_pass.samples) for u in line_coc]
    change = largest_within(np.abs(after - before), radius)
    across = largest_within(np.abs(np.diff(after, axis=1, append=after[:, -1:])), radius)
    down = largest_within(np.abs(np.diff(after, axis=0, append=after[-1:])), radius)
    position_error = 2 * precision.SOFTWARE.place(max(width, height))
    change += (reach[0] * moved + position_error)[..., None] * across + (reach[1] * moved + position_error)[
        ..., None
    ] * down
    contrast = largest_within(after, radius) + largest_within(-after, radius)
    reweighed, total, magnitude = (0.0, count[1], np.ones_like(count[1])) if weights is None else weights
    share = (np.abs(count[1] - count[0]) * magnitude + reweighed) / np.maximum(total, 1e-9)
    change = magnitude[..., None] * change + np.minimum(share, magnitude)[..., None] * contrast
    change += (STORE_STEP + 2 * (render_pass.samples + 8) * precision.FLOAT_STEP) * largest_within(
        after + change, radius
    )
    return change[..., :-1]


def largest_within(image: np.ndarray, radius: list[int]) -> np.ndarray:
    """Return the largest value within `radius` pixels (horizontally, vertically) of each pixel of (H, W, C)."""
    for axis, reach in ((1, radius[0]), (0, radius[1])):
        padding = [(0, 0)] * image.ndim
        padding[axis] = (reach, reach)
        image = np.moveaxis(np.pad(image, padding, mode="edge"), axis, 0)
        width, expected = 1, 2 * reach + 1
        while width < expected:
            # a window of twice the width, or of the wanted width, is the maximum of two overlapping ones
            further = min(width, expected - width)
            image = np.maximum(image[:-further], image[further:])
            width += further
        image = np.moveaxis(image, 0, axis)
    return image


# Columns per pixel of the integral; its error is far below a half float's step
DISC_COLUMNS = 2048


def disc(size: tuple[int, int], center: tuple[float, float], diameter: float) -> np.ndarray:
    """Return the fraction of each pixel that a disc covers by area, (H, W) float64; the disc must be inside the image.

    center    in pixels from the image's corner (pixel centres at .5)
    diameter  pixels
    """
    (left, right), (top, bottom) = ((int(c - diameter / 2), int(np.ceil(c + diameter / 2))) for c in center)
    x = left + (np.arange((right - left) * DISC_COLUMNS) + 0.5) / DISC_COLUMNS - center[0]
    half = np.sqrt(np.maximum((diameter / 2) ** 2 - x**2, 0.0))
    y = (np.arange(top, bottom) - center[1])[:, None]
    covered = np.clip(half, y, y + 1) - np.clip(-half, y, y + 1)
    image = np.zeros((size[1], size[0]))
    image[top:bottom, left:right] = covered.reshape(bottom - top, right - left, DISC_COLUMNS).mean(axis=-1)
    return image
