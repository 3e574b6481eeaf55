"""What truth's commands compare, by the names that --method takes."""

import numpy as np

from bokeh_validation.drivers.base import Driver
from bokeh_validation.frame.methods import PRESETS, Camera, Settings
from bokeh_validation.probes import shapes
from bokeh_validation.probes.model import Case, drawn

# gather: shapes.brute_force, in one pass with Listing 3's weights
METHODS = ("pinhole", "paper", "exact", "gather", *(f"layered {preset}" for preset in PRESETS))
# The same with noise that is another in each frame
JITTERED = tuple(f"{label}, jitter" for label in METHODS if label.startswith(("exact", "layered")))


def complete(label: str) -> str:
    """Return the label with the default preset where it names a method with presets and none of them."""
    method, comma, jitter = label.partition(", ")
    return f"layered medium{comma}{jitter}" if method == "layered" else label


def settings(label: str, camera: Camera, aperture: str = "hexagon", **changes) -> Settings:
    """Those of one of METHODS or JITTERED; `changes` to them."""
    (method, _, preset), jitter = label.removesuffix(", jitter").partition(" "), float(label in JITTERED)
    own = {"spacing": 1.0} if method == "exact" else {"preset": preset} if preset else {}
    name = method if method in ("paper", "layered") else "exact"
    return Settings(name, aperture, **{"camera": camera, "jitter": jitter, **own, **changes})


def picture(driver: Driver, label: str, case: Case) -> np.ndarray:
    """What a method makes of a case with its settings(), (H, W, >= 3)."""
    if label == "pinhole":
        return case.color
    return shapes.brute_force(driver, case) if label == "gather" else drawn(driver, case)
