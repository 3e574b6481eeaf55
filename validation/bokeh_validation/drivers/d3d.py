"""HLSL on Direct3D, compiled by fxc: `d3d9` (ps_3_0) and `d3d11` (ps_5_0), on Wine's Direct3D.

A program of ours (windows/d3d9run.cpp, d3d11run.cpp) runs whole lists of passes; it stays up between calls.
"""

import hashlib

import numpy as np

from bokeh_validation import shaders
from bokeh_validation.compilers import fxc
from bokeh_validation.drivers.base import Driver, flattened, storage_type
from bokeh_validation.errors import Unavailable
from bokeh_validation.shaders.passes import SLOTS, is_linear
from bokeh_validation.windows import programs, server, wine

RUN_S = 300.0  # the largest scene takes 2 s on two cores


class Direct3D(Driver):
    """What both share. A subclass names its program, libraries and shader model."""

    name = ""
    libraries: tuple[str, ...] = ()
    model = 0

    def __init__(self, adapter: str | None = None):
        self._compiled: dict[tuple[str, str], str] = {}
        fxc.load()
        program = programs.build(f"{self.name}run", *self.libraries)
        self.server = server.Server(program)
        self.server.start()
        self.adapter = f"{wine.get().device}, {self.server.greeting}"
        if adapter is not None and adapter.lower() not in self.adapter.lower():
            raise Unavailable(f"{self.name} has no device but {self.adapter}")

    def shader(self, stage: str, entry: str, values: dict[str, object]) -> str:
        """File name of the bytecode of an entry point, in the program's folder. `stage` is 'ps' or 'vs'."""
        source = shaders.hlsl(self.model, values)
        key = (entry, source)
        if key not in self._compiled:
            try:
                code = fxc.bytecode(source, f"{stage}_{self.model}_0", entry)
            except RuntimeError as error:
                if self.model > 3 or not values.get("BOKEH_CHARACTER"):
                    raise
                # it has no room for all of a lens's character
                raise Unavailable(str(error).splitlines()[-1]) from error
            name = f"{hashlib.sha256(code).hexdigest()[:32]}.{stage}"
            (self.server.folder / name).write_bytes(code)
            self._compiled[key] = name
        return self._compiled[key]

    def run(self, passes, textures, size, storage="half", keep=("result",)) -> dict[str, np.ndarray]:
        """See Driver. Raises RuntimeError with what Direct3D said, also after a crash or a hang."""
        images, draws, numbers = flattened(passes, textures, size, storage)
        folder = self.server.folder
        lines, files = [f"vertex {self.shader('vs', 'BokehFullScreen_VS', {})}"], []
        for number, ((width, height), kind, channels) in enumerate(image[1:4] for image in images):
            lines.append(f"texture {number} {width} {height} {kind}{channels}")
            if images[number].pixels is not None:
                files.append(folder / f"texture-{number}")
                files[-1].write_bytes(images[number].pixels.tobytes())
                lines[-1] += f" {files[-1].name}"
        for item, inputs, targets, area in draws:
            lines.append(f"pixel {self.shader('ps', item.entry + '_PS', item.constants)}")
            for slot, number in inputs.items():
                kind = "linear" if is_linear(item.entry, slot) else "nearest"
                lines.append(f"input {SLOTS.index(slot)} {number} {kind}")
            # nine digits are enough for any float32
            values = [f"{value:.9g}" for value in item.values().values()]
            for word, arguments in {"viewport": area, "values": values, "draw": targets}.items():
                lines.append(f"{word} {' '.join(map(str, arguments))}")
        results = {name: folder / f"result-{index}" for index, name in enumerate(keep)}
        lines += [f"keep {numbers[name]} {file.name}" for name, file in results.items()]
        job = folder / f"{self.name}.job"
        job.write_text("\n".join(lines) + "\n", encoding="ascii", newline="\n")
        try:
            ok, answer = self.server.ask(job.name, RUN_S)
            if not ok:
                raise RuntimeError(f"{self.name}: {answer}")
            pixels = {name: np.frombuffer(file.read_bytes(), storage_type(storage)) for name, file in results.items()}
            return {name: images[numbers[name]].shaped(data) for name, data in pixels.items()}
        except server.Ended as error:
            raise RuntimeError(f"{self.name}: {error}") from error
        finally:
            for file in (*files, *results.values()):
                file.unlink(missing_ok=True)


class D3D9(Direct3D):
    """ps_3_0 and vs_3_0 on Direct3D 9."""

    name = "d3d9"
    libraries = ("-ld3d9",)
    model = 3


class D3D11(Direct3D):
    """ps_5_0 and vs_5_0 on Direct3D 11."""

    name = "d3d11"
    libraries = ("-ld3d11",)
    model = 5
