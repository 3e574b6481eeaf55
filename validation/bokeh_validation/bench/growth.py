"""How time grows: with the number of samples, with the CoC, with the size of the picture."""

from dataclasses import dataclass, replace

import numpy as np

from bokeh_validation import methods
from bokeh_validation.bench import rows
from bokeh_validation.passes import Pass

# Fractions of the image height
COCS = (0.025, 0.05, 0.1, 0.2)
# Sides of the picture, relative to the size that is measured
SCALES = (0.5, 0.7071, 1.0, 1.4142)


@dataclass(frozen=True)
class Fit:
    """seconds = constant * x ^ slope, by least squares of the logarithms; r2 = share of the variance it explains."""

    slope: float
    r2: float

    @classmethod
    def of(cls, x: np.ndarray, seconds: np.ndarray) -> "Fit":
        """Two or more points, all positive."""
        lx, ly = np.log(np.asarray(x, float)), np.log(np.asarray(seconds, float))
        slope, constant = np.polyfit(lx, ly, 1)
        rest, all_ = ((ly - slope * lx - constant) ** 2).sum(), ((ly - ly.mean()) ** 2).sum()
        return cls(float(slope), float(1.0 - rest / all_) if all_ > 0.0 else 1.0)


@dataclass(frozen=True)
class Series:
    """Jobs of one curve: `against` is 'samples', 'CoC' or 'pixels'; points are x, size, passes."""

    name: str
    against: str
    points: tuple[tuple[float, tuple[int, int], tuple[Pass, ...]], ...]


CURVES = (
    ("naive 144", methods.Settings("naive-grid", "hexagon", 12)),
    ("paper hexagon 144", methods.Settings("paper", "hexagon", 12)),
    ("exact hexagon 144", methods.Settings("exact", "hexagon", 6)),
    ("exact hexagon adaptive", methods.Settings("exact", "hexagon", spacing=1.0, max_samples=rows.MOST)),
)


def _passes(settings: methods.Settings, size: tuple[int, int], coc: float) -> tuple[Pass, ...]:
    return methods.plan(replace(settings, camera=methods.Camera(max_coc=1.0), coc=coc), size).passes


def with_coc(size: tuple[int, int]) -> list[Series]:
    """Time against the CoC, pixels: fixed counts stay, adaptive ones grow with it."""
    return [
        Series(name, "CoC", tuple((coc * size[1], size, _passes(settings, size, coc)) for coc in COCS))
        for name, settings in CURVES[1:]
    ]


def with_size(size: tuple[int, int]) -> list[Series]:
    """Time against the number of pixels, the CoC a constant fraction of the height."""
    found = []
    for name, settings in CURVES:
        points = []
        for scale in SCALES:
            scaled = (max(2, round(size[0] * scale)), max(2, round(size[1] * scale)))
            points.append((float(scaled[0] * scaled[1]), scaled, _passes(settings, scaled, rows.COC)))
        found.append(Series(name, "pixels", tuple(points)))
    return found
