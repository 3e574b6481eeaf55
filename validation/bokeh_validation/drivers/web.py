"""Run GLSL ES 3.00 on WebGL 2 (`webgl2`) and WGSL on WebGPU (`webgpu`), both in headless Chromium."""

import base64
from collections.abc import Mapping

import numpy as np

from bokeh_validation import browser, shaders
from bokeh_validation.drivers.base import Driver, Image, flattened
from bokeh_validation.drivers.webgpu import texture_format
from bokeh_validation.errors import Unavailable
from bokeh_validation.numerics.images import STORAGE
from bokeh_validation.shaders.passes import SAMPLE_TYPES, Pass, is_linear


def packed(image: Image) -> dict[str, object]:
    """Convert an image to the form that page/job.js takes."""
    data = None if image.pixels is None else base64.b64encode(image.pixels.tobytes()).decode("ascii")
    return {"size": image.size, "format": texture_format(image.storage, image.channels), "data": data}


def unpacked(image: Mapping, storage: str) -> np.ndarray:
    """Convert an image from the page to (H, W, 4) in the type of `storage`.

    Half floats may arrive as floats; the numbers are the same.
    """
    data = np.frombuffer(base64.b64decode(image["data"]), np.float16 if "16" in image["format"] else np.float32)
    return data.reshape(*image["size"][::-1], 4).astype(STORAGE[storage])


class BrowserDriver(Driver):
    """Implement what both drivers share: a job as data. A subclass describes the program of a pass.

    adapter  part of the device's name; the only device is the software one that comes with Chromium
    """

    def __init__(self, adapter: str | None = None):
        try:
            described = self.session.call(f"{self.name}.describe")
        except (browser.Refused, browser.BrowserError) as error:
            raise Unavailable(f"Chromium has no {self.name} on this machine: {error}") from error
        self.adapter = f"{described['device']}, Chromium {self.session.version}"
        self.require_adapter(adapter)
        self.attachment_bytes = described["attachmentBytes"]

    @property
    def session(self) -> browser.Session:
        """Return the browser; after a crash, a new one."""
        return browser.session()

    def _program(self, render_pass: Pass) -> dict[str, object]:
        """Return what the page needs to know of a pass's program."""

    def _shared(self) -> dict[str, object]:
        """Return what all passes of a job share."""

    def run(self, passes, textures, size, storage="half", keep=("result",)) -> dict[str, np.ndarray]:
        images, draws, numbers = flattened(self, passes, textures, size, storage)
        job = {**self._shared(), "images": [packed(image) for image in images], "passes": []}
        for render_pass, inputs, targets, area in draws:
            input_images = [
                {"slot": slot, "image": number, "linear": is_linear(render_pass.entry, slot)}
                for slot, number in inputs.items()
            ]
            values = {name: float(value) for name, value in render_pass.values().items()}
            pass_job = {"inputs": input_images, "targets": targets, "area": area, "values": values}
            job["passes"].append({**self._program(render_pass), **pass_job})
        job["keep"] = [numbers[name] for name in keep]
        results = self.session.call(f"{self.name}.run", job)
        return {name: unpacked(image, storage) for name, image in zip(keep, results, strict=True)}


class WebGL2(BrowserDriver):
    """Run GLSL ES 3.00 through ANGLE."""

    name = "webgl2"

    def _program(self, render_pass: Pass) -> dict[str, object]:
        return {"fragment": shaders.glsl(render_pass.entry, "300es", render_pass.constants)}

    def _shared(self) -> dict[str, object]:
        return {"vertex": shaders.glsl("BokehFullScreen", "300es")}


class WebGPU(BrowserDriver):
    """Run WGSL through Tint and Dawn."""

    name = "webgpu"

    def _program(self, render_pass: Pass) -> dict[str, object]:
        return {"entry": render_pass.entry + "_PS", "constants": render_pass.constants}

    def _shared(self) -> dict[str, object]:
        return {"code": shaders.wgsl(), "vertex": "BokehFullScreen_VS", "slots": SAMPLE_TYPES}
