"""Layered scatter by brute force, in float64: the point splatting that the paper's section 6.1 asks for as comparison.

Every pixel spreads its colour over the polygon of its own CoC, with weights that add up to 1. Pixels are sorted by
signed CoC into three layers, and those composited from near to far. Nothing here is fit for real time: it says what
spreading alone makes of one colour and depth image.
"""

import numpy as np

from bokeh_validation.frame import polygons
from bokeh_validation.probes import shapes
from bokeh_validation.probes.model import Case
from bokeh_validation.reference import listings

# CoC below this, in pixels, are in focus: these pixels stay as they are
FOCUSED = 1.0
# From one kernel to the next, pixels of CoC and share of it
STEP, GROWTH = 0.5, 0.05
# The middle layer: CoC up to this share of the picture's largest. Beyond it are one near and one far layer. Nearest to
# the truth over the scenes of validation/scenes, of shares from .3 to .5 and from 1 to 14 layers on each side.
MIDDLE = 0.3
# Coverage that needs no filling, and that a mean of what is around a hole is taken from; pixels across the first mean
ENOUGH, ENOUGH_AROUND, FIRST_FILL = 0.1, 0.5, 8
# Less coverage than this is rounding
MIN_COVERAGE = 1e-6


def signed_pixels(case: Case) -> np.ndarray:
    """Signed CoC of every pixel, diameters in pixels, (H, W): below 0 nearer than the focus."""
    camera = case.settings.camera
    depth = listings.safe_depth(case.depth.astype(np.float64))
    coc = listings.circle_of_confusion(depth, *vars(camera).values())
    return listings.signed_coc(depth, coc, camera.focus_distance) * case.size[1]


def diameters(largest: float) -> np.ndarray:
    """CoC that there are kernels for, two or more, from FOCUSED to `largest` or beyond."""
    sizes = [FOCUSED, FOCUSED + STEP]
    while sizes[-1] < largest:
        sizes.append(sizes[-1] + max(STEP, GROWTH * sizes[-1]))
    return np.array(sizes)


def spectrum(corners: np.ndarray, diameter: float, shape: tuple[int, int]) -> np.ndarray:
    """Of a polygon with sum 1 around the first texel of a picture of (height, width) that wraps around."""
    reach = int(np.ceil(diameter / 2)) + 1
    side = 2 * reach + 1
    mask = polygons.coverage(diameter * corners, (side, side), (reach + 0.5, reach + 0.5))
    whole = np.zeros(shape)
    whole[:side, :side] = mask / mask.sum()
    return np.fft.rfft2(np.roll(whole, (-reach, -reach), axis=(0, 1)))


class Scatter:
    """A case with its border repeated outwards, as clamp addressing has it, so that a circular convolution will do.

    signed   CoC, (H, W), pixels
    picture  (4, H, W): rgb and 1
    """

    def __init__(self, case: Case) -> None:
        signed = signed_pixels(case)
        self.kernels = diameters(float(np.abs(signed).max()))
        self.corners = shapes.outline(case.settings)
        self.reach = int(np.ceil(self.kernels[-1] / 2)) + 2
        # up to sizes that the FFT is quick with
        around = [(self.reach, self.reach + -(length + 2 * self.reach) % 32) for length in signed.shape]
        self.signed = np.pad(signed, around, mode="edge")
        color = listings.safe_color(case.color[..., :3].astype(np.float64))
        self.picture = np.ones((4, *self.signed.shape))
        self.picture[:3] = np.pad(color, [*around, (0, 0)], mode="edge").transpose(2, 0, 1)
        # between the kernels `interval` and the next, nearer to that by `share`
        place = np.interp(np.abs(self.signed), self.kernels, np.arange(len(self.kernels)))
        self.interval = np.minimum(place.astype(int), len(self.kernels) - 2)
        self.share = place - self.interval
        self.spectra: dict[int, np.ndarray] = {}

    def spread(self, members: np.ndarray) -> np.ndarray:
        """(4, H, W): premultiplied colour and coverage of these pixels."""
        stay = members & (np.abs(self.signed) < FOCUSED)
        result, moved = self.picture * stay, members & ~stay
        if not moved.any():
            return result
        total = 0.0
        for k in range(self.interval[moved].min(), self.interval[moved].max() + 2):
            lower, upper = self.interval == k, self.interval == k - 1
            weight = moved * np.where(lower, 1.0 - self.share, upper * self.share)
            if k not in self.spectra:
                self.spectra[k] = spectrum(self.corners, self.kernels[k], self.signed.shape)
            total = total + np.fft.rfft2(self.picture * weight) * self.spectra[k]
        return result + np.maximum(np.fft.irfft2(total, self.signed.shape), 0.0)

    def composite(self, layers: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """(3, H, W) premultiplied and (H, W) coverage of layers, the nearest first."""
        color, left = np.zeros_like(self.picture[:3]), np.ones_like(self.signed)
        for members in layers:
            if members.any():
                layer = self.spread(members)
                # coverage is more than whole where pixels of several CoC meet
                color += left * layer[:3] / np.maximum(layer[3], 1.0)
                left = left * (1.0 - np.minimum(layer[3], 1.0))
        return color, 1.0 - left

    def filled(self, color: np.ndarray, coverage: np.ndarray) -> np.ndarray:
        """(3, H, W) of what is premultiplied; its holes are filled by means of what is around, narrow ones first."""
        share = np.minimum(coverage / ENOUGH, 1.0)
        result = color / np.maximum(coverage, MIN_COVERAGE) * share
        left = 1.0 - share
        planes = np.fft.rfft2(np.concatenate([color, coverage[None]]))
        size = FIRST_FILL
        while left.max() > 0.0 and size < min(self.signed.shape):
            around = np.maximum(
                np.fft.irfft2(planes * spectrum(self.corners, size, self.signed.shape), left.shape), 0.0
            )
            share = left * np.minimum(around[3] / ENOUGH_AROUND, 1.0)
            result += share * around[:3] / np.maximum(around[3], MIN_COVERAGE)
            left = left - share
            size *= 2
        # nothing but near objects far and wide
        return result + left * self.picture[:3]


def scatter(case: Case) -> np.ndarray:
    """The picture, (H, W, 3) float64."""
    work = Scatter(case)
    size, near = np.abs(work.signed), work.signed < 0
    middle = size <= max(MIDDLE * size.max(), FOCUSED)
    front, covered = work.composite([near & ~middle])
    rest, known = work.composite([middle, ~near & ~middle])
    result = front + (1.0 - covered) * work.filled(rest, known)
    rows, columns = (slice(work.reach, work.reach + length) for length in case.size[::-1])
    return result[:, rows, columns].transpose(1, 2, 0)
