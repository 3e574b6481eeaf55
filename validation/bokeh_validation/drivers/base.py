"""The one interface of all drivers: passes and textures in, textures out."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Protocol

import numpy as np

from bokeh_validation.passes import Pass

Textures = Mapping[str, np.ndarray]


class Driver(Protocol):
    """A real runtime, or the reference.

    name      what --driver takes
    adapter   the device behind it, as the runtime names it
    software  True where the texture unit is Mesa's software one: exact float32 filtering
    """

    name: str
    adapter: str
    software: bool

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
