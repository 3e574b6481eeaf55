"""GLSL ES 3.00 on WebGL 2 (`webgl2`) and WGSL on WebGPU (`webgpu`), both in headless Chromium."""

import base64
from collections.abc import Mapping, Sequence

import numpy as np

from bokeh_validation import browser, shaders
from bokeh_validation.drivers.base import Driver, drawn_over, kind_of, require_targets, storage_type
from bokeh_validation.errors import Unavailable
from bokeh_validation.passes import SAMPLE_TYPES, Pass, is_linear, target_area, target_size

SOFTWARE_DEVICE = "swiftshader"


def packed(pixels: np.ndarray) -> dict[str, object]:
    """(H, W, 4) or (H, W), float16 or float32, as page/job.js takes it."""
    (height, width), (kind, channels) = pixels.shape[:2], kind_of(pixels)
    data = base64.b64encode(np.ascontiguousarray(pixels).tobytes()).decode("ascii")
    return {"width": width, "height": height, "channels": channels, "type": kind, "data": data}


def unpacked(pixels: Mapping, storage: str) -> np.ndarray:
    """(H, W, 4) in the type of `storage`: a half float that came as a float is the same number."""
    data = np.frombuffer(base64.b64decode(pixels["data"]), storage_type(pixels["type"]))
    return data.reshape(pixels["height"], pixels["width"], 4).astype(storage_type(storage))


class BrowserDriver(Driver):
    """What both share: the job as data. A subclass says which program a pass is.

    adapter  None: the software device that comes with Chromium; else a part of the name of the machine's GPU, as
             Chromium tells it (a GPU was never tried)
    """

    name = ""
    # SwiftShader, Chromium's software device, filters in float32 as Mesa does, but its sin() and cos() are off by up to
    # 1.9e-4 (Vulkan allows 4.9e-4; Mesa's are off by 7e-8). So lines at an angle end a little elsewhere: within the
    # interval of a GPU, and not always within the bounds in steps that Mesa is held to.
    software = False

    def __init__(self, adapter: str | None = None):
        self.hardware = adapter is not None and adapter.lower() not in SOFTWARE_DEVICE
        try:
            self.told = self.session.call(f"{self.name}.describe")
        except (browser.Refused, browser.BrowserError) as error:
            raise Unavailable(f"Chromium has no {self.name} on this machine: {error}") from error
        device = self.told["device"]
        if adapter is not None and adapter.lower() not in device.lower():
            raise Unavailable(f"Chromium has no device named like {adapter!r}; it has {device}")
        self.adapter = f"{device}, Chromium {self.session.version}"

    @property
    def session(self) -> browser.Session:
        """The browser: after a crash, a new one."""
        return browser.session(self.hardware)

    def _program(self, item: Pass) -> dict[str, object]:
        """What the page needs to know of a pass's program."""
        raise NotImplementedError

    def _shared(self) -> dict[str, object]:
        """What is the same for all passes of a job."""
        raise NotImplementedError

    def run(self, passes, textures, size, storage="half", keep=("result",)) -> dict[str, np.ndarray]:
        """See Driver."""
        self._require_filter(passes, textures, storage)
        require_targets(self, passes, storage, self.told["attachmentBytes"])
        over = drawn_over(passes, size)
        job = {
            **self._shared(),
            "storage": storage,
            "keep": list(keep),
            "textures": {name: packed(pixels) for name, pixels in textures.items()},
            "passes": [
                {
                    **self._program(item),
                    "outputs": [{"name": name, "over": name in kept} for name in item.outputs],
                    "size": target_size(item.scale, size),
                    "viewport": target_area(item.scale, item.viewport) if item.viewport else None,
                    "values": {name: float(value) for name, value in item.values().items()},
                    "inputs": {
                        slot: {"texture": texture, "linear": is_linear(item.entry, slot)}
                        for slot, texture in item.inputs.items()
                    },
                }
                for item, kept in zip(passes, over, strict=True)
            ],
        }
        kept = self.session.call(f"{self.name}.run", job)
        return {name: unpacked(pixels, storage) for name, pixels in kept.items()}

    def _require_filter(self, passes: Sequence[Pass], textures: Mapping, storage: str) -> None:
        """32-bit textures under a linear filter are an option in WebGL 2 and in WebGPU."""
        if self.told["floatFilterable"]:
            return
        wide = {name for name, pixels in textures.items() if pixels.dtype == np.float32}
        wide |= {name for item in passes for name in item.outputs} if storage == "float" else set()
        for item in passes:
            if any(texture in wide and is_linear(item.entry, slot) for slot, texture in item.inputs.items()):
                raise Unavailable(f"{self.adapter} cannot filter 32-bit float textures; use half floats")


class WebGL2(BrowserDriver):
    """GLSL ES 3.00 through ANGLE."""

    name = "webgl2"

    def _program(self, item: Pass) -> dict[str, object]:
        return {"fragment": shaders.glsl(item.entry, "300es", item.constants)}

    def _shared(self) -> dict[str, object]:
        return {"vertex": shaders.glsl("BokehFullScreen", "300es")}


class WebGPU(BrowserDriver):
    """WGSL through tint and Dawn."""

    name = "webgpu"

    def _program(self, item: Pass) -> dict[str, object]:
        return {"entry": item.entry + "_PS", "constants": item.constants}

    def _shared(self) -> dict[str, object]:
        return {"code": shaders.wgsl(), "vertex": "BokehFullScreen_VS", "slots": SAMPLE_TYPES}
