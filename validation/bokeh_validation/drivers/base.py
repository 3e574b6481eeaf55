"""The one interface of all drivers: passes and textures in, textures out."""

from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np

from bokeh_validation.errors import Unavailable
from bokeh_validation.numerics import images, precision
from bokeh_validation.numerics.images import STORAGE, Textures
from bokeh_validation.shaders.passes import Pass, target_area, target_size

# Parts of the names of devices that are programs on this machine's cores -> whose they are
SOFTWARE = {"llvmpipe": "Mesa", "softpipe": "Mesa", "swiftshader": "SwiftShader", "microsoft basic render": "WARP"}


def software_device(adapter: str) -> str:
    """'Mesa', 'SwiftShader' or 'WARP' where a device is a program of theirs; '' for a GPU."""
    return next((owner for part, owner in SOFTWARE.items() if part in adapter.lower()), "")


def precision_of(adapter: str) -> precision.Precision:
    """What the reference has to allow a device."""
    known = {"Mesa": precision.SOFTWARE, "SwiftShader": precision.SWIFTSHADER}
    return known.get(software_device(adapter), precision.GPU)


PROGRAMS = 64  # kept by a driver between jobs: in Mesa one takes 3 to 5 MB


class Driver:
    """A real runtime, or the reference.

    name              what --driver takes
    adapter           the device behind it, as the runtime names it
    attachment_bytes  that all targets of a pass may have together for a pixel
    """

    name: str
    adapter: str
    attachment_bytes = 64

    @property
    def software(self) -> bool:
        """Whether the texture unit is Mesa's software one: exact float32 filtering.

        SwiftShader's filters in float32 too, but its sin() and cos() are off by up to 1.9e-4 (Mesa's by 7e-8), so lines
        at an angle end a little elsewhere: not always within the bounds in steps that Mesa is held to.
        """
        return software_device(self.adapter) == "Mesa"

    @property
    def precision(self) -> precision.Precision:
        """What the reference has to allow it."""
        return precision_of(self.adapter)

    @cached_property
    def rounding(self) -> str:
        """How its half-float targets round, 'nearest' or 'zero': measured, see half_rounding()."""
        return half_rounding(self)

    def require_adapter(self, adapter: str | None) -> None:
        """Raise Unavailable where a device was asked for by a part of its name, and it is another."""
        if adapter is not None and adapter.lower() not in self.adapter.lower():
            raise Unavailable(f"{self.name} has no device named like {adapter!r}; it has {self.adapter}")

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
        size      (width, height) of every target of scale 1
        storage   'half' or 'float': format of the targets between and after the passes
        returns   name -> (H, W, 4) of the target's size, float16 or float32 by `storage`

        A pass with a viewport draws nothing outside of it; uv runs 0 .. 1 over it. What an earlier pass has left in its
        targets stays around it; a target that no earlier pass has made is 0 there, also where a texture of that name
        was handed in.
        """


class Image(NamedTuple):
    """A texture of some passes that was handed in, or a target, which has no pixels: 0 everywhere at first.

    size  (width, height)
    """

    name: str
    size: tuple[int, int]
    storage: str
    channels: int = 4
    pixels: np.ndarray | None = None

    @classmethod
    def of(cls, name: str, pixels: np.ndarray) -> "Image":
        """(H, W) or (H, W, channels), float16 or float32."""
        storage = next(known for known, dtype in STORAGE.items() if pixels.dtype == dtype)
        channels = 1 if pixels.ndim == 2 else pixels.shape[2]
        return cls(name, pixels.shape[1::-1], storage, channels, np.ascontiguousarray(pixels))

    def shaped(self, data: np.ndarray) -> np.ndarray:
        """What was read from a target, as (H, W, channels)."""
        return data.reshape(*self.size[::-1], self.channels)


class Draw(NamedTuple):
    """A pass by the numbers of its images.

    inputs  slot -> number
    area    (x, y, width, height) in texels of the targets: what is drawn; the rest of them stays as it was
    """

    item: Pass
    inputs: dict[str, int]
    targets: list[int]
    area: tuple[int, int, int, int]


def flattened(
    driver: Driver, passes: Sequence[Pass], textures: Textures, size: tuple[int, int], storage: str
) -> tuple[list[Image], list[Draw], dict[str, int]]:
    """What `run` is to do: all images, the draws, and name -> number of the image that has it at the end.

    Raises Unavailable where the driver cannot write all targets of a pass at once.
    """
    images = [Image.of(name, pixels) for name, pixels in textures.items()]
    numbers, draws = {name: number for number, name in enumerate(textures)}, []
    for item in passes:
        inputs, extent = {slot: numbers[name] for slot, name in item.inputs.items()}, target_size(item.scale, size)
        needed, limit = 4 * np.dtype(STORAGE[storage]).itemsize * len(item.outputs), driver.attachment_bytes
        if needed > limit:
            raise Unavailable(f"{driver.adapter} writes {limit} bytes a pixel at once; {item.entry} needs {needed}")
        for name in item.outputs:
            # what a viewport is drawn over; else the name is that of a new target from here on
            if not item.viewport or numbers.get(name, -1) < len(textures):
                numbers[name] = len(images)
                images.append(Image(name, extent, storage))
        area = target_area(item.scale, item.viewport) if item.viewport else (0, 0, *extent)
        draws.append(Draw(item, inputs, [numbers[name] for name in item.outputs], area))
    return images, draws, numbers


class DeviceDriver(Driver):
    """A driver that holds textures of its device in this process: osmesa, egl, wgpu, dxc.

    A subclass makes the textures, and of each pass a step: whatever it draws it from.
    """

    def run(self, passes, textures, size, storage="half", keep=("result",)) -> dict[str, np.ndarray]:
        images, draws, numbers = flattened(self, passes, textures, size, storage)
        self.make_current()
        handles = list(map(self.texture, images))
        self.draw([self.step(draw, handles) for draw in draws])
        kept = {name: numbers[name] for name in keep}
        return {name: images[at].shaped(self.pixels(handles[at], images[at])).copy() for name, at in kept.items()}

    def make_current(self) -> None:
        """Called before anything else here."""

    def texture(self, image: Image) -> object:
        """A texture with the pixels of an image, row 0, v = 0, first in memory; or a target of zeros."""

    def step(self, draw: Draw, handles: Sequence) -> object:
        """A pass ready to be drawn; `handles` are the textures and targets by the numbers of their images."""

    def draw(self, steps: Sequence) -> None:
        """Give the steps to the device; does not wait."""

    def pixels(self, handle: object, image: Image) -> np.ndarray:
        """The contents of a target, of any shape."""


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
