"""The one interface of all drivers: passes and textures in, textures out."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Protocol

import numpy as np

from bokeh_validation.errors import Unavailable
from bokeh_validation.passes import Pass
from bokeh_validation.reference import images

Textures = Mapping[str, np.ndarray]


class Driver(Protocol):
    """A real runtime, or the reference.

    name      what --driver takes
    adapter   the device behind it, as the runtime names it
    software  True where the texture unit is Mesa's software one: exact float32 filtering
    rounding  how its half-float targets round, 'nearest' or 'zero': measured, see half_rounding()
    """

    name: str
    adapter: str
    software: bool
    rounding: str

    def run(
        self,
        passes: Sequence[Pass],
        textures: Textures,
        size: tuple[int, int],
        storage: str = "half",
        keep: Iterable[str] = ("result",),
    ) -> dict[str, np.ndarray]:
        """Run the passes in order and return the textures named in `keep`.

        textures  (H, W, 4) float16 or float32, or (H, W) float32 for depth
        size      (width, height) of every target
        storage   'half' or 'float': format of the targets between and after the passes
        returns   name -> (H, W, 4), float16 or float32 by `storage`
        """
        ...


def storage_type(storage: str) -> type:
    """NumPy type of a storage name."""
    return {"half": np.float16, "float": np.float32}[storage]


def require_targets(driver: "Driver", passes: Sequence[Pass], storage: str, limit: float) -> None:
    """Raise Unavailable where all targets of a pass together have more bytes a pixel than the device's `limit`."""
    texel = 4 * np.dtype(storage_type(storage)).itemsize
    for item in passes:
        needed = texel * len(item.outputs)
        if needed > limit:
            raise Unavailable(f"{driver.adapter} writes {limit} bytes a pixel at once; {item.entry} needs {needed}")


def half_rounding(driver: "Driver") -> str:
    """How a driver's half-float targets round what a shader writes: 'nearest', or 'zero' for cutting off.

    Found by storing constants that lie between two half floats in the alpha of the first pass. OpenGL, Vulkan and
    Direct3D leave it open; a step in the stored CoC moves every later sample, so the reference has to store as the
    device does.
    """
    # quarters of a step above half floats of several sizes, exact in float32
    constants = np.array([base * (1 + k * 2.0**-12) for base in (0.5, 0.0625, 0.3125) for k in (1, 3)])
    passes = [
        Pass("BokehConstantCoC", {"ColorSamp": "color"}, f"{i}", {"BokehConstantCoC": float(c), "BokehMaxCoC": 1.0})
        for i, c in enumerate(constants)
    ]
    names = [name for item in passes for name in item.outputs]
    outputs = driver.run(passes, {"color": np.ones((1, 1, 4), np.float16)}, (1, 1), keep=names)
    seen = np.array([outputs[name][0, 0, 3] for name in names])
    for rounding in ("nearest", "zero"):
        if np.array_equal(seen, images.rounded(constants, np.float16, rounding)):
            return rounding
    raise RuntimeError(f"{driver.name}: half-float targets neither round to nearest nor cut off")
