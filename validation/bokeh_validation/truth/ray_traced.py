"""Read the ray-traced scenes of validation/scenes with their cameras and their truth."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from bokeh_validation import exr, paths, terminal
from bokeh_validation.frame import methods
from bokeh_validation.probes.model import Case

# aperture -> suffix of the truth's file name
TRUTHS = {"hexagon": "hex", "octagon": "oct"}
# aperture -> rotation in degrees that matches the truth, which has a corner straight up
TRUTH_ROTATION = {"hexagon": 0.0, "octagon": 22.5}


@dataclass(frozen=True)
class SceneFile:
    """Describe a ray-traced scene of validation/scenes with its camera: NAME_pin.exr, and its truth NAME_hex.exr.

    pinhole  name of the scene whose pinhole image it shares; None: it has its own
    """

    name: str
    camera: methods.Camera
    pinhole: str | None = None

    @property
    def source(self) -> Path:
        """Return the path of the image with colour and depth."""
        return paths.SCENES / f"{self.pinhole or self.name}_pin.exr"


MARKET = SceneFile("market_7", methods.Camera(0.0714, 0.05, 2.42, 0.024, 0.15))
STREET = SceneFile("street_11", methods.Camera(0.05, 0.05, 5.0, 0.024, 0.15))
CANOPY = SceneFile("canopy_12", methods.Camera(0.0714, 0.05, 7.0, 0.024, 0.15))
# the same scenes with three times the aperture
WIDE_STREET = SceneFile("street_11x3", methods.Camera(0.15, 0.05, 5.0, 0.024, 0.15), "street_11")
WIDE_CANOPY = SceneFile("canopy_12x3", methods.Camera(0.2142, 0.05, 7.0, 0.024, 0.15), "canopy_12")
SCENES = (MARKET, STREET, CANOPY, WIDE_STREET, WIDE_CANOPY)
# Only the live page shows it: no bound is checked on it, and `layered` was not tuned on it
WINTER = SceneFile("winter_3", methods.Camera(0.044, 0.05, 1.07, 0.024, 0.15))
# The small scenes, which every driver draws with every method
DRIVER_SCENES = (STREET, CANOPY)


def chosen(names: Iterable[str] | None) -> list[SceneFile]:
    """Return the scenes chosen with --scene, or all of them. Raises UserError for an unknown name."""
    scenes = {scene.name: scene for scene in SCENES}
    return [scenes[name] for name in terminal.chosen("--scene", names, scenes)]


def scene_case(scene: SceneFile, method: str, aperture: str) -> Case:
    """Return a case of a scene through its own camera."""
    image = picture(scene)
    return Case(scene.name, methods.Settings(method, aperture, camera=scene.camera), image.color, image.depth)


@cache
def picture(scene: SceneFile) -> exr.Scene:
    """Read colour and depth through a pinhole; the result is cached."""
    return exr.read(scene.source)


def truth(scene: SceneFile, aperture: str) -> np.ndarray:
    """Read the ray-traced result of a thin lens, (H, W, 4)."""
    return exr.read(paths.SCENES / f"{scene.name}_{TRUTHS[aperture]}.exr", None).color
