"""Run HLSL of shader model 3, compiled by fxc, on Wine's Direct3D 9.

A small program, windows/d3d9run.cpp, creates the textures and draws the passes; it keeps running between calls.
"""

import shutil
from dataclasses import replace

import numpy as np

from bokeh_validation import shaders
from bokeh_validation.compilers import fxc
from bokeh_validation.drivers.base import Driver, Image, flattened
from bokeh_validation.errors import Unavailable
from bokeh_validation.numerics.images import STORAGE
from bokeh_validation.numerics.precision import SHADER_MODEL_3, Precision
from bokeh_validation.shaders.passes import SLOTS, is_linear
from bokeh_validation.windows import programs, server, wine

RUN_S = 300.0  # the largest scene takes 2 s on two cores


class D3D9(Driver):
    """Run ps_3_0 and vs_3_0 on Direct3D 9."""

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
        """Return the precision: shader model 3 has no room for blended outlines."""
        return replace(super().precision, constants=SHADER_MODEL_3)

    def shader(self, stage: str, entry: str, values: dict[str, object]) -> str:
        """Compile an entry point and return its bytecode's file name in the program's folder.

        stage   'ps' or 'vs'
        values  constants to compile with
        Raises Unavailable if a lens shape or viewport does not fit into shader model 3.
        """
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
        """Send a request to windows/d3d9run.cpp and wait until it is done."""
        self.server.ask(" ".join(map(str, words)), RUN_S)

    def make(self, number: int, image: Image) -> None:
        """Create a texture or a target with this number."""
        file_names = []
        if image.pixels is not None:
            self.file.write_bytes(image.pixels.tobytes())
            file_names = [self.file.name]
        self.ask("texture", number, *image.size, f"{image.storage}{image.channels}", *file_names)

    def pixels(self, number: int, image: Image) -> np.ndarray:
        """Read a target, (H, W, channels)."""
        self.ask("keep", number, self.file.name)
        return image.shaped(np.frombuffer(self.file.read_bytes(), STORAGE[image.storage]))

    def run(self, passes, textures, size, storage="half", keep=("result",)) -> dict[str, np.ndarray]:
        """Run the passes, see Driver.run(). Raises RuntimeError with Direct3D's message, also after a
        crash or a hang.
        """
        images, draws, numbers = flattened(self, passes, textures, size, storage)
        self.ask("clear")
        self.ask("vertex", self.shader("vs", "BokehFullScreen_VS", {}))
        for number, image in enumerate(images):
            self.make(number, image)
        for render_pass, inputs, targets, area in draws:
            self.ask("pixel", self.shader("ps", f"{render_pass.entry}_PS", render_pass.constants))
            for slot, number in inputs.items():
                self.ask(
                    "input", SLOTS.index(slot), number, "linear" if is_linear(render_pass.entry, slot) else "nearest"
                )
            # nine significant digits identify any float32
            self.ask("values", *(f"{value:.9g}" for value in render_pass.values().values()))
            self.ask("viewport", *area)
            self.ask("draw", *targets)
        return {name: self.pixels(numbers[name], images[numbers[name]]) for name in keep}
