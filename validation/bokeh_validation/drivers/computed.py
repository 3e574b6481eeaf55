"""Provide the float64 reference as a driver: it computes the passes instead of drawing them."""

import numpy as np

from bokeh_validation.drivers.base import Driver
from bokeh_validation.numerics.images import STORAGE
from bokeh_validation.numerics.precision import SOFTWARE, Precision
from bokeh_validation.reference import pass_images


class Reference(Driver):
    """Compute passes with NumPy in float64, rounded to the targets' format between passes; no graphics device is
    involved.
    """

    name = "reference"
    adapter = "NumPy float64"
    software = True
    rounding = "nearest"

    def __init__(self, adapter: str | None = None):
        del adapter

    @property
    def precision(self) -> Precision:
        """Return the precision of a device that filters in float32."""
        return SOFTWARE

    def run(self, passes, textures, size, storage="half", keep=("result",)) -> dict[str, np.ndarray]:
        """Compute the passes; see Driver.run()."""
        images = pass_images.images(passes, textures, size, storage)
        return {name: images[name].value.astype(STORAGE[storage]) for name in keep}
