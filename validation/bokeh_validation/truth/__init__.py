"""Draw every ray-traced scene with every method, and compare the results with a lens."""

import numpy as np

from bokeh_validation import metrics
from bokeh_validation.drivers.base import Driver
from bokeh_validation.probes.model import Case
from bokeh_validation.truth import labels, ray_traced
from bokeh_validation.truth.labels import METHODS
from bokeh_validation.truth.ray_traced import SceneFile

DEFAULT = METHODS[: METHODS.index("layered medium") + 1]
# Exposure with which scenes are displayed; 1 for all others
EXPOSURE = {"market_7": 2.2, "canopy_12": 0.5, "canopy_12x3": 0.5}


def case(scene: SceneFile, label: str, aperture: str = "hexagon", **changes) -> Case:
    """Return a case of a scene with one of METHODS, the polygon rotated as in the truth; `changes` are to its
    settings.
    """
    changes = {"rotation": ray_traced.TRUTH_ROTATION[aperture], **changes}
    image = ray_traced.picture(scene)
    return Case(scene.name, labels.settings(label, scene.camera, aperture, **changes), image.color, image.depth)


def picture(driver: Driver, scene: SceneFile, label: str, aperture: str = "hexagon", **changes) -> np.ndarray:
    """Draw a scene with one of METHODS, (H, W, >= 3); arguments as in case()."""
    return labels.picture(driver, label, case(scene, label, aperture, **changes))


def measured(image: np.ndarray, lens: np.ndarray) -> dict[str, float]:
    """Compare an image with the truth `lens`, both linear (H, W, >= 3): mean FLIP, PSNR of tone-mapped colour in dB,
    and light divided by the truth's.
    """
    light = image[..., :3].astype(np.float64).sum() / lens[..., :3].astype(np.float64).sum()
    return {"flip": metrics.flip(image, lens), "psnr": metrics.psnr(image, lens), "light": float(light)}
