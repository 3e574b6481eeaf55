"""Draw a ray-traced scene by three methods next to its truth, for docs/results.md."""

from collections.abc import Callable

import numpy as np

from bokeh_validation import pictures, truth
from bokeh_validation.drivers.base import Driver
from bokeh_validation.pictures import Captioned
from bokeh_validation.truth import ray_traced

CAPTIONS = {
    "pinhole": "input: colour and depth through a pinhole",
    "paper": "paper, hexagon, 13 samples per line",
    "gather": "gather: Listing 3, 924 samples",
    "layered medium": "layered, preset MEDIUM",
    "truth": "truth: ray traced through a lens",
}
# scene, without the factor of its lens -> left and top of its detail; width, height
PLACES, DETAIL_SIZE = {"market_7": (600, 220), "street_11": (225, 150), "canopy_12": (100, 100)}, (240, 160)


def likeness(driver: Driver, scene: ray_traced.SceneFile) -> dict[str, np.ndarray]:
    """Draw a detail at twice its size, and market_7 at half size; returns file name -> 8-bit rgb."""
    corner, exposed = PLACES[scene.name.removesuffix("x3")], {}

    def shown(label: str) -> np.ndarray:
        if label not in exposed:
            image = ray_traced.truth(scene, "hexagon") if label == "truth" else truth.picture(driver, scene, label)
            exposed[label] = pictures.filmic(image, truth.EXPOSURE.get(scene.name, 1.0))
        return exposed[label]

    def sheet(second: str, cut: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
        labels = ("pinhole", second, "layered medium", "truth")
        panels = [Captioned(cut(shown(label)), CAPTIONS[label]) for label in labels]
        return pictures.grid([panels[:2], panels[2:]])

    def enlarged(pixels: np.ndarray) -> np.ndarray:
        return pictures.enlarged(pictures.crop(pixels, *corner, *DETAIL_SIZE), 2)

    images = {f"likeness_{scene.name}_detail": sheet("gather", enlarged)}
    if scene is ray_traced.MARKET:
        images[f"likeness_{scene.name}"] = sheet("paper", pictures.halved)
    return images
