"""Draw a ray-traced scene by three methods next to its truth, for docs/results.md."""

from collections.abc import Callable

import numpy as np

from bokeh_validation import pictures, truth
from bokeh_validation.drivers.base import Driver
from bokeh_validation.truth import ray_traced
from lab import captioned
from lab.captioned import Captioned

CAPTIONS = {
    "pinhole": "input: colour and depth through a pinhole",
    "paper": "paper, hexagon, 13 samples per line",
    "gather": "gather: Listing 3, 924 samples",
    "layered medium": "layered, preset MEDIUM",
    "truth": "truth: ray traced through a lens",
}
# scene, without the factor of its lens -> left and top of its detail; width, height
PLACES, DETAIL_SIZE = {"market_7": (600, 220), "street_11": (225, 150), "canopy_12": (100, 100)}, (240, 160)
# Scenes that are drawn as a whole, at half size
SHOWN_WHOLE = (ray_traced.MARKET, ray_traced.WINTER)


def names(scene: ray_traced.SceneFile) -> list[str]:
    """Return the file names of a scene's pictures: as a whole, and a detail of those that methods are measured on."""
    detail = [f"likeness_{scene.name}_detail"] if scene in ray_traced.SCENES else []
    return detail + ([f"likeness_{scene.name}"] if scene in SHOWN_WHOLE else [])


def likeness(driver: Driver, scene: ray_traced.SceneFile) -> dict[str, np.ndarray]:
    """Draw a detail at twice its size, and the scenes of SHOWN_WHOLE at half size; returns file name -> 8-bit rgb."""
    exposed = {}

    def shown(label: str) -> np.ndarray:
        if label not in exposed:
            image = ray_traced.truth(scene, "hexagon") if label == "truth" else truth.picture(driver, scene, label)
            exposed[label] = pictures.filmic(image, truth.EXPOSURE.get(scene.name, 1.0))
        return exposed[label]

    def sheet(second: str, cut: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
        labels = ("pinhole", second, "layered medium", "truth")
        panels = [Captioned(cut(shown(label)), CAPTIONS[label]) for label in labels]
        return captioned.grid([panels[:2], panels[2:]])

    def enlarged(pixels: np.ndarray) -> np.ndarray:
        corner = PLACES[scene.name.removesuffix("x3")]
        return captioned.enlarged(captioned.crop(pixels, *corner, *DETAIL_SIZE), 2)

    return {
        name: sheet("gather", enlarged) if name.endswith("detail") else sheet("paper", captioned.halved)
        for name in names(scene)
    }
