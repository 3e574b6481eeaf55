"""Prepare Mesa's software Vulkan, and the ray-traced scene for samples that have no scene."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np

from bokeh_validation import needs, pictures
from bokeh_validation.errors import Unavailable
from bokeh_validation.reference import listings
from bokeh_validation.truth import ray_traced

SCENE, EVERY, STORED = ray_traced.MARKET, 2, {"kind": 1, "near": 0.5, "far": 400.0}


def description() -> Path:
    """Return the path of the driver description of lavapipe, Mesa's software Vulkan. Raises Unavailable."""
    drivers = sorted(Path("/usr/share/vulkan/icd.d").glob("lvp_icd*.json"))
    if not drivers:
        raise Unavailable(f"no Vulkan driver; {needs.install('vulkan')}")
    return drivers[0]


def write_scene(folder: Path) -> dict:
    """Write the input of a sample: color.f16, depth.f32 as a depth buffer stores it, and camera.txt.

    Returns the entries of capture.json that describe them.
    """
    scene = ray_traced.picture(SCENE)
    color, metres = (np.ascontiguousarray(pixels[::EVERY, ::EVERY]) for pixels in (scene.color, scene.depth))
    (folder / "color.f16").write_bytes(color.tobytes())
    depth = listings.stored_depth(metres.astype(np.float64), **STORED)
    (folder / "depth.f32").write_bytes(depth.astype(np.float32).tobytes())
    (height, width), camera = metres.shape, asdict(SCENE.camera)
    lens = [camera[key] for key in ("aperture_diameter", "focal_length", "focus_distance", "max_coc")]
    numbers = [width, height, *lens, STORED["near"], STORED["far"]]
    (folder / "camera.txt").write_text(" ".join(map(str, numbers)))
    sources = {"color": "color.f16", "depth": "depth.f32", "stored": STORED}
    return {"width": width, "height": height, "camera": camera, **sources}


def write_picture(folder: Path, images: Sequence[np.ndarray]) -> None:
    """Write linear images, (H, W, 4) each, side by side as picture.png."""
    pictures.write_png(folder / "picture.png", pictures.filmic(np.concatenate(images, axis=1)))
