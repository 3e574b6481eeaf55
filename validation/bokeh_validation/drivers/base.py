"""Define the interface of all drivers: passes and textures in, textures out."""

from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np

from bokeh_validation.errors import Unavailable
from bokeh_validation.numerics import images, precision
from bokeh_validation.numerics.images import STORAGE, Textures
from bokeh_validation.shaders.passes import Pass, target_area, target_size

# Parts of device names that mean a software device -> its maker
SOFTWARE = {"llvmpipe": "Mesa", "softpipe": "Mesa", "swiftshader": "SwiftShader", "microsoft basic render": "WARP"}


def software_device(adapter: str) -> str:
    """Return 'Mesa', 'SwiftShader' or 'WARP' if a device runs on the CPU; '' for a GPU."""
    return next((owner for part, owner in SOFTWARE.items() if part in adapter.lower()), "")


def precision_of(adapter: str) -> precision.Precision:
    """Return the precision that the reference has to allow a device."""
    return precision.SOFTWARE if software_device(adapter) in ("Mesa", "SwiftShader") else precision.GPU


PROGRAMS = 64  # kept by a driver between jobs; one takes 3 to 5 MB in Mesa


class Driver:
    """Run passes on a real runtime, or on the reference.

    name              what --driver takes
    adapter           the device, as the runtime names it
    attachment_bytes  most bytes per pixel for all targets of a pass together
    """

    name: str
    adapter: str
    attachment_bytes = 64

    @property
    def software(self) -> bool:
        """Return whether the device is Mesa's software renderer, which filters in exact float32.

        SwiftShader also filters in float32, but its sin() and cos() are off by up to 1.9e-4 (Mesa's by 7e-8). Lines at
        an angle therefore end at slightly different positions, which may exceed the bounds in steps for Mesa.
        """
        return software_device(self.adapter) == "Mesa"

    @property
    def precision(self) -> precision.Precision:
        """Return the precision that the reference has to allow this driver."""
        return precision_of(self.adapter)

    @cached_property
    def rounding(self) -> str:
        """Return how half-float targets round, 'nearest' or 'zero', as measured by half_rounding()."""
        return half_rounding(self)

    def require_adapter(self, adapter: str | None) -> None:
        """Raise Unavailable if `adapter` is given and is not a part of the device's name."""
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

        textures  name -> (H, W, 4) float16 or float32, or (H, W) float32 for depth
        size      (width, height) of every target of scale 1
        storage   'half' or 'float': format of the targets between and after the passes
        Returns name -> (H, W, 4) of the target's size, float16 or float32 as `storage` says.

        A pass with a viewport draws only inside it, where uv runs from 0 to 1. Around it, targets keep what an earlier
        pass wrote to them. A target without an earlier pass is 0 there, even if an input texture has its name.
        """


class Image(NamedTuple):
    """Describe an input texture, or a target, which has no pixels and starts as zeros.

    size     (width, height)
    storage  a key of STORAGE
    """

    name: str
    size: tuple[int, int]
    storage: str
    channels: int = 4
    pixels: np.ndarray | None = None

    @classmethod
    def of(cls, name: str, pixels: np.ndarray) -> "Image":
        """Make an image of pixels (H, W) or (H, W, channels), float16 or float32."""
        storage = next(key for key, dtype in STORAGE.items() if pixels.dtype == dtype)
        channels = 1 if pixels.ndim == 2 else pixels.shape[2]
        return cls(name, pixels.shape[1::-1], storage, channels, np.ascontiguousarray(pixels))

    def shaped(self, data: np.ndarray) -> np.ndarray:
        """Reshape what was read from a target to (H, W, channels)."""
        return data.reshape(*self.size[::-1], self.channels)


class Draw(NamedTuple):
    """Describe a pass by the numbers of its images.

    inputs   slot -> number
    targets  numbers
    area     (x, y, width, height) in texels of the targets that is drawn; the rest is left unchanged
    """

    item: Pass
    inputs: dict[str, int]
    targets: list[int]
    area: tuple[int, int, int, int]


def flattened(
    driver: Driver, passes: Sequence[Pass], textures: Textures, size: tuple[int, int], storage: str
) -> tuple[list[Image], list[Draw], dict[str, int]]:
    """Return the work of `run`: all images, the draws, and target name -> number of the image that holds it in the end.

    Raises Unavailable if the driver cannot write all targets of a pass at once.
    """
    images = [Image.of(name, pixels) for name, pixels in textures.items()]
    numbers, draws = {name: number for number, name in enumerate(textures)}, []
    for render_pass in passes:
        inputs = {slot: numbers[name] for slot, name in render_pass.inputs.items()}
        extent, limit = target_size(render_pass.scale, size), driver.attachment_bytes
        bytes_needed = 4 * np.dtype(STORAGE[storage]).itemsize * len(render_pass.outputs)
        if bytes_needed > limit:
            raise Unavailable(
                f"{driver.adapter} writes {limit} bytes a pixel at once; {render_pass.entry} needs {bytes_needed}"
            )
        for name in render_pass.outputs:
            # a viewport draws into the existing target; otherwise the name refers to a new target from here on
            if not render_pass.viewport or numbers.get(name, -1) < len(textures):
                numbers[name] = len(images)
                images.append(Image(name, extent, storage))
        area = target_area(render_pass.scale, render_pass.viewport) if render_pass.viewport else (0, 0, *extent)
        draws.append(Draw(render_pass, inputs, [numbers[name] for name in render_pass.outputs], area))
    return images, draws, numbers


class DeviceDriver(Driver):
    """Provide `run` for drivers that hold their device's textures in this process: osmesa, egl, wgpu, dxc.

    A subclass creates the textures, and prepares for each pass a step that it can draw.
    """

    def run(self, passes, textures, size, storage="half", keep=("result",)) -> dict[str, np.ndarray]:
        images, draws, numbers = flattened(self, passes, textures, size, storage)
        self.make_current()
        handles = list(map(self.texture, images))
        self.draw([self.step(draw, handles) for draw in draws])
        kept_numbers = {name: numbers[name] for name in keep}
        return {
            name: images[number].shaped(self.pixels(handles[number], images[number])).copy()
            for name, number in kept_numbers.items()
        }

    def make_current(self) -> None:
        """Make the driver's context current; called before anything else."""

    def texture(self, image: Image) -> object:
        """Create a texture with an image's pixels, row 0 (v = 0) first in memory, or a target of zeros."""

    def step(self, draw: Draw, handles: Sequence) -> object:
        """Prepare a pass for drawing; `handles` are the textures and targets by the numbers of their images."""

    def draw(self, steps: Sequence) -> None:
        """Submit the steps to the device without waiting."""

    def pixels(self, handle: object, image: Image) -> np.ndarray:
        """Read a target; the array may have any shape."""


