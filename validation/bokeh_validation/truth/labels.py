"""Name the methods that the truth commands compare, as --method takes them."""

import numpy as np

from bokeh_validation.drivers.base import Driver
from bokeh_validation.frame.methods import PRESETS, Camera, Settings
from bokeh_validation.probes import shapes
from bokeh_validation.probes.model import Case, drawn

# gather is shapes.brute_force: a single pass with Listing 3's weights
METHODS = ("pinhole", "paper", "exact", "gather", *(f"layered {preset}" for preset in PRESETS))
# The same methods with random sample offsets that differ in each frame
JITTERED = tuple(f"{label}, jitter" for label in METHODS if label.startswith(("exact", "layered")))


def complete(label: str) -> str:
    """Return the label with the default preset added if it names a method with presets but no preset."""
    method, comma, jitter = label.partition(", ")
    return f"layered medium{comma}{jitter}" if method == "layered" else label


def settings(label: str, camera: Camera, aperture: str = "hexagon", **changes) -> Settings:
    """Return the settings of one of METHODS or JITTERED, with `changes`."""
    (method, _, preset), jitter = label.removesuffix(", jitter").partition(" "), float(label in JITTERED)
    of_method = {"spacing": 1.0} if method == "exact" else {"preset": preset} if preset else {}
    name = method if method in ("paper", "layered") else "exact"
    return Settings(name, aperture, **{"camera": camera, "jitter": jitter, **of_method, **changes})


def picture(driver: Driver, label: str, case: Case) -> np.ndarray:
    """Draw a case, whose settings must be the label's; returns (H, W, >= 3)."""
    if label == "pinhole":
        return case.color
    return shapes.brute_force(driver, case) if label == "gather" else drawn(driver, case)
