"""HLSL of shader model 3, compiled by fxc, on Wine's Direct3D 9.

A program of ours (windows/d3d9run.cpp) makes textures and draws passes; it stays up between calls.
"""

import shutil
from dataclasses import replace
from math import pi

import numpy as np

from bokeh_validation import shaders
from bokeh_validation.compilers import fxc
from bokeh_validation.drivers.base import Driver, Image, flattened
from bokeh_validation.errors import Unavailable
from bokeh_validation.numerics.images import STORAGE
from bokeh_validation.numerics.precision import FLOAT_STEP, Precision
from bokeh_validation.shaders.passes import SLOTS, is_linear
from bokeh_validation.windows import programs, server, wine

RUN_S = 300.0  # the largest scene takes 2 s on two cores


class D3D9(Driver):
    """ps_3_0 and vs_3_0 on Direct3D 9."""

    name = "d3d9"

    def __init__(self, adapter: str | None = None):
        fxc.load()
        self.server = server.Server(programs.build("d3d9run", "-ld3d9"))
        self.server.start()
        self.file = self.server.folder / "pixels"
        self.adapter = f"{wine.get().device}, {self.server.greeting}"
        self.require_adapter(adapter)

    @property
    def precision(self) -> Precision:
        """Its sin and cos are less exact: for ps_3_0 fxc writes those of x as sincos of frac(x / 2 pi + 1/2) 2 pi - pi,
        and the rounding of the fraction, FLOAT_STEP, becomes 2 pi times that of an angle.
        """
        device = super().precision
        return replace(device, line=device.line + 2.0 * pi * FLOAT_STEP)

    def shader(self, stage: str, entry: str, values: dict[str, object]) -> str:
        """File name of the bytecode of an entry point, in the program's folder. `stage` is 'ps' or 'vs'."""
        try:
            code = fxc.bytecode(shaders.hlsl(3, values), f"{stage}_3_0", entry)
        except RuntimeError as error:
            if not (values.get("BOKEH_LENS_SHAPE") or values.get("BOKEH_VIEWPORT")):
                raise
            # variants.NO_ROOM
            raise Unavailable(str(error).splitlines()[-1]) from error
        shutil.copy(code, self.server.folder)
        return code.name

    def ask(self, *words: object) -> None:
        """Have the program do a request of windows/d3d9run.cpp."""
        self.server.ask(" ".join(map(str, words)), RUN_S)

    def make(self, number: int, image: Image) -> None:
        """Have it make a texture or a target."""
        given = []
        if image.pixels is not None:
            self.file.write_bytes(image.pixels.tobytes())
            given = [self.file.name]
        self.ask("texture", number, *image.size, f"{image.storage}{image.channels}", *given)

    def pixels(self, number: int, image: Image) -> np.ndarray:
        """What is in a target."""
        self.ask("keep", number, self.file.name)
        return image.shaped(np.frombuffer(self.file.read_bytes(), STORAGE[image.storage]))

    def run(self, passes, textures, size, storage="half", keep=("result",)) -> dict[str, np.ndarray]:
        """See Driver. Raises RuntimeError with what Direct3D said, also after a crash or a hang."""
        images, draws, numbers = flattened(self, passes, textures, size, storage)
        self.ask("clear")
        self.ask("vertex", self.shader("vs", "BokehFullScreen_VS", {}))
        for number, image in enumerate(images):
            self.make(number, image)
        for item, inputs, targets, area in draws:
            self.ask("pixel", self.shader("ps", f"{item.entry}_PS", item.constants))
            for slot, number in inputs.items():
                self.ask("input", SLOTS.index(slot), number, "linear" if is_linear(item.entry, slot) else "nearest")
            # nine digits are enough for any float32
            self.ask("values", *(f"{value:.9g}" for value in item.values().values()))
            self.ask("viewport", *area)
            self.ask("draw", *targets)
        return {name: self.pixels(numbers[name], images[numbers[name]]) for name in keep}