def half_rounding(driver: "Driver") -> str:
    """Return how a driver's half-float targets round what a shader writes: 'nearest', or 'zero' for truncation.

    Measured by storing constants between two half floats in the alpha of the first pass. OpenGL, Vulkan and Direct3D
    allow both. A step in the stored CoC moves every later sample, so the reference has to store as the device does.
    """
    # a quarter and three quarters of a step above half floats of different magnitude, exact in float32
    constants = np.array([base * (1 + k * 2.0**-12) for base in (0.5, 0.0625, 0.3125) for k in (1, 3)])
    passes = [
        Pass("BokehConstantCoC", {"ColorSamp": "color"}, f"{i}", {"BokehConstantCoC": float(c), "BokehMaxCoC": 1.0})
        for i, c in enumerate(constants)
    ]
    names = [name for render_pass in passes for name in render_pass.outputs]
    outputs = driver.run(passes, {"color": np.ones((1, 1, 4), np.float16)}, (1, 1), keep=names)
    stored = np.array([outputs[name][0, 0, 3] for name in names])
    for rounding in ("nearest", "zero"):
        if np.array_equal(stored, images.rounded(constants, np.float16, rounding)):
            return rounding
    raise RuntimeError(f"{driver.name}: half-float targets neither round to nearest nor cut off")
