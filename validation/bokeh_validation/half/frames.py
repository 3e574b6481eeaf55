"""Whole passes on a real image in the corner of a 4K frame, with some variables half: what becomes of the picture."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from bokeh_validation import exr, methods, metrics, paths
from bokeh_validation.half.emulator import Emulator, Place, Window
from bokeh_validation.half.evaluate import ALL_FLOAT, Choice
from bokeh_validation.half.numbers import Rounded

SCENE = "street_11"
# Lamps and sky behind a near edge. The lamps are 42 as stored, 16800 at this exposure: four exceed a half float.
LEFT, TOP = 376, 128
EXPOSURE = 400.0
FRAME = (3840, 2160)
# wide enough for a CoC of up to 0.09, nearly MaxCoC
CAMERA = methods.Camera(aperture_diameter=0.1)
LARGE, SMALL = (160, 120), (64, 48)

METHODS = {
    "paper": methods.Settings("paper", "hexagon", camera=CAMERA),
    "paper, adaptive": methods.Settings("paper", "star", spacing=1.0, max_samples=17, jitter=0.5, camera=CAMERA),
    "exact": methods.Settings("exact", "hexagon", spacing=1.0, max_samples=17, jitter=0.5, camera=CAMERA),
    "exact, one target": methods.Settings("exact", "octagon", targets=False, samples=4, camera=CAMERA),
    "naive": methods.Settings("naive", "hexagon", samples=5, camera=CAMERA),
    "naive-grid": methods.Settings("naive-grid", "square", samples=4, camera=CAMERA),
}


@dataclass(frozen=True)
class Outcome:
    """A method with some variables half, against all of them float.

    psnr   tone-mapped, dB; lost pixels are taken for the largest half float
    moved  largest displacement of a sample, pixels of the frame
    lost   share of the pixels that are not finite
    """

    psnr: float
    moved: float
    lost: float


@dataclass(frozen=True)
class Frame:
    """A method on the image, as it should be.

    exposure  factor on the colours
    truth     (H, W, 4), all variables float32
    places    of its reads
    """

    method: str
    size: tuple[int, int]
    exposure: float
    truth: np.ndarray
    places: dict[str, list[Place]]

    def outcome(self, choice: Choice, flush: bool = False, storage: str = "half") -> Outcome:
        """Run it again with a choice of half variables, or with other targets."""
        result, places = _run(self.method, self.size, self.exposure, choice, flush, storage)
        finite = np.isfinite(result)
        shown = np.where(finite, result, np.finfo(np.float16).max)
        return Outcome(
            metrics.psnr(shown / self.exposure, self.truth / self.exposure),
            max(_moved(self.places[name], places[name]) for name in self.places),
            float(1.0 - finite.all(axis=-1).mean()),
        )


@cache
def frame(
    method: str, size: tuple[int, int] = LARGE, exposure: float = EXPOSURE, storage: str | None = "half"
) -> Frame:
    """One of METHODS with everything float32, on RGBA16F targets unless `storage` says otherwise."""
    return Frame(method, size, exposure, *_run(method, size, exposure, ALL_FLOAT, False, storage))


def _run(
    method: str, size: tuple[int, int], exposure: float, choice: Choice, flush: bool, storage: str | None
) -> tuple[np.ndarray, dict[str, list[Place]]]:
    """Result and places."""
    color, depth = _image(size, exposure)
    plan = methods.plan(METHODS[method], FRAME)
    window = Window(FRAME, (FRAME[0] - size[0], FRAME[1] - size[1]))
    emulator = Emulator(Rounded(flush=flush), choice, window)
    textures = {"color": color, "depth": depth, **plan.tables}
    return emulator.run(plan.passes, textures, size, storage)["result"], emulator.places


@cache
def _image(size: tuple[int, int], exposure: float) -> tuple[np.ndarray, np.ndarray]:
    scene = exr.read(paths.SCENES / f"{SCENE}_pin.exr")
    rows, columns = slice(TOP, TOP + size[1]), slice(LEFT, LEFT + size[0])
    color = scene.color[rows, columns].astype(np.float32)
    color[..., :3] *= exposure
    return color, scene.depth[rows, columns]


def _moved(before: Sequence[Place], after: Sequence[Place]) -> float:
    """Largest distance between the same sample of both, where both have it; infinite where it went nowhere."""
    worst = 0.0
    for a, b in zip(before, after, strict=False):
        both = a.counts & b.counts
        if both.any():
            distance = np.abs(a.texels[both] - b.texels[both]).max(initial=0.0)
            worst = max(worst, float(distance) if np.isfinite(distance) else np.inf)
    return worst
